#!/usr/bin/env python3
"""All pairs of what a user can ask for, in a small scene: combinations.py BIN [--every N] [--keep FOLDER]

Run at the top of the tree; BIN is the folder with the tools. A closed room with a lamp under its ceiling,
a box that moves and a camera on a dolly, frames 1 to 3. Each pair is rendered by make, and the mean of
each frame is compared with path tracing that has the same shutter, lens and smoke. A pair is right if the
difference is below 2 % (METHOD=preview: 10 %, since a preview is rough) and 4 standard errors of the
path-traced mean, and no pixel is NaN or infinite. Or it is refused with one line and exit code 2. `--every
N`: each Nth pair, a short form. The whole table: `make evidence PARTS=combinations`.
"""

import argparse
import itertools
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "tests" / "stress"))
import exr  # noqa: E402
from scenes import Scene, box_mesh  # noqa: E402

FRAMES, SIZE = (1, 2, 3), "64x36"
SAMPLES = 256  # of a path-traced pixel
LIMIT, OF_PREVIEW = 0.02, 0.10
SMOKE = {"VOLUME": "smoke.vdb", "VOLUME_OPTIONS": "--sigma-t 2 --albedo .8"}
ASKED = {
    "shutter": {"SHUTTER": "180"},
    "lens": {"FSTOP": ".5", "FOCUS": "1.5"},
    "kept pixels": {"METHOD": "still"},
    "walkthrough": {"METHOD": "walkthrough"},
    "preview": {"METHOD": "preview"},
    "smoke": SMOKE,
    "FILTER=5": {"FILTER": "5"},
    "light over time": {"MOVING": "time", "INDIRECT": "records"},
    "gathering": {"INDIRECT": "gather"},
    "SPLIT": {"SPLIT": "on"},
    "mattes": {"CHANNELS": "RGBA,cryptomatte"},
    "farm": {"RUN": "sh RUNNER", "GROUP": "frame"},
}
OF_PATHS = {
    "shutter": ["--shutter", "180"],
    "lens": ["--f-stop", ".5", "--focus", "1.5"],
    "smoke": ["--volume", "smoke.vdb", "--sigma-t", "2", "--albedo", ".8"],
}


def make_scene(folder):
    scene = Scene()
    scene.room((-1, 0, -1), (1, 2, 1), scene.material([0.7, 0.6, 0.5]))
    scene.quad(
        (-0.4, 1.98, -0.4), (0.4, 1.98, -0.4), (0.4, 1.98, 0.4), (-0.4, 1.98, 0.4), scene.material(0.0, 6.0)
    )
    scene.mesh(
        *box_mesh((-0.7, 0, -0.8), (-0.3, 0.7, -0.4)),
        scene.material(0.8, metallic=1.0, roughness=0.3, specular=1.0),
    )
    box = scene.mesh(*box_mesh((-0.15, -0.15, -0.15), (0.15, 0.15, 0.15)), scene.material([0.2, 0.4, 0.7]))
    camera = scene.camera((0.1, 1.0, 0.95), (0, 0.9, -1), fov=1.0)
    scene.animate(box, "translation", [0, 4 / 24], [(-0.2, 0.4, 0), (0.4, 0.5, 0)])
    scene.animate(camera, "translation", [0, 4 / 24], [(0.1, 1.0, 0.95), (0.05, 1.0, 0.93)])
    scene.save(folder / "room.glb")


def make_smoke(tools, folder):
    """A ball of density 1 above the floor; False without make-vdb."""
    program = tools.parent / "tests" / "make-vdb"
    if not os.access(program, os.X_OK):
        return False
    (folder / "smoke.vdb").unlink(missing_ok=True)
    values = b"".join(
        struct.pack("<f", max(0.0, 1 - math.dist((x, y, z), (7.5,) * 3) / 6))
        for x in range(16)
        for y in range(16)
        for z in range(16)
    )
    subprocess.run(
        [program, folder / "smoke.vdb", "16", "16", "16", ".06", "-.45", ".3", "-.45"],
        input=values,
        check=True,
    )
    return True


class Means:
    """Means of path-traced frames by what is asked of them; each is made once."""

    def __init__(self, tools, folder):
        self.tools, self.folder, self.known = tools, folder, {}

    def of(self, frame, names):
        """(mean of the picture, its standard error)"""
        key = (frame, *sorted(name for name in names if name in OF_PATHS))
        if key not in self.known:
            file = self.folder / "path.exr"
            words = [word for name in key[1:] for word in OF_PATHS[name]]
            subprocess.run(
                [
                    self.tools / "frame-render",
                    "room.glb",
                    "--integrator",
                    "path",
                    "--spp",
                    str(SAMPLES),
                    "--halves",
                    "--size",
                    SIZE,
                    "--frame",
                    str(frame),
                    *words,
                    "--channels",
                    "RGBA",
                    "-q",
                    "-o",
                    file,
                ],
                cwd=self.folder,
                check=True,
            )
            halves = [exr.read(file.with_name(f"path_{h}.exr")) for h in "ab"]
            mean = sum(mean_of(half) for half in halves) / 2
            self.known[key] = (mean, spread_of(*halves) / math.sqrt(halves[0].width * halves[0].height))
        return self.known[key]


def mean_of(image):
    return math.fsum(v for c in "RGB" for v in image.channels[c]) / (3 * image.width * image.height)


def spread_of(a, b):
    """Standard deviation of a pixel's mean of both halves, mean over pixels."""
    squares = [
        sum((x - y) / 6 for x, y in values) ** 2
        for values in zip(*(zip(a.channels[c], b.channels[c]) for c in "RGB"))
    ]
    return math.sqrt(math.fsum(squares) / len(squares))


class Runner:
    def __init__(self, tools, folder):
        self.tools, self.folder, self.means = tools, folder, Means(tools, folder)
        (folder / "runner").write_text('exec "$@"\n')

    def make(self, variables):
        """What went wrong, as one line, or None; frames lie in self.folder/out."""
        out = self.folder / "out"
        shutil.rmtree(out, ignore_errors=True)
        words = {
            "SCENE": "room.glb",
            "FRAMES": f"{FRAMES[0]}-{FRAMES[-1]}",
            "SIZE": SIZE,
            "OUT": "out",
            "BIN": self.tools,
            "PHOTONS": "100k",
        } | variables
        words = {
            name: str(value).replace("RUNNER", str(self.folder / "runner")) for name, value in words.items()
        }
        environment = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith("MAKE") and name != "MFLAGS"
        }
        done = subprocess.run(
            ["make", "-s", "-f", TOP / "Makefile.example", "demo", *(f"{n}={v}" for n, v in words.items())],
            cwd=self.folder,
            capture_output=True,
            text=True,
            env=environment,
        )
        if done.returncode == 0:
            return None
        lines = [line for line in done.stderr.splitlines() if not line.startswith("make")]
        return (
            lines[0]
            if len(lines) == 1 and done.returncode == 2
            else f"FAIL: exit {done.returncode}: {' / '.join(lines)[-300:]}"
        )

    def verdict(self, names):
        """What became of a pair."""
        variables = {}
        for name in names:
            if clash := [
                word for word in ASKED[name] if word in variables and variables[word] != ASKED[name][word]
            ]:
                return f"one variable: {clash[0]}"
            variables |= ASKED[name]
        refused = self.make(variables)
        if refused:
            return refused if refused.startswith("FAIL") else f"refused: {refused}"
        most = 0.0
        for frame in FRAMES:
            image = exr.read(self.folder / "out" / "frames" / f"{frame:04d}.exr")
            if image.not_finite():
                return f"FAIL: not finite: {image.not_finite()}"
            mean, error = self.means.of(frame, names)
            difference = mean_of(image) / mean - 1
            limit = (OF_PREVIEW if "preview" in names else LIMIT) + 4 * error / mean
            if abs(difference) > limit:
                return f"FAIL: frame {frame}: mean {100 * difference:+.1f} % (limit {100 * limit:.1f})"
            most = max(most, difference, key=abs)
        return f"right: {100 * most:+.1f} %"


def table(rows):
    """(header, rows of cells, notes on what is refused): a cell for each pair."""
    names = list(ASKED)
    cells, notes = {frozenset(pair): verdict for pair, verdict in rows}, []

    def cell(a, b):
        verdict = cells.get(frozenset((a, b)), "")
        if not verdict.startswith("refused"):
            return verdict.removeprefix("right: ")
        notes.append(f"({len(notes) + 1}) {a} and {b}: {verdict}")
        return f"refused ({len(notes)})"

    found = [
        [b, *(cell(a, b) for a in names[: i + 1]), *[""] * (len(names) - 1 - i)] for i, b in enumerate(names)
    ]
    return ["", *names], found, notes


def verdicts(tools, folder, every=1):
    """[(pair, verdict)] of each `every`-th pair; without make-vdb there is no smoke."""
    make_scene(folder)
    runner = Runner(tools, folder)
    if not make_smoke(tools, folder):
        ASKED.pop("smoke", None)
    pairs = [(name,) for name in ASKED] + list(itertools.combinations(ASKED, 2))
    for pair in pairs[::every]:
        yield pair, runner.verdict(pair)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("bin", type=Path)
    parser.add_argument("--every", type=int, default=1, metavar="N", help="each Nth pair")
    parser.add_argument("--keep", type=Path, help="work in this folder and keep it")
    args = parser.parse_args()
    folder = args.keep or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    try:
        rows = []
        for pair, verdict in verdicts(args.bin.resolve(), folder, args.every):
            rows.append((pair, verdict))
            print(f"{' + '.join(pair):32} {verdict}", flush=True)
        failed = [verdict for _, verdict in rows if verdict.startswith("FAIL")]
        print(f"{len(rows)} pairs, {len(failed)} failed")
        sys.exit(1 if failed else 0)
    finally:
        if not args.keep:
            shutil.rmtree(folder)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Instructions of every tool on a scene without texture, gloss, glass and environment, against the tools of before those.

    python3 tests/bench/bench.py --only instructions               builds the old tools first, once, in its output folder
    python3 tests/bench/instructions.py OLD/bin NEW/bin            the table alone
"""
import argparse
import json
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import results_page
from measure import Missing, figure, percent

BEFORE = "fee73c3"            # the last commit before textures, rough glass and environments
IMAGES = ("OpenImageIO", "OpenEXR", "libpng", "libjpeg")


def before(bench):
    """Folder of the old tools."""
    folder = bench.out / "before" / BEFORE
    if bench.tiny:
        return bench.bin
    if not (folder / "build" / "bin" / "frame-render").exists():
        if subprocess.run(["git", "-C", str(bench.project), "cat-file", "-e", BEFORE], capture_output=True).returncode != 0:
            raise Missing(f"commit {BEFORE} is not in this repository")
        print(f"  building the tools of {BEFORE} ...", flush=True)
        (folder / "source").mkdir(parents=True, exist_ok=True)
        archive = subprocess.run(["git", "-C", str(bench.project), "archive", BEFORE], capture_output=True, check=True)
        subprocess.run(["tar", "-x", "-C", str(folder / "source")], input=archive.stdout, check=True)
        bench.run(["cmake", "-G", "Ninja", "-S", folder / "source", "-B", folder / "build", "-DCMAKE_BUILD_TYPE=Release",
                   "-DTEMPOLUX_TESTS=OFF", "-DTEMPOLUX_BENCH=OFF"])
        bench.run(["ninja", "-C", folder / "build"])
    return folder / "build" / "bin"


def commands(scene, folder):
    """(title, command): every setting is named, as defaults have changed."""
    common = [scene, "--frame", 10, "--threads", 1, "--seed", 1, "-q"]
    photons, points, cache = (folder / f"a.{end}" for end in ("photons", "irradpoints", "irradcache"))
    path, frame = folder / "path.exr", folder / "a.exr"
    render = ["frame-render", *common, "--size", "64x36"]
    return [("scene-plan, 48 frames", ["scene-plan", scene, "--frames", "0-47", "-q", "-o", folder / "plan"]),
            ("photon-trace, 20k paths", ["photon-trace", *common, "--photons", "20k", "--kinds", "caustic,indirect",
                                         "-o", photons]),
            ("irradcache-build points, 2k", ["irradcache-build", "points", *common, "--photons", photons, "--point-count", "2k",
                                             "--light-samples", 2, "-o", points]),
            ("irradcache-build records, 64x36", ["irradcache-build", "records", *common, "--points", points, "--size", "64x36",
                                                 "--rays", 50, "--error-bound", 0.5, "-o", cache]),
            ("frame-render, path, 4 samples", [*render, "--integrator", "path", "--spp", 4, "-o", path]),
            ("frame-render, photons, 1 sample", [*render, "--photons", photons, "--spp", 1, "--pixel-error", 0, "-o", frame]),
            ("frame-render, cache, 4 samples", [*render, "--irradcache", cache, "--points", points, "--spp", 4,
                                                "--pixel-error", 0, "-o", frame]),
            ("tempolux-info, a frame", ["tempolux-info", path]),
            ("aqm-compare, two frames", ["aqm-compare", path, frame, "-q", "--json", folder / "a.json"]),
            ("error-report --help", ["error-report", "--help"])]


def count(binary, command, profile):
    """Instructions of one process, by callgrind."""
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile}", str(binary / command[0]),
                           *map(str, command[1:])], capture_output=True, text=True)
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or not found:
        raise RuntimeError(f"valgrind, {command}: {done.stderr[-400:]}")
    return int(found.group(1))


def gather_rays(binary, command, stats):
    subprocess.run([str(binary / command[0]), *map(str, command[1:]), "--stats", str(stats)], check=True, capture_output=True)
    return json.loads(stats.read_text())["counts"]["gather_rays"]


def linked(tool):
    """What reads images and is loaded whenever the tool starts."""
    libraries = subprocess.run(["ldd", str(tool)], capture_output=True, text=True).stdout
    return ", ".join(name for name in IMAGES if name in libraries) or "none"


def table(old, new, scene, quick=False):
    """Rows, and whether no tool takes 1 % more."""
    if not shutil.which("valgrind"):
        raise Missing("valgrind is not installed")
    rows, met = [], True
    with tempfile.TemporaryDirectory() as scratch:
        folders = [Path(scratch) / side for side in ("old", "new")]
        for folder in folders:
            folder.mkdir()
        both = list(zip(*(commands(scene, folder) for folder in folders)))
        for (title, was), (_, now) in both[:1] if quick else both:
            sides = [(old, was, folders[0]), (new, now, folders[1])]
            counts = [count(binary, command, folder / "callgrind") for binary, command, folder in sides]
            libraries = linked(new / now[0])
            if "records" in title:
                rows.append([title, *(f"{n:,}" for n in counts), percent(counts[1] / counts[0] - 1), "not judged", libraries])
                counts = [n / gather_rays(binary, command, folder / "stats.json")
                          for n, (binary, command, folder) in zip(counts, sides)]
                title = "the same, per gather ray"
            good = counts[1] <= 1.01 * counts[0]
            met = met and good
            rows.append([title, *(f"{n:,.0f}" for n in counts), percent(counts[1] / counts[0] - 1),
                         "met" if good else "**missed**", libraries])
    return rows, met


HEADER = ["on S2", f"instructions, {BEFORE}", "now", "change", "at most 1 % more", "image libraries it starts with"]


def instructions(bench, _):
    """Instructions on a scene without texture, gloss, glass, environment, against the tools of before there were any."""
    rows, met = table(before(bench), bench.bin, bench.scene("S2")[0], bench.tiny)
    return figure("What a scene does not use: instructions, against the tools before textures, rough glass and environments",
                  "at most 1 % more of every tool; OpenImageIO never loaded", HEADER, rows, None if bench.tiny else met,
                  ["callgrind, one thread. More gather rays are traced where light is uneven than then, for the sake of their "
                   "error, and in packets: records are judged per ray."])


FIGURES = {"instructions": instructions}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path, help="folder of the old tools")
    parser.add_argument("new", type=Path, help="folder of the tools")
    args = parser.parse_args()
    scenes = Path(__file__).resolve().parents[2] / "pipelines" / "scenes"
    print(results_page.table(HEADER, table(args.old, args.new, scenes / "S2_cornell_moving.glb")[0]))

#!/usr/bin/env python3
"""A frame is the same whichever range is asked for: same_bytes.py BIN [--size 48x27] [--long]

Run at the top of the tree; BIN is the folder with the tools.

Bytes: frame 12 of the demo by FRAMES=12, 0-12, 0-47 and 12-200, for several METHOD, MOVING and FILTER. Make is asked for that one frame, so a
range costs what the frame needs. The digests are equal.

Means: in scenes where something comes and goes (../shared/scenes/made/cases: late, blink, passer), frames of METHOD=frames, walkthrough and
auto have the mean of the same frame made alone, within 1 %. --long compares 24 frames of each scene at 160x90, else 4 frames at 64x36.
Scenes that are not there are left out.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

# The makes started here are independent of the make that runs the tests.
for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
    os.environ.pop(name, None)

CASES = Path("../shared/scenes/made/cases")
if not CASES.is_dir():
    CASES = Path(os.environ.get("TEMPOLUX_SCENES", "/nowhere")) / "made" / "cases"
SMALL = {"QUALITY": "draft", "PHOTONS": "10k", "CACHE": "--rays 60", "POINTS": "--point-count 1k --light-samples 1"}
RANGES = ["12", "0-12", "0-47", "12-200"]
MODES = [{}, {"QUALITY": "final", "MOVING": "light"}, {"QUALITY": "final", "MOVING": "records"}, {"QUALITY": "final", "MOVING": "time"}, {"METHOD": "auto"},
         {"METHOD": "walkthrough"}, {"FILTER": "3"}]
# Frames at which something comes or goes, and others.
LOOKED = {"late": [0, 29, 30, 40], "blink": [2, 3, 5, 6], "passer": [0, 4, 8, 12]}


def make(tools, out, variables, goal):
    command = ["nice", "make", "-f", "Makefile.example", "--no-print-directory", goal, f"OUT={out}", f"BIN={tools}", *(f"{k}={v}" for k, v in variables.items())]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900)
    if done.returncode:
        raise RuntimeError(" ".join(command[2:]) + "\n" + (done.stdout + done.stderr)[-800:])


def digest(tools, path):
    return subprocess.run([tools / "tempolux-info", "--digest", path], capture_output=True, text=True, check=True).stdout.split()[0]


def means(tools, path):
    """Mean of R, G, B, in the frame's unit of radiance."""
    facts = json.loads(subprocess.run([tools / "tempolux-info", "--json", path], capture_output=True, text=True, check=True).stdout)
    facts = facts[0] if isinstance(facts, list) else facts
    return [next(c["mean"] for c in facts["channels"] if c["channel"] == name) for name in "RGB"]


def same_bytes(tools, folder, size):
    failed = 0
    for number, mode in enumerate(MODES):
        digests = {}
        for frames in RANGES:
            out = folder / f"{number}_{frames}"
            try:
                make(tools, out, SMALL | mode | {"FRAMES": frames, "SIZE": size}, f"{out}/frames/0012.exr")
                digests[frames] = digest(tools, out / "frames" / "0012.exr")
            except RuntimeError as error:
                digests[frames] = f"failed: {error}"
        good = len(set(digests.values())) == 1 and not digests["12"].startswith("failed")
        failed += not good
        title = " ".join(f"{k}={v}" for k, v in mode.items()) or "as it comes"
        print(f"{'ok' if good else 'FAILED'}: frame 12, {title}" + ("" if good else "".join(f"\n    FRAMES={r}: {d}" for r, d in digests.items())), flush=True)
    return failed


def same_means(tools, folder, size, frames_of, small, only):
    failed = 0
    for name, looked in frames_of.items():
        if only not in name:
            continue
        scene = CASES / f"{name}.glb"
        if not scene.exists():
            print(f"left out: {scene} is not there")
            continue
        variables = small | {"SCENE": str(scene), "SIZE": size}
        alone = {}
        for frame in looked:
            out = folder / f"{name}_alone_{frame}"
            make(tools, out, variables | {"FRAMES": str(frame)}, f"{out}/frames/{frame:04d}.exr")
            alone[frame] = means(tools, out / "frames" / f"{frame:04d}.exr")
        for method in ("frames", "auto", "walkthrough"):
            out = folder / f"{name}_{method}"
            make(tools, out, variables | {"FRAMES": f"0-{max(looked)}", "METHOD": method}, "demo")
            wrong = []
            for frame in looked:
                there = means(tools, out / "frames" / f"{frame:04d}.exr")
                worst = max(abs(a - b) for a, b in zip(there, alone[frame])) / (sum(alone[frame]) / 3)
                wrong += [(100 * worst, frame)] if worst > 0.01 else []
            failed += bool(wrong)
            print(f"{'FAILED' if wrong else 'ok'}: {name}, METHOD={method}: {len(wrong)} of {len(looked)} frames differ by more than 1 % in the mean" +
                  "".join(f"\n    frame {frame}: {percent:.1f} %" for percent, frame in sorted(wrong, reverse=True)[:4]), flush=True)
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=Path)
    parser.add_argument("--size", default="48x27")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--only", default="", help="bytes, late, blink or passer")
    arguments = parser.parse_args()
    tools = arguments.bin.resolve()
    with tempfile.TemporaryDirectory(prefix="bytes") as folder:
        folder = Path(folder)
        failed = same_bytes(tools, folder, arguments.size) if arguments.only in "bytes" else 0
        if arguments.long:
            looked = {"late": range(24, 48), "blink": range(0, 17), "passer": range(0, 24)}
            failed += same_means(tools, folder, "160x90", {name: list(frames) for name, frames in looked.items()}, {"QUALITY": "draft"}, arguments.only)
        else:
            failed += same_means(tools, folder, "64x36", LOOKED, SMALL, arguments.only)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

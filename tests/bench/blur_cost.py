#!/usr/bin/env python3
"""What shutter and lens cost: QUALITY=final with both, SHUTTER=180 FSTOP=2.8, beside final without.

    python3 -B tests/bench/blur_cost.py --out /tmp/cost --scenes S2,S8

Frames of 320x180 of two seeds or more at several pixel errors, the sides alternating. By side and pixel error: CPU seconds of
the frame's commands, noise between seeds in 8-bit sRGB codes of one exposure for both sides, and, where OUT has halves of
a path-traced reference (OUT/NAME.sharp_a.exr, _b.exr, OUT/NAME.blurred_a.exr, _b.exr), the error against them. Then CPU
seconds at equal error, else at equal noise, between the points along straight lines of logarithms. Frames that exist are
used again.
"""

import itertools
import json
import math
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import blur
import exr
import filter_few
import pipeline
import pixels
from seen import Seen

TOP = Path(__file__).resolve().parents[2]
SIDES = {"sharp": {"SHUTTER": 0, "FSTOP": 0}, "blurred": {"SHUTTER": 180, "FSTOP": 2.8}}


def cases(shared):
    """By name: frame, variables of make, what is sharp [m]: the median depth."""
    made = shared / "made"
    window = {"SCENE": made / "S8_window_room.glb", "CAMERA": "cam", "LIGHT_UNITS": "spec", "SKY": "1.1,1.5,2"}
    return {"S2": (12, {"SCENE": made / "S2_cornell_moving.glb"}, 2.73), "S8": (17, window, 3.85)}


def frame_of(options, name, seed, error, side):
    """Planes of the frame and CPU seconds of the commands that make it from light."""
    kept = options.out / f"{name}.{seed}.{error}.{side}"
    file, cost = kept.with_name(kept.name + ".exr"), kept.with_name(kept.name + ".json")
    if not cost.exists():
        frame, variables, focus = cases(options.shared)[name]
        wish = {"SIZE": options.size, "FRAMES": frame, "METHOD": "frames", "QUALITY": "final", "CHANNELS": "RGBA,Z"}
        wish |= variables | SIDES[side] | {"FOCUS": focus, "PIXELS": f"--spp 4 --pixel-error {error}"}
        out, env = options.out / f"{name}.{seed}", pipeline.environment() | {"MEASURE_SEED": str(seed)}
        command = pipeline.command(TOP, options.bin, out, f"frames/{frame:04d}.exr", **wish)
        subprocess.run(command, check=True, env=env, stdout=subprocess.DEVNULL)
        shutil.copy(pipeline.frame_of(out, frame), file)
        cost.write_text(json.dumps(pipeline.cpu_of(out)["frames"]))
    return pixels.planes(exr.read(file)), json.loads(cost.read_text())


def mean_square(one, two):
    return statistics.fmean((x - y) ** 2 for pair in zip(one, two) for x, y in zip(*pair))


def cost_at(points, codes):
    """CPU seconds [s] of a side at an error or noise [codes], along the logarithms of (codes, CPU seconds)."""
    points = sorted((math.log(c), math.log(cpu)) for c, cpu in points)
    i = max(0, min(len(points) - 2, sum(c <= math.log(codes) for c, _ in points) - 1))
    (x0, y0), (x1, y1) = points[i], points[i + 1]
    return math.exp(y0 + (math.log(codes) - x0) * (y1 - y0) / (x1 - x0))


def main():
    options = blur.options_of(__doc__, "S2,S8", errors=("0.032,0.016,0.008", "pixel errors; final has 0.016"), seeds=("1,2", "seeds of a frame"))
    options.out.mkdir(parents=True, exist_ok=True)
    seeds = options.seeds.split(",")
    for name in options.scenes.split(","):
        halves = {side: [options.out / f"{name}.{side}_{half}.exr" for half in "ab"] for side in SIDES}
        judged = all(file.exists() for files in halves.values() for file in files)
        points, exposure = {side: [] for side in SIDES}, None
        for error in options.errors.split(","):
            found = {side: [] for side in SIDES}
            for seed, side in itertools.product(seeds, SIDES):
                found[side].append(frame_of(options, name, seed, error, side))
            for side, frames in found.items():
                exposure = exposure or Seen(frames[0][0], frames[0][0])
                codes = [exposure.codes(planes) for planes, _ in frames]
                noise = math.sqrt(statistics.fmean(mean_square(*pair) / 2 for pair in itertools.combinations(codes, 2)))
                cpu = statistics.fmean(cost for _, cost in frames)
                off = noise
                if judged:
                    truth = Seen(*(pixels.planes(exr.read(file)) for file in halves[side]))
                    off = statistics.fmean(truth.error(planes) for planes, _ in frames)
                points[side].append((off, cpu))
                beside = f", error {off:.2f}" if judged else ""
                print(f"{name} {side:8} {error:6} CPU {cpu:6.2f} s, noise {noise:.2f} codes{beside}", flush=True)
        for codes, cpu in points["sharp"]:
            other = cost_at(points["blurred"], codes)
            print(f"{name} at {codes:.2f} codes: sharp {cpu:.2f} s, blurred {other:.2f} s, {other / cpu:.2f} times")


if __name__ == "__main__":
    main()

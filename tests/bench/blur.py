#!/usr/bin/env python3
"""What st-filter blur errs by, beside frames that were rendered with the lens and the shutter.

    python3 -B tests/bench/blur.py --bin build/release/bin --out /tmp/blur --scenes S2,S4,evening_shot

For each scene, two seeds of everything: the chain's sharp frame, and its frames under a shutter of 180 degrees, a lens of
f/2.8 that is focused on the median depth, both, and much of both: 720 degrees and f/0.35. Files that exist are used again. Printed in 8-bit sRGB codes, for
single pixels and boxes of 5x5 and 15x15: the difference to the rendered frame of the other seed, less the variance of
that frame, of the sharp frame and of the sharp frame blurred.
"""

import argparse
import math
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import filter_few
import pipeline
import pixels

TOP = Path(__file__).resolve().parents[2]
SEEDS = (1, 2)
KINDS = {
    "shutter": {"SHUTTER": 180},
    "lens": {"FSTOP": 2.8},
    "both": {"SHUTTER": 180, "FSTOP": 2.8},
    "much": {"SHUTTER": 720, "FSTOP": 0.35},
}


def rendered(options, name, seed, kind, wish):
    """The frame that the chain renders; `kind` names its file."""
    file = options.out / name / str(seed) / f"{kind}.exr"
    if file.exists():
        return file
    frame, variables = filter_few.scenes(options.shared)[name]
    sharp = {"FSTOP": 0, "SHUTTER": 0}
    wish = {"SIZE": options.size, "FRAMES": frame, "FILTER": 1, "METHOD": "frames", "CHANNELS": "RGBA,Z,id,motion"} | variables | sharp | wish
    env = pipeline.environment() | {"MEASURE_SEED": str(seed)}
    out = options.out / name / str(seed) / "make"
    subprocess.run(pipeline.command(TOP, options.bin, out, "demo", **wish), check=True, env=env, stdout=subprocess.DEVNULL)
    Path(pipeline.frame_of(out, frame)).rename(file)
    return file


def blurred(options, file, kind, focus):
    out = file.with_name(f"{kind}.of-sharp.exr")
    words = []
    if "SHUTTER" in KINDS[kind]:
        words += ["--shutter", KINDS[kind]["SHUTTER"]]
    if "FSTOP" in KINDS[kind]:
        words += ["--f-stop", KINDS[kind]["FSTOP"], "--focus", focus]
    subprocess.run([options.bin / "st-filter", "blur", file, *map(str, words), "-o", out, "-q"], check=True)
    return out


def options_of(page, scenes, **further):
    """Options of this script and of blur_cost.py. further: {name: (default, help)}."""
    parser = argparse.ArgumentParser(description=page, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=TOP / "build" / "release" / "bin", help="folder of the tools")
    parser.add_argument("--out", type=Path, required=True, help="folder for frames; those that exist are used again")
    parser.add_argument("--shared", type=Path, default=filter_few.SHARED, help="folder of the scenes")
    parser.add_argument("--scenes", default=scenes)
    parser.add_argument("--size", default="320x180")
    for name, (default, words) in further.items():
        parser.add_argument(f"--{name}", default=default, help=words)
    options = parser.parse_args()
    options.bin, options.out, options.shared = (p.resolve() for p in (options.bin, options.out, options.shared))
    return options


def main():
    options = options_of(__doc__, "S2,S4,evening_shot")
    for name in options.scenes.split(","):
        sharp = [rendered(options, name, seed, "sharp", {}) for seed in SEEDS]
        depths = [z for z in exr.read(sharp[0]).channels["Z"] if math.isfinite(z)]
        focus = round(statistics.median(depths), 2)
        print(f"{name}: focus {focus} m")
        for kind, wish in KINDS.items():
            wish = wish | ({"FOCUS": focus} if "FSTOP" in wish else {})
            true = filter_few.References([rendered(options, name, seed, kind, wish) for seed in SEEDS])
            made = [blurred(options, file, kind, focus) for file in sharp]
            for what, files in (("sharp", sharp), ("blurred", made)):
                error, noise = true.figures([pixels.planes(exr.read(file)) for file in files])
                cells = "  ".join(" ".join(f"{v:6.2f}" for v in row) for row in (error, noise))
                print(f"{name:14} {kind:8} {what:8} error, noise {cells}", flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""The filter at few samples, beside Open Image Denoise on the same raw frames.

    python3 -B tests/bench/filter_few.py --bin build/release/bin --out /tmp/few --scenes S2,demo,furnished_day

For each scene and two seeds of everything the chain's raw frame is rendered with three pixel errors and, as reference,
with --reference samples. Files that exist are used again, so another filter (--bin, --label) costs seconds. Printed in
8-bit sRGB codes for single pixels and boxes of 5x5 and 15x15:
error   against the reference of the other seed, less the variance of a reference: the references share no file of light
        with the frame, so noise of photons and records counts
noise   of two seeds, over root 2
Open Image Denoise gets colour, albedo and normals of the same file. It runs where `make -f Makefile.example peers` or
--oidn FOLDER (of the Python package pyoidn) has it.
"""

import argparse
import math
import os
import re
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import peer_renderers
import pixels
from seen import blurred, code

TOP = Path(__file__).resolve().parents[2]
ERRORS = {"e20": 0.2, "e06": 0.06, "e03": 0.03}  # pixel errors: about 4 to 8, 6 to 19, 8 to 33 samples
BOXES = (1, 5, 15)
SHARED = TOP.parent / "shared" / "scenes"


def scenes(folder):
    """By name: frame and variables of make."""
    made, found = folder / "made", folder / "found"
    return {
        "demo": (24, {}),
        "S2": (10, {"SCENE": made / "S2_cornell_moving.glb"}),
        "S4": (10, {"SCENE": made / "S4_atrium.glb"}),
        "S8": (17, {"SCENE": made / "S8_window_room.glb", "LIGHT_UNITS": "spec", "SKY": "1.1,1.5,2"}),
        "furnished_day": (12, {"SCENE": made / "furnished_day.glb", "ENVIRONMENT": made / "furnished_day_world.exr"}),
        "evening_shot": (
            12,
            {
                "SCENE": found / "gltf" / "interiors" / "evening_shot.glb",
                "LIGHT_UNITS": "spec",
                "ENVIRONMENT": found / "hdri" / "evening_sky.exr",
            },
        ),
    }


def raw_frame(options, name, seed, label, words):
    """The raw frame of the chain with these options of frame-render."""
    folder = options.out / f"{name}.{seed}"
    file = folder / f"{label}.exr"
    if file.exists():
        return file
    folder.mkdir(parents=True, exist_ok=True)
    frame, variables = scenes(options.shared)[name]
    wish = {"BIN": options.bin, "OUT": folder / "out", "SIZE": options.size, "FRAMES": frame, "FILTER": 1, "PIXELS": words}
    command = ["make", "-s", "-f", TOP / "Makefile.example", *(f"{k}={v}" for k, v in (wish | variables).items())]
    env = os.environ | {"MEASURE_SEED": str(seed)}

    def make(goal):
        subprocess.run([*map(str, command), goal], check=True, env=env, stdout=subprocess.DEVNULL)

    make("plan")
    raw = re.search(rf"^(raw/{frame:04d}-\w+\.exr):", (folder / "out" / "plan.mk").read_text(), re.M)[1]
    make(raw)
    (folder / "out" / raw).rename(file)
    return file


def filtered(options, file):
    out = file.with_suffix(f".{options.label}.f.exr")
    if not out.exists():
        subprocess.run([options.bin / "st-filter", file, "-o", out, "-q"], check=True)
    return out


def denoised(options, file):
    """R, G, B planes of the frame after Open Image Denoise; None where it is not installed."""
    program = next(options.oidn.glob("lib/python*/site-packages/pyoidn/oidn/bin/oidnDenoise"), None)
    if not program:
        return None
    stem, out = file.with_suffix(""), file.with_suffix(".oidn.pfm")
    if not out.exists():
        program.chmod(0o755)
        peer_renderers.for_denoising(stem, exr.read(file))
        words = ["--hdr", f"{stem}.pfm", "--alb", f"{stem}.albedo.pfm", "--nrm", f"{stem}.normal.pfm", "-o", out]
        env = {"LD_LIBRARY_PATH": str(program.parents[1] / "lib")}
        subprocess.run([program, *words], check=True, env=env, stdout=subprocess.DEVNULL)
    return peer_renderers.read_pfm(out)[2]


class Scene:
    """References of both seeds, and figures against them."""

    def __init__(self, files):
        images = [exr.read(file) for file in files]
        self.width, self.height = images[0].width, images[0].height
        planes = [pixels.planes(image) for image in images]
        median = statistics.median(sum(v) for v in zip(*planes[0], *planes[1])) / 6
        self.exposure = 0.18 / median if median > 0 else 1
        self.references = [self.codes(p) for p in planes]
        self.variance = [v / 2 for v in self.squares(*self.references)]

    def codes(self, planes):
        return [[code(self.exposure * v) for v in plane] for plane in planes]

    def squares(self, one, two):
        """Mean squared difference of box means, by box."""
        off = [[a - b for a, b in zip(*pair)] for pair in zip(one, two)]
        boxed = ([blurred(p, self.width, self.height, n // 2) if n > 1 else p for p in off] for n in BOXES)
        return [statistics.fmean(v * v for plane in planes for v in plane) for planes in boxed]

    def figures(self, pair):
        """(error, noise) by box, of the pictures of both seeds."""
        mine = [self.codes(planes) for planes in pair]
        against = [self.squares(mine[s], self.references[1 - s]) for s in (0, 1)]
        error = [math.sqrt(max(0.0, (a + b) / 2 - v)) for a, b, v in zip(*against, self.variance)]
        return error, [math.sqrt(v / 2) for v in self.squares(*mine)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=TOP / "build" / "release" / "bin", help="folder of the tools")
    parser.add_argument("--out", type=Path, required=True, help="folder for frames; those that exist are used again")
    parser.add_argument("--shared", type=Path, default=SHARED, help="folder of the scenes")
    parser.add_argument("--scenes", default="demo,S2,S4,S8,furnished_day,evening_shot")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--reference", type=int, default=48, help="samples per pixel of each reference")
    parser.add_argument("--oidn", type=Path, default=TOP / "build" / "peers" / "oidn")
    parser.add_argument("--label", default="filtered", help="name of this filter in the names of its files")
    options = parser.parse_args()
    ratios = []
    for name in options.scenes.split(","):
        scene = Scene([raw_frame(options, name, seed, "ref", f"--spp {options.reference}") for seed in (1, 2)])
        for label, error in ERRORS.items():
            files = [raw_frame(options, name, seed, label, f"--spp 4 --pixel-error {error}") for seed in (1, 2)]
            of = {
                "raw": [pixels.planes(exr.read(file)) for file in files],
                "st-filter": [pixels.planes(exr.read(filtered(options, file))) for file in files],
                "oidn": [denoised(options, file) for file in files],
            }
            first = {}
            for kind, pair in of.items():
                if pair[0] is None:
                    continue
                errors, noise = scene.figures(pair)
                first[kind] = errors[0]
                cells = "  ".join(" ".join(f"{v:6.2f}" for v in row) for row in (errors, noise))
                print(f"{name:14} {error:5} {kind:9} error, noise {cells}", flush=True)
            if "oidn" in first:
                ratios.append(first["st-filter"] / max(1e-9, first["oidn"]))
    if ratios:
        print(f"st-filter over Open Image Denoise: median {statistics.median(ratios):.2f}, most {max(ratios):.2f}")


if __name__ == "__main__":
    main()

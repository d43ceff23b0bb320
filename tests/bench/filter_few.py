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
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import peer_renderers
import pipeline
import pixels
from seen import Seen, blurred

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
    wish = {"SIZE": options.size, "FRAMES": frame, "FILTER": 1, "PIXELS": words} | variables
    out, env = folder / "out", pipeline.environment() | {"MEASURE_SEED": str(seed)}

    def make(goal):
        command = pipeline.command(TOP, options.bin, out, goal, **wish)
        subprocess.run(command, check=True, env=env, stdout=subprocess.DEVNULL)

    make("plan")
    raw = next(name for name in pipeline.made_files(out) if name.startswith(f"raw/{frame:04d}-"))
    make(raw)
    (out / raw).rename(file)
    return file


def filtered(options, file):
    out = file.with_suffix(f".{options.label}.f.exr")
    if not out.exists():
        subprocess.run([options.bin / "st-filter", file, "-o", out, "-q"], check=True)
    return out


def denoised(options, file):
    """R, G, B planes of the frame after Open Image Denoise; None where it is not installed."""
    program = peer_renderers.oidn_in(options.oidn)
    if not program:
        return None
    stem, out = file.with_suffix(""), file.with_suffix(".oidn.pfm")

    def run(command, env):
        subprocess.run(command, check=True, env=env, stdout=subprocess.DEVNULL)

    if not out.exists():
        peer_renderers.for_denoising(stem, exr.read(file))
        peer_renderers.denoise(run, program, stem, out)
    return peer_renderers.read_pfm(out)[2]


class References(Seen):
    """References of both seeds, and figures against them."""

    def __init__(self, files):
        images = [exr.read(file) for file in files]
        self.width, self.height = images[0].width, images[0].height
        super().__init__(*map(pixels.planes, images))
        self.variance = [v / 2 for v in self.boxed(self.a, self.b)]

    def boxed(self, one, two):
        """Mean squared difference of box means, by box."""
        off = [[a - b for a, b in zip(*pair)] for pair in zip(one, two)]
        boxed = ([blurred(p, self.width, self.height, n // 2) if n > 1 else p for p in off] for n in BOXES)
        return [statistics.fmean(v * v for plane in planes for v in plane) for planes in boxed]

    def figures(self, pair):
        """(error, noise) by box, of the pictures of both seeds."""
        mine = [self.codes(planes) for planes in pair]
        against = [self.boxed(mine[0], self.b), self.boxed(mine[1], self.a)]
        error = [math.sqrt(max(0.0, (a + b) / 2 - v)) for a, b, v in zip(*against, self.variance)]
        return error, [math.sqrt(v / 2) for v in self.boxed(*mine)]


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
    options.bin, options.out, options.shared = (p.resolve() for p in (options.bin, options.out, options.shared))
    ratios = []
    for name in options.scenes.split(","):
        references = References([raw_frame(options, name, seed, "ref", f"--spp {options.reference}") for seed in (1, 2)])
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
                errors, noise = references.figures(pair)
                first[kind] = errors[0]
                cells = "  ".join(" ".join(f"{v:6.2f}" for v in row) for row in (errors, noise))
                print(f"{name:14} {error:5} {kind:9} error, noise {cells}", flush=True)
            if "oidn" in first:
                ratios.append(first["st-filter"] / max(1e-9, first["oidn"]))
    if ratios:
        print(f"st-filter over Open Image Denoise: median {statistics.median(ratios):.2f}, most {max(ratios):.2f}")


if __name__ == "__main__":
    main()

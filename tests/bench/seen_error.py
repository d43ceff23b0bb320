#!/usr/bin/env python3
"""Seen error of pictures: the root mean square difference of 8-bit sRGB codes to a reference in two halves.

    frame-render room.glb --spp 256 --channels RGBA,halves -o reference.exr
    python3 tests/bench/seen_error.py --reference reference.exr raw.exr filtered.exr

One exposure for all pictures puts the median of the reference's pixel means at .18. Codes are 255 times the sRGB curve of the exposed
value, cut to [0, 1], not rounded. The squared error of a picture x is the mean of (x - a)(x - b), where a and b are the reference's
halves: it has no noise of its own. Codes are not linear, so a figure counts only where the halves differ by less than twice as much;
the line says "not converged" otherwise. Halves are two files (--reference a.exr b.exr) or channels of one (--channels halves).
"""
import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
from seen import Seen

LAYERS = ("emission", "specular", "direct", "caustic", "indirect", "volume")
def halves_of(files):
    """The two halves of a reference as lists of R, G and B planes."""
    images = [exr.read(file) for file in files]
    if len(images) == 2:
        return [[image.channels[c] for c in "RGB"] for image in images]
    channels = images[0].channels
    layers = [layer for layer in LAYERS if f"{layer}.a.R" in channels]
    if not layers:
        raise SystemExit(f"{files[0]}: no halves; name two files, or render it with --channels halves")
    return [[[math.fsum(v) for v in zip(*(channels[f"{layer}.{h}.{c}"] for layer in layers))] for c in "RGB"] for h in "ab"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reference", nargs="+", required=True, metavar="FILE")
    parser.add_argument("--worst", action="store_true", help="also the share of the squared error in the worst percent of the pixels")
    parser.add_argument("pictures", nargs="+")
    options = parser.parse_args()
    seen = Seen(*halves_of(options.reference))
    noise = seen.halves_differ()
    for file in options.pictures:
        image = exr.read(file)
        planes = [image.channels[c] for c in "RGB"]
        error = seen.error(planes)
        line = f"{error:8.3f}  {file}"
        if options.worst:
            squares = sorted(seen.squares(planes), reverse=True)
            line += f"  worst percent {100 * sum(squares[:len(squares) // 100]) / max(sum(squares), 1e-9):.0f} %"
        print(line + ("" if 2 * noise < 2 * error else f"  (reference not converged: {noise:.2f})"))


if __name__ == "__main__":
    main()

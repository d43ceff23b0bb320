#!/usr/bin/env python3
"""Seen error of pictures: the root mean square difference of 8-bit sRGB codes to a reference in two halves.

    frame-render room.glb --spp 256 --halves --channels RGBA -o reference.exr
    python3 tests/bench/seen_error.py --reference reference_a.exr reference_b.exr raw.exr filtered.exr

One exposure for all pictures puts the median of the reference's pixel means at .18. Codes are 255 times the sRGB curve of the exposed
value, cut to [0, 1], not rounded. The squared error of a picture x is the mean of (x - a)(x - b), where a and b are the reference's
halves: it has no noise of its own. Codes are not linear, so a figure counts only where the halves differ by less than twice as much;
the line says "not converged" otherwise.
"""
import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import pixels
from seen import Seen


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reference", nargs=2, required=True, metavar="FILE", help="the reference's halves")
    parser.add_argument("--worst", action="store_true", help="also the share of the squared error in the worst percent of the pixels")
    parser.add_argument("pictures", nargs="+")
    options = parser.parse_args()
    seen = Seen(*(pixels.planes(exr.read(file)) for file in options.reference))
    noise = seen.halves_differ()
    for file in options.pictures:
        image = exr.read(file)
        planes = pixels.planes(image)
        error = seen.error(planes)
        line = f"{error:8.3f}  {file}"
        if options.worst:
            squares = sorted(seen.squares(planes), reverse=True)
            line += f"  worst percent {100 * sum(squares[:len(squares) // 100]) / max(sum(squares), 1e-9):.0f} %"
        print(line + ("" if 2 * noise < 2 * error else f"  (reference not converged: {noise:.2f})"))


if __name__ == "__main__":
    main()

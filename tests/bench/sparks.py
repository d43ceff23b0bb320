#!/usr/bin/env python3
"""Sparks: single pixels that are bright by chance.

    python3 -B tests/bench/sparks.py BIN SCENE FRAMES.. [--options '--environment m.hdr'] [--samples 1024]

FRAMES: NNNN.exr with layers, as CHANNELS=RGBA,layers makes them; the name is the number of the frame. A spark is a
pixel above 2.5 times the median of its 7x7, if the reference shows no such pixel there: it must also exceed the
reference by this median, and a tenth of the picture's mean. Path samples of BIN/frame-render are the reference, in the
7x7 around the pixels in question. Prints for each frame the number of sparks, the layers that make them, and the
largest spark in medians.
"""

import argparse
import array
import collections
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import pixels

REACH, BRIGHT = 3, 2.5


def around(at, width, height):
    """Places of the 7x7 around a place, as far as they lie in the picture."""
    x, y = at % width, at // width
    return [j * width + i for j in range(max(0, y - REACH), min(height, y + REACH + 1))
            for i in range(max(0, x - REACH), min(width, x + REACH + 1))]


def median(values, places):
    return sorted(values[p] for p in places)[len(places) // 2]


def standing_out(values, width, height):
    """{place: median of its 7x7} of the pixels above BRIGHT medians and a tenth of the mean."""
    found, least = {}, sum(values) / len(values) / 10
    for at in range(width * height):
        if values[at] < least:
            continue
        # A spark is brighter than one of the two pixels beside it, and few pixels are.
        if values[at] <= BRIGHT * min(values[max(0, at - 2)], values[min(len(values) - 1, at + 2)]):
            continue
        middle = median(values, around(at, width, height))
        if values[at] > BRIGHT * middle:
            found[at] = middle
    return found


def reference(program, scene, path, options, samples, image, places):
    """The path-traced values at the places; elsewhere those of the frame at this path."""
    with tempfile.TemporaryDirectory() as folder:
        mask, picture = Path(folder, "mask.exr"), Path(folder, "r.exr")
        wanted = array.array("f", bytes(4 * image.width * image.height))
        for p in places:
            wanted[p] = 1
        exr.write(mask, image.width, image.height, {"mask": wanted})
        size = f"{image.width}x{image.height}"
        words = ["--frame", str(int(path.stem)), "--size", size, "--integrator", "path", "--spp", str(samples),
                 "--mask", mask, "--base", path, "--channels", "RGBA", "--compression", "none", "--quiet", *options]
        subprocess.run([program, scene, *words, "-o", picture], check=True, stdout=subprocess.DEVNULL)
        return pixels.grey(exr.read(picture))


def sparks(image, reference_of):
    """[(place, radiance over the median)]; reference_of(places): values of a reference, at these places at least."""
    values = pixels.grey(image)
    found = standing_out(values, image.width, image.height)
    if not found:
        return []
    truth = reference_of(sorted({p for at in found for p in around(at, image.width, image.height)}))
    real = {at for at in found if truth[at] > BRIGHT * median(truth, around(at, image.width, image.height))}
    return [(at, values[at] / middle if middle > 0 else float("inf")) for at, middle in found.items()
            if at not in real and values[at] - truth[at] > middle]


def layer_of(image, at):
    """The layer that stands out most at a place."""
    places = around(at, image.width, image.height)

    def above(layer):
        planes = pixels.planes(image, layer)
        grey = {p: sum(plane[p] for plane in planes) / 3 for p in places}
        return grey[at] - median(grey, places)
    return max((name for name in pixels.LAYERS if name + ".R" in image.channels), key=above)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("scene", type=Path)
    parser.add_argument("frames", nargs="+", type=Path)
    parser.add_argument("--options", default="", help="of frame-render for the reference")
    parser.add_argument("--samples", type=int, default=1024)
    given = parser.parse_args()
    total = 0
    for path in given.frames:
        image = exr.read(path)
        program, options = given.bin / "frame-render", shlex.split(given.options)
        found = sparks(image, lambda places: reference(program, given.scene, path, options, given.samples, image,
                                                       places))
        layers = collections.Counter(layer_of(image, at) for at, _ in found)
        total += len(found)
        print(f"{path.name}: {len(found)} sparks", *(f"{name} {n}" for name, n in layers.items()),
              *([f"largest {max(r for _, r in found):.1f}"] if found else []))
    print(f"{total / len(given.frames):.2f} sparks a frame")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Steadiness of a sequence without a reference: two runs with independent random numbers, frame by frame.

    python3 tests/bench/steady.py A/frames B/frames 22-25 [--flow FOLDER] [--border 24]

A, B: folders of NNNN.exr. D is the difference of their codes over root 2: the noise of one run. Values are root mean squares of D, in 8-bit
codes, in means over boxes of 1, 5 and 15 pixels: large boxes are what a viewer sees boil.
noise              of single frames
from frame to frame  of the change of D over root 2, at the same place of the surface if FOLDER has motion (NNNN.exr with forward.u, .v)
border over within   that across the first frame of a segment over that between other frames
sticks             what neighbouring frames share of D: to the screen at the same pixel, to surfaces at the same place; boxes of 5 pixels
"""

import argparse
import json
import math
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import pixels
from seen import blurred, code

BOXES = (1, 5, 15)


def differences(first, second):
    """D of each frame, three planes; `first`, `second`: R, G, B of the frames of two runs. One exposure for all: the first frames' median at .18."""
    median = statistics.median(sum(v) for v in zip(*first[0], *second[0])) / 6
    exposure = 0.18 / median if median > 0 else 1
    return [
        [[(code(exposure * a) - code(exposure * b)) / math.sqrt(2) for a, b in zip(*pair)] for pair in zip(*frames)]
        for frames in zip(first, second)
    ]


def followed(flow, width, height):
    """By pixel the place of its surface point in the next frame, None outside; `flow`: forward.u and .v, None: nothing moves on the screen."""
    if flow is None:
        return range(width * height)
    places = []
    for p, (u, v) in enumerate(zip(*flow)):
        if not (math.isfinite(u) and math.isfinite(v)):
            places.append(None)
            continue
        x, y = p % width + round(u), p // width - round(v)
        places.append(y * width + x if 0 <= x < width and 0 <= y < height else None)
    return places


def rms(values):
    values = list(values)
    return math.sqrt(math.fsum(v * v for v in values) / len(values)) if values else 0.0


def product(one, two, places):
    """Root of the mean of D of a frame times D of the next at these places; 0 if it is negative."""
    found = [plane[p] * after[q] for plane, after in zip(one, two) for p, q in enumerate(places) if q is not None]
    return math.sqrt(max(0.0, math.fsum(found) / max(1, len(found))))


def steadiness(first, second, width, height, flows=None, border=None):
    """Of two runs (lists of R, G, B planes). flows: motion from each frame to the next. border: index of a segment's first frame."""
    found = {"noise": [], "frame to frame": [], "border over within": []}
    noise = differences(first, second)
    places = [followed(flows[t] if flows else None, width, height) for t in range(len(noise) - 1)]
    for size in BOXES:
        boxed = [
            [blurred(plane, width, height, size // 2) if size > 1 else plane for plane in frame] for frame in noise
        ]
        changes = []
        for t, to in enumerate(places):
            # The change is taken before the mean, so that a box holds what its pixels do together.
            change = [
                [(after[q] - now[p]) / math.sqrt(2) if q is not None else 0.0 for p, q in enumerate(to)]
                for now, after in zip(noise[t], noise[t + 1])
            ]
            changes.append(
                rms(v for plane in change for v in (blurred(plane, width, height, size // 2) if size > 1 else plane))
            )
        within = [c for t, c in enumerate(changes) if t + 1 != border]
        found["noise"].append(rms(v for frame in boxed for plane in frame for v in plane))
        found["frame to frame"].append(rms(within))
        if border is not None and within:
            found["border over within"].append(changes[border - 1] / max(1e-9, rms(within)))
        if size == 5:
            found["sticks to the screen"] = statistics.mean(
                product(boxed[t], boxed[t + 1], range(width * height)) for t in range(len(places))
            )
            found["sticks to surfaces"] = statistics.mean(
                product(boxed[t], boxed[t + 1], to) for t, to in enumerate(places)
            )
    return found


def cells(found):
    """Of a table: noise, from frame to frame, border over within, what sticks."""
    def three(name):
        return ", ".join(f"{v:.2f}" for v in found[name]) or "-"
    return [
        three("noise"),
        three("frame to frame"),
        three("border over within"),
        f"{found['sticks to the screen']:.2f}, {found['sticks to surfaces']:.2f}",
    ]


HEADER = [
    "noise in boxes of 1, 5, 15 pixels",
    "from frame to frame",
    "border over within",
    "sticks to the screen, to surfaces",
]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path)
    parser.add_argument("frames", help="as 22-25")
    parser.add_argument("--flow", type=Path, help="folder of frames with the channels motion")
    parser.add_argument("--border", type=int, help="first frame of a segment")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    a, _, b = options.frames.partition("-")
    frames = range(int(a), int(b or a) + 1)
    images = [[exr.read(folder / f"{f:04d}.exr") for f in frames] for folder in (options.first, options.second)]
    flows = options.flow and [
        [exr.read(options.flow / f"{f:04d}.exr").channels[f"forward.{c}"] for c in "uv"] for f in frames
    ]
    found = steadiness(
        *([pixels.planes(i) for i in run] for run in images),
        images[0][0].width,
        images[0][0].height,
        flows,
        options.border - frames[0] if options.border is not None else None,
    )
    print(
        json.dumps(found)
        if options.json
        else "\n".join(f"{name}: {cell}" for name, cell in zip(HEADER, cells(found)) if cell != "-")
    )


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Reads pixel flow as formats/flow/flow.md describes it, with the standard library only.

    read_flow.py FLOW.exr       prints every pixel: for small files
"""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "lib", "image"))
from read_frame import Frame

CHANNELS = {"forward.u": 2, "forward.v": 2, "backward.u": 2, "backward.v": 2, "speed": 2, "valid": 0}


def read_flow(path):
    """Width, height and a list of (forward, backward, speed) by pixel; a vector is None where it is not known."""
    frame = Frame(path)
    kinds = dict(frame.channels)
    for name, kind in CHANNELS.items():
        # Half is float with fewer digits: readers of EXR take one for the other.
        if name not in kinds or (kinds[name] == 0) != (kind == 0):
            raise ValueError(f"{path}: channel {name} is absent or of another type")
    pixels = []
    for y in range(frame.height):
        for x in range(frame.width):
            p = frame.pixel(x, y)
            if not all(math.isfinite(p[name]) for name in CHANNELS) or p["speed"] < 0 or p["valid"] > 3:
                raise ValueError(f"{path}: pixel ({x}, {y}): not finite, negative speed or valid above 3")
            forward = (p["forward.u"], p["forward.v"]) if p["valid"] & 1 else None
            backward = (p["backward.u"], p["backward.v"]) if p["valid"] & 2 else None
            pixels.append((forward, backward, p["speed"]))
    return frame.width, frame.height, pixels


def main(path):
    def show(vector):
        return "unknown" if vector is None else f"{vector[0]:.9g} {vector[1]:.9g}"
    width, _, pixels = read_flow(path)
    for i, (forward, backward, speed) in enumerate(pixels):
        print(f"{i % width} {i // width}  forward {show(forward)}  backward {show(backward)}  speed {speed:.9g}")


if __name__ == "__main__":
    main(sys.argv[1])

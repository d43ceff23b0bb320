#!/usr/bin/env python3
"""Reads a mask as formats/mask/mask.md describes it, with the standard library only.

    read_mask.py MASK.exr       prints every pixel and the sums by cause: for small files
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "lib", "image"))
from read_frame import Frame

CAUSES = ["specular", "occlusion", "slow", "deforming", "changed light", "border", "edge", "undersampled"]


def read_mask(path):
    """Width, height and by pixel the list of its causes."""
    frame = Frame(path)
    if dict(frame.channels).get("why") != 0:
        raise ValueError(f"{path}: channel why is absent or not uint")
    pixels = []
    for y in range(frame.height):
        for x in range(frame.width):
            why = frame.pixel(x, y)["why"]
            known = [name for bit, name in enumerate(CAUSES) if why >> bit & 1]
            pixels.append(known + ["unknown"] * (why >> len(CAUSES) != 0))
    return frame.width, frame.height, pixels


def main(path):
    width, _, pixels = read_mask(path)
    for i, causes in enumerate(pixels):
        print(f"{i % width} {i // width}  {' '.join(causes) or 'keep'}")
    traced = [causes[0] for causes in pixels if causes]
    sums = " ".join(f"{name} {traced.count(name)}" for name in [*CAUSES, "unknown"] if name in traced)
    print(f"traced {len(traced)} of {len(pixels)}: {sums}")


if __name__ == "__main__":
    main(sys.argv[1])

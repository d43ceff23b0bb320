#!/usr/bin/env python3
"""A house with a smoking chimney in the light of a lamp panel, 64 frames; the camera walks by.

    python3 tests/bench/chimney.py FOLDER --make-vdb build/release/tests/make-vdb

Writes FOLDER/chimney.glb and FOLDER/chimney_0000.vdb .. 0063.vdb. The smoke is made of puffs: one leaves the chimney every half frame, rises ever
more slowly, drifts with the wind, sways, and spreads as the square root of its age, so that density falls as it spreads. Not a
simulation of a gas: what matters here is that it is new at the chimney in each frame and changes slowly elsewhere.

    make -f Makefile.example SCENE=FOLDER/chimney.glb VOLUME=FOLDER/chimney_####.vdb VOLUME_OPTIONS='--sigma-t 12 --albedo .9' FRAMES=0-63 UPDATE=10%
"""
import argparse
import math
import random
import struct
import subprocess
from pathlib import Path

import smoky_rooms
from smoky_rooms import box, material, quad

FRAMES = 64
OPTIONS = ["--sigma-t", 12, "--albedo", ".9"]
TOP = (0.0, 3.2, 0.0)                        # of the chimney, m
VOXEL, LOW, COUNTS = 0.08, (-0.6, 3.0, -1.0), (52, 40, 26)
PUFFS_PER_FRAME, LIFE = 2, 56                # LIFE: frames
WARM_UP = 40                                 # frames that it has smoked before the first


def parts():
    yield "Ground", material((0.35, 0.4, 0.3)), quad((-8, 0, 8), (16, 0, 0), (0, 0, -16))
    yield "House", material((0.7, 0.62, 0.5)), box((-1.5, 0, -1.2), (1.5, 2.0, 1.2))
    yield "Roof", material((0.5, 0.2, 0.15)), box((-1.7, 2.0, -1.4), (1.7, 2.3, 1.4))
    yield "Chimney", material((0.45, 0.25, 0.2)), box((-0.25, 2.3, -0.25), (0.25, 3.2, 0.25))
    yield "Wall", material((0.6, 0.6, 0.65)), quad((-8, 0, -4), (16, 0, 0), (0, 7, 0))
    yield "Lamp", material((0, 0, 0), emissiveFactor=[1, 0.95, 0.85], extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 25}}), \
        quad((-1.0, 8, 1.0), (3.0, 0, 0), (0, 0, 3.0))


def puffs():
    """Of each puff: when it leaves the chimney, how it sways."""
    draw = random.Random(20)
    for i in range((FRAMES + WARM_UP) * PUFFS_PER_FRAME):
        yield i / PUFFS_PER_FRAME - WARM_UP, draw.uniform(0, 2 * math.pi), draw.uniform(0.5, 1.5), draw.uniform(0.6, 1.4)


def density(frame):
    """Values of all voxels, z fastest."""
    nx, ny, nz = COUNTS
    values = [0.0] * (nx * ny * nz)
    for born, phase, sway, mass in puffs():
        age = frame - born
        if not 0 <= age < LIFE:
            continue
        rise, spread = 3.4 * (1 - math.exp(-age / 30)), 0.1 + 0.05 * math.sqrt(age)
        centre = (TOP[0] + 0.035 * age + 0.06 * sway * math.sin(phase + age / 5), TOP[1] + rise, TOP[2] + 0.08 * sway * math.cos(phase + age / 6))
        peak = mass * (0.1 / spread) ** 3 * min(1.0, (LIFE - age) / 16)
        reach = 2.5 * spread
        low = [max(0, math.ceil((c - reach - l) / VOXEL)) for c, l in zip(centre, LOW)]
        high = [min(n, math.floor((c + reach - l) / VOXEL) + 1) for c, l, n in zip(centre, LOW, COUNTS)]
        along = [[math.exp(-0.5 * ((l + VOXEL * i - c) / spread) ** 2) for i in range(a, b)]
                 for c, l, a, b in zip(centre, LOW, low, high)]
        for x, wx in enumerate(along[0], low[0]):
            for y, wy in enumerate(along[1], low[1]):
                row, w = (x * ny + y) * nz + low[2], peak * wx * wy
                for z, wz in enumerate(along[2]):
                    values[row + z] += w * wz
    return [v if v > 0.01 else 0.0 for v in values]   # the tails of the Gaussians would make the box of the smoke larger


def make(folder, make_vdb, frames=range(FRAMES)):
    """The scene's file; smoke of these frames."""
    scene = folder / "chimney.glb"
    walk = [(-3.0 + 4.0 * i / (FRAMES - 1), 3.2, 8.0) for i in range(FRAMES)]
    smoky_rooms.write_scene(scene, {"parts": list(parts()), "walk": walk, "yfov": 0.9})
    for frame in frames:
        file = folder / f"chimney_{frame:04d}.vdb"
        file.unlink(missing_ok=True)
        values = density(frame)
        subprocess.run([make_vdb, file, *map(str, (*COUNTS, VOXEL, *LOW))], input=struct.pack(f"<{len(values)}f", *values), check=True)
    return scene


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--make-vdb", default="make-vdb")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    print(make(options.folder, options.make_vdb))

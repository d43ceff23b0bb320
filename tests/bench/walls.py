#!/usr/bin/env python3
"""Thin walls: is light right in the pixels beside them? Written scenes, the photon chain against path tracing.

    python3 tests/bench/walls.py --out out/walls                     all scenes, 640x360 and 128x72, table
    python3 tests/bench/walls.py --write partition FILE.gltf         the scene alone
    python3 tests/bench/walls.py --only shelf --size 128x72 --seeds 4

Scenes, metres: `partition`, a room of 4 x 2.4 x 2.25 seen from above, cut by a wall 12 mm thick and half as high as the room, a
lamp low on one side of it; `shelf`, boards and back of 4 mm in front of a lit wall; `table`, a top of 8 mm under a lamp, seen
from below its height; `crate`, an open box with sides of 3 mm; `leaves`, 3600 leaves without thickness in a room, facing all ways.

Beside a wall are the pixels whose neighbour along the row is of another object: the first, the second and the third column of
them, on either side. Light there is the layer indirect (--layer), its mean over such pixels against path tracing, in two halves
whose difference gives the noise (printed as one standard deviation). Prints a table, writes walls.json to --out.
"""
import argparse
import json
import math
import random
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import pipeline
from scenes import Scene, add, box_mesh, cross, normalize

PROJECT = Path(__file__).resolve().parents[2]


def box(scene, lower, upper, material):
    scene.mesh(*box_mesh(lower, upper), material)


def partition(scene):
    wall, lamp = scene.material(0.6), scene.material(0.0, 8.0)
    scene.room((-2, 0, -1.125), (2, 2.4, 1.125), wall)
    box(scene, (-0.006, 0, -1.125), (0.006, 1.2, 1.125), scene.material(0.6))
    scene.quad((-1.999, 0.3, 0.3), (-1.999, 0.3, -0.3), (-1.999, 0.7, -0.3), (-1.999, 0.7, 0.3), lamp)
    scene.camera((0.0075, 2.39, 0), (0.0075, 0, 0), fov=2 * math.atan(0.45))


def shelf(scene):
    wood = scene.material((0.6, 0.5, 0.4))
    scene.room((-1.5, 0, -1.5), (1.5, 2.4, 1.5), scene.material(0.7))
    for height in (0.4, 0.8, 1.2, 1.6):
        box(scene, (-0.6, height, -1.4), (0.6, height + 0.004, -1.1), wood)
    for x in (-0.6, -0.2, 0.2, 0.596):
        box(scene, (x, 0.2, -1.4), (x + 0.004, 1.8, -1.1), wood)
    box(scene, (-0.6, 0.2, -1.404), (0.6, 1.8, -1.4), wood)
    scene.quad((-0.9, 2.39, -1.0), (-0.9, 2.39, -0.4), (-0.3, 2.39, -0.4), (-0.3, 2.39, -1.0), scene.material(0.0, 12.0))
    scene.camera((0.3, 1.2, 1.3), (0, 1.0, -1.2), fov=0.8)


def table(scene):
    wood = scene.material((0.6, 0.5, 0.4))
    scene.room((-1.5, 0, -1.5), (1.5, 2.4, 1.5), scene.material(0.7))
    box(scene, (-0.6, 0.72, -0.4), (0.6, 0.728, 0.4), wood)
    for x in (-0.55, 0.52):
        for z in (-0.35, 0.32):
            box(scene, (x, 0, z), (x + 0.03, 0.72, z + 0.03), wood)
    scene.quad((-0.2, 2.2, -0.2), (0.2, 2.2, -0.2), (0.2, 2.2, 0.2), (-0.2, 2.2, 0.2), scene.material(0.0, 12.0))
    scene.camera((0.4, 0.9, 1.4), (0, 0.6, 0), fov=0.8)


def crate(scene):
    wood = scene.material((0.6, 0.5, 0.4))
    scene.room((-1.5, 0, -1.5), (1.5, 2.4, 1.5), scene.material(0.7))
    for low, high in (((-0.4, 0, -0.3), (-0.397, 0.5, 0.3)), ((0.397, 0, -0.3), (0.4, 0.5, 0.3)),
                      ((-0.397, 0, -0.3), (0.397, 0.5, -0.297)), ((-0.397, 0, 0.297), (0.397, 0.5, 0.3))):
        box(scene, low, high, wood)
    scene.quad((-1.4, 1.6, 0.3), (-1.4, 1.6, -0.3), (-1.4, 2.0, -0.3), (-1.4, 2.0, 0.3), scene.material(0.0, 12.0))
    scene.camera((0.5, 1.6, 1.0), (0, 0.1, 0), fov=0.7)


def leaves(scene, count=3600):
    draw = random.Random(1)
    scene.room((-1.5, 0, -1.5), (1.5, 2.4, 1.5), scene.material(0.7))
    positions, triangles = [], []
    for _ in range(count):
        centre = [draw.uniform(-0.7, 0.7), draw.uniform(0.3, 1.7), draw.uniform(-0.7, 0.7)]
        u = normalize([draw.gauss(0, 1) for _ in range(3)])
        v = normalize(cross(u, normalize([draw.gauss(0, 1) for _ in range(3)])))
        first = len(positions) // 3
        for s, t in ((0.05, 0), (0, 0.02), (-0.05, 0), (0, -0.02)):
            positions.extend(add(add(centre, u, s), v, t))
        triangles.extend((first, first + 1, first + 2, first, first + 2, first + 3))
    scene.mesh(positions, triangles, scene.material((0.3, 0.55, 0.2)))
    scene.quad((-0.3, 2.39, -0.3), (-0.3, 2.39, 0.3), (0.3, 2.39, 0.3), (0.3, 2.39, -0.3), scene.material(0.0, 15.0))
    scene.camera((0.2, 1.2, 1.45), (0, 1.0, 0), fov=1.0)


SCENES = {made.__name__: made for made in (partition, shelf, table, crate, leaves)}
COLUMNS = 3


def write(name, path):
    scene = Scene()
    SCENES[name](scene)
    return scene.save(path)


def beside(ids, width):
    """By column and side: pixels beside a border along a row that keep their object for COLUMNS pixels."""
    found = {(side, column): [] for side in (-1, 1) for column in range(1, COLUMNS + 1)}
    for row in range(len(ids) // width):
        line = ids[row * width:(row + 1) * width]
        for x in range(COLUMNS, width - COLUMNS):
            if line[x] == line[x - 1]:
                continue
            if len(set(line[x:x + COLUMNS])) == 1:
                for column in range(COLUMNS):
                    found[1, column + 1].append(row * width + x + column)
            if len(set(line[x - COLUMNS:x])) == 1:
                for column in range(COLUMNS):
                    found[-1, column + 1].append(row * width + x - 1 - column)
    return found


class Walls:
    def __init__(self, options):
        self.options, self.out = options, Path(options.out)
        self.out.mkdir(parents=True, exist_ok=True)
        self.bin = Path(options.bin)

    def run(self, tool, *arguments):
        stats = self.out / "stats.json"
        subprocess.run([str(self.bin / tool), *map(str, arguments), "-q", "--stats", str(stats)], check=True)
        return json.loads(stats.read_text())["cpu_s"]

    def layer(self, path, name):
        image = exr.read(path)
        return [sum(pixel) / 3 for pixel in zip(*(image.channels[f"{name}.{c}"] for c in "RGB"))], image

    def chain(self, scene, seed, size):
        cpu = pipeline.chain(self.run, [scene, "--seed", seed], self.out / "chain", ["--photons", self.options.photons, "--kinds", "caustic,indirect"], (),
                             ["--size", size],
                             ["--size", size, "--spp", 4, "--pixel-error", 0.016, "--channels", "layers,id", "--compression", "none"])
        return self.out / "chain.exr", cpu

    def paths(self, scene, name, size):
        frame = self.out / f"{name}-{size}-path-{self.options.paths}.exr"
        halves = [frame.with_name(f"{frame.stem}_{half}.exr") for half in "ab"]
        if not all(half.exists() for half in halves):
            self.run("frame-render", scene, "--integrator", "path", "--halves", "--size", size, "--spp", self.options.paths,
                     "--channels", "layers,id", "--compression", "none", "-o", frame)
        return halves

    def judge(self, name, size):
        scene, width = write(name, self.out / f"{name}.gltf"), int(size.split("x")[0])
        layer = self.options.layer
        a, b = (self.layer(half, layer)[0] for half in self.paths(scene, name, size))
        light, cpu = [0.0] * len(a), []
        for seed in range(self.options.seeds):
            frame, spent = self.chain(scene, seed, size)
            values, image = self.layer(frame, layer)
            light = [x + y / self.options.seeds for x, y in zip(light, values)]
            cpu.append(spent)
        ids = image.channels["id.object"]
        rows = []
        for (side, column), pixels in beside(ids, width).items():
            if not pixels:
                continue
            mean_a, mean_b, mean = (sum(v[p] for p in pixels) / len(pixels) for v in (a, b, light))
            reference = (mean_a + mean_b) / 2
            noise = math.sqrt(sum((a[p] - b[p]) ** 2 for p in pixels)) / 2 / len(pixels)
            rows.append({"side": side, "column": column, "pixels": len(pixels), "off": mean / reference - 1,
                         "noise": noise / reference})
        square = sum((x - r) * (x - s) for x, r, s in zip(light, a, b)) / len(a)
        whole = sum(light) / (sum(a) + sum(b)) * 2 - 1
        return {"scene": name, "size": size, "beside": rows, "bias": whole,
                "rmse": math.sqrt(max(0.0, square)), "cpu_s": [sum(c) / len(cpu) for c in zip(*cpu)]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", nargs=2, metavar=("SCENE", "FILE"))
    parser.add_argument("--only", choices=SCENES)
    parser.add_argument("--size", action="append")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--photons", default="700k")
    parser.add_argument("--paths", type=int, default=256, help="samples per pixel of the reference's halves together")
    parser.add_argument("--layer", default="indirect")
    parser.add_argument("--bin", default=str(PROJECT / "build/release/bin"))
    parser.add_argument("--out", default="out/walls")
    options = parser.parse_args()
    if options.write:
        write(*options.write)
        return
    walls, results = Walls(options), []
    for name in [options.only] if options.only else SCENES:
        for size in options.size or ["640x360", "128x72"]:
            result = walls.judge(name, size)
            results.append(result)
            print(f"{name} {size}: bias {100 * result['bias']:+.2f} %, rmse {result['rmse']:.5f}, CPU s "
                  + "/".join(f"{c:.2f}" for c in result["cpu_s"]))
            for row in result["beside"]:
                print(f"  {'left' if row['side'] < 0 else 'right'} {row['column']}: {row['pixels']} pixels, "
                      f"{100 * row['off']:+.1f} % +- {100 * row['noise']:.1f}", flush=True)
    (walls.out / "walls.json").write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()

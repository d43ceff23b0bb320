#!/usr/bin/env python3
"""Random layered materials on balls in a room: is the light of the chain that of the path tracer?

    python3 tests/bench/layered_materials.py BIN OUT [--first 0] [--rooms 5] [--runs 4] [--spp 256] [--only sheen] [--films]
                                             [--glass]

A room holds eight balls. Each has a base of random colour, metal or not, and by chance a clearcoat, a sheen and an
anisotropy of random strength and roughness, and a normal map of the base or of the coat. With --films half of the
balls have a thin film, with --glass each second ball is glass with dispersion. The means of the runs of both ways are
compared for each object and layer; a difference above 1 % of the object's light plus 3 standard errors is reported,
and the exit status is 1. Objects 0 to 6 are the room and its lamp, 7 to 14 the balls.

A standard error from few runs is itself uncertain. With 2 runs and 16 samples of the path tracer (--spp) 2 of 65 means
lay beyond the limit (indirect light 5 to 7 % high); with 3 runs and 256 samples 0 of 130; one frame of 512 samples
agreed. Rare bright paths by way of the balls, which few samples miss without showing it in their spread, may explain the
difference; that is not proven.
"""
import argparse
import base64
import math
import random
import statistics
import subprocess
import sys
from pathlib import Path

import pipeline
from pixels import LAYERS

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from open_scenes import Scene, png  # noqa: E402
from exr import read  # noqa: E402  (open_scenes has tests/stress in the path)


def bump(x, y, size=32, waves=2, slope=0.3):
    """A pixel of a normal map of waves."""
    n = [slope * math.cos(2 * math.pi * waves * (v + 0.5) / size) for v in (x, y)] + [1]
    return [round(127.5 + 127.5 * v / math.hypot(*n)) for v in n]


def film(rng):
    return {"iridescenceFactor": rng.choice([1, rng.random()]), "iridescenceIor": rng.uniform(1.2, 2),
            "iridescenceThicknessMaximum": rng.uniform(100, 1000)}


def glass(scene, rng, films):
    index = scene.glass(rng.choice([0, rng.uniform(0.1, 0.5)]), rng.uniform(1.4, 1.8))
    extensions = scene.document["materials"][index]["extensions"]
    extensions["KHR_materials_dispersion"] = {"dispersion": 20 / rng.uniform(20, 60)}
    scene.extensions.add("KHR_materials_dispersion")
    if films and films.random() < 0.5:
        extensions["KHR_materials_iridescence"] = film(films)
        scene.extensions.add("KHR_materials_iridescence")
    return index


def layered(scene, rng, only, films=None):
    """A random material; the ranges are those of a product's surfaces, smooth coats included."""
    coat, sheen, brushed = (f"KHR_materials_{name}" for name in ("clearcoat", "sheen", "anisotropy"))
    extensions = {}
    if rng.random() < 0.6:
        extensions[coat] = {"clearcoatFactor": rng.random(), "clearcoatRoughnessFactor": rng.choice([0, rng.random()])}
    if rng.random() < 0.5:
        extensions[sheen] = {"sheenColorFactor": [rng.random() for _ in range(3)],
                             "sheenRoughnessFactor": rng.uniform(0.2, 1)}
    if rng.random() < 0.5:
        extensions[brushed] = {"anisotropyStrength": rng.random(), "anisotropyRotation": rng.uniform(0, 6.28)}
    map_of = rng.choice(["", "", "base", "coat"])
    if map_of == "coat" and coat in extensions:
        extensions[coat]["clearcoatNormalTexture"] = {"index": 0}
    extensions = {k: v for k, v in extensions.items() if only in k}
    if films and films.random() < 0.5:
        extensions["KHR_materials_iridescence"] = film(films)
    material = {"pbrMetallicRoughness": {"baseColorFactor": [*(rng.uniform(0.1, 0.9) for _ in range(3)), 1],
                                         "metallicFactor": rng.choice([0, 0, 1]),
                                         "roughnessFactor": rng.uniform(0.3, 1)}, "extensions": extensions}
    if map_of == "base":
        material["normalTexture"] = {"index": 0}
    scene.extensions |= set(extensions)
    return scene._append("materials", material)


def ball(scene, name, centre, radius, material, rings=24, sectors=48):
    positions, normals, uvs, triangles = [], [], [], []
    for i in range(rings + 1):
        for j in range(sectors + 1):
            theta, phi = math.pi * i / rings, 2 * math.pi * j / sectors
            n = (math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi))
            normals += n
            positions += (c + radius * x for c, x in zip(centre, n))
            uvs += (j / sectors, i / rings)
    for i in range(rings):
        for j in range(sectors):
            a, b = i * (sectors + 1) + j, (i + 1) * (sectors + 1) + j
            if i > 0:
                triangles += (a, b, a + 1)
            if i < rings - 1:
                triangles += (a + 1, b, b + 1)
    scene.mesh(positions, triangles, material, normals, uvs, name=name)


def walls(scene, x, y, z, material, open_side=None, **others):
    """A room of 2x by y by 2z m whose faces look inwards. open_side: the wall that is left out; others: materials of
    walls that differ, by their names."""
    faces = {"floor": ((-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z)),
             "ceiling": ((-x, y, -z), (x, y, -z), (x, y, z), (-x, y, z)),
             "back": ((-x, 0, -z), (x, 0, -z), (x, y, -z), (-x, y, -z)),
             "front": ((x, 0, z), (-x, 0, z), (-x, y, z), (x, y, z)),
             "left": ((-x, 0, z), (-x, 0, -z), (-x, y, -z), (-x, y, z)),
             "right": ((x, 0, -z), (x, 0, z), (x, y, z), (x, y, -z))}
    for name, corners in faces.items():
        if name != open_side:
            scene.quad(*corners, others.get(name, material), name=name)


def room(path, seed, options):
    rng, scene, others = random.Random(seed), Scene(), random.Random(f"films and glass {seed}")
    films = others if options.films else None
    scene._append("images", {"uri": "data:image/png;base64," + base64.b64encode(png(32, bump)).decode()})
    scene._append("textures", {"source": 0})
    grey, red, blue = (scene.material(c, one_sided=True) for c in (0.6, (0.7, 0.3, 0.2), (0.2, 0.4, 0.7)))
    x, y, z = 2, 2, 1.5
    walls(scene, x, y, z, grey, left=red, right=blue)
    lamp, y = scene.material(0, 10, one_sided=True), y - 0.01
    scene.quad((-0.5, y, -0.4), (0.5, y, -0.4), (0.5, y, 0.4), (-0.5, y, 0.4), lamp, name="lamp")
    for i in range(8):
        centre = (-1.35 + 0.9 * (i % 4), 0.4 + 0.8 * (i // 4), -0.7)
        material = layered(scene, rng, options.only, films)
        ball(scene, f"ball {i}", centre, 0.36, glass(scene, others, films) if options.glass and i % 2 else material)
    scene.camera((0, 1, 1.4), (0, 1, 0), fov=0.95)
    scene.save(path)


def means_of(path):
    """By the number of each object that is seen, and by layer: the mean of the three channels over its pixels."""
    image = read(path)
    ids = image.channels["id.object"]
    layers = {layer: [sum(c) / 3 for c in zip(*(image.channels[f"{layer}.{c}"] for c in "RGB"))] for layer in LAYERS}
    result = {}
    for number in sorted({int(i) for i in ids if i < 1e6}):
        pixels = [p for p, i in enumerate(ids) if int(i) == number]
        result[number] = {layer: sum(values[p] for p in pixels) / len(pixels) for layer, values in layers.items()}
    return result


def render(tools, scene, out, seed, spp, words=()):
    """The means by paths and by the chain. words: options of the scene."""
    def run(tool, *words):
        subprocess.run([str(word) for word in (tools / tool, *words, "-q")], check=True)
    common, picture = [scene, "--seed", seed, *words], ["--size", "64x36", "--channels", "RGBA,layers,id"]
    run("frame-render", *common, "--integrator", "path", "--spp", spp, *picture, "-o", out / "paths.exr")
    pipeline.chain(run, common, out / "chain", ["--photons", 400000],
                   pixels=["--keep-outliers", "--spp", 64, *picture], map_beside=True)
    return means_of(out / "paths.exr"), means_of(out / "chain.exr")


def mean_and_error(values):
    return statistics.fmean(values), statistics.stdev(values) / math.sqrt(len(values))


def differences(name, pairs):
    """Compares the means of pairs of both ways by object and layer. Prints those that differ by more than 1 % of the
    object's light and 3 standard errors; returns their number, and how many were compared."""
    beyond = count = 0
    for thing in pairs[0][0]:
        light = mean_and_error([sum(p[thing].values()) for p, _ in pairs])[0]
        for layer in LAYERS:
            by_paths, error_paths = mean_and_error([p[thing][layer] for p, _ in pairs])
            by_chain, error_chain = mean_and_error([c[thing][layer] for _, c in pairs])
            error, count = math.hypot(error_paths, error_chain), count + 1
            if abs(by_chain - by_paths) > 0.01 * light + 3 * error:
                beyond += 1
                print(f"{name} object {thing} {layer}: chain {by_chain:.5f}, paths {by_paths:.5f},",
                      f"error {error:.5f}, light {light:.5f}", flush=True)
    return beyond, count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("out", type=Path)
    for name, default in (("rooms", 5), ("runs", 4), ("spp", 256)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--first", type=int, default=0, help="number of the first room [0]")
    parser.add_argument("--only", default="", help="clearcoat, sheen or anisotropy: leaves out the others; none: all")
    for name in ("films", "glass"):
        parser.add_argument(f"--{name}", action="store_true")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    beyond = count = 0
    for number in range(options.first, options.first + options.rooms):
        scene = options.out / f"room{number}.gltf"
        room(scene, number, options)
        pairs = [render(options.bin, scene, options.out, seed + 1, options.spp) for seed in range(options.runs)]
        found, compared = differences(f"room {number}", pairs)
        beyond, count = beyond + found, count + compared
    print(f"{beyond} of {count} means differ by more than 1 % of the object's light and 3 errors")
    return beyond > 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Random layered materials on balls in a room: is the light of the chain that of the path tracer?

    python3 tests/bench/layered_materials.py BIN OUT [--rooms 5] [--runs 4] [--spp 256] [--only sheen]

A room holds eight balls. Each has a base of random colour, metal or not, and by chance a clearcoat, a sheen and an
anisotropy of random strength and roughness, and a normal map of the base or of the coat. By object and layer the means of the runs of both ways are compared; a
difference above 1 % of the object's light plus 3 standard errors is reported, and the exit status is 1. A standard error
from few runs is itself uncertain: fewer samples of the path tracer (--spp) miss the rare bright paths by way of the
balls, and their spread does not show it. Objects 0 to 6 are the room and its lamp, 7 to 14 the balls.
"""
import argparse
import base64
import json
import math
import random
import struct
import subprocess
import sys
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
from exr import read  # noqa: E402

LAYERS = ("emission", "specular", "direct", "caustic", "indirect")


class Gltf:
    """A glTF file whose data are in it."""

    def __init__(self):
        self.data = b""
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "accessors": [], "bufferViews": [],
                     "materials": [], "extensionsUsed": ["KHR_materials_clearcoat", "KHR_materials_sheen", "KHR_materials_anisotropy"]}

    def accessor(self, rows, kind, code="f"):
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": 4 * len(rows) * len(rows[0])})
        self.data += b"".join(struct.pack(f"<{len(r)}{code}", *r) for r in rows)
        entry = {"bufferView": len(self.json["bufferViews"]) - 1, "componentType": 5126 if code == "f" else 5125, "count": len(rows), "type": kind}
        if kind == "VEC3":
            entry |= {"min": [min(c) for c in zip(*rows)], "max": [max(c) for c in zip(*rows)]}
        self.json["accessors"].append(entry)
        return len(self.json["accessors"]) - 1

    def node(self, name, positions, triangles, material, normals=None, uvs=None):
        self.json["materials"].append(material)
        attributes = {"POSITION": self.accessor(positions, "VEC3")}
        if normals:
            attributes |= {"NORMAL": self.accessor(normals, "VEC3"), "TEXCOORD_0": self.accessor(uvs, "VEC2")}
        indices = self.accessor([(i,) for t in triangles for i in t], "SCALAR", "I")
        self.json["meshes"].append({"primitives": [{"attributes": attributes, "indices": indices, "material": len(self.json["materials"]) - 1}]})
        self.add({"name": name, "mesh": len(self.json["meshes"]) - 1})

    def add(self, node):
        self.json["nodes"].append(node)
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def write(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        self.json["buffers"] = [{"byteLength": len(self.data), "uri": uri}]
        Path(path).write_text(json.dumps(self.json))


def bumps(size=32, waves=2, slope=0.3):
    """A normal map of waves, as a PNG in a data URI."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    rows = b""
    for y in range(size):
        rows += b"\0"
        for x in range(size):
            n = [slope * math.cos(2 * math.pi * waves * (v + 0.5) / size) for v in (x, y)] + [1]
            rows += bytes(round(127.5 + 127.5 * v / math.hypot(*n)) for v in n)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", size, size, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    return "data:image/png;base64," + base64.b64encode(png).decode()


def matte(*colour, emission=0):
    m = {"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0}, "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
    if emission:
        m |= {"emissiveFactor": [1, 1, 1]}
        m["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": emission}
    return m


def layered(rng, only):
    """A random material; the ranges are those of a product's surfaces, smooth coats included."""
    extensions = {}
    if rng.random() < 0.6:
        extensions["KHR_materials_clearcoat"] = {"clearcoatFactor": rng.random(), "clearcoatRoughnessFactor": rng.choice([0, rng.random()])}
    if rng.random() < 0.5:
        extensions["KHR_materials_sheen"] = {"sheenColorFactor": [rng.random() for _ in range(3)], "sheenRoughnessFactor": rng.uniform(0.2, 1)}
    if rng.random() < 0.5:
        extensions["KHR_materials_anisotropy"] = {"anisotropyStrength": rng.random(), "anisotropyRotation": rng.uniform(0, 6.28)}
    map_of = rng.choice(["", "", "base", "coat"])
    if map_of == "coat" and "KHR_materials_clearcoat" in extensions:
        extensions["KHR_materials_clearcoat"]["clearcoatNormalTexture"] = {"index": 0}
    extensions = {k: v for k, v in extensions.items() if only in k}
    return ({"normalTexture": {"index": 0}} if map_of == "base" else {}) | {"pbrMetallicRoughness": {"baseColorFactor": [*(rng.uniform(0.1, 0.9) for _ in range(3)), 1], "metallicFactor": rng.choice([0, 0, 1]),
                                     "roughnessFactor": rng.uniform(0.3, 1)}, "extensions": extensions}


def ball(gltf, name, centre, radius, material, rings=24, sectors=48):
    positions, normals, uvs, triangles = [], [], [], []
    for i in range(rings + 1):
        for j in range(sectors + 1):
            theta, phi = math.pi * i / rings, 2 * math.pi * j / sectors
            n = (math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi))
            normals.append(n)
            positions.append(tuple(c + radius * x for c, x in zip(centre, n)))
            uvs.append((j / sectors, i / rings))
    for i in range(rings):
        for j in range(sectors):
            a, b = i * (sectors + 1) + j, (i + 1) * (sectors + 1) + j
            triangles += [t for t, there in (((a, b, a + 1), i > 0), ((a + 1, b, b + 1), i < rings - 1)) if there]
    gltf.node(name, positions, triangles, material, normals, uvs)


def quad(gltf, name, corners, material):
    gltf.node(name, corners, [(0, 1, 2), (0, 2, 3)], material)


def room(path, seed, only):
    rng, gltf = random.Random(seed), Gltf()
    gltf.json["extensionsUsed"] += ["KHR_materials_specular", "KHR_materials_emissive_strength"]
    gltf.json |= {"images": [{"uri": bumps()}], "textures": [{"source": 0}]}
    x, y, z = 2, 2, 1.5
    grey = matte(0.6, 0.6, 0.6)
    quad(gltf, "floor", [(-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z)], grey)
    quad(gltf, "ceiling", [(-x, y, -z), (x, y, -z), (x, y, z), (-x, y, z)], grey)
    quad(gltf, "back", [(-x, 0, -z), (x, 0, -z), (x, y, -z), (-x, y, -z)], grey)
    quad(gltf, "front", [(x, 0, z), (-x, 0, z), (-x, y, z), (x, y, z)], grey)
    quad(gltf, "left", [(-x, 0, z), (-x, 0, -z), (-x, y, -z), (-x, y, z)], matte(0.7, 0.3, 0.2))
    quad(gltf, "right", [(x, 0, -z), (x, 0, z), (x, y, z), (x, y, -z)], matte(0.2, 0.4, 0.7))
    quad(gltf, "lamp", [(-.5, y - .01, -.4), (.5, y - .01, -.4), (.5, y - .01, .4), (-.5, y - .01, .4)], matte(0, 0, 0, emission=10))
    for i in range(8):
        ball(gltf, f"ball {i}", (-1.35 + 0.9 * (i % 4), 0.4 + 0.8 * (i // 4), -0.7), 0.36, layered(rng, only))
    gltf.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.95, "znear": 0.1, "aspectRatio": 16 / 9}}]
    gltf.add({"name": "Camera", "camera": 0, "translation": [0, 1, 1.4]})
    gltf.write(path)


def means_of(path):
    """By object and layer the mean of the three channels over the object's pixels, and by object its name's number."""
    image = read(path)
    ids = image.channels["id.object"]
    layers = {layer: [sum(c) / 3 for c in zip(*(image.channels[f"{layer}.{c}"] for c in "RGB"))] for layer in LAYERS}
    result = {}
    for number in sorted({int(i) for i in ids if i < 1e6}):
        pixels = [p for p, i in enumerate(ids) if int(i) == number]
        result[number] = {layer: sum(values[p] for p in pixels) / len(pixels) for layer, values in layers.items()}
    return result


def run(*command):
    subprocess.run([str(c) for c in command], check=True)


def render(tools, scene, out, run_number, spp):
    """The means by paths and by the chain."""
    common = [scene, "--seed", run_number]
    picture = ["--size", "64x36", "--channels", "RGBA,layers,id", "-q"]
    paths, chain = out / "paths.exr", out / "chain.exr"
    run(tools / "frame-render", *common, "--integrator", "path", "--spp", spp, *picture, "-o", paths)
    photons, points, cache = (out / f"x.{e}" for e in ("photons", "irradpoints", "irradcache"))
    run(tools / "photon-trace", *common, "--photons", 400000, "-o", photons, "-q")
    run(tools / "irradcache-build", "points", *common, "--photons", photons, "-o", points, "-q")
    run(tools / "irradcache-build", "records", *common, "--points", points, "-o", cache, "-q")
    run(tools / "frame-render", *common, "--irradcache", cache, "--points", points, "--photons", photons, "--keep-outliers", "--spp", 64, *picture, "-o", chain)
    return means_of(paths), means_of(chain)


def statistics(values):
    mean = sum(values) / len(values)
    return mean, math.sqrt(sum((v - mean) ** 2 for v in values) / (len(values) - 1) / len(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("out", type=Path)
    for name, default in (("rooms", 5), ("runs", 4), ("spp", 256)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--only", default="", help="clearcoat, sheen or anisotropy: leaves out the others; none: all")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    beyond = count = 0
    for number in range(options.rooms):
        scene = options.out / f"room{number}.gltf"
        room(scene, number, options.only)
        pairs = [render(options.bin, scene, options.out, seed + 1, options.spp) for seed in range(options.runs)]
        for thing in pairs[0][0]:
            light = statistics([sum(p[thing].values()) for p, _ in pairs])[0]
            for layer in LAYERS:
                by_paths, error_paths = statistics([p[thing][layer] for p, _ in pairs])
                by_chain, error_chain = statistics([c[thing][layer] for _, c in pairs])
                error, count = math.hypot(error_paths, error_chain), count + 1
                if abs(by_chain - by_paths) > 0.01 * light + 3 * error:
                    beyond += 1
                    print(f"room {number} object {thing} {layer}: chain {by_chain:.5f}, paths {by_paths:.5f}, error {error:.5f}, light {light:.5f}", flush=True)
    print(f"{beyond} of {count} means differ by more than 1 % of the object's light and 3 errors")
    return beyond > 0


if __name__ == "__main__":
    sys.exit(main())

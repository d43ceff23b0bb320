#!/usr/bin/env python3
"""Rooms with smoke, one difficulty each: layers of the chain against path tracing.

    python3 tests/bench/smoky_rooms.py build/release/bin --make-vdb build/release/tests/make-vdb [CASE ...]

A room of 2 m with a lamp under its ceiling and a ball of smoke in the middle; the camera looks along -z. CASES says what differs. Prints for
each layer the mean of the chain over that of the path tracer, and its standard error from what the seeds differ by. With --limit: exit 1
where a layer that is not dark is off by more.
"""
import argparse
import json
import math
import struct
import subprocess
import sys
from pathlib import Path

import pipeline

SIZE = "256x144"   # of smaller ones records are so far apart that indirect light comes out half a per cent low (--size 64x36)
DARK = 0.005                                 # layers below are not judged: the room has about 0.2
MATTE = {"roughnessFactor": 1, "metallicFactor": 0}
NO_GLOSS = {"KHR_materials_specular": {"specularFactor": 0}}
LAMP = ((-0.3, 1.99, -0.3), (0.6, 0, 0), (0, 0, 0.6))      # u x v points down
CASES = {
    "outside": {},
    "inside": {"eye": 0.15},
    "mirror": {"mirror": True},
    "glass": {"glass": True},
    "lamp inside": {"lamp": ((-0.1, 1.05, -0.1), (0.2, 0, 0), (0, 0, 0.2))},
    "g .9": {"media": [{"g": 0.9}]},
    "g -.5": {"media": [{"g": -0.5}]},
    "two media": {"media": [{"g": 0.6, "albedo": ".9,.5,.3"}, {"file": "box", "sigma": 3, "albedo": ".3,.6,.9"}]},
    "dense": {"media": [{"sigma": 60, "albedo": "1"}]},
}


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def quad(corner, u, v):
    """Front towards u x v."""
    at = [tuple(c + s * a + t * b for c, a, b in zip(corner, u, v)) for s, t in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return at, [0, 1, 2, 0, 2, 3]


def box(low, high, inwards=False):
    positions, indices = [], []
    for axis in range(3):
        for side in (0, 1):
            u, v = [0.0] * 3, [0.0] * 3
            a, b = (axis + 1) % 3, (axis + 2) % 3
            u[a], v[b] = high[a] - low[a], high[b] - low[b]
            corner = list(low)
            corner[axis] = high[axis] if side else low[axis]
            at, order = quad(corner, *((u, v) if bool(side) != inwards else (v, u)))
            indices += [len(positions) + i for i in order]
            positions += at
    return positions, indices


def material(colour, **more):
    extensions = dict(more.pop("extensions", NO_GLOSS))
    return {"pbrMetallicRoughness": {**MATTE, "baseColorFactor": [*colour, 1], **more.pop("pbr", {})}, "extensions": extensions, **more}


def room(case):
    """(name, material, mesh) of what the room holds."""
    yield "Room", material((0.7, 0.7, 0.7)), box((-1, 0, -1), (1, 2, 1), inwards=True)
    yield "Red", material((0.7, 0.1, 0.1)), quad((-0.999, 0, 1), (0, 0, -2), (0, 2, 0))
    yield "Block", material((0.3, 0.5, 0.7)), box((0.35, 0, -0.8), (0.75, 0.7, -0.4))
    light = {"KHR_materials_emissive_strength": {"emissiveStrength": 10}, **NO_GLOSS}
    yield "Lamp", material((0, 0, 0), emissiveFactor=[1, 0.9, 0.8], doubleSided="lamp" in case, extensions=light), quad(*case.get("lamp", LAMP))
    if case.get("mirror"):
        yield "Mirror", material((0.9, 0.9, 0.9), pbr={"metallicFactor": 1, "roughnessFactor": 0}), quad((-0.9, 0.2, -0.95), (1.8, 0, 0), (0, 1.6, 0))
    if case.get("glass"):
        glass = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5},
                 "KHR_materials_volume": {"thicknessFactor": 0.1}}
        yield "Glass", material((1, 1, 1), pbr={"roughnessFactor": 0}, extensions=glass), box((-0.5, 0.5, 0.55), (0.1, 1.5, 0.65))


def write_scene(path, case):
    """The room of a case; with "parts" what these list instead, with "point" a point lamp there, with "walk" a camera that is at these places in the frames 0, 1, ..."""
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [],
            "extensionsUsed": ["KHR_materials_specular", "KHR_materials_emissive_strength", "KHR_materials_transmission",
                               "KHR_materials_ior", "KHR_materials_volume"]}
    data = bytearray()

    def accessor(values, code, kind, component, **more):
        chunk = struct.pack(f"<{len(values)}{code}", *values)
        gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": len(chunk)})
        data.extend(chunk)
        gltf["accessors"].append({"bufferView": len(gltf["bufferViews"]) - 1, "componentType": component, "type": kind,
                                  "count": len(values) // (3 if kind == "VEC3" else 1), **more})
        return len(gltf["accessors"]) - 1

    for name, look, (positions, indices) in case.get("parts") or room(case):
        bounds = {"min": [min(p[i] for p in positions) for i in range(3)], "max": [max(p[i] for p in positions) for i in range(3)]}
        mesh = {"attributes": {"POSITION": accessor([x for p in positions for x in p], "f", "VEC3", 5126, **bounds)},
                "indices": accessor(indices, "I", "SCALAR", 5125), "material": len(gltf["materials"])}
        gltf["materials"].append({"name": name, **look})
        gltf["meshes"].append({"primitives": [mesh]})
        gltf["nodes"].append({"name": name, "mesh": len(gltf["meshes"]) - 1})
    if "point" in case:
        gltf["extensionsUsed"].append("KHR_lights_punctual")
        gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 1}]}}
        gltf["nodes"].append({"name": "Point", "translation": list(case["point"]), "extensions": {"KHR_lights_punctual": {"light": 0}}})
    gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": case.get("yfov", 1.2), "znear": 0.01, "aspectRatio": 16 / 9}}]
    gltf["nodes"].append({"name": "Camera", "camera": 0, "translation": list(case["walk"][0]) if "walk" in case else [0, 1, case.get("eye", 0.95)]})
    if walk := case.get("walk"):
        times = [i / 24 for i in range(len(walk))]
        sampler = {"input": accessor(times, "f", "SCALAR", 5126, min=[times[0]], max=[times[-1]]),
                   "output": accessor([x for p in walk for x in p], "f", "VEC3", 5126), "interpolation": "LINEAR"}
        target = {"node": len(gltf["nodes"]) - 1, "path": "translation"}
        gltf["animations"] = [{"samplers": [sampler], "channels": [{"sampler": 0, "target": target}]}]
    gltf["scenes"] = [{"nodes": list(range(len(gltf["nodes"])))}]
    gltf["buffers"] = [{"byteLength": len(data)}]
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    with open(path, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)


def write_volumes(folder, make_vdb):
    """ball.vdb: denser inside, 1 m across; box.vdb: even, in its lower right."""
    voxels = 24
    ball = [max(0.0, 1 - math.dist((x, y, z), (11.5,) * 3) / 12) for x in range(voxels) for y in range(voxels) for z in range(voxels)]
    even = [1.0] * 16 ** 3
    for name, values, n, size, corner in (("ball", ball, voxels, 1 / voxels, (-0.48, 0.52, -0.48)), ("box", even, 16, 0.04, (0.0, 0.4, -0.3))):
        (folder / f"{name}.vdb").unlink(missing_ok=True)
        subprocess.run([make_vdb, folder / f"{name}.vdb", *map(str, (n, n, n, size, *corner))],
                       input=struct.pack(f"<{len(values)}f", *values), check=True)


def means(info, path):
    """Mean of each layer, channels together."""
    answer = json.loads(subprocess.run([info, "--json", path], capture_output=True, check=True, text=True).stdout)
    channels = {c["channel"]: c["mean"] for c in answer["channels"]}
    return {layer: sum(channels[f"{layer}.{c}"] for c in "RGB") / 3
            for layer in ("emission", "specular", "direct", "caustic", "indirect", "volume") if f"{layer}.R" in channels}


def compare(bin_folder, folder, name, case, seeds, paths, size):
    """By layer: mean of the chain, mean of the path tracer, standard error of both over the seeds."""
    def run(tool, *options):
        subprocess.run([bin_folder / tool, *map(str, options), "-q"], check=True)
    scene = folder / f"{name.replace(' ', '_')}.glb"
    write_scene(scene, case)
    smoke = []
    for medium in case.get("media", [{}]):
        smoke += ["--volume", folder / f"{medium.get('file', 'ball')}.vdb", "--sigma-t", medium.get("sigma", 8),
                  "--albedo", medium.get("albedo", ".85,.85,.88"), "--phase-g", medium.get("g", 0)]
    size = ["--size", size]
    stem = str(scene.with_suffix(""))
    chain, path = [], []
    for seed in range(seeds):
        common = [scene, *smoke, "--seed", seed]
        run("frame-render", *common, *size, "--integrator", "path", "--spp", paths // seeds, "--channels", "RGBA,layers", "-o", stem + ".path.exr")
        clear = stem + ".clear"
        pipeline.chain(run, common, clear, ["--photons", "300k", "--kinds", "caustic,indirect,volume"], (), size,
                       [*size, "--spp", 16, "--pixel-error", 0.01, "--channels", "RGBA,layers,Z"], map_beside=True)
        run("volume-compose", *common, "--photons", clear + ".photons", "--points", clear + ".irradpoints", "--base", clear + ".exr", "--spp", 8, "-o", stem + ".chain.exr")
        chain.append(means(bin_folder / "tempolux-info", stem + ".chain.exr"))
        path.append(means(bin_folder / "tempolux-info", stem + ".path.exr"))
    return chain, path


def spread(values):
    mean = sum(values) / len(values)
    return mean, math.sqrt(sum((v - mean) ** 2 for v in values) / max(1, len(values) - 1) / len(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--make-vdb", default="make-vdb")
    parser.add_argument("--folder", type=Path, default=Path("smoky_rooms"))
    parser.add_argument("--seeds", type=int, default=8, help="of few seeds, one says little of how much they differ: .2 %% by chance of 2, where it is 2 %%")
    parser.add_argument("--size", default=SIZE)
    parser.add_argument("--paths", type=int, default=64, help="of a pixel, all seeds together")
    parser.add_argument("--limit", type=float, default=math.inf)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    write_volumes(options.folder, options.make_vdb)
    print("| case | layer | path tracer | chain / path | standard error |\n|---|---|---:|---:|---:|")
    wrong = 0
    for name in options.cases or CASES:
        chain, path = compare(options.bin.resolve(), options.folder, name, CASES[name], options.seeds, options.paths, options.size)
        for layer in path[0]:
            (a, sa), (b, sb) = spread([c[layer] for c in chain]), spread([p[layer] for p in path])
            if b > 0:
                print(f"| {name} | {layer} | {b:.4f} | {a / b:.4f} | {math.hypot(sa, sb) / b:.4f} |", flush=True)
            wrong += b > DARK and abs(a / b - 1) > options.limit
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Write scenes for walkthroughs from others: make_walkthrough.py VARIANT SOURCE.glb OUT.glb

  polished   every floor (material named Floor...) reflects like polished stone: a smooth dielectric of index 1.5 over its colour
  toy        a toy car, rigid, drives through the hall: from z = -3 to z = -8 in 48 frames, turning on the way
  pan        the camera stands and pans: 54 degrees to the right in 16 frames (81 degrees a second), rests for 16, and pans back

SOURCE for the first two: a hall that a camera walks through, such as S4_atrium.glb; for `pan` any room with a camera, such as
pipelines/scenes/S3_indirect_room.glb. Frames are those of 24 a second.
"""
import json
import math
import struct
import sys

FPS, FRAMES = 24, 48


def read_glb(path):
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] != b"glTF":
        raise SystemExit(f"{path}: not a .glb file; give one")
    size, = struct.unpack_from("<I", data, 12)
    return json.loads(data[20:20 + size]), bytearray(data[28 + size:])


def write_glb(path, gltf, binary):
    binary += bytes(-len(binary) % 4)
    gltf["buffers"][0]["byteLength"] = len(binary)
    text = json.dumps(gltf, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def add_accessor(gltf, binary, values, kind, form="f"):
    """Numbers or tuples into the buffer; the number of their accessor."""
    rows = [v if isinstance(v, tuple) else (v,) for v in values]
    binary += bytes(-len(binary) % 4)
    gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": 4 * len(rows) * len(rows[0])})
    for row in rows:
        binary += struct.pack(f"<{len(row)}{form}", *row)
    columns = list(zip(*rows))
    accessor = {"bufferView": len(gltf["bufferViews"]) - 1, "componentType": 5126 if form == "f" else 5125, "type": kind,
                "count": len(rows), "min": [min(c) for c in columns], "max": [max(c) for c in columns]}
    gltf["accessors"].append(accessor)
    return len(gltf["accessors"]) - 1


def animate(gltf, binary, node, path, keys):
    """A channel of the scene's animation. keys: {frame: value}, linear between them.

    All channels are in one animation: importers play one at a time.
    """
    times = add_accessor(gltf, binary, [frame / FPS for frame in keys], "SCALAR")
    values = add_accessor(gltf, binary, list(keys.values()), "VEC3" if path == "translation" else "VEC4")
    if not gltf.get("animations"):
        gltf["animations"] = [{"name": "Shot", "samplers": [], "channels": []}]
    animation = gltf["animations"][0]
    animation["samplers"].append({"input": times, "output": values, "interpolation": "LINEAR"})
    animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path}})


def about_y(degrees):
    return 0.0, math.sin(math.radians(degrees) / 2), 0.0, math.cos(math.radians(degrees) / 2)


def times(a, b):
    """Product of two quaternions x y z w: first b, then a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def polished(gltf, _):
    floors = [m for m in gltf["materials"] if m.get("name", "").startswith("Floor")]
    if not floors:
        raise SystemExit("no material is named Floor...; name the floor's so")
    for material in floors:
        material["pbrMetallicRoughness"].update(metallicFactor=0, roughnessFactor=0)
        material.setdefault("extensions", {})["KHR_materials_specular"] = {"specularFactor": 1}


def box(lower, upper):
    """Corners and triangles of a box, fronts outwards; four corners for each side, so that it is flat."""
    corners, triangles = [], []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            first = len(corners)
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                p = [0.0] * 3
                p[axis], p[u], p[v] = (lower, upper)[side][axis], (lower, upper)[a][u], (lower, upper)[b][v]
                corners.append(tuple(p))
            order = (0, 1, 2, 0, 2, 3) if side else (0, 2, 1, 0, 3, 2)
            triangles += [first + i for i in order]
    return corners, triangles


def toy(gltf, binary):
    parts = [((-.2, .08, -.4), (.2, .25, .4)), ((-.16, .25, -.25), (.16, .4, .15)),
             *(((x - .05, 0, z - .08), (x + .05, .16, z + .08)) for x in (-.2, .2) for z in (-.25, .25))]
    gltf["materials"] += [
        {"name": name, "doubleSided": True, "pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0},
         "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
        for name, color in (("ToyBody", (.7, .1, .05)), ("ToyCabin", (.7, .6, .1)), ("ToyWheel", (.05, .05, .05)))]
    primitives = []
    for number, part in enumerate(parts):
        corners, triangles = box(*part)
        primitives.append({"attributes": {"POSITION": add_accessor(gltf, binary, corners, "VEC3")},
                           "indices": add_accessor(gltf, binary, triangles, "SCALAR", "I"),
                           "material": len(gltf["materials"]) - 3 + min(number, 2)})
    gltf["meshes"].append({"name": "Toy", "primitives": primitives})
    gltf["nodes"].append({"name": "Toy", "mesh": len(gltf["meshes"]) - 1, "translation": [-1.2, 0, -3]})
    node = len(gltf["nodes"]) - 1
    gltf["scenes"][gltf.get("scene", 0)]["nodes"].append(node)
    frames = range(0, FRAMES, 4)
    along = {f: f / (FRAMES - 1) for f in [*frames, FRAMES - 1]}
    animate(gltf, binary, node, "translation", {f: (-1.2 + .6 * math.sin(2 * math.pi * t), 0.0, -3 - 5 * t) for f, t in along.items()})
    animate(gltf, binary, node, "rotation",
            {f: about_y(math.degrees(math.atan2(-.6 * 2 * math.pi * math.cos(2 * math.pi * t), 5))) for f, t in along.items()})


def pan(gltf, binary):
    node = next((i for i, n in enumerate(gltf["nodes"]) if "camera" in n), None)
    if node is None:
        raise SystemExit("the scene has no camera; give one that has")
    gltf["animations"] = [a for a in gltf.get("animations", []) if all(c["target"].get("node") != node for c in a["channels"])]
    at_rest = tuple(gltf["nodes"][node].get("rotation", (0, 0, 0, 1)))
    angle = {f: -54 * min(f, 16, FRAMES - f) / 16 for f in [*range(0, 17), *range(32, FRAMES + 1)]}
    animate(gltf, binary, node, "rotation", {f: times(about_y(a), at_rest) for f, a in angle.items()})


def main(variant, source, out):
    gltf, binary = read_glb(source)
    {"polished": polished, "toy": toy, "pan": pan}[variant](gltf, binary)
    write_glb(out, gltf, binary)


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("polished", "toy", "pan"):
        raise SystemExit(__doc__)
    main(*sys.argv[1:])

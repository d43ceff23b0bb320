#!/usr/bin/env python3
"""Edit a .glb file the way a user or an exporter would: edit_gltf.py IN.glb OUT EDIT [ARGUMENT...]

OUT may be a .glb, or a .gltf that gets its buffer as a .bin file beside it.

  same                  nothing: keys in another order, other white space, buffer contents moved
  camera-from FRAME     the camera stands one centimetre higher from FRAME on
  emission FACTOR       all emissive materials are FACTOR times as bright
  lamp [FRAME]          a lamp that moves through frames 0 to 5; one centimetre higher at FRAME
  still                 no animation
  event KIND            of frames 0 to 8 at frame 4 the moving box is elsewhere (teleports), larger (grows), there from then on (born), there no
                        more (gone), or no more below the lamp, which it covered (uncovers), or the lamp has no area (lamp-off); else all stands
  nudge FRAME           the moving box is two centimetres aside at FRAME
  mirror                the first material that emits nothing is a perfect mirror
  drop NAME             without the key NAME at the top level (cameras, for example)
"""
import json
import os
import struct
import sys

FPS = 24


def read_glb(path):
    data = open(path, "rb").read()
    size, = struct.unpack_from("<I", data, 12)
    gltf = json.loads(data[20:20 + size])
    return gltf, bytearray(data[28 + size:])


def write_glb(path, gltf, binary, **style):
    binary += bytes(-len(binary) % 4)
    gltf["buffers"][0]["byteLength"] = len(binary)
    text = json.dumps(gltf, **style).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def add_accessor(gltf, binary, values, kind):
    binary += bytes(-len(binary) % 4)
    floats = [x for value in values for x in value]
    gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": 4 * len(floats)})
    binary += struct.pack(f"<{len(floats)}f", *floats)
    columns = list(zip(*values))
    gltf["buffers"][0]["byteLength"] = len(binary)
    gltf["accessors"].append({"bufferView": len(gltf["bufferViews"]) - 1, "componentType": 5126, "type": kind,
                              "count": len(values), "min": [min(c) for c in columns],
                              "max": [max(c) for c in columns]})
    return len(gltf["accessors"]) - 1


def animate(gltf, binary, node, keys, path="translation", interpolation="LINEAR"):
    """keys: {frame: value}."""
    times = add_accessor(gltf, binary, [(frame / FPS,) for frame in keys], "SCALAR")
    places = add_accessor(gltf, binary, list(keys.values()), "VEC3")
    gltf.setdefault("animations", []).append({
        "samplers": [{"input": times, "output": places, "interpolation": interpolation}],
        "channels": [{"sampler": 0, "target": {"node": node, "path": path}}]})


def same(gltf, binary):
    shift = 64
    binary[:0] = bytes(shift)
    for view in gltf["bufferViews"]:
        view["byteOffset"] = view.get("byteOffset", 0) + shift
    gltf["buffers"][0]["byteLength"] += shift


def camera_from(gltf, binary, frame):
    node = next(i for i, n in enumerate(gltf["nodes"]) if "camera" in n)
    here = gltf["nodes"][node]["translation"]
    up = [here[0], here[1] + 0.01, here[2]]
    animate(gltf, binary, node, {f: up if f >= int(frame) else here for f in range(8)})


def emission(gltf, binary, factor):
    for material in gltf["materials"]:
        strength = material.get("extensions", {}).get("KHR_materials_emissive_strength")
        if strength:
            strength["emissiveStrength"] *= float(factor)


def lamp(gltf, binary, lifted=None):
    gltf["extensionsUsed"].append("KHR_lights_punctual")
    gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 1}]}}
    gltf["nodes"].append({"name": "Lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}})
    node = len(gltf["nodes"]) - 1
    gltf["scenes"][0]["nodes"].append(node)
    animate(gltf, binary, node,
            {f: [0.1 * f, 1 + (0.01 if str(f) == lifted else 0), 0.5] for f in range(6)})


def still(gltf, binary):
    gltf.pop("animations", None)


def event(gltf, binary, kind):
    gltf.pop("animations", None)
    name = "Emitter" if kind == "lamp-off" else "MovingBox"
    node = next(i for i, n in enumerate(gltf["nodes"]) if n.get("name") == name)
    if kind == "uncovers":                   # the box is .6 m wide and .7 high, the lamp 1 m x .8 m at a height of 2 m
        gltf["nodes"][node] |= {"translation": [0, 1.9, 0.1], "scale": [1.8, 0.1, 1.5]}
    here, size = gltf["nodes"][node].get("translation", [0, 0, 0]), gltf["nodes"][node].get("scale", [1, 1, 1])
    none = [0, 0, 0]
    path, before, at, after = {"teleports": ("translation", here, [here[0] + 0.6, *here[1:]], here), "grows": ("scale", size, [1.5 * x for x in size], size),
                               "born": ("scale", none, size, size), "gone": ("scale", size, none, none),
                               "uncovers": ("scale", size, none, none), "lamp-off": ("scale", size, none, size)}[kind]
    animate(gltf, binary, node, {f: before if f < 4 else at if f == 4 else after for f in range(9)}, path, "STEP")


def nudge(gltf, binary, frame):
    animation = gltf["animations"][0]
    channel = next(c for c in animation["channels"] if c["target"]["path"] == "translation")
    accessor = gltf["accessors"][animation["samplers"][channel["sampler"]]["output"]]
    offset = gltf["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0) + 12 * int(frame)
    struct.pack_into("<f", binary, offset, struct.unpack_from("<f", binary, offset)[0] + 0.02)


def mirror(gltf, binary):
    material = next(m for m in gltf["materials"] if not any(m.get("emissiveFactor", [0])))
    material["pbrMetallicRoughness"] |= {"metallicFactor": 1, "roughnessFactor": 0}


def drop(gltf, binary, name):
    gltf.pop(name)
    if name == "cameras":
        for node in gltf["nodes"]:
            node.pop("camera", None)


def main():
    source, target, edit, *arguments = sys.argv[1:]
    gltf, binary = read_glb(source)
    edits = {"same": same, "camera-from": camera_from, "emission": emission, "lamp": lamp, "still": still,
             "mirror": mirror, "nudge": nudge, "event": event, "drop": drop}
    edits[edit](gltf, binary, *arguments)
    if target.endswith(".gltf"):
        buffer = target[:-5] + ".bin"
        gltf["buffers"][0]["uri"] = os.path.basename(buffer)
        with open(buffer, "wb") as file:
            file.write(binary)
        with open(target, "w") as file:
            json.dump(gltf, file)
        return
    style = {"indent": 1, "sort_keys": True} if edit == "same" else {"separators": (",", ":")}
    write_glb(target, gltf, binary, **style)


if __name__ == "__main__":
    main()

"""Scenes of a white square under a lamp, seen from above, in scene/: plain; with one or two animations of the lamp; with a texture
of a white and a black texel, inside their folder and outside."""
import base64
import json
import os
import struct
import zlib


def png(width, height, rows):
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    lines = b"".join(b"\0" + bytes(row) for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


os.makedirs("scene", exist_ok=True)
os.makedirs("images", exist_ok=True)
for folder in ("scene", "images"):
    open(f"{folder}/two.png", "wb").write(png(2, 1, [[255, 0]]))
views, accessors, data = [], [], bytearray()


def accessor(code, component, kind, per, values):
    packed = struct.pack(f"<{len(values)}{code}", *values)
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
    data.extend(packed)
    accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(values) // per, "type": kind})
    return len(accessors) - 1


def floats(kind, per, values):
    return accessor("f", 5126, kind, per, values)


positions = floats("VEC3", 3, [-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1])
coordinates = floats("VEC2", 2, [0, 0, 0, 1, 1, 1, 1, 0])
times = floats("SCALAR", 1, [0, 1])
sink, fall = (floats("VEC3", 3, [0, 3, 0, 0, height, 0]) for height in (2, 1))
corners = accessor("H", 5123, "SCALAR", 1, [0, 1, 2, 0, 2, 3])
down = [-0.5 ** 0.5, 0, 0, 0.5 ** 0.5]


def animation(name, output):
    return {"name": name, "samplers": [{"input": times, "output": output}],
            "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]}


scene = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}],
    "extensionsUsed": ["KHR_lights_punctual"],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 683}]}},
    "nodes": [{"mesh": 0, "name": "Floor"}, {"name": "Lamp", "translation": [0, 3, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}},
              {"camera": 0, "name": "Above", "translation": [0, 2, 0], "rotation": down},
              {"camera": 0, "name": "Aside", "translation": [9, 2, 0], "rotation": down}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}],
    "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": positions, "TEXCOORD_0": coordinates}, "indices": corners, "material": 0}]}],
    "animations": [animation("Sink", sink), animation("Fall", fall)],
    "accessors": accessors, "bufferViews": views,
    "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(bytes(data)).decode()}]}
json.dump({**scene, "animations": []}, open("scene/plain.gltf", "w"))
json.dump({**scene, "animations": [scene["animations"][0]]}, open("scene/sink.gltf", "w"))
json.dump(scene, open("scene/two.gltf", "w"))
scene["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
for name, uri in ("inside", "two.png"), ("outside", "../images/two.png"):
    scene["images"], scene["textures"] = [{"uri": uri}], [{"source": 0}]
    json.dump({**scene, "animations": []}, open(f"scene/{name}.gltf", "w"))

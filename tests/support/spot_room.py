#!/usr/bin/env python3
"""S3 with its lamp narrowed to a cone: the same flux through a spot of 0.2 rad, so that a small bright spot lights the room by reflection.

    python3 tests/support/spot_room.py spot.glb [ball]

With `ball` the ball rises by 0.6 m in 48 frames; else nothing moves.
"""
import json
import math
import struct
import sys
from pathlib import Path

S3 = Path(__file__).resolve().parents[2] / "pipelines/scenes/S3_indirect_room.glb"
CONE = 0.2                                  # rad, half of the cone; light falls off from 0.8 of it


def read_glb(path):
    data = Path(path).read_bytes()
    size, = struct.unpack_from("<I", data, 12)
    return json.loads(data[20:20 + size]), data[28 + size:]


def lift(gltf, binary, name="Ball", by=0.6, last=47 / 24):
    """An animation of a node: up by so many metres in so many seconds. Returns the binary with its four numbers a key."""
    node = next(i for i, n in enumerate(gltf["nodes"]) if n["name"] == name)
    begin = gltf["nodes"][node].get("translation", [0, 0, 0])
    times, places = struct.pack("<2f", 0, last), struct.pack("<6f", *begin, begin[0], begin[1] + by, begin[2])
    binary += b"\0" * (-len(binary) % 4)
    for data, accessor in ((times, {"count": 2, "type": "SCALAR", "min": [0], "max": [last]}), (places, {"count": 2, "type": "VEC3"})):
        gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        gltf["accessors"].append({"bufferView": len(gltf["bufferViews"]) - 1, "componentType": 5126, **accessor})
        binary += data
    gltf["buffers"][0]["byteLength"] = len(binary)
    last_accessor = len(gltf["accessors"]) - 1
    gltf["animations"] = [{"samplers": [{"input": last_accessor - 1, "output": last_accessor}], "channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}]}]
    return binary


def make(path, cone=CONE, ball=False):
    """Writes the scene; the lamp shines from its middle along its normal, +x, into the wall 2 m away. The camera Behind looks there, too."""
    gltf, binary = read_glb(S3)
    lamp = next(n for n in gltf["nodes"] if n["name"] == "Emitter")
    primitive = gltf["meshes"][lamp["mesh"]]["primitives"][0]
    bounds = gltf["accessors"][primitive["attributes"]["POSITION"]]
    material = gltf["materials"][primitive["material"]]
    low, high = bounds["min"], bounds["max"]
    area = (high[1] - low[1]) * (high[2] - low[2])
    radiance = material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
    colour = material["emissiveFactor"]
    material["emissiveFactor"] = [0, 0, 0]
    # A cone of uniform intensity I has the flux 2 pi (1 - cos) I; the lamp's is pi x radiance x area.
    intensity = math.pi * radiance * area / (2 * math.pi * (1 - math.cos(cone)))
    gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "color": colour, "intensity": intensity,
                                                             "spot": {"innerConeAngle": 0.8 * cone, "outerConeAngle": cone}}]}}
    gltf["extensionsUsed"].append("KHR_lights_punctual")
    half = math.sqrt(0.5)                   # a spot shines along its -z: turned by -90 degrees about y that is +x
    gltf["nodes"].append({"name": "Spot", "translation": [high[0] + 0.02, *[(low[a] + high[a]) / 2 for a in (1, 2)]],
                          "rotation": [0, -half, 0, half], "extensions": {"KHR_lights_punctual": {"light": 0}}})
    gltf["nodes"].append({"name": "Behind", "camera": 0, "translation": [high[0] + 0.1, 1.3, (low[2] + high[2]) / 2], "rotation": [0, -half, 0, half]})
    gltf["scenes"][0]["nodes"] += [len(gltf["nodes"]) - 2, len(gltf["nodes"]) - 1]
    if ball:
        binary = lift(gltf, binary)
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    Path(path).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


if __name__ == "__main__":
    make(sys.argv[1], ball="ball" in sys.argv[2:])

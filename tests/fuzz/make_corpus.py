#!/usr/bin/env python3
"""Make tests/fuzz/corpus: small inputs from which the fuzzers start, good ones and the kinds of bad ones met so far.

    make_corpus.py FOLDER          FOLDER is tests/fuzz/corpus

The containers' corpus is tests/formats/*/accept and refuse. Files named found-* are not made here: each once broke a
reader, and keeps its name.
"""
import base64
import copy
import json
import os
import struct
import sys
import zlib

folder = sys.argv[1]


def save(target, name, data):
    os.makedirs(os.path.join(folder, target), exist_ok=True)
    with open(os.path.join(folder, target, name), "wb") as file:
        file.write(data if isinstance(data, bytes) else data.encode())


# ---- glTF: a triangle, a camera, a lamp and an animation ------------------------------------------------------

POSITIONS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
BYTES = (POSITIONS + struct.pack("<9f", *(0, 0, 1) * 3) + struct.pack("<4H", 0, 1, 2, 0) +
         struct.pack("<2f", 0, 1) + struct.pack("<6f", 0, 0, 0, 1, 2, 3) + struct.pack("<8f", 0, 0, 0, 1, 0, 0, 1, 0) +
         struct.pack("<6f", 0, 0, 1, 0, 0, 1))
VIEWS = [36, 36, 8, 8, 24, 32, 24]


def scene():
    at = [sum(VIEWS[:i]) for i in range(len(VIEWS))]
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_emissive_strength"],
        "nodes": [{"mesh": 0, "children": [3], "extras": {"a": [1, "b"]}},
                  {"camera": 0, "translation": [0, 0, 2]},
                  {"extensions": {"KHR_lights_punctual": {"light": 0}}, "rotation": [0, 0, 0, 1]},
                  {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 5, "spot": {}}]}},
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.2, 1], "metallicFactor": 0},
                       "emissiveFactor": [1, 1, 1], "doubleSided": True,
                       "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 10},
                                      "KHR_materials_transmission": {"transmissionFactor": 1},
                                      "KHR_materials_volume": {"thicknessFactor": 1},
                                      "KHR_materials_ior": {"ior": 1.5}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 6}, "indices": 2,
                                    "material": 0}]}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}},
                                     {"sampler": 1, "target": {"node": 2, "path": "rotation"}}],
                        "samplers": [{"input": 3, "output": 4}, {"input": 3, "output": 5, "interpolation": "STEP"}]}],
        "accessors": [{"bufferView": v, "componentType": t, "count": n, "type": k}
                      for v, t, n, k in ((0, 5126, 3, "VEC3"), (1, 5126, 3, "VEC3"), (2, 5123, 3, "SCALAR"),
                                         (3, 5126, 2, "SCALAR"), (4, 5126, 2, "VEC3"), (5, 5126, 2, "VEC4"),
                                         (6, 5126, 3, "VEC2"))],
        "bufferViews": [{"buffer": 0, "byteOffset": a, "byteLength": n} for a, n in zip(at, VIEWS)],
        "buffers": [{"byteLength": len(BYTES)}]}


def text(document):
    document = copy.deepcopy(document)
    if "uri" not in document["buffers"][0]:
        document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(BYTES).decode()
    return json.dumps(document, separators=(",", ":"))


def glb(document, data=BYTES):
    body = json.dumps(document, separators=(",", ":")).encode()
    body += b" " * (-len(body) % 4)
    data += b"\0" * (-len(data) % 4)
    return (struct.pack("<4sIIII", b"glTF", 2, 28 + len(body) + len(data), len(body), 0x4E4F534A) + body +
            struct.pack("<II", len(data), 0x004E4942) + data)


def changed(**places):
    """The scene with values put in: nodes_0_children=[0]."""
    document = scene()
    for place, value in places.items():
        *path, last = (int(key) if key.isdigit() else key for key in place.split("__"))
        inside = document
        for key in path:
            inside = inside[key]
        inside[last] = value
    return document


save("gltf", "good.glb", glb(scene()))
save("gltf", "good.gltf", text(scene()))
save("gltf", "nodes-form-a-loop.gltf", text(changed(nodes__3__children=[0])))
save("gltf", "accessor-of-4e9.gltf", text(changed(accessors__0__count=4_000_000_000, bufferViews__0__byteOffset=4_000_000_000)))
save("gltf", "index-beyond-the-vertices.glb", glb(scene(), BYTES[:72] + struct.pack("<3H", 0, 1, 7) + BYTES[78:]))
save("gltf", "infinite-position.glb", glb(scene(), struct.pack("<f", float("inf")) + BYTES[4:]))
save("gltf", "bad-percent.gltf", text(changed(images=[{"uri": "%!QAAAQAAA5"}], textures=[{"source": 0}])))
save("gltf", "leaves-the-folder.gltf", text(changed(buffers__0__uri="../../../etc/hostname")))
save("gltf", "names-itself.gltf", text(changed(buffers__0__uri="input.glb")))
save("gltf", "wrong-types.gltf", text(changed(nodes__0__mesh="0", accessors__0__type=3)))
save("gltf", "sparse.gltf", text(changed(accessors__0__sparse={
    "count": 1, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 4}})))
save("gltf", "packed.gltf", text(changed(extensionsRequired=["EXT_meshopt_compression"])))
save("gltf", "deep.gltf", '{"asset":{"version":"2.0"},"extras":' + "[" * 300 + "]" * 300 + "}")
save("gltf", "morph-and-skin.gltf", text(changed(
    meshes__0__primitives__0__targets=[{"POSITION": 4}], meshes__0__weights=[0.5],
    skins=[{"joints": [0, 2]}], nodes__0__skin=0)))

# ---- what error-report reads -----------------------------------------------------------------------------------

save("report", "stats.json", json.dumps({
    "schema": "tempolux.stats", "version": "1.0", "tool": "photon-trace", "cpu_s": 1.5, "wall_s": 0.8,
    "peak_memory_bytes": 1e7, "phases": [{"name": "trace", "cpu_s": 1, "wall_s": 0.5}], "counts": {"rays": 1000}}))
save("report", "comparison.json", json.dumps({
    "schema": "tempolux.comparison", "version": "1.0", "mode": "reference_halves", "layer": "", "frames": [{}],
    "total": {"pixels": 100, "mse": 0.01, "mse_standard_error": 0.001, "relmse": 0.1, "bias": -0.2,
              "objects": [{"id": 3, "bias": 0.1, "few_pixels": False}]}}))
save("report", "manifest.json", json.dumps({
    "schema": "tempolux.report", "version": "1.0", "title": "t", "baseline": "c",
    "runs": [{"scene": "s", "curve": "c", "x": 4, "label": "l", "parameters": {"p": 1}, "stats": ["input.json"],
              "comparison": "input.json", "image": "a.png"}],
    "points": [{"scene": "s", "label": "l", "cpu_s": 1, "rmse": 0.1}], "references": {"s": "r.png"}}))
save("report", "folder.json", json.dumps({
    "schema": "tempolux.report", "version": "1.0",
    "runs": [{"curve": "c", "stats": [""]}]}))
save("report", "version-of-two-lines.json", json.dumps({"schema": "tempolux.stats", "version": "2\n" + 3000 * "x"}))
save("report", "number-too-large.json", '{"schema":"tempolux.stats","version":"1","tool":"t","cpu_s":1e999,"wall_s":1}')
save("report", "deep.json", "[" * 2000 + "]" * 2000)

# ---- pictures --------------------------------------------------------------------------------------------------


def png(width, height, kind, rows, *extra):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)) +
            b"".join(chunk(*pair) for pair in extra) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def attribute(name, kind, value):
    return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value


save("pictures", "rgb.png", png(2, 2, 2, b"\0abcdef\0ghijkl"))
save("pictures", "palette.png", png(2, 1, 3, b"\0\0\1", (b"PLTE", b"abcdef"), (b"tRNS", b"\x80")))
save("pictures", "huge.png", png(30000, 30000, 6, b""))


def exr_header(side, kinds, compression):
    box = struct.pack("<4i", 0, 0, side - 1, side - 1)
    channels = b"".join(name + b"\0" + struct.pack("<iB3xii", kind, 0, 1, 1) for name, kind in kinds) + b"\0"
    return (struct.pack("<II", 20000630, 2) + attribute(b"channels", b"chlist", channels) +
            attribute(b"compression", b"compression", bytes([compression])) + attribute(b"dataWindow", b"box2i", box) +
            attribute(b"displayWindow", b"box2i", box) + attribute(b"lineOrder", b"lineOrder", b"\0") +
            attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) +
            attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)) +
            attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0")


def exr(header, chunks):
    """Of chunks (first line, data)."""
    offset, offsets, whole = len(header) + 8 * len(chunks), b"", b""
    for line, data in chunks:
        offsets += struct.pack("<Q", offset + len(whole))
        whole += struct.pack("<ii", line, len(data)) + data
    return header + offsets + whole


def zipped(data):
    """As OpenEXR compresses a chunk: even bytes before odd ones, differences, zlib."""
    turned = data[::2] + data[1::2]
    return zlib.compress(turned[:1] + bytes((b - a + 128) & 255 for a, b in zip(turned, turned[1:])))


save("pictures", "rgb.exr", exr(exr_header(2, [(b"B", 2), (b"G", 2), (b"R", 2)], 0), [(y, bytes(24)) for y in (0, 1)]))
# Three chunks of 16 lines; float, half and whole numbers.
line = struct.pack("<40f", *range(40)) + struct.pack("<40e", *range(40)) + struct.pack("<40I", *range(40))
save("pictures", "zip.exr", exr(exr_header(40, [(b"A", 2), (b"R", 1), (b"id", 0)], 3),
                                [(y, zipped(line * min(16, 40 - y))) for y in (0, 16, 32)]))


def hdr(width, height, pixels, extra=b""):
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + extra + b"\n-Y %d +X %d\n" % (height, width) + pixels


run = b"\2\2\0\x08" + b"\x88\x80" + b"\x08abcdefgh" + b"\x84\x40\x84\x20" + b"\x88\x81"
save("pictures", "flat.hdr", hdr(3, 2, bytes(range(120, 144))))
save("pictures", "runs.hdr", hdr(8, 2, run + run, b"EXPOSURE=2\n"))
save("pictures", "old-runs.hdr", hdr(8, 1, b"\x80\x40\x20\x81" + b"\1\1\1\7"))
save("pictures", "huge.hdr", hdr(2000000000, 2000000000, b""))
# 8 x 8 baseline with halved colour, 9 x 5 progressive; by libjpeg.
save("pictures", "baseline.jpg", base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABALDA4MChAODQ4SERATGCgaGBYWGDEjJR0oOjM9PDkzODdASFxOQERXRTc4UG1RV19iZ2hnPk1xeXBk"
    "eFxlZ2P/2wBDARESEhgVGC8aGi9jQjhCY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2P/wAARCAAIAAgD"
    "ASIAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAAAAL/xAAbEAACAwEBAQAAAAAAAAAAAAABAgARITESIv/EABUBAQEAAAAAAAAAAAAAAAAAAAID"
    "/8QAGhEAAgIDAAAAAAAAAAAAAAAAAAEDERJBcf/aAAwDAQACEQMRAD8AhVB+fIC3WKQlDNFWcIzvF6zGIiJR5ba4SkdM/9k="))
save("pictures", "progressive.jpg", base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABsSFBcUERsXFhceHBsgKEIrKCUlKFE6PTBCYFVlZF9VXVtqeJmBanGQc1tdhbWGkJ6jq62rZ4C8ybqm"
    "x5moq6T/2wBDARweHigjKE4rK06kbl1upKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKSkpKT/wgARCAAFAAkD"
    "ASIAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAAAAL/xAAVAQEBAAAAAAAAAAAAAAAAAAABA//aAAwDAQACEAMQAAABkFf/xAAVEAEBAAAAAAAA"
    "AAAAAAAAAAAAEv/aAAgBAQABBQJb/8QAGBEAAgMAAAAAAAAAAAAAAAAAAQIAAxH/2gAIAQMBAT8BrUMTs//EABQRAQAAAAAAAAAAAAAAAAAAAAD/"
    "2gAIAQIBAT8Bf//EABQQAQAAAAAAAAAAAAAAAAAAABD/2gAIAQEABj8CP//EABkQAAMAAwAAAAAAAAAAAAAAAAARoUHR8P/aAAgBAQABPyHEUH5a"
    "P//aAAwDAQACAAMAAAAQg//EABYRAQEBAAAAAAAAAAAAAAAAAAEAMf/aAAgBAwEBPxA4GX//xAAWEQEBAQAAAAAAAAAAAAAAAAABADH/2gAIAQIB"
    "AT8QcL//xAAcEAEAAQQDAAAAAAAAAAAAAAABEQAxQZEhYcH/2gAIAQEAAT8QIxL8BBc9aIytdDqj/9k="))

# ---- what people type ------------------------------------------------------------------------------------------

for number, typed in enumerate(["0-47x2,60", "9-1", "-5--2", "1,5,9-12y3", "f.####.exr", "f.%04d.%%.exr", "1.5M", "64KiB",
                                "640x360", "0.000001G", "9223372036854775807", "%99d", "", "1-"]):
    save("arguments", f"{number:02}", typed)

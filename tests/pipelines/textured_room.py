#!/usr/bin/env python3
"""A textured room by both ways: textured_room.py BIN [SCENE.gltf to keep it]. BIN is the folder with the tools.

Made here: a closed room whose floor has colours and a normal map, a lamp with an emission texture, a block with a
metallic-roughness texture, a pane of alpha mode BLEND and one of MASK. The path tracer and the photon chain must agree in
the mean of every layer, within 1.5 % and two standard errors of the path tracer.

Caustic light is the density of photons in discs that are not small beside the cells of the panes: -1 % with 300k photons;
4 % is asked of it.
"""
import base64
import json
import math
import subprocess
import sys
import tempfile
import struct
import zlib
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / folder) for folder in ("stress", "bench")]
import pipeline
import exr


def data_uri(kind, data):
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def png(size, pixel):
    """size x size pixels RGBA, pixel(x, y) each."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + b"".join(bytes(pixel(x, y)) for x in range(size)) for y in range(size))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class Maker:
    def __init__(self):
        self.binary = b""
        self.gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [],
                     "textures": [], "images": [], "samplers": [{}], "accessors": [], "bufferViews": [], "cameras": []}

    def texture(self, size, pixel):
        self.gltf["images"].append({"uri": data_uri("image/png", png(size, pixel))})
        self.gltf["textures"].append({"source": len(self.gltf["images"]) - 1, "sampler": 0})
        return {"index": len(self.gltf["textures"]) - 1}

    def accessor(self, kind, code, component, rows):
        data = struct.pack(f"<{sum(map(len, rows))}{code}", *(x for row in rows for x in row))
        self.gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data + bytes(-len(data) % 4)
        self.gltf["accessors"].append({"bufferView": len(self.gltf["bufferViews"]) - 1, "componentType": component, "type": kind,
                                       "count": len(rows), "min": [min(c) for c in zip(*rows)], "max": [max(c) for c in zip(*rows)]})
        return len(self.gltf["accessors"]) - 1

    def quads(self, material, *quads):
        """Each (corner, edge, edge): edge x edge is its front; texture coordinates 0 to 1 along the edges."""
        places, coordinates, indices = [], [], []
        for corner, u, v in quads:
            first = len(places)
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                places.append([c + a * x + b * y for c, x, y in zip(corner, u, v)])
                coordinates.append((a, b))
            indices += [(first + i,) for i in (0, 1, 2, 0, 2, 3)]
        g = self.gltf
        g["materials"].append(material)
        attributes = {"POSITION": self.accessor("VEC3", "f", 5126, places), "TEXCOORD_0": self.accessor("VEC2", "f", 5126, coordinates)}
        g["meshes"].append({"primitives": [{"attributes": attributes, "indices": self.accessor("SCALAR", "H", 5123, indices),
                                            "material": len(g["materials"]) - 1}]})
        self.node(mesh=len(g["meshes"]) - 1)

    def node(self, **node):
        self.gltf["nodes"].append(node)
        self.gltf["scenes"][0]["nodes"].append(len(self.gltf["nodes"]) - 1)

    def save(self, path):
        self.gltf["buffers"] = [{"byteLength": len(self.binary), "uri": data_uri("application/octet-stream", self.binary)}]
        path.write_text(json.dumps(self.gltf))


def box(lower, upper, inwards):
    """Six quads."""
    (a, b, c), (d, e, f) = lower, upper
    x, y, z = (d - a, 0, 0), (0, e - b, 0), (0, 0, f - c)
    faces = [(lower, y, x), (lower, x, z), (lower, z, y), ((a, b, f), x, y), ((a, e, c), z, x), ((d, b, c), y, z)]
    return [(corner, v, u) if inwards else (corner, u, v) for corner, u, v in faces]


def make(path):
    m = Maker()

    def checker(one, other, cells=4):
        return m.texture(16, lambda x, y: one if (x * cells // 16 + y * cells // 16) % 2 else other)
    white = {"baseColorFactor": [0.7, 0.7, 0.7, 1], "metallicFactor": 0}
    floor, *walls = sorted(box((-1, 0, -1), (1, 2, 1), True), key=lambda q: q[0] != (-1, 0, -1) or q[1][1] or q[2][1])
    m.quads({"pbrMetallicRoughness": white, "doubleSided": True}, *walls)
    m.quads({"pbrMetallicRoughness": {"baseColorTexture": checker((240, 200, 60, 255), (40, 90, 200, 255)), "metallicFactor": 0},
             "normalTexture": m.texture(16, lambda x, y: (128 + round(60 * math.sin(x * math.pi / 4)),
                                                          128 + round(60 * math.cos(y * math.pi / 4)), 235, 255))}, floor)
    m.quads({"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}, "emissiveFactor": [1, 0.9, 0.8],
             "emissiveTexture": checker((255, 255, 255, 255), (120, 60, 30, 255), 2)}, ((-0.5, 1.99, -0.5), (1, 0, 0), (0, 0, 1)))
    m.quads({"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.7, 0.6, 1],
                                      "metallicRoughnessTexture": checker((0, 130, 220, 255), (0, 220, 0, 255), 2)}},
            *box((0.1, 0.001, -0.7), (0.7, 0.6, -0.2), False))
    m.quads({"pbrMetallicRoughness": {"baseColorTexture": checker((230, 60, 60, 200), (230, 230, 60, 60)), "metallicFactor": 0},
             "alphaMode": "BLEND", "doubleSided": True}, ((-0.9, 0.2, -0.3), (0.8, 0, 0.2), (0, 0.9, 0.2)))
    m.quads({"pbrMetallicRoughness": {"baseColorTexture": checker((60, 200, 60, 255), (60, 200, 60, 0)), "metallicFactor": 0},
             "alphaMode": "MASK", "doubleSided": True}, ((-0.8, 1.2, -0.8), (1.4, 0, 0), (0, 0.1, 1.2)))
    m.gltf["cameras"].append({"type": "perspective", "perspective": {"yfov": 1.2, "znear": 0.01}})
    m.node(camera=0, translation=[0, 1, 0.98])
    m.save(path)


def run(program, *arguments):
    subprocess.run([str(x) for x in (program, *arguments, "-q")], check=True, timeout=120)


def main():
    tools = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        scene = Path(sys.argv[2]) if len(sys.argv) > 2 else work / "room.gltf"
        make(scene)
        picture = ["--size", "64x48", "--channels", "RGBA,layers", "--compression", "none"]
        run(tools / "frame-render", scene, *picture, "--integrator", "path", "--spp", 256, "--halves", "-o", work / "path.exr")
        pipeline.chain(lambda tool, *words: run(tools / tool, *words), [scene], work / "chain",
                       ["--photons", "300k", "--kinds", "caustic,indirect"], (), ["--size", "64x48"], picture, map_beside=True)
        run(tools / "frame-render", scene, *picture, "--photons", work / "chain.photons", "--spp", 32, "-o", work / "density.exr")
        path, chain, density, a, b = (exr.read(work / f"{name}.exr") for name in ("path", "chain", "density", "path_a", "path_b"))
    everywhere, pane = range(64 * 48), [64 * y + x for y in range(23, 38) for x in range(5, 25)]
    good = not (path.not_finite() or chain.not_finite() or density.not_finite())
    for layer, asked in (("emission", 0.015), ("specular", 0.015), ("direct", 0.015), ("caustic", 0.04), ("indirect", 0.015)):
        good = agree(layer, chain, path, (a, b), layer, everywhere, asked) and good
    good = agree("indirect, BLEND pane", chain, path, (a, b), "indirect", pane, 0.015) and good
    good = agree("indirect, BLEND pane, density of photons", density, path, (a, b), "indirect", pane, 0.04) and good
    return 0 if good else 1


def agree(title, image, path, halves, layer, pixels, asked):
    """Whether an image has the path tracer's mean of a layer over some pixels."""
    def values(of):
        return [v for c in "RGB" for v in map(of.channels[f"{layer}.{c}"].__getitem__, pixels)]
    photons, paths = math.fsum(values(image)), math.fsum(values(path))
    # Halves of the samples differ by twice the error of the mean; the colours of a pixel vary together.
    error = math.sqrt(3 * math.fsum((x - y) ** 2 for x, y in zip(*map(values, halves))) / 4) / paths
    difference = photons / paths - 1
    good = abs(difference) <= asked + 2 * error
    print(f"{'ok' if good else 'FAILED'}: {title}: photons / paths - 1 = {100 * difference:+.2f} %, "
          f"standard error of the paths {100 * error:.2f} %")
    return good


if __name__ == "__main__":
    sys.exit(main())

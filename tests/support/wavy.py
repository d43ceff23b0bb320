#!/usr/bin/env python3
"""A closed hall of 16 x 8 x 6 m with wavy sides, a lamp under its ceiling and a wavy ball that moves: a million triangles.

    python3 tests/support/wavy.py hall.glb [triangles]
"""
import json
import math
import struct
import sys
from array import array
from pathlib import Path

SIZE = (16.0, 6.0, 8.0)                      # m; x along, y up, z across
SIDES = (("Floor", 0.6, 0.55, 0.45), ("Ceiling", 0.8, 0.8, 0.8), ("Left", 0.7, 0.3, 0.2), ("Right", 0.3, 0.6, 0.3),
         ("Front", 0.7, 0.7, 0.7), ("Back", 0.5, 0.55, 0.7))
LAST_S = 2.0                                 # the ball's last key


class Mesh:
    """Positions, normals and triangles as glTF's buffers want them."""

    def __init__(self):
        self.positions, self.normals, self.indices = array("f"), array("f"), array("I")

    def grid(self, across, up, point):
        """A grid of across x up cells; point(s, t) gives position and normal. Counter-clockwise from where s runs to the right
        and t upwards."""
        first = len(self.positions) // 3
        for j in range(up + 1):
            for i in range(across + 1):
                position, normal = point(i / across, j / up)
                self.positions.extend(position)
                self.normals.extend(normal)
        for j in range(up):
            for i in range(across):
                a = first + j * (across + 1) + i
                b = a + across + 1
                self.indices.extend((a, a + 1, b + 1, a, b + 1, b))


def unit(v):
    length = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return (v[0] / length, v[1] / length, v[2] / length)


def side(origin, along, upward, inward):
    """A rectangle from `origin` with waves 0.1 m high towards `inward` that end at its edges, so that the hall is closed."""
    width, height = math.hypot(*along), math.hypot(*upward)
    x_axis, y_axis = unit(along), unit(upward)
    kx, ky, high = 2 * math.pi * round(width / 0.8) / 2, 2 * math.pi * round(height / 0.8) / 2, 0.1

    def point(s, t):
        wave = high * math.sin(kx * s) * math.sin(ky * t)
        slope_x = high * kx * math.cos(kx * s) * math.sin(ky * t) / width
        slope_y = high * ky * math.sin(kx * s) * math.cos(ky * t) / height
        if s in (0, 1) or t in (0, 1):
            wave = 0.0
        position = [o + s * a + t * b + wave * n for o, a, b, n in zip(origin, along, upward, inward)]
        return position, unit([n - slope_x * a - slope_y * b for n, a, b in zip(inward, x_axis, y_axis)])
    return point


def ball(s, t):
    """A ball of 0.8 m with bumps: longitude s, latitude t. Its poles have triangles without area, which every reader must
    leave out, so rows of cells start a little away from them and the holes are 1 mm wide."""
    a, b = 2 * math.pi * s, math.pi * (t * 0.999 + 0.0005) - math.pi / 2
    radius = 0.8 + 0.04 * math.sin(12 * a) * math.cos(b) ** 2
    direction = (math.cos(b) * math.cos(a), math.sin(b), -math.cos(b) * math.sin(a))
    return [radius * x for x in direction], direction


def meshes(triangles):
    """(name, colour, mesh) of everything matte; three quarters of the triangles are the hall's."""
    x, y, z = SIZE
    corners = {"Floor": ((0, 0, z), (x, 0, 0), (0, 0, -z), (0, 1, 0)), "Ceiling": ((0, y, 0), (x, 0, 0), (0, 0, z), (0, -1, 0)),
               "Left": ((0, 0, z), (0, 0, -z), (0, y, 0), (1, 0, 0)), "Right": ((x, 0, 0), (0, 0, z), (0, y, 0), (-1, 0, 0)),
               "Front": ((x, 0, z), (-x, 0, 0), (0, y, 0), (0, 0, -1)), "Back": ((0, 0, 0), (x, 0, 0), (0, y, 0), (0, 0, 1))}
    cells = max(4, round(math.sqrt(triangles * 0.75 / 12)))
    for name, *colour in SIDES:
        mesh = Mesh()
        mesh.grid(cells, cells, side(*corners[name]))
        yield name, colour, mesh
    rows = max(4, round(math.sqrt((triangles - 12 * cells * cells) / 4)))
    mesh = Mesh()
    mesh.grid(2 * rows, rows, ball)
    yield "Ball", (0.7, 0.6, 0.2), mesh


def write_glb(path, gltf, binary):
    """The scene as a .glb file, with its one buffer."""
    gltf["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    header = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON")
    Path(path).write_bytes(header + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


class Room:
    """A .glb of matte meshes, a lamp, a camera and one node that moves."""

    def __init__(self):
        self.gltf = {
            "asset": {"version": "2.0"}, "scene": 0, "nodes": [], "meshes": [], "materials": [], "accessors": [],
            "bufferViews": [], "extensionsUsed": ["KHR_materials_specular", "KHR_materials_emissive_strength"],
        }
        self.binary, self.triangles = bytearray(), 0

    def accessor(self, data, kind, component, **more):
        gltf = self.gltf
        gltf["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data) * data.itemsize}
        )
        self.binary.extend(data.tobytes())
        count = len(data) // {"VEC3": 3, "SCALAR": 1}[kind]
        view = len(gltf["bufferViews"]) - 1
        gltf["accessors"].append(
            {"bufferView": view, "componentType": component, "type": kind, "count": count, **more}
        )
        return len(gltf["accessors"]) - 1

    def add(self, name, mesh, material, extensions):
        """Adds a node with this mesh, of a material without reflection. Returns the node's number."""
        gltf = self.gltf
        bounds = {f: [g(mesh.positions[i::3]) for i in range(3)] for f, g in (("min", min), ("max", max))}
        attributes = {
            "POSITION": self.accessor(mesh.positions, "VEC3", 5126, **bounds),
            "NORMAL": self.accessor(mesh.normals, "VEC3", 5126),
        }
        matte = {"KHR_materials_specular": {"specularFactor": 0}} | extensions
        gltf["materials"].append({"name": name, **material, "extensions": matte})
        primitive = {
            "attributes": attributes,
            "material": len(gltf["materials"]) - 1,
            "indices": self.accessor(mesh.indices, "SCALAR", 5125),
        }
        gltf["meshes"].append({"name": name, "primitives": [primitive]})
        gltf["nodes"].append({"name": name, "mesh": len(gltf["meshes"]) - 1})
        self.triangles += len(mesh.indices) // 3
        return len(gltf["nodes"]) - 1

    def add_matte(self, name, colour, mesh):
        return self.add(
            name, mesh, {"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0}}, {}
        )

    def add_lamp(self, mesh):
        black = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}
        strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 12}}
        return self.add("Lamp", mesh, {"emissiveFactor": [1, 0.95, 0.85], "pbrMetallicRoughness": black}, strength)

    def move(self, node, begin, end, last_s):
        """Moves a node from begin to end between the times 0 and last_s."""
        times, places = array("f", [0, last_s]), array("f", [*begin, *end])
        sampler = {
            "input": self.accessor(times, "SCALAR", 5126, min=[0], max=[last_s]),
            "output": self.accessor(places, "VEC3", 5126),
        }
        channel = {"sampler": 0, "target": {"node": node, "path": "translation"}}
        self.gltf["animations"] = [{"samplers": [sampler], "channels": [channel]}]

    def write(self, path, yfov, translation, rotation):
        """Adds the camera and writes the file."""
        gltf = self.gltf
        gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": yfov, "znear": 0.01}}]
        gltf["nodes"].append({"name": "Camera", "camera": 0, "translation": translation, "rotation": rotation})
        gltf["scenes"] = [{"nodes": list(range(len(gltf["nodes"])))}]
        write_glb(path, gltf, self.binary)


def make(path, triangles=10**6):
    """Writes the hall as .glb; the number of triangles it has."""
    room = Room()
    for name, colour, mesh in meshes(triangles):
        mover = room.add_matte(name, colour, mesh)
    begin, end = [4, 1.2, 3], [11, 1.2, 4]
    room.gltf["nodes"][mover]["translation"] = begin
    room.move(mover, begin, end, LAST_S)
    lamp = Mesh()
    lamp.grid(1, 1, lambda s, t: ([6 + 4 * s, 5.5, 3 + 2 * t], (0, -1, 0)))
    room.add_lamp(lamp)
    room.write(path, 0.9, [0.7, 3, 7], [-0.05, -0.46, -0.026, 0.886])
    return room.triangles


if __name__ == "__main__":
    print(make(sys.argv[1], *map(int, sys.argv[2:])))

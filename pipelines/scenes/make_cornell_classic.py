#!/usr/bin/env python3
"""Write the Cornell box from its published measurements: make_cornell_classic.py > cornell_classic.gltf

Corners, camera: "Cornell Box Data", Program of Computer Graphics, Cornell University, 1998
(graphics.cornell.edu/online/box/data.html), in millimetres; here metres. The camera stands at z = -0.8 and looks along
+z, so x grows to the left. Reflectances and lamp are measured there as spectra; here they are the linear RGB that
renderers commonly use for them: white .725 .71 .68, red .63 .065 .05, green .14 .45 .091, lamp 17 12 4 with
reflectance .78. The room is open at the front, outside is black. The lamp is flush with the ceiling, which has a hole for it.
"""
import base64
import json
import math
import struct
import sys

WHITE, RED, GREEN, LAMP = range(4)
MATERIALS = [("White", (.725, .71, .68)), ("Red", (.63, .065, .05)), ("Green", (.14, .45, .091)), ("Lamp", (.78, .78, .78))]
RADIANCE = (17, 12, 4)


def prism(base, height):
    """Quads of a block that stands on y = 0, over four (x, z)."""
    top = [(x, height, z) for x, z in base]
    sides = [[(p[0], 0, p[1]), (q[0], 0, q[1]), (q[0], height, q[1]), (p[0], height, p[1])]
             for p, q in zip(base, base[1:] + base[:1])]
    return [top] + sides


def around(x0, x1, z0, z1, y, room):
    """The ceiling `room` but for the lamp: four quads from its corners to the lamp's."""
    hole = [(x1, y, z0), (x1, y, z1), (x0, y, z1), (x0, y, z0)]
    return [[room[i], room[(i + 1) % 4], hole[(i + 1) % 4], hole[i]] for i in range(4)]


OBJECTS = [  # name, material, quads
    ("Floor", WHITE, [[(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]]),
    ("Ceiling", WHITE, around(213, 343, 227, 332, 548.8,
                              [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)])),
    ("BackWall", WHITE, [[(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]]),
    ("RightWall", GREEN, [[(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]]),
    ("LeftWall", RED, [[(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]]),
    ("Lamp", LAMP, [[(343, 548.8, 227), (343, 548.8, 332), (213, 548.8, 332), (213, 548.8, 227)]]),
    ("ShortBlock", WHITE, prism([(130, 65), (82, 225), (240, 272), (290, 114)], 165)),
    ("TallBlock", WHITE, prism([(423, 247), (265, 296), (314, 456), (472, 406)], 330)),
]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normal(quad):
    """Unit normal by the right hand along the corners; leaning walls are plane within 0.2 mm or less."""
    d = [[b - a for a, b in zip(quad[i], quad[i + 2])] for i in (0, 1)]
    n = cross(*d)
    length = math.hypot(*n)
    return tuple(x / length + 0.0 for x in n)


def facing(quad, name):
    """Corners in the order that turns the front to the lit side: out of blocks, into the room."""
    middle = [sum(p[c] for p in quad) / 4 for c in range(3)]
    blocks = {"ShortBlock": (185, 82, 169), "TallBlock": (368, 165, 351)}
    target = blocks.get(name, (278, 274, 280))
    inward = sum(n * (t - m) for n, t, m in zip(normal(quad), target, middle)) > 0
    return quad if inward != (name in blocks) else quad[::-1]


def main():
    data, views, accessors, meshes, nodes = b"", [], [], [], []

    def accessor(kind, rows, code, component, **extra):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": struct.calcsize(code) * sum(map(len, rows))})
        data += b"".join(struct.pack(f"<{len(row)}{code}", *row) for row in rows)
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(rows), "type": kind, **extra})
        return len(accessors) - 1

    for name, material, quads in OBJECTS:
        quads = [facing(quad, name) for quad in quads]
        places = [tuple(struct.unpack("<3f", struct.pack("<3f", *(x / 1000 for x in p)))) for quad in quads for p in quad]
        corners = [(4 * q + i,) for q in range(len(quads)) for i in (0, 1, 2, 0, 2, 3)]
        attributes = {
            "POSITION": accessor("VEC3", places, "f", 5126, min=[min(c) for c in zip(*places)], max=[max(c) for c in zip(*places)]),
            "NORMAL": accessor("VEC3", [normal(quad) for quad in quads for _ in quad], "f", 5126)}
        indices = accessor("SCALAR", corners, "I", 5125)
        nodes.append({"name": name, "mesh": len(meshes)})
        meshes.append({"name": name, "primitives": [{"attributes": attributes, "indices": indices, "material": material}]})

    matte = {"KHR_materials_specular": {"specularFactor": 0}}
    materials = [{"name": name, "doubleSided": True, "extensions": dict(matte),
                  "pbrMetallicRoughness": {"baseColorFactor": [*rgb, 1], "metallicFactor": 0}} for name, rgb in MATERIALS]
    brightest = max(RADIANCE)
    materials[LAMP].update(doubleSided=False, emissiveFactor=[x / brightest for x in RADIANCE])
    materials[LAMP]["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": brightest}
    # Film 25 mm x 25 mm behind 35 mm of focal length; half a turn about y, for a glTF camera looks along -z.
    camera = {"type": "perspective", "name": "Camera",
              "perspective": {"aspectRatio": 1, "yfov": 2 * math.atan(0.0125 / 0.035), "znear": 0.01, "zfar": 10}}
    nodes.append({"name": "Camera", "camera": 0, "translation": [0.278, 0.273, -0.8], "rotation": [0, 1, 0, 0]})
    gltf = {"asset": {"version": "2.0", "generator": "make_cornell_classic.py"},
            "extensionsUsed": ["KHR_materials_specular", "KHR_materials_emissive_strength"],
            "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "cameras": [camera],
            "materials": materials, "meshes": meshes, "accessors": accessors, "bufferViews": views,
            "buffers": [{"byteLength": len(data),
                         "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}
    json.dump(gltf, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Scenes that closed rooms of a few metres do not stand for: open grounds, a street, a thin wall, leaves, many lamps.

    python3 tests/support/open_scenes.py FOLDER [NAME...]    writes them as .glb, all or some; prints the options of each

hut-R: a hut of 4 m with a door and a window on a ground that reaches R metres to each side, R = 5, 50, 500, 5000. Two
cameras, `inside` and `outside`; with a sun (hut-R-sun.glb) or without (hut-R-sky.glb), under the sky of SKY.
street: thirty boxes in two rows.  partition: a room seen from above, parted by a board of 12 mm with the lamp on its left.
leaves: 3600 leaves in a lit room.  lamps: 200 lamps of all shapes under a ceiling.

Metres, y up; the same bytes at each run.
"""
import argparse
import array
import math
import random
import struct
import sys
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
from scenes import Scene, box_mesh, grid_mesh, leaves_mesh, sphere_mesh

SKY = ("--environment", "0.5,0.7,1")     # W/m^2/sr: gives an open horizontal surface about 2.3 W/m^2
SUN = (20, 19, 17)                             # W/m^2 across its direction: nine times the sky's
SUNLIGHT = (-0.45, -0.6, -0.66)                # direction of travel: through the hut's door and its window
GROUNDS = (5, 50, 500, 5000)                   # m from the middle to each side
PARTITION = 0.012                              # m


def boxes(scene, material, corners):
    """One object of several boxes, each (lower, upper)."""
    positions, triangles = array.array("f"), array.array("I")
    for lower, upper in corners:
        first = len(positions) // 3
        more, order = box_mesh(lower, upper)
        positions.extend(more)
        triangles.extend(first + i for i in order)
    scene.mesh(positions, triangles, material)


def ground(scene, reach, reflectance=(0.30, 0.28, 0.22)):
    scene.quad((-reach, 0, reach), (reach, 0, reach), (reach, 0, -reach), (-reach, 0, -reach), scene.material(reflectance))


def hut(reach, sun):
    """Walls of 0.2 m around 4 x 4 m, 2.6 m high; door of 1 x 2.1 m in the wall at +z, window of 1.4 x 1 m in that at +x."""
    scene = Scene()
    ground(scene, reach)
    h, a, b = 2.6, 2.0, 2.2                    # height; half of the width inside and outside
    boxes(scene, scene.material((0.75, 0.72, 0.68)), [
        ((-b, 0, -b), (b, h, -a)), ((-b, 0, -a), (-a, h, a)),
        ((-b, 0, a), (-0.5, h, b)), ((0.5, 0, a), (b, h, b)), ((-0.5, 2.1, a), (0.5, h, b)),
        ((a, 0, -a), (b, h, -0.7)), ((a, 0, 0.7), (b, h, a)), ((a, 0, -0.7), (b, 1, 0.7)), ((a, 2, -0.7), (b, h, 0.7))])
    boxes(scene, scene.material((0.45, 0.2, 0.15)), [((-b - 0.3, h, -b - 0.3), (b + 0.3, h + 0.15, b + 0.3))])
    boxes(scene, scene.material((0.3, 0.4, 0.65)), [((-1.2, 0.01, -0.9), (-0.2, 0.75, -0.3))])      # a table
    scene.camera((-1.6, 1.5, -1.7), (0.7, 0.9, 0.9), fov=1.1, name="inside")
    scene.camera((6.5, 2.2, 8.5), (0, 1.2, 0), fov=0.66, name="outside")
    if sun:
        scene.sun(SUNLIGHT, SUN)
    return scene


def street(sun):
    """Two rows of fifteen houses along a street of 10 m, on a ground of +-300 m."""
    scene, rng = Scene(), random.Random(30)
    ground(scene, 300, (0.25, 0.25, 0.25))
    for side in (-1, 1):
        for i in range(15):
            colour = [rng.uniform(0.25, 0.7) for _ in range(3)]
            x, width, z, height = side * 5, side * rng.uniform(7, 10), 20 - 10 * i, rng.uniform(6, 20)
            boxes(scene, scene.material(colour), [((min(x, x + width), 0, z - 9), (max(x, x + width), height, z))])
    scene.camera((1.5, 1.7, 22), (0, 4, -20), fov=0.9)
    if sun:
        scene.sun((-0.5, -0.8, -0.35), SUN)
    return scene


def partition():
    """A closed room of 5.4 x 3.2 x 2.5 m, a board of 12 mm and 2.2 m across its middle, a lamp in the left half. The camera looks
    straight down from below the ceiling without perspective, so that the board stands between two columns of pixels."""
    scene = Scene()
    scene.room((-2.7, 0, -1.6), (2.7, 2.5, 1.6), scene.material(0.7))
    boxes(scene, scene.material((0.7, 0.6, 0.5)), [((0, 0, -1.6), (PARTITION, 2.2, 1.6))])
    lamp = scene.material(0.0, 15, one_sided=True)
    scene.quad((-1.7, 2.49, -0.3), (-1.1, 2.49, -0.3), (-1.1, 2.49, 0.3), (-1.7, 2.49, 0.3), lamp)
    scene.camera((0, 2.45, 0), (0, 0, 0), half_height=1.5)
    return scene


def leaves(count=3600):
    """Twelve bushes of 300 leaves each, 5 x 3 cm, in a room of 4 x 3 x 2.6 m."""
    scene, rng = Scene(), random.Random(3600)
    scene.room((-2, 0, -1.5), (2, 2.6, 1.5), scene.material(0.7))
    bushes = [(-1.5 + i % 4, 0.5 + 0.1 * (i % 3), -0.8 + 0.8 * (i // 4)) for i in range(12)]
    scene.mesh(*leaves_mesh(rng, count, bushes, 0.4, 0.025, 0.015), scene.material((0.2, 0.5, 0.12)))
    lamp = scene.material(0.0, 18, one_sided=True)
    scene.quad((-0.5, 2.59, -0.3), (0.5, 2.59, -0.3), (0.5, 2.59, 0.3), (-0.5, 2.59, 0.3), lamp)
    scene.camera((-1.8, 1.6, 1.35), (0.4, 0.5, -0.4), fov=1.0)
    return scene


# ---- lamps of all shapes

def png(size, pixel):
    """An image of size x size pixels, RGB, 8 bits; pixel(x, y): three values."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + b"".join(bytes(pixel(x, y)) for x in range(size)) for y in range(size))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def textured(scene, material, image):
    """Gives a material an emission texture, stored in the buffer."""
    view = scene._append("bufferViews", {"buffer": 0, "byteOffset": len(scene.data), "byteLength": len(image)})
    scene.data += image + bytes(-len(image) % 4)
    source = scene._append("images", {"bufferView": view, "mimeType": "image/png"})
    texture = scene._append("textures", {"source": source})
    scene.document["materials"][material]["emissiveTexture"] = {"index": texture}


def textured_quad(scene, corner, u, v, material):
    """A parallelogram with texture coordinates 0 to 1 along its edges; front u x v."""
    positions, triangles = grid_mesh(corner, u, v, 1, 1)
    node = scene.mesh(positions, triangles, material)
    mesh = scene.document["meshes"][scene.document["nodes"][node]["mesh"]]
    view = scene._append("bufferViews", {"buffer": 0, "byteOffset": len(scene.data), "byteLength": 32})
    scene.data += struct.pack("<8f", 0, 0, 0, 1, 1, 0, 1, 1)
    mesh["primitives"][0]["attributes"]["TEXCOORD_0"] = scene._append("accessors", {
        "bufferView": view, "componentType": 5126, "count": 4, "type": "VEC2"})


def disc(scene, centre, radius, material, sides=32):
    """Facing down; as a fan of triangles, as exporters write it."""
    positions = [*centre]
    for i in range(sides):
        a = 2 * math.pi * i / sides
        positions += [centre[0] + radius * math.cos(a), centre[1], centre[2] + radius * math.sin(a)]
    scene.mesh(positions, [k for i in range(sides) for k in (0, 1 + i, 1 + (i + 1) % sides)], material)


def stripes(x, y):
    """Most of the light in three of eight stripes."""
    return (255, 220, 160) if x // 8 in (1, 4, 6) else (10, 8, 5)


def lamps():
    """A hall of 12 x 8 x 3 m under 20 x 10 lamps, of seven shapes in turn: a quad, a disc, a tessellated panel, a panel with a texture, a
    ball, a point, a spot."""
    scene, rng = Scene(), random.Random(200)
    scene.room((-6, 0, -4), (6, 3, 4), scene.material(0.6))
    boxes(scene, scene.material((0.6, 0.35, 0.2)), [((-4 + 2.6 * i, 0, -1.2 + 0.9 * (i % 3)), (-3 + 2.6 * i, 0.9, -0.2 + 0.9 * (i % 3)))
                                                    for i in range(4)])
    image = png(64, stripes)
    for i in range(200):
        x, z, y = -5.7 + 0.6 * (i % 20), -3.6 + 0.8 * (i // 20), 2.95 - 0.3 * rng.random()
        warmth, strength, r = rng.random(), 20 * 4 ** rng.uniform(-1, 1), 0.06 + 0.04 * rng.random()
        colour = [strength, strength * (0.75 + 0.2 * warmth), strength * (0.45 + 0.5 * warmth)]
        shape = i % 7
        if shape < 5:
            material = scene.material(0.0, colour, one_sided=True)
        if shape == 0:
            scene.quad((x - r, y, z - r), (x + r, y, z - r), (x + r, y, z + r), (x - r, y, z + r), material)
        elif shape == 1:
            disc(scene, (x, y, z), r, material)
        elif shape == 2:
            scene.mesh(*grid_mesh((x - r, y, z - r), (2 * r, 0, 0), (0, 0, 2 * r), 8, 8), material)
        elif shape == 3:
            textured(scene, material, image)
            textured_quad(scene, (x - r, y, z - r), (2 * r, 0, 0), (0, 0, 2 * r), material)
        elif shape == 4:
            positions, triangles, normals = sphere_mesh((x, y, z), (r, r, r), 4, inwards=False)
            scene.mesh(positions, triangles, material, normals)
        else:                                  # candela: the flux of a quad of that radiance, pi L (2 r)^2, into all directions
            intensity = [c * r * r for c in colour]
            if shape == 5:
                scene.point_light((x, y, z), intensity)
            else:
                scene.spot_light((x, y, z), (x, 0, z), [4 * c for c in intensity], 0.3, 0.8)
    scene.camera((-5.6, 1.7, 3.6), (1, 0.9, -1), fov=1.1)
    return scene


# ---- all of them

def plan():
    """{name: (file, camera, options of all tools, maker)}"""
    found = {}
    for reach in GROUNDS:
        for view in ("inside", "outside"):
            for light, sun, sky in (("sun", True, ()), ("sky", False, SKY), ("both", True, SKY)):
                found[f"hut-{reach}-{view}-{light}"] = (f"hut-{reach}-{'sun' if sun else 'sky'}.glb", view, sky,
                                                        lambda reach=reach, sun=sun: hut(reach, sun))
    found["street-both"] = ("street-sun.glb", "auto", SKY, lambda: street(True))
    found["street-sky"] = ("street-sky.glb", "auto", SKY, lambda: street(False))
    found |= {name: (f"{name}.glb", "auto", (), make) for name, make in
              (("partition", partition), ("leaves", leaves), ("lamps", lamps))}
    return found


def make(folder, wanted=lambda name: True):
    """Writes the files of the wanted scenes; {name: (path, camera, options)}."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    done, result = set(), {}
    for name, (file, camera, options, maker) in plan().items():
        if not wanted(name):
            continue
        if file not in done:
            maker().save(folder / file)
            done.add(file)
        result[name] = (folder / file, camera, options)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", help="these scenes alone [all]")
    args = parser.parse_args()
    for name, (file, camera, options) in make(args.folder, lambda name: not args.names or name in args.names).items():
        print(name, file, "--camera", camera, *options)


if __name__ == "__main__":
    main()

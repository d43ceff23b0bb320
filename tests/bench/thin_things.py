#!/usr/bin/env python3
"""Paper, cloth and leaves that light passes through: is the light of the chain that of the path tracer?

    python3 tests/bench/thin_things.py BIN OUT [--runs 3] [--spp 512] [--scene shade]

shade: a lamp inside a paper shade, an open tube, is the only light of a closed room. pure: the same with a shade that
reflects nothing, as Blender's Translucent alone. curtain: a cloth with a coat covers
most of a window of a room under a sky and a sun. leaves: forty leaves with a texture of veins stand in the sun in a room
with an open wall; a mirror shows them. The means of the runs of both ways are compared for each object and layer, as
layered_materials.py does; the exit status is 1 if one differs by more than 1 % of the object's light and 3 standard errors.
"""
import argparse
import base64
import math
import random
import sys
from pathlib import Path

from layered_materials import differences, png, render, walls  # adds tests/support to the path
from open_scenes import Scene, textured_quad

THIN = "KHR_materials_diffuse_transmission"


def thin(scene, colour, through, share, texture=None, **more):
    """A material that reflects and transmits: `share` of the light that is not absorbed passes."""
    extension = {"diffuseTransmissionFactor": share, "diffuseTransmissionColorFactor": list(through)}
    if texture is not None:
        extension["diffuseTransmissionTexture"] = extension["diffuseTransmissionColorTexture"] = {"index": texture}
    scene.extensions |= {THIN, *more}
    return scene._append("materials", {
        "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": 0.6},
        "doubleSided": True, "extensions": {THIN: extension, **more}})


def tube(scene, centre, radius, height, material, sides=24):
    positions, triangles = [], []
    for i in range(sides + 1):
        a = 2 * math.pi * i / sides
        for y in (0, height):
            positions += [centre[0] + radius * math.cos(a), centre[1] + y, centre[2] - radius * math.sin(a)]
    for i in range(sides):
        a = 2 * i
        triangles += (a, a + 2, a + 1, a + 1, a + 2, a + 3)
    scene.mesh(positions, triangles, material, name="shade")


def room(scene, open_side=None):
    grey, red = scene.material(0.6, one_sided=True), scene.material((0.65, 0.3, 0.25), one_sided=True)
    walls(scene, 2, 2.4, 1.5, grey, open_side, left=red)


def pure():
    return shade(1, KHR_materials_specular={"specularFactor": 0})


def shade(share=0.5, **more):
    scene = Scene()
    room(scene)
    tube(scene, (0.2, 1.2, -0.5), 0.22, 0.4, thin(scene, (0.8, 0.75, 0.6), (0.9, 0.8, 0.6), share, **more))
    lamp = scene.material(0, 60, one_sided=True)
    x, y, z = 0.2, 1.35, -0.5
    scene.quad((x - 0.05, y, z - 0.05), (x + 0.05, y, z - 0.05), (x + 0.05, y, z + 0.05), (x - 0.05, y, z + 0.05), lamp)
    scene.camera((0, 1.1, 1.4), (0.1, 1.1, 0), fov=0.95)
    return scene, ()


def curtain():
    scene = Scene()
    room(scene, "right")
    cloth = thin(scene, (0.7, 0.7, 0.75), (0.5, 0.6, 0.8), 0.6, KHR_materials_clearcoat={"clearcoatFactor": 0.7})
    scene.quad((1.98, 0.1, 1.4), (1.98, 0.1, -1.2), (1.98, 2.3, -1.2), (1.98, 2.3, 1.4), cloth, name="curtain")
    scene.sun((-0.8, -0.5, -0.2), (6, 5.5, 5))
    scene.camera((-1.7, 1.3, 1.3), (0.6, 1.0, -0.3), fov=0.95)
    return scene, ("--environment", "0.5,0.7,1")


def leaves():
    scene, rng = Scene(), random.Random(7)
    room(scene, "right")
    image = png(32, lambda x, y: [90, 200, 60] if (x + y) % 8 else [200, 230, 150])
    scene._append("images", {"uri": "data:image/png;base64," + base64.b64encode(image).decode()})
    scene._append("textures", {"source": 0})
    leaf = thin(scene, (0.25, 0.5, 0.12), (0.7, 1, 0.5), 0.45, texture=0)
    for _ in range(40):
        at = [rng.uniform(-0.5, 0.9), rng.uniform(0.3, 1.7), rng.uniform(-0.8, 0.2)]
        u, v = ([rng.uniform(-0.25, 0.25) for _ in range(3)] for _ in range(2))
        textured_quad(scene, at, u, v, leaf)
    mirror = scene._append("materials", {"pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0}})
    scene.quad((-1.6, 0.4, -1.48), (-0.6, 0.4, -1.48), (-0.6, 1.6, -1.48), (-1.6, 1.6, -1.48), mirror, name="mirror")
    scene.sun((-0.8, -0.4, -0.3), (6, 5.5, 5))
    scene.camera((-1.5, 1.3, 1.3), (0.3, 1.0, -0.4), fov=0.95)
    return scene, ("--environment", "0.5,0.7,1")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--scene", choices=("shade", "pure", "curtain", "leaves"), action="append")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    beyond = count = 0
    for make in (shade, pure, curtain, leaves):
        if options.scene and make.__name__ not in options.scene:
            continue
        path = options.out / f"{make.__name__}.gltf"
        scene, words = make()
        scene.save(path)
        pairs = [render(options.bin, path, options.out, seed + 1, options.spp, words) for seed in range(options.runs)]
        found, compared = differences(make.__name__, pairs)
        beyond, count = beyond + found, count + compared
    print(f"{beyond} of {count} means differ by more than 1 % of the object's light and 3 errors")
    return beyond > 0


if __name__ == "__main__":
    sys.exit(main())

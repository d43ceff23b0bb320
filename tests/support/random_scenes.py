#!/usr/bin/env python3
"""Scenes at random, to find what nobody thought of: random_scenes.py FOLDER FIRST LAST writes them as .glb.

scene N is the same at each run. A room of matte walls, closed, with a window, or a ground under the sky;
three to ten things in it; one to five lamps of all kinds. One scene in five is extreme in each of these
ways, independently: its size is 1e-3 to 1e3 m instead of some metres; lamps differ by up to 1e6 in power;
some things are there twice at the same place, with the same material; meshes have triangles without area;
keys are 1e-4 or 1e4 s apart; the camera stands in a wall, in a corner or in a thing.
"""

import argparse
import array
import math
import random
from pathlib import Path
import sys

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
from scenes import Scene, add, box_mesh, grid_mesh, normalize, sphere_mesh  # noqa: E402

EXTREME = 0.2  # share of scenes that are extreme in one way


class Maker:
    def __init__(self, number):
        self.rng, self.scene = random.Random(number), Scene()
        rng = self.rng
        self.extremes = {
            name for name in ("size", "power", "twice", "flat", "time", "camera") if rng.random() < EXTREME
        }
        self.kind = rng.choice(("closed", "closed", "window", "open"))
        self.scale = 10 ** rng.uniform(-3, 3) if "size" in self.extremes else 1.0
        half_x, half_z, height = (self.scale * rng.uniform(*limits) for limits in ((1, 4), (1, 4), (2, 3.5)))
        self.lower, self.upper = [-half_x, 0, -half_z], [half_x, height, half_z]

    def place(self, low=0.1, high=0.9):
        """A place inside the room, in world space."""
        return [a + self.rng.uniform(low, high) * (b - a) for a, b in zip(self.lower, self.upper)]

    def colour(self, least, most):
        grey = self.rng.uniform(least, most)
        return [min(most, max(least, grey * self.rng.uniform(0.6, 1.4))) for _ in range(3)]

    def material(self):
        rng, scene = self.rng, self.scene
        kind = rng.choice(
            (
                "matte",
                "matte",
                "plastic",
                "plastic",
                "metal",
                "mirror",
                "glass",
                "rough glass",
                "coat",
                "sheen",
                "thin",
                "leaf",
            )
        )
        if kind == "matte":
            return scene.material(self.colour(0.05, 0.85))
        if kind in ("metal", "mirror"):
            return scene.material(
                self.colour(0.4, 0.95),
                metallic=1.0,
                roughness=0 if kind == "mirror" else rng.uniform(0.05, 1),
                specular=1.0,
            )
        if kind in ("glass", "rough glass"):
            return scene.glass(
                0 if kind == "glass" else rng.uniform(0.05, 0.6), rng.choice((1.1, 1.33, 1.5, 1.8))
            )
        index = scene.material(self.colour(0.05, 0.85), specular=1.0, roughness=rng.uniform(0.05, 1))
        added = {
            "coat": {
                "KHR_materials_clearcoat": {
                    "clearcoatFactor": rng.uniform(0.2, 1),
                    "clearcoatRoughnessFactor": rng.uniform(0, 0.5),
                }
            },
            "sheen": {
                "KHR_materials_sheen": {
                    "sheenColorFactor": self.colour(0.1, 0.9),
                    "sheenRoughnessFactor": rng.uniform(0.1, 1),
                }
            },
            "thin": {"KHR_materials_transmission": {"transmissionFactor": rng.uniform(0.2, 1)}},
            "leaf": {
                "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": rng.uniform(0.2, 0.9)}
            },
        }.get(kind, {})
        scene.document["materials"][index]["extensions"] |= added
        scene.extensions |= set(added)
        return index

    def thing(self):
        """A box, a ball or a plate; returns its node."""
        rng, scene = self.rng, self.scene
        size = [self.scale * 10 ** rng.uniform(-1.3, -0.2) for _ in range(3)]
        material, at = self.material(), self.place()
        shape = rng.choice(("box", "ball", "plate"))
        if shape == "box":
            mesh = box_mesh([-s for s in size], size)
        elif shape == "ball":
            mesh = sphere_mesh((0, 0, 0), size, rng.choice((2, 6, 12)), inwards=False)
        else:
            u, v = normalize([rng.gauss(0, 1) for _ in range(3)]), normalize(
                [rng.gauss(0, 1) for _ in range(3)]
            )
            mesh = grid_mesh((0, 0, 0), [x * size[0] * 2 for x in u], [x * size[1] * 2 for x in v], 2, 2)
        positions, triangles, *normals = mesh
        if "flat" in self.extremes:
            triangles = array.array(
                "I", [*triangles, *(k for i in range(0, len(triangles), 6) for k in (triangles[i],) * 3)]
            )
        angle = rng.uniform(0, math.pi)
        words = {"translation": at, "rotation": [0, math.sin(angle / 2), 0, math.cos(angle / 2)]}
        nodes = [scene.mesh(positions, triangles, material, normals[0] if normals else None, **words)]
        if "twice" in self.extremes and rng.random() < 0.5:
            nodes.append(scene.mesh(positions, triangles, material, normals[0] if normals else None, **words))
        return nodes, at

    def lamp(self, power):
        """One light of `power` watts about."""
        rng, scene, at = self.rng, self.scene, self.place(0.2, 0.95)
        kind = rng.choice(("point", "spot", "panel", "panel", "bulb", "spark"))
        if kind == "point":
            return scene.point_light(at, power / (4 * math.pi))
        if kind == "spot":
            outer = rng.uniform(0.1, 1.2)
            return scene.spot_light(
                at,
                self.place(),
                power / (2 * math.pi * (1 - math.cos(outer))),
                outer * rng.uniform(0, 0.9),
                outer,
            )
        side = self.scale * (
            rng.uniform(0.2, 0.8) if kind == "panel" else rng.uniform(0.03, 0.08) if kind == "bulb" else 0.005
        )
        if kind == "panel":
            mesh = grid_mesh(at, (side, 0, 0), (0, 0, side), 1, 1)
            area = 2 * side * side
        else:
            mesh = sphere_mesh(at, (side, side, side), 3, inwards=False)
            area = 4 * math.pi * side * side
        return scene.mesh(mesh[0], mesh[1], scene.material(0.0, power / (math.pi * area)))

    def walls(self):
        scene = self.scene
        if self.kind == "open":
            reach = self.scale * 10 ** self.rng.uniform(0.7, 3)
            scene.quad(
                (-reach, 0, reach),
                (reach, 0, reach),
                (reach, 0, -reach),
                (-reach, 0, -reach),
                scene.material(self.colour(0.1, 0.6)),
            )
            return
        (x0, y0, z0), (x1, y1, z1) = self.lower, self.upper
        faces = [
            ((x0, y0, z1), (x1, y0, z1), (x1, y0, z0), (x0, y0, z0)),
            ((x0, y1, z0), (x1, y1, z0), (x1, y1, z1), (x0, y1, z1)),
            ((x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)),
            ((x1, y0, z1), (x0, y0, z1), (x0, y1, z1), (x1, y1, z1)),
            ((x1, y0, z0), (x1, y0, z1), (x1, y1, z1), (x1, y1, z0)),
        ]
        for face in faces:
            scene.quad(*face, scene.material(self.colour(0.2, 0.85)))
        side, wall = [(x0, z1), (x0, z0)], scene.material(
            self.colour(0.2, 0.85)
        )  # the wall at x0, with a window or without

        def part(s0, s1, t0, t1):
            z, y = lambda s: side[0][1] + s * (side[1][1] - side[0][1]), lambda t: y0 + t * (y1 - y0)
            scene.quad((x0, y(t0), z(s0)), (x0, y(t0), z(s1)), (x0, y(t1), z(s1)), (x0, y(t1), z(s0)), wall)

        if self.kind == "closed":
            part(0, 1, 0, 1)
            return
        w, h = self.rng.uniform(0.1, 0.6), self.rng.uniform(0.2, 0.6)
        s, t = self.rng.uniform(0.05, 0.95 - w), self.rng.uniform(0.1, 0.95 - h)
        part(0, s, 0, 1)
        part(s + w, 1, 0, 1)
        part(s, s + w, 0, t)
        part(s, s + w, t + h, 1)

    def made(self):
        """(scene, options of all tools, what is extreme)"""
        rng, scene = self.rng, self.scene
        self.walls()
        count = rng.randint(3, 10)
        things = [self.thing() for _ in range(count)]
        step = rng.choice((1e-4, 1e4)) if "time" in self.extremes else 1 / 6
        for nodes, at in things[: rng.randint(0, 2)]:
            to = self.place()
            for node in nodes:
                scene.animate(node, "translation", [0, step], [at, to])
        options = []
        lamps = rng.randint(0 if self.kind != "closed" else 1, 5)
        watts = 100 * self.scale**2
        for _ in range(lamps):
            self.lamp(watts * (10 ** rng.uniform(-3, 3) if "power" in self.extremes else rng.uniform(0.3, 3)))
        if self.kind != "closed":
            options += ["--environment", ",".join(f"{v:.3f}" for v in self.colour(0.3, 2))]
            if rng.random() < 0.6:
                scene.sun(
                    (rng.uniform(0.2, 1), -rng.uniform(0.3, 1), rng.uniform(-0.6, 0.6)), rng.uniform(3, 30)
                )
        eye, target = self.place(0.05, 0.95), self.place(0.3, 0.7)
        if "camera" in self.extremes:
            where = rng.choice(("wall", "corner", "thing"))
            eye = {
                "wall": [eye[0], eye[1], self.upper[2]],
                "corner": add(self.lower, [1e-3 * self.scale] * 3),
                "thing": list(things[-1][1]),
            }[where]
        scene.camera(eye, target, fov=rng.uniform(0.6, 1.5))
        return scene, options, sorted(self.extremes)


def make(folder, number):
    """(file, kind, options of all tools, what is extreme) of scene `number`."""
    maker = Maker(number)
    scene, options, extremes = maker.made()
    file = Path(folder) / f"random-{number:03d}.glb"
    file.parent.mkdir(parents=True, exist_ok=True)
    scene.save(file)
    return file, maker.kind, options, extremes


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    args = parser.parse_args()
    for n in range(args.first, args.last + 1):
        print(*make(args.folder, n))

"""Lamps with an extent as emitting meshes of the radiance that Cycles gives them; others as lamps of glTF."""
import math
import os
import tempfile

import bpy
import numpy

from .colour import rec709

BALL_STEPS = (
    3  # of an icosphere: 642 corners; its mean outline is .6 % less than the ball's, which its radiance makes up for
)


class LampState:
    """A lamp at a frame. power: three numbers, W, with exposure, temperature and normalize at work."""

    def __init__(self, lamp, place):
        self.kind, self.lamp = lamp.type, lamp.original if hasattr(lamp, "original") else lamp
        scale = numpy.linalg.norm(place[:3, :3], axis=0)
        colour = numpy.array(lamp.color, "f8")
        if getattr(lamp, "use_temperature", False):
            colour = colour * numpy.array(lamp.temperature_color)
        strength = lamp.energy * 2 ** getattr(lamp, "exposure", 0)
        self.radius = getattr(lamp, "shadow_soft_size", 0)
        self.angle = getattr(lamp, "angle", 0)
        self.spread = getattr(lamp, "spread", math.pi)
        self.outline, self.area = None, 1.0
        if self.kind == "AREA":
            self.outline = outline(lamp)
            self.area = area_of(self.outline) * scale[0] * scale[1]
        if not getattr(lamp, "normalize", True):
            strength *= self.surface()
        self.power = numpy.array(rec709(colour)) * strength
        self.cone = getattr(lamp, "spot_size", 0) / 2
        self.blend = getattr(lamp, "spot_blend", 0)

    def surface(self):
        """What Cycles divides by unless Normalize is off."""
        if self.kind == "AREA":
            return self.area
        if self.kind == "SUN":
            return math.pi * math.tan(self.angle / 2) ** 2 if self.angle > 0 else 1.0
        return 4 * math.pi * self.radius ** 2 if self.radius > 0 else 4.0

    def emits(self):
        """Is it a mesh in the file?"""
        return self.kind == "AREA" and self.area > 0 or self.kind == "POINT" and self.radius > 0

    def radiance(self):
        if self.kind == "AREA":
            return self.power * area_gain() / self.area
        return self.power / (4 * math.pi ** 2 * self.radius ** 2) * self.radiance_gain()

    @staticmethod
    def radiance_gain():
        """What makes up for the mesh's outline, which is smaller than the ball's."""
        return ball(1)[2]

    def mesh(self):
        """Points and triangles in the lamp's own axes, where it shines along -z."""
        if self.kind == "POINT":
            return ball(self.radius)[:2]
        n = len(self.outline)
        return numpy.array(self.outline, "f4"), numpy.array([(0, k, k + 1) for k in range(1, n - 1)], "i4")

    def gltf(self):
        """KHR_lights_punctual. The inner cone keeps the flux: Cycles' edge is a smooth step of the cosine, glTF's a square."""
        per = 1 if self.kind == "SUN" else 4 * math.pi
        top = max(float(self.power.max()), 0.0)
        light = {"type": {"SUN": "directional", "SPOT": "spot"}.get(self.kind, "point"), "intensity": top / per,
                 "color": [float(c) / top for c in self.power] if top > 0 else [1.0, 1.0, 1.0]}
        if self.kind == "SPOT":
            outer = min(self.cone, math.pi / 2)
            inner = math.acos(min(1.0, math.cos(outer) + .75 * self.blend * (1 - math.cos(outer))))
            light["spot"] = {"outerConeAngle": outer, "innerConeAngle": min(inner, .9999 * outer)}
        return light

    def extras(self):
        if self.kind == "SUN":
            return {"angle_rad": self.angle}
        return {"radius_m": self.radius} if self.radius > 0 else {}


def area_gain():
    """Radiance of an area lamp of 1 W and 1 m^2: 1/4 in older versions of Cycles, 1/pi in newer ones. It is measured: a floor far below such a
    lamp is rendered."""
    if not MEASURED:
        MEASURED.append(measured_gain())
    return MEASURED[0]


MEASURED = []            # once in a run
HEIGHT, ALBEDO = 10.0, .8


def measured_gain():
    stage = bpy.data.scenes.new("tempolux lamp")
    made = []
    try:
        stage.render.engine = "CYCLES"
        stage.cycles.samples, stage.cycles.use_denoising, stage.cycles.device, stage.cycles.max_bounces = (
            16,
            False,
            "CPU",
            0,
        )
        stage.render.resolution_x = stage.render.resolution_y = 16
        stage.render.resolution_percentage = 100
        settings = stage.render.image_settings
        settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
        lamp = bpy.data.lights.new("tempolux lamp", "AREA")
        lamp.energy, lamp.shape, lamp.size = 1000, "SQUARE", 1
        mesh = bpy.data.meshes.new("tempolux lamp")
        mesh.from_pydata(
            [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)]
        )  # without a material: matte of .8
        lens = bpy.data.cameras.new("tempolux lamp")
        lens.type, lens.ortho_scale = "ORTHO", .5
        for data, height in ((lamp, HEIGHT), (mesh, 0), (lens, 1)):
            made.append(bpy.data.objects.new("tempolux lamp", data))
            made[-1].location.z = height
            stage.collection.objects.link(made[-1])
        stage.camera = made[-1]
        with tempfile.TemporaryDirectory() as folder:
            stage.render.filepath = os.path.join(folder, "lamp.exr")
            bpy.ops.render.render(write_still=True, scene=stage.name)
            image = bpy.data.images.load(stage.render.filepath)
            pixels = numpy.empty(16 * 16 * 4, "f4")
            image.pixels.foreach_get(pixels)
            bpy.data.images.remove(image)
        seen = float(pixels.reshape(-1, 4)[:, 0].mean())
        gain = seen * math.pi * HEIGHT ** 2 / (ALBEDO * 1000)
        return min((1 / 4, 1 / math.pi), key=lambda known: abs(known - gain)) if .2 < gain < .4 else gain or 1 / math.pi
    finally:
        for thing in made:
            bpy.data.objects.remove(thing)
        bpy.data.scenes.remove(stage)


def lamp_state(lamp, place):
    return LampState(lamp, place)


def outline(lamp):
    """Corners of an area lamp in its own plane, counter-clockwise seen from where it shines to, along -z."""
    across = lamp.size
    down = lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size
    if lamp.shape in ("SQUARE", "RECTANGLE"):
        ring = [(-1, -1), (-1, 1), (1, 1), (1, -1)]
    else:
        ring = [(math.cos(a), -math.sin(a)) for a in (2 * math.pi * k / 64 for k in range(64))]
    return [(x * across / 2, y * down / 2, 0) for x, y in ring]


def area_of(corners):
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, corners[1:] + corners[:1]))) / 2


def ball(radius):
    """Points and triangles of an icosphere, and the ball's outline by its own, in the mean: a quarter of the surface of each."""
    points, triangles = icosphere(BALL_STEPS)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum() / 2
    return (radius * points).astype("f4"), triangles, 4 * math.pi / float(area)


def icosphere(steps):
    """Points on the unit ball and triangles, counter-clockwise from outside."""
    g = (1 + math.sqrt(5)) / 2
    points = [
        (-1, g, 0),
        (1, g, 0),
        (-1, -g, 0),
        (1, -g, 0),
        (0, -1, g),
        (0, 1, g),
        (0, -1, -g),
        (0, 1, -g),
        (g, 0, -1),
        (g, 0, 1),
        (-g, 0, -1),
        (-g, 0, 1),
    ]
    faces = [
        (0, 11, 5),
        (0, 5, 1),
        (0, 1, 7),
        (0, 7, 10),
        (0, 10, 11),
        (1, 5, 9),
        (5, 11, 4),
        (11, 10, 2),
        (10, 7, 6),
        (7, 1, 8),
        (3, 9, 4),
        (3, 4, 2),
        (3, 2, 6),
        (3, 6, 8),
        (3, 8, 9),
        (4, 9, 5),
        (2, 4, 11),
        (6, 2, 10),
        (8, 6, 7),
        (9, 8, 1),
    ]
    points = [numpy.array(p) / math.sqrt(1 + g * g) for p in points]
    for _ in range(steps):
        middle, finer = {}, []

        def between(a, b):
            edge = min(a, b), max(a, b)
            if edge not in middle:
                p = points[a] + points[b]
                points.append(p / numpy.linalg.norm(p))
                middle[edge] = len(points) - 1
            return middle[edge]
        for a, b, c in faces:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return numpy.array(points), numpy.array(faces, "i4")

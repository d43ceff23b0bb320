"""One export: the record of the shot becomes nodes, meshes, lamps, cameras of a .glb."""
import math
import os

import bpy
import numpy

from . import gltf
from .bake import Baker
from .cameras import picture_size
from .colour import is_known, working_space
from .fixtures import Cameras, Lamps
from .looks import Look, look_of, matte
from .materials import Materials, needs_bake
from .meshes import Meshes
from .nodes import Nodes
from .notes import Damage, Notes
from .record import record, stands_still
from .smoke import Smoke
from .world import bake_world

SMALLEST = 32            # pixels of a baked texture
SILENT = {"empty", "armature", "lattice", "speaker", "light_probe", "lightprobe"}


class Shot(Meshes, Nodes, Lamps, Cameras, Smoke):
    def __init__(self, scene, path, bake=1024, deform=True):
        self.scene, self.path, self.bake_limit, self.deform = scene, os.path.abspath(path), bake, deform
        self.notes, self.others, self.plain_values = Notes(), {}, Look()
        self.sky, self.world_file, self.smoke, self.record = None, None, None, None
        self.first, self.last = max(0, scene.frame_start), max(0, scene.frame_end)
        if scene.frame_start < 0:
            self.notes.lost(Damage.MOTION, "the scene", "frames below 0 are left out")
        self.surfaces, self.wanted, self.camera_name = {}, {}, None
        self.camera = scene.camera
        self.layer = next(
            (layer for layer in scene.view_layers if layer == bpy.context.view_layer or layer.use), scene.view_layers[0]
        )
        self.still = stands_still(scene)

    def frames(self):
        """The frames that are looked at: one if nothing can change."""
        return range(self.first, self.first + 1 if self.still else self.last + 1)

    def look_frame(self):
        return self.first if self.still else min(max(self.scene.frame_current, self.first), self.last)

    def rate(self):
        return self.scene.render.fps / self.scene.render.fps_base

    def times(self, frames):
        return [frame / self.rate() for frame in frames]

    def step_times(self, frames):
        """Half a frame early: rounding of a key's time must not leave the state of the frame before."""
        return [max(0.0, (frame - .5) / self.rate()) for frame in frames]

    # ---- materials ----

    def look_of(self, material):
        return look_of(material)[0]

    def surface(self, material):
        """(look, volume) of a material; look None where it has only a volume."""
        name = material.name_full if material else ""
        if name not in self.surfaces:
            self.surfaces[name] = matte((.8, .8, .8)), None
            if material:
                with self.notes.guard(Damage.MATERIAL, f"material {material.name}", "becomes grey"):
                    self.surfaces[name] = look_of(material)
        return self.surfaces[name]

    def needs_bake(self, materials):
        return any(material and needs_bake(self.surface(material)[0]) for material in materials)

    def need_bake(self, topology, material):
        if topology not in self.record.baking:
            raise RuntimeError("its mesh could not be copied")

    def bake_size(self, topology):
        """Pixels of a texture: one for a pixel of the picture where the mesh is nearest; None where baking is off."""
        if not self.bake_limit:
            return None
        return min(
            self.bake_limit,
            max(SMALLEST, 2 ** math.ceil(math.log2(max(1, self.wanted.get(topology, self.bake_limit))))),
        )

    # ---- the export ----

    def export(self):
        self.check()
        self.record = record(self)
        self.notes.shares = self.record.shares
        for step in (self.list_others, lambda: bake_world(self), self.measure_bakes):
            with self.notes.guard(Damage.LIGHT, "the scene", "a part of it is left out"):
                step()
        self.document = gltf.Document(f"Blender {bpy.app.version_string}, tempolux_export")
        baker = Baker(self)
        try:
            self.materials = Materials(self, self.document, baker)
            self.geometry, self.groups = {}, {}
            for key, item in self.record.items.items():
                with self.notes.guard(Damage.OBJECT, item.label, "is left out"):
                    {"mesh": self.add_mesh, "light": self.add_lamp, "camera": self.add_camera}[item.kind](key, item)
            for step in (self.add_groups, self.add_cut):
                with self.notes.guard(Damage.OBJECT, "the scene", "instances or cuts are left out"):
                    step()
        finally:
            baker.close()
        self.warn_if_dark()
        self.document.write(self.path)

    def warn_if_dark(self):
        emits = any(max(m.get("emissiveFactor", [0])) > 0 for m in self.document.json.get("materials", []))
        if not emits and "extensions" not in self.document.json and not self.sky and not self.world_file:
            self.notes.lost(Damage.OBJECT, "the scene", "no lamp, no emission, no sky: black")

    def check(self):
        if not is_known():
            self.notes.lost(
                Damage.LIGHT, "the scene", f"colours of the working space {working_space()} are taken as Rec.709"
            )
        if sum(layer.use for layer in self.scene.view_layers) > 1:
            self.notes.lost(Damage.DETAIL, "the scene", f"of its view layers only {self.layer.name} is exported")
        render = self.scene.render
        if render.use_border and not render.use_crop_to_border:
            self.notes.lost(
                Damage.CAMERA, "the render border", "the whole picture is rendered; Crop to Render Region is kept"
            )
        if render.pixel_aspect_x != render.pixel_aspect_y:
            size = "x".join(map(str, picture_size(render)))
            self.notes.lost(Damage.CAMERA, "the pixel aspect", f"pixels are square: the same picture as {size}")
        for image in bpy.data.images:
            path = (
                bpy.path.abspath(image.filepath, library=image.library)
                if image.source == "FILE" and image.filepath
                else ""
            )
            if path and image.users and not image.packed_file and not os.path.isfile(path):
                self.notes.lost(Damage.MATERIAL, f"image {image.name}", f"its file is missing: {path}")
        view = self.scene.view_settings
        if view.view_transform not in ("Standard", "Raw"):
            self.notes.lost(
                Damage.HINT,
                "the view transform",
                f"{view.view_transform} is not applied: previews are sRGB (Standard) at the scene's exposure; compare "
                "the linear EXR files through one transform",
            )
        shown = {
            "look": view.look not in ("None", ""),
            "gamma": abs(view.gamma - 1) > 1e-6,
            "curves": view.use_curve_mapping,
        }
        for word in (word for word, used in shown.items() if used):
            self.notes.lost(Damage.HINT, f"the view's {word}", "is not applied to the previews")

    def measure_bakes(self):
        """Pixels that a texture of each mesh needs, by its size and distance from the camera over the shot."""
        eyes = {frame: self.record.items[key] for frame, key in self.record.cameras.items()}
        height = picture_size(self.scene.render)[1]
        for item in self.record.items.values():
            if item.kind != "mesh":
                continue
            for frame in self.some(item):
                shape, eye = self.record.shapes[item.shapes[frame]], eyes.get(frame)
                if shape.topology() not in self.record.baking or not len(shape.points):
                    continue
                place = item.places[frame]
                low, high = shape.points.min(axis=0), shape.points.max(axis=0)
                corners = numpy.array([[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)])
                world = corners @ place[:3, :3].T + place[:3, 3]
                area = shape.volume_and_area()[1] * abs(numpy.linalg.det(place[:3, :3])) ** (2 / 3)
                pixel = self.pixel(eye, frame, world, height)
                wanted = math.sqrt(2 * area) / max(pixel, 1e-9)
                self.wanted[shape.topology()] = max(self.wanted.get(shape.topology(), 0), wanted)

    @staticmethod
    def some(item):
        frames = sorted(item.places)
        return sorted({frames[0], frames[len(frames) // 2], frames[-1]})

    @staticmethod
    def pixel(eye, frame, corners, height):
        """Size of a pixel of the picture, m, at the nearest point of a box."""
        if eye is None or frame not in eye.places:
            return 1e-9
        state, place = eye.states[frame], eye.places[frame]
        if state.kind == "ORTHO":
            return 2 * state.half / height
        turn = place[:3, :3] / numpy.linalg.norm(place[:3, :3], axis=0)
        local = (corners - place[:3, 3]) @ turn
        low, high = local.min(axis=0), local.max(axis=0)
        nearest = numpy.clip(0, low, high)
        return (
            2
            * state.half
            * max(float(numpy.linalg.norm(nearest)), 0.05 * float(numpy.linalg.norm(high - low)))
            / height
        )

    # ---- what is not geometry, lamp or camera ----

    def list_others(self):
        for kind, found in self.others.items():
            for name, original in found.items():
                if kind in SILENT:
                    continue
                if kind == "volume":
                    self.add_smoke(name, original)
                else:
                    self.notes.lost(Damage.OBJECT, name, f"{kind.replace('_', ' ')} is left out: make it a mesh")
        for item in self.record.items.values():
            for system in getattr(item.original, "particle_systems", ()):
                settings = system.settings
                if settings.type == "HAIR" and settings.render_type == "PATH":
                    self.notes.lost(Damage.OBJECT, item.original.name, "its hair is left out: make it a mesh")
                elif settings.render_type in ("HALO", "LINE", "PATH"):
                    self.notes.lost(
                        Damage.OBJECT,
                        item.original.name,
                        f"its particles as {settings.render_type.lower()} are left out",
                    )
        for thing in self.scene.objects:
            if (
                thing.type in ("GPENCIL", "GREASEPENCIL")
                and not thing.hide_render
                and thing.name not in self.others.get(thing.type.lower(), ())
            ):
                self.notes.lost(Damage.OBJECT, thing.name, "grease pencil is left out: make it a mesh")

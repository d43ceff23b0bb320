"""Lamps and cameras of the record as nodes of the file."""
import copy
import math

import numpy

from . import gltf
from .lamps import area_gain
from .nodes import moves, unscaled, unturned
from .notes import Damage
from .spread import cones_for, places_on
from .values import as_number, as_tuple, is_constant, resolve


class Lamps:
    """The part of Shot that adds lamps."""

    def add_lamp(self, key, item):
        states = item.states
        first = states[min(states)]
        lamp, lost = first.lamp, self.notes.lost
        tree = lamp.node_tree if getattr(lamp, "use_nodes", False) or lamp.node_tree else None
        if tree and any(n.type not in ("EMISSION", "OUTPUT_LIGHT") for n in tree.nodes):
            lost(Damage.LIGHT, item.label, "nodes of a lamp are left out, but its power and colour are kept")
        elif tree:
            scale_by_nodes(tree, states.values())
        if item.flags & {
            "visible_diffuse",
            "visible_glossy",
            "visible_transmission",
            "visible_shadow",
            "light_linking",
        }:
            lost(Damage.LIGHT, item.label, "light linking and hiding from rays are left out: it lights all objects")
        if (
            not getattr(lamp, "cycles", None)
            or not getattr(lamp.cycles, "cast_shadow", True)
            or not getattr(lamp, "use_shadow", True)
        ):
            lost(Damage.LIGHT, item.label, "it casts shadows here")
        if getattr(getattr(lamp, "cycles", None), "is_portal", False):
            return
        if all(float(state.power.max()) <= 0 for state in states.values()):
            return                         # its shape would stand in the way of light, which it does not in Blender
        places = {frame: gltf.TO_GLTF @ place for frame, place in item.places.items()}
        self.notes.keep("lamps")
        if first.kind == "AREA" and first.spread < math.pi - 1e-3:
            self.add_spots(item, states, places)
            return
        # The camera would see the ball of a lamp that Blender hides from it. No ray meets a lamp of glTF.
        unseen = first.kind == "POINT" and first.radius > 0 and "visible_camera" in item.flags and self.in_view(item)
        if first.emits() and not unseen:
            self.add_emitter(item, states, places)
            return
        if first.kind == "SPOT" and first.cone > math.pi / 2:
            lost(Damage.LIGHT, item.label, "a spot wider than half of all directions is cut there")
        lights = self.document.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})[
            "lights"
        ]
        self.document.use("KHR_lights_punctual")
        light = {"name": item.name, **first.gltf()}
        index = len(lights)
        lights.append(light)
        rigid = {frame: unscaled(place) for frame, place in places.items()}
        self.node(item, rigid, extras=first.extras(), extensions={"KHR_lights_punctual": {"light": index}})
        at = f"/extensions/KHR_lights_punctual/lights/{index}"
        frames = sorted(states)
        values = [states[f].gltf() for f in frames]
        there = [1.0 if f in states else 0.0 for f in self.frames()]
        self.changes(frames, [[v["intensity"]] for v in values], f"{at}/intensity")
        if min(there) == 0:
            rows = [[states[f].gltf()["intensity"]] if f in states else [0.0] for f in self.frames()]
            self.document.channel(self.step_times(self.frames()), rows, "STEP", pointer=f"{at}/intensity")
        self.changes(frames, [v["color"] for v in values], f"{at}/color")
        if first.kind == "SPOT":
            self.changes(frames, [[v["spot"]["outerConeAngle"]] for v in values], f"{at}/spot/outerConeAngle")
            self.changes(frames, [[v["spot"]["innerConeAngle"]] for v in values], f"{at}/spot/innerConeAngle")

    def add_spots(self, item, states, places):
        """An area lamp with a spread: a grid of spots, children of one node."""
        frames = sorted(states)
        first, document = states[frames[0]], self.document
        lights = document.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        document.use("KHR_lights_punctual")
        scale = numpy.linalg.norm(places[frames[0]][:3, :3], axis=0)
        spots = [
            tuple(float(v) for v in numpy.array(p) * scale)
            for p in places_on(first.outline, first.lamp.shape in ("DISK", "ELLIPSE"))
        ]
        parent = self.node(item, {frame: unscaled(place) for frame, place in places.items()})
        children = document.json["nodes"][parent]["children"] = []
        for outer, inner, intensity in cones_for(first.spread / 2):
            powers = [max(float(states[f].power.max()), 0.0) for f in frames]
            colours = [
                [float(c) / p for c in states[f].power] if p > 0 else [1.0, 1.0, 1.0] for f, p in zip(frames, powers)
            ]
            index = len(lights)
            lights.append(
                {
                    "name": item.name,
                    "type": "spot",
                    "color": colours[0],
                    "intensity": powers[0] * intensity / len(spots),
                    "spot": {"innerConeAngle": inner, "outerConeAngle": outer},
                }
            )
            at = f"/extensions/KHR_lights_punctual/lights/{index}"
            self.changes(frames, [[p * intensity / len(spots)] for p in powers], f"{at}/intensity")
            self.changes(frames, colours, f"{at}/color")
            for place in spots:
                children.append(document.append("nodes", {"name": item.name, "translation": list(place),
                                                          "extensions": {"KHR_lights_punctual": {"light": index}}}))
        self.notes.baked(
            item.label,
            f"its spread: {len(children)} spots in its place; its shadows have steps, mirrors do not show it",
        )

    def in_view(self, item):
        """Is the middle of a thing in the picture, at some frame?"""
        for frame in self.some(item):
            eye = self.record.items.get(self.record.cameras.get(frame))
            if (
                eye is not None
                and frame in eye.states
                and eye.states[frame].shows(eye.places[frame], item.places[frame][:3, 3])
            ):
                return True
        return not self.record.cameras

    def changes(self, frames, rows, pointer):
        if len(frames) == len(self.frames()) and moves(numpy.array(rows, "f4")):
            self.document.channel(self.times(frames), rows, pointer=pointer)

    def add_emitter(self, item, states, places):
        """A lamp with an extent: a mesh that shines from its front."""
        frames = sorted(states)
        first, lost = states[frames[0]], self.notes.lost
        if "visible_camera" in item.flags and self.in_view(item):
            lost(Damage.CAMERA, item.label, "the camera sees the shape of this lamp, which Blender hides")
        if (
            any(
                abs(states[f].area - first.area) > 1e-6 * first.area or abs(states[f].radius - first.radius) > 1e-6
                for f in frames
            )
            and first.kind == "POINT"
        ):
            lost(Damage.MOTION, item.label, "its size stays that of the first frame; its power is kept")
        points, triangles = first.mesh()
        if first.kind == "POINT":
            points = gltf.axes(points)
            places = {frame: unturned(place) for frame, place in places.items()}
        material = {
            "name": item.name,
            "pbrMetallicRoughness": {"baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0},
            "extensions": self.specular_none(),
        }
        rows = [self.shine(states[f], first) for f in frames]
        top = max(max(rows[0]), 1e-9)
        material["emissiveFactor"] = [float(c / top) for c in rows[0]]
        material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": float(top)}
        self.document.use("KHR_materials_emissive_strength")
        index = self.document.append("materials", material)
        make = self.document.accessor
        attributes = {"POSITION": make(points.astype("f4"), bounds=True, target=34962)}
        primitive = {
            "attributes": attributes,
            "indices": make(triangles.reshape(-1).astype("u2"), target=34963),
            "material": index,
        }
        mesh = self.document.append("meshes", {"name": item.name, "primitives": [primitive]})
        self.node(
            item, places, mesh=mesh, extras={"hidden_from_camera": True} if "visible_camera" in item.flags else None
        )
        tops = [max(max(r), 1e-9) for r in rows]
        self.changes(
            frames,
            [[t] for t in tops],
            f"/materials/{index}/extensions/KHR_materials_emissive_strength/emissiveStrength",
        )
        self.changes(frames, [[c / t for c in r] for r, t in zip(rows, tops)], f"/materials/{index}/emissiveFactor")

    @staticmethod
    def shine(state, first):
        """Radiance of a frame on the shape of the first frame: the power is that of the frame."""
        if state.kind == "POINT":
            return [float(c) for c in state.power / (4 * math.pi ** 2 * first.radius ** 2) * first.radiance_gain()]
        return [float(c) for c in state.power * area_gain() / first.area]


class Cameras:
    """The part of Shot that adds cameras."""

    def add_camera(self, key, item):
        states, lost = item.states, self.notes.lost
        frames = sorted(states)
        first = states[frames[0]]
        lens = item.original.data
        if lens.type == "PANO":
            lost(Damage.CAMERA, item.label, "a panorama becomes a perspective")
        if lens.dof.use_dof and (lens.dof.aperture_blades or lens.dof.aperture_ratio != 1):
            lost(Damage.CAMERA, item.label, "the lens' opening becomes a disc")
        camera = {"name": item.original.name, **first.gltf()}
        if any(abs(s) > 1e-9 for s in first.shift):
            camera["extras"] = {"lens_shift": [float(s) for s in first.shift]}
        if any(abs(a - b) > 1e-6 for f in frames for a, b in zip(states[f].shift, first.shift)):
            lost(Damage.CAMERA, item.label, "its shift stays that of the first frame")
        index = self.document.append("cameras", camera)
        places = {frame: unscaled(gltf.TO_GLTF @ place) for frame, place in item.places.items()}
        for frame in self.frames():               # a camera that is hidden sees all the same
            places.setdefault(frame, places[max([f for f in places if f <= frame], default=min(places))])
        self.node(item, places, extras=self.camera_extras([states[f] for f in frames], frames[0]), camera=index)
        self.zoom([states.get(f, first) for f in self.frames()], index)
        self.notes.keep("cameras")

    def zoom(self, states, index):
        word = "orthographic/ymag" if states[0].kind == "ORTHO" else "perspective/yfov"
        rows = [[s.half if s.kind == "ORTHO" else 2 * math.atan(s.half)] for s in states]
        if moves(numpy.array(rows)):
            self.document.channel(self.times(self.frames()), rows, pointer=f"/cameras/{index}/{word}")

    @staticmethod
    def camera_extras(states, first):
        """Each value once, or as a list by frame where it changes; the lists begin at frame `first_frame`."""
        extras = {}
        for name in states[0].extras:
            values = [s.extras.get(name, states[0].extras[name]) for s in states]
            extras[name] = values[0] if all(v == values[0] for v in values) else values
            if isinstance(extras[name], list):
                extras["first_frame"] = first
        return extras

    def add_cut(self):
        """One camera that jumps as the markers say."""
        used = list(dict.fromkeys(self.record.cameras.values()))
        self.camera_name = self.record.items[used[0]].name if used else None
        if len(used) < 2:
            return
        items = {frame: self.record.items[key] for frame, key in self.record.cameras.items()}
        states = [items[f].states[f] for f in self.frames()]
        if (
            len({tuple(round(s, 6) for s in state.shift) for state in states}) > 1
            or len({state.kind for state in states}) > 1
        ):
            self.notes.lost(
                Damage.CAMERA,
                "the cuts",
                "cameras of the markers differ in shift or kind, which one camera cannot: render each range "
                "with CAMERA=NAME",
            )
        camera = {"name": "Cuts", **states[0].gltf()}
        if any(abs(s) > 1e-9 for s in states[0].shift):
            camera["extras"] = {"lens_shift": [float(s) for s in states[0].shift]}
        index = self.document.append("cameras", camera)
        cuts = copy.copy(items[self.first])
        cuts.name, cuts.extras = "Cuts", {}
        places = {f: unscaled(gltf.TO_GLTF @ items[f].places[f]) for f in self.frames()}
        self.node(cuts, places, extras=self.camera_extras(states, self.first), camera=index)
        self.zoom(states, index)
        self.camera_name = "Cuts"
        self.notes.baked("the cuts", f"{len(used)} cameras of the markers are one camera, Cuts")


def scale_by_nodes(tree, states):
    """A lamp's emission node multiplies its light."""
    node = next((n for n in tree.nodes if n.type == "EMISSION" and n.outputs[0].is_linked), None)
    if node is None:
        return
    colour, strength = (resolve(node.inputs[name]) for name in ("Color", "Strength"))
    if is_constant(colour) and is_constant(strength):
        for state in states:
            state.power = state.power * numpy.array(as_tuple(colour)) * as_number(strength)

"""Meshes of the record as meshes of the file: shapes, deformation, instances."""
import copy
import os

import bpy
import numpy

from . import gltf, grain
from .nodes import distinct
from .notes import Damage
from .shapes import follow, reduce, split_creases
from .smoke import pattern_of
from .values import as_number, as_tuple, is_constant, times


class Meshes:
    """The part of Shot that adds meshes."""

    def add_mesh(self, key, item):
        shapes = {frame: self.record.shapes[k] for frame, k in item.shapes.items()}
        if not any(len(s.corners) for s in shapes.values()):
            return
        if self.only_volume(item, shapes):
            return
        hidden = self.hidden(item, shapes)
        if hidden:
            return
        places = {frame: gltf.TO_GLTF @ place @ gltf.TO_GLTF.T for frame, place in item.places.items()}
        if not all(gltf.decomposed(place)[3] for place in distinct(places)):
            shapes, places = self.without_shear(item, shapes)
        names = {id(s): s for s in shapes.values()}
        topologies = {s.topology() for s in names.values()}
        if len(names) > 1 and not self.deform:
            self.notes.lost(Damage.MOTION, item.label, "its deformation is left out (--no-deform)")
            first = next(iter(shapes.values()))
            shapes = {frame: first for frame in shapes}
        elif len({s.faces() for s in names.values()}) > 1:
            self.add_sequence(item, shapes, places)
            return
        elif len(topologies) > 1:
            self.notes.lost(
                Damage.DETAIL, item.label, "its texture coordinates change: they stay those of the first frame"
            )
        mesh, weights = self.mesh(item, shapes)
        if mesh is None:
            return
        self.notes.keep("objects")
        constant = len(places) == len(self.frames()) and len(distinct(places)) == 1 and weights is None
        if item.instanced and constant:
            self.groups.setdefault((mesh, key[0], item.original.name), []).append((item, places[self.first]))
            return
        self.node(item, places, mesh=mesh, weights=weights)

    def only_volume(self, item, shapes):
        """A domain whose materials are only volumes is no surface."""
        materials = next(iter(shapes.values())).materials
        if not all(m is not None and self.surface(m)[0] is None for m in materials):
            return False
        domain = (
            next(
                (m.domain_settings for m in item.original.modifiers if m.type == "FLUID" and m.fluid_type == "DOMAIN"),
                None,
            )
            if hasattr(item.original, "modifiers")
            else None
        )
        pattern = (
            pattern_of(os.path.join(bpy.path.abspath(domain.cache_directory), "data", "fluid_data_0001.vdb"))
            if domain
            else None
        )
        self.take_smoke(item.label, pattern)
        return True

    def hidden(self, item, shapes):
        """Names what Cycles hides from some rays; True if the object is left out."""
        flags, lost = item.flags, self.notes.lost
        if "is_shadow_catcher" in flags:
            lost(Damage.OBJECT, item.label, "a shadow catcher is left out")
            return True
        if "holdout" in flags:
            lost(Damage.OBJECT, item.label, "a holdout becomes a black object")
        if flags & {"visible_camera", "indirect_only"}:
            if not any(m and self.shines(m) for s in shapes.values() for m in s.materials):
                lost(
                    Damage.LIGHT,
                    item.label,
                    "is hidden from the camera: it is left out, with its shadow and the light it reflects",
                )
                return True
            lost(Damage.OBJECT, item.label, "is hidden from the camera in Blender: it is seen here, as it shines")
        if flags & {
            "visible_diffuse",
            "visible_glossy",
            "visible_transmission",
            "visible_volume_scatter",
            "visible_shadow",
        }:
            words = ", ".join(
                sorted(
                    f.replace("visible_", "").replace("_", " ")
                    for f in flags
                    if f.startswith("visible_") and f != "visible_camera"
                )
            )
            lost(Damage.LIGHT, item.label, f"is hidden from rays ({words}) in Blender, not here")
        if "light_linking" in flags:
            lost(Damage.LIGHT, item.label, "light linking is left out: all lamps reach all objects")
        return False

    def shines(self, material):
        look = self.surface(material)[0]
        light = times(look["emission"], look["strength"]) if look is not None else 0.0
        return not is_constant(light) or max(as_tuple(light)) > 0

    def without_shear(self, item, shapes):
        """Shapes in world space, for placements that are no translation, rotation and scale."""
        made = {}
        for frame, shape in shapes.items():
            place = item.places[frame]
            mark = id(shape), place.tobytes()
            if mark not in made:
                moved = made[mark] = copy.copy(shape)
                moved.points = (shape.points @ place[:3, :3].T + place[:3, 3]).astype("f4")
                if shape.normals is not None:
                    normals = shape.normals @ numpy.linalg.pinv(place[:3, :3])
                    moved.normals = (
                        normals / numpy.maximum(numpy.linalg.norm(normals, axis=1, keepdims=True), 1e-20)
                    ).astype("f4")
                if numpy.linalg.det(place[:3, :3]) < 0:
                    moved.corners = shape.corners[:, ::-1]
                moved.bake_topology = getattr(shape, "bake_topology", None) or shape.topology()
            shapes[frame] = made[mark]
        return dict(shapes), {frame: numpy.eye(4) for frame in shapes}

    def add_sequence(self, item, shapes, places):
        """A mesh whose faces change: one node for each shape, which is there at its frames alone."""
        by_shape = {}
        for frame, shape in shapes.items():
            by_shape.setdefault(id(shape), []).append(frame)
        before = len(self.document.binary)
        for number, frames in enumerate(by_shape.values()):
            part = copy.copy(item)
            part.name = f"{item.name} {frames[0]}"
            mesh, weights = self.mesh(part, {frame: shapes[frame] for frame in frames})
            if mesh is not None:
                self.node(part, {frame: places[frame] for frame in frames}, mesh=mesh, weights=weights)
        self.notes.keep("objects")
        self.notes.baked(
            item.label, f"its faces change: {len(by_shape)} meshes, {megabytes(len(self.document.binary) - before)}"
        )

    def mesh(self, item, shapes):
        """(mesh, weights by frame): a mesh with the morph targets that the shapes need."""
        order = {}
        for shape in shapes.values():
            order.setdefault(id(shape), shape)
        holdout = "holdout" in item.flags
        mark = tuple(id(s) for s in shapes.values()) if len(order) > 1 else (next(iter(order)),)
        mark = (*mark, holdout)
        if mark not in self.geometry:
            before = len(self.document.binary)
            self.geometry[mark] = self.make_mesh(item, list(order.values()), holdout)
            targets = self.geometry[mark][1]
            if len(order) > 1 and targets is not None:
                self.notes.baked(
                    item.label,
                    f"its deformation: {targets.shape[1]} shapes for {len(order)} different frames, "
                    f"{megabytes(len(self.document.binary) - before)}",
                )
        index, weights = self.geometry[mark]
        numbers = {key: row for row, key in enumerate(order)}
        return index, (
            {frame: weights[numbers[id(shape)]] for frame, shape in shapes.items()} if weights is not None else None
        )

    def make_mesh(self, item, order, holdout):
        shape = order[0]
        morph = reduce([s.points for s in order]) if len(order) > 1 else None
        solid = self.thickness(shape)
        if solid > 0:
            order = [split_creases(s) for s in order]
            shape = order[0]
        primitives = []
        for slot in numpy.unique(shape.slots):
            material = shape.materials[slot]
            if material is not None and self.surface(material)[0] is None:
                self.notes.lost(
                    Damage.DETAIL, item.label, f"its faces with only a volume, {material.name}, are left out"
                )
                continue
            primitives.append(self.primitive(shape, order, morph, int(slot), solid, holdout))
        if not primitives:
            return None, None
        mesh = {"name": shape.name, "primitives": primitives}
        if morph is not None and morph.weights.shape[1]:
            mesh["weights"] = [0.0] * morph.weights.shape[1]
        return self.document.append("meshes", mesh), morph.weights if morph is not None else None

    def thickness(self, shape):
        """Mean chord of a closed body of glass, 4 volume / area (Cauchy); 0 for other meshes."""
        glass = [
            m
            for m in shape.materials
            if m
            and self.surface(m)[0] is not None
            and not (
                is_constant(self.surface(m)[0]["transmission"]) and as_number(self.surface(m)[0]["transmission"]) == 0
            )
        ]
        if not glass:
            return 0.0
        volume, area = shape.volume_and_area()
        return 4 * volume / max(area, 1e-30) if volume else 0.0

    def primitive(self, shape, order, morph, slot, solid, holdout):
        material = shape.materials[slot]
        topology = getattr(shape, "bake_topology", None) or shape.topology()
        if holdout:
            number, layers, colours = self.black(), [], None
        else:
            number, layers, colours = self.materials.material(material, shape, topology, slot, solid)
        loops = shape.corners[shape.slots == slot].reshape(-1)
        columns = [shape.vertex[loops][:, None].astype("i4")]
        sets = []
        for name in layers:
            uv = self.materials.baker.unwrapped[topology][1] if name is None else shape.uvs[name]
            sets.append(uv[loops])
        for values in (
            ([shape.normals[loops]] if shape.normals is not None else [])
            + sets
            + ([shape.colours[colours][loops]] if colours else [])
        ):
            columns.append(numpy.ascontiguousarray(values, "f4").view("i4"))
        rows = numpy.concatenate(columns, axis=1)
        _, index, inverse = numpy.unique(rows, axis=0, return_index=True, return_inverse=True)
        corner = loops[index]
        vertex = shape.vertex[corner]
        make = self.document.accessor
        attributes = {"POSITION": make(gltf.axes(shape.points[vertex]), bounds=True, target=34962)}
        if shape.normals is not None:
            attributes["NORMAL"] = make(gltf.axes(shape.normals[corner]), target=34962)
        axis = self.grain_axis(number, material) if shape.normals is not None else None
        if axis:
            along = gltf.axes(grain.around(shape.points, shape.normals[corner], vertex, axis))
            attributes["TANGENT"] = make(numpy.concatenate([along, numpy.ones_like(along[:, :1])], axis=1).astype("f4"), target=34962)
        for k, uv in enumerate(sets):
            attributes[f"TEXCOORD_{k}"] = make(
                numpy.stack([uv[index, 0], 1 - uv[index, 1]], axis=1).astype("f4"), target=34962
            )
        if colours:
            attributes["COLOR_0"] = make(
                numpy.clip(shape.colours[colours][corner][:, :3], 0, None).astype("f4"), target=34962
            )
        kind = "u2" if len(index) < 65535 else "u4"
        result = {
            "attributes": attributes,
            "indices": make(inverse.reshape(-1).astype(kind), target=34963),
            "material": number,
        }
        if morph is not None and morph.weights.shape[1]:
            targets = [{"POSITION": make(gltf.axes(t[vertex]), bounds=True)} for t in morph.targets]
            if shape.normals is not None and all(s.normals is not None for s in order):
                for target, normals in zip(targets, follow(morph.weights, [s.normals[corner] for s in order])):
                    target["NORMAL"] = make(gltf.axes(normals))
            result["targets"] = targets
        return result

    def grain_axis(self, number, material):
        """The axis that a brushed surface's tangents go round; None if it is not brushed, or if its texture coordinates give tangents."""
        made = self.document.json["materials"][number]
        brushed = made.get("extensions", {}).get("KHR_materials_anisotropy")
        if not brushed or "normalTexture" in made or "anisotropyTexture" in brushed:
            return None
        return self.surface(material)[0].get("grain_axis", "Z")

    def black(self):
        return self.document.once("materials", {"name": "holdout", "doubleSided": True, "pbrMetallicRoughness":
                                  {"baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0},
                                  "extensions": self.specular_none()})

    def specular_none(self):
        self.document.use("KHR_materials_specular")
        return {"KHR_materials_specular": {"specularFactor": 0.0}}


def megabytes(size):
    return f"{size / 1e6:.1f} MB" if size >= 1e5 else f"{size / 1e3:.0f} kB"

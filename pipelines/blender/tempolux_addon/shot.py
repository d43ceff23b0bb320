"""One export: the record of the shot becomes nodes, meshes, lamps, cameras of a .glb."""
import copy
import math
import os
import re

import bpy
import numpy

from . import gltf
from .bake import Baker
from .cameras import picture_size
from .lamps import area_gain
from .looks import Look, look_of, matte
from .materials import Materials, needs_bake
from .notes import Damage, Notes
from .record import record
from .shapes import follow, reduce
from .values import as_number, is_constant
from .world import bake_world

FEW = 4                  # as many equal instances become one node with EXT_mesh_gpu_instancing
SMALLEST = 32            # pixels of a baked texture
SILENT = {"empty", "armature", "lattice", "speaker", "light_probe", "lightprobe"}


class Shot:
    def __init__(self, scene, path, bake=1024, deform=True):
        self.scene, self.path, self.bake_limit, self.deform = scene, os.path.abspath(path), bake, deform
        self.notes, self.others, self.plain_values = Notes(), {}, Look()
        self.sky, self.world_file, self.smoke, self.record = None, None, None, None
        self.first, self.last = max(0, scene.frame_start), max(0, scene.frame_end)
        if scene.frame_start < 0:
            self.notes.lost(Damage.MOTION, "the scene", "frames below 0 are left out")
        self.surfaces = {}

    def frames(self):
        return range(self.first, self.last + 1)

    def look_frame(self):
        return min(max(self.scene.frame_current, self.first), self.last)

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
        return min(self.bake_limit, max(SMALLEST, 2 ** math.ceil(math.log2(max(1, self.wanted.get(topology, self.bake_limit))))))

    # ---- the export ----

    def export(self):
        self.check()
        self.record = record(self)
        self.notes.shares = self.record.shares
        self.list_others()
        bake_world(self)
        self.measure_bakes()
        self.document = gltf.Document(f"Blender {bpy.app.version_string}, tempolux_export")
        baker = Baker(self)
        try:
            self.materials = Materials(self, self.document, baker)
            self.geometry, self.groups = {}, {}
            for key, item in self.record.items.items():
                with self.notes.guard(Damage.OBJECT, item.label, "is left out"):
                    {"mesh": self.add_mesh, "light": self.add_lamp, "camera": self.add_camera}[item.kind](key, item)
            self.add_groups()
            self.add_cut()
        finally:
            baker.close()
        self.document.write(self.path)

    def check(self):
        from .colour import is_known, working_space
        if not is_known():
            self.notes.lost(Damage.LIGHT, "the scene", f"colours of the working space {working_space()} are taken as Rec.709")
        if sum(layer.use for layer in self.scene.view_layers) > 1:
            self.notes.lost(Damage.DETAIL, "the scene", f"of its view layers only {bpy.context.view_layer.name} is exported")
        render = self.scene.render
        if render.use_border and not render.use_crop_to_border:
            self.notes.lost(Damage.CAMERA, "the render border", "the whole picture is rendered; Crop to Render Region is kept")
        if render.pixel_aspect_x != render.pixel_aspect_y:
            size = "x".join(map(str, picture_size(render)))
            self.notes.lost(Damage.CAMERA, "the pixel aspect", f"pixels are square: the same picture as {size}")
        if render.use_motion_blur:
            self.notes.lost(Damage.CAMERA, "motion blur", "is not rendered (shutter kept in the camera's extras)")
        view = self.scene.view_settings
        if view.view_transform not in ("Standard", "Raw"):
            self.notes.lost(Damage.HINT, "the view transform", f"{view.view_transform} is not applied: previews are sRGB; compare the linear "
                                                                 "EXR files through one transform")
        if abs(view.exposure) > 1e-6:
            self.notes.lost(Damage.HINT, "the exposure", f"{view.exposure:+g} stops are not in the frames; a preview as Blender shows it: "
                                                           f"tempolux-info FRAME.exr --png FRAME.png --exposure {view.exposure:g}")

    def measure_bakes(self):
        """Pixels that a texture of each mesh needs, by its size and distance from the camera over the shot."""
        self.wanted = {}
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
        return 2 * state.half * max(float(numpy.linalg.norm(nearest)), .05 * float(numpy.linalg.norm(high - low))) / height

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
                    self.notes.lost(Damage.OBJECT, item.original.name, f"its particles as {settings.render_type.lower()} are left out")
        for thing in self.scene.objects:
            if thing.type in ("GPENCIL", "GREASEPENCIL") and not thing.hide_render and thing.name not in self.others.get(thing.type.lower(), ()):
                self.notes.lost(Damage.OBJECT, thing.name, "grease pencil is left out: make it a mesh")

    def add_smoke(self, name, original):
        pattern = pattern_of(bpy.path.abspath(original.data.filepath, library=original.library)) if original.data.filepath else None
        self.take_smoke(name, pattern)

    def take_smoke(self, name, pattern):
        if pattern is None:
            self.notes.lost(Damage.OBJECT, name, "smoke is left out: there is no .vdb file; bake the simulation, or name files by VOLUME=")
        elif self.smoke is None:
            self.smoke = pattern
            self.notes.lost(Damage.OBJECT, name, "smoke is in the make line as VOLUME; its files lie in the axes and place of the .vdb, and its "
                                                 "colours and density are set by VOLUME_OPTIONS")
        else:
            self.notes.lost(Damage.OBJECT, name, "smoke is left out: VOLUME names one series of files")

    # ---- meshes ----

    def add_mesh(self, key, item):
        shapes = {frame: self.record.shapes[k] for frame, k in item.shapes.items()}
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
            self.notes.lost(Damage.DETAIL, item.label, "its texture coordinates change: they stay those of the first frame")
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
        domain = next((m.domain_settings for m in item.original.modifiers if m.type == "FLUID" and m.fluid_type == "DOMAIN"), None) \
            if hasattr(item.original, "modifiers") else None
        pattern = pattern_of(os.path.join(bpy.path.abspath(domain.cache_directory), "data", "fluid_data_0001.vdb")) if domain else None
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
                lost(Damage.LIGHT, item.label, "is hidden from the camera: it is left out, with its shadow and the light it reflects")
                return True
            lost(Damage.OBJECT, item.label, "is hidden from the camera in Blender: it is seen here, as it shines")
        if flags & {"visible_diffuse", "visible_glossy", "visible_transmission", "visible_volume_scatter", "visible_shadow"}:
            words = ", ".join(sorted(f.replace("visible_", "").replace("_", " ") for f in flags if f.startswith("visible_") and f != "visible_camera"))
            lost(Damage.LIGHT, item.label, f"is hidden from rays ({words}) in Blender, not here")
        if "light_linking" in flags:
            lost(Damage.LIGHT, item.label, "light linking is left out: all lamps reach all objects")
        return False

    def shines(self, material):
        look = self.surface(material)[0]
        return look is not None and not (is_constant(look["strength"]) and as_number(look["strength"]) == 0)

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
                    moved.normals = (normals / numpy.maximum(numpy.linalg.norm(normals, axis=1, keepdims=True), 1e-20)).astype("f4")
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
        self.notes.baked(item.label, f"its faces change: {len(by_shape)} meshes, {megabytes(len(self.document.binary) - before)}")

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
                self.notes.baked(item.label, f"its deformation: {targets.shape[1]} shapes for {len(order)} different frames, "
                                            f"{megabytes(len(self.document.binary) - before)}")
        index, weights = self.geometry[mark]
        numbers = {key: row for row, key in enumerate(order)}
        return index, {frame: weights[numbers[id(shape)]] for frame, shape in shapes.items()} if weights is not None else None

    def make_mesh(self, item, order, holdout):
        shape = order[0]
        morph = reduce([s.points for s in order]) if len(order) > 1 else None
        solid = self.thickness(shape)
        primitives = []
        for slot in numpy.unique(shape.slots):
            material = shape.materials[slot]
            if material is not None and self.surface(material)[0] is None:
                self.notes.lost(Damage.DETAIL, item.label, f"its faces with only a volume, {material.name}, are left out")
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
        glass = [m for m in shape.materials if m and self.surface(m)[0] is not None
                 and not (is_constant(self.surface(m)[0]["transmission"]) and as_number(self.surface(m)[0]["transmission"]) == 0)]
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
        for values in ([shape.normals[loops]] if shape.normals is not None else []) + sets + ([shape.colours[colours][loops]] if colours else []):
            columns.append(numpy.ascontiguousarray(values, "f4").view("i4"))
        rows = numpy.concatenate(columns, axis=1)
        _, index, inverse = numpy.unique(rows, axis=0, return_index=True, return_inverse=True)
        corner = loops[index]
        vertex = shape.vertex[corner]
        make = self.document.accessor
        attributes = {"POSITION": make(gltf.axes(shape.points[vertex]), bounds=True, target=34962)}
        if shape.normals is not None:
            attributes["NORMAL"] = make(gltf.axes(shape.normals[corner]), target=34962)
        for k, uv in enumerate(sets):
            attributes[f"TEXCOORD_{k}"] = make(numpy.stack([uv[index, 0], 1 - uv[index, 1]], axis=1).astype("f4"), target=34962)
        if colours:
            attributes["COLOR_0"] = make(numpy.clip(shape.colours[colours][corner][:, :3], 0, None).astype("f4"), target=34962)
        kind = "u2" if len(index) < 65535 else "u4"
        result = {"attributes": attributes, "indices": make(inverse.reshape(-1).astype(kind), target=34963), "material": number}
        if morph is not None and morph.weights.shape[1]:
            targets = [{"POSITION": make(gltf.axes(t[vertex]), bounds=True)} for t in morph.targets]
            if shape.normals is not None and all(s.normals is not None for s in order):
                for target, normals in zip(targets, follow(morph.weights, [s.normals[corner] for s in order])):
                    target["NORMAL"] = make(gltf.axes(normals))
            result["targets"] = targets
        return result

    def black(self):
        return self.document.once("materials", {"name": "holdout", "doubleSided": True, "pbrMetallicRoughness":
                                  {"baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0},
                                  "extensions": self.specular_none()})

    def specular_none(self):
        self.document.use("KHR_materials_specular")
        return {"KHR_materials_specular": {"specularFactor": 0.0}}

    # ---- nodes ----

    def node(self, item, places, weights=None, extras=None, **more):
        """A node with its keys; `places` of glTF by frame, not at all frames where the item is not always there."""
        frames, there = list(self.frames()), sorted(places)
        held = [places[max([f for f in there if f <= frame], default=there[0])] if frame not in places else places[frame] for frame in frames]
        parts = [gltf.decomposed(m) for m in held] if len(distinct(dict(enumerate(held)))) > 1 else [gltf.decomposed(held[0])] * len(held)
        where = numpy.array([p[0] for p in parts])
        turned = numpy.array(gltf.steady([p[1].copy() for p in parts]))
        scale = numpy.array([p[2] for p in parts])
        visible = numpy.array([frame in places for frame in frames])
        node = {"name": item.name, **{k: v for k, v in more.items() if v is not None}}
        for key, rows, rest in (("translation", where, (0, 0, 0)), ("rotation", turned, (0, 0, 0, 1)), ("scale", scale, (1, 1, 1))):
            if (abs(rows[0] - rest) > 1e-9).any():
                node[key] = [float(v) for v in rows[0]]
        if extras or item.extras:
            node["extras"] = {**item.extras, **(extras or {})}
        index = self.document.append("nodes", node)
        self.document.json["scenes"][0]["nodes"].append(index)
        times, moved = self.times(frames), False
        for path, rows in (("translation", where), ("rotation", turned)):
            if moves(rows):
                self.document.channel(times, rows, node=index, path=path)
                moved = True
        if not visible.all():
            self.document.channel(self.step_times(frames), scale * visible[:, None], "STEP", node=index, path="scale")
            self.notes.keep("objects that appear or vanish")
        elif moves(scale):
            self.document.channel(times, scale, node=index, path="scale")
            moved = True
        if weights and len(next(iter(weights.values()))):
            rows = numpy.array([weights.get(f, weights[min(weights, key=lambda k: abs(k - f))]) for f in frames])
            self.document.channel(times, rows, node=index, path="weights")
            self.notes.keep("objects that deform")
        if moved:
            self.notes.keep("things that move")
        return index

    def add_groups(self):
        """Instances that stand still: many of one mesh are one node."""
        for (mesh, _, name), found in self.groups.items():
            if len(found) < FEW:
                for item, place in found:
                    self.node(item, {self.first: place, **{f: place for f in self.frames()}}, mesh=mesh)
                continue
            parts = [gltf.decomposed(place) for _, place in found]
            make, attributes = self.document.accessor, {}
            for word, k in (("TRANSLATION", 0), ("ROTATION", 1), ("SCALE", 2)):
                attributes[word] = make(numpy.array([p[k] for p in parts], "f4"))
            self.document.use("EXT_mesh_gpu_instancing")
            node = {"name": f"{name} (instances)", "mesh": mesh, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}}
            self.document.json["scenes"][0]["nodes"].append(self.document.append("nodes", node))
            self.notes.keep("instances", len(found))

    # ---- lamps ----

    def add_lamp(self, key, item):
        states = item.states
        first = states[min(states)]
        lamp, lost = first.lamp, self.notes.lost
        tree = lamp.node_tree if getattr(lamp, "use_nodes", False) or lamp.node_tree else None
        if tree and any(n.type not in ("EMISSION", "OUTPUT_LIGHT") for n in tree.nodes):
            lost(Damage.LIGHT, item.label, "nodes of a lamp are left out, but its power and colour are kept")
        elif tree:
            scale_by_nodes(tree, states.values())
        if item.flags & {"visible_diffuse", "visible_glossy", "visible_transmission", "visible_shadow", "light_linking"}:
            lost(Damage.LIGHT, item.label, "light linking and hiding from rays are left out: it lights all objects")
        if not getattr(lamp, "cycles", None) or not getattr(lamp.cycles, "cast_shadow", True) or not getattr(lamp, "use_shadow", True):
            lost(Damage.LIGHT, item.label, "it casts shadows here")
        if getattr(getattr(lamp, "cycles", None), "is_portal", False):
            return
        places = {frame: gltf.TO_GLTF @ place for frame, place in item.places.items()}
        self.notes.keep("lamps")
        if first.emits():
            self.add_emitter(item, states, places)
            return
        if first.kind == "SPOT" and first.radius > 0:
            lost(Damage.DETAIL, item.label, "a spot has no radius here: its shadows are sharp (radius kept in extras)")
        if first.kind == "SUN" and first.angle > .001:
            lost(Damage.DETAIL, item.label, "a sun has no angle here: its shadows are sharp (angle kept in extras)")
        if first.kind == "SPOT" and first.cone > math.pi / 2:
            lost(Damage.LIGHT, item.label, "a spot wider than half of all directions is cut there")
        lights = self.document.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
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

    def changes(self, frames, rows, pointer):
        if len(frames) == len(self.frames()) and moves(numpy.array(rows, "f4")):
            self.document.channel(self.times(frames), rows, pointer=pointer)

    def add_emitter(self, item, states, places):
        """A lamp with an extent: a mesh that shines from its front."""
        frames = sorted(states)
        first, lost = states[frames[0]], self.notes.lost
        if first.kind == "AREA" and first.spread < math.pi - 1e-3:
            lost(Damage.LIGHT, item.label, "its spread is left out: it shines to all sides")
        if "visible_camera" in item.flags:
            lost(Damage.DETAIL, item.label, "the camera sees the shape of this lamp, which Blender hides")
        if any(abs(states[f].area - first.area) > 1e-6 * first.area or abs(states[f].radius - first.radius) > 1e-6 for f in frames) \
                and first.kind == "POINT":
            lost(Damage.MOTION, item.label, "its size stays that of the first frame; its power is kept")
        points, triangles = first.mesh()
        if first.kind == "POINT":
            points = gltf.axes(points)
            places = {frame: unturned(place) for frame, place in places.items()}
        material = {"name": item.name, "pbrMetallicRoughness": {"baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0},
                    "extensions": self.specular_none()}
        rows = [self.shine(states[f], first) for f in frames]
        top = max(max(rows[0]), 1e-9)
        material["emissiveFactor"] = [float(c / top) for c in rows[0]]
        material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": float(top)}
        self.document.use("KHR_materials_emissive_strength")
        index = self.document.append("materials", material)
        make = self.document.accessor
        attributes = {"POSITION": make(points.astype("f4"), bounds=True, target=34962)}
        primitive = {"attributes": attributes, "indices": make(triangles.reshape(-1).astype("u2"), target=34963), "material": index}
        mesh = self.document.append("meshes", {"name": item.name, "primitives": [primitive]})
        self.node(item, places, mesh=mesh)
        tops = [max(max(r), 1e-9) for r in rows]
        self.changes(frames, [[t] for t in tops], f"/materials/{index}/extensions/KHR_materials_emissive_strength/emissiveStrength")
        self.changes(frames, [[c / t for c in r] for r, t in zip(rows, tops)], f"/materials/{index}/emissiveFactor")

    @staticmethod
    def shine(state, first):
        """Radiance of a frame on the shape of the first frame: the power is that of the frame."""
        if state.kind == "POINT":
            return [float(c) for c in state.power / (4 * math.pi ** 2 * first.radius ** 2) * first.radiance_gain()]
        return [float(c) for c in state.power * area_gain() / first.area]

    # ---- cameras ----

    def add_camera(self, key, item):
        states, lost = item.states, self.notes.lost
        frames = sorted(states)
        first = states[frames[0]]
        lens = item.original.data
        if lens.type == "PANO":
            lost(Damage.CAMERA, item.label, "a panorama becomes a perspective")
        if lens.dof.use_dof:
            lost(Damage.CAMERA, item.label, "depth of field is not rendered (f-stop and focus kept in extras)")
        camera = {"name": item.original.name, **first.gltf()}
        if any(abs(s) > 1e-9 for s in first.shift):
            camera["extras"] = {"lens_shift": [float(s) for s in first.shift]}
        if any(abs(a - b) > 1e-6 for f in frames for a, b in zip(states[f].shift, first.shift)):
            lost(Damage.CAMERA, item.label, "its shift stays that of the first frame")
        index = self.document.append("cameras", camera)
        places = {frame: unscaled(gltf.TO_GLTF @ place) for frame, place in item.places.items()}
        for frame in self.frames():               # a camera that is hidden sees all the same
            places.setdefault(frame, places[max([f for f in places if f <= frame], default=min(places))])
        self.node(item, places, extras=self.camera_extras([states[f] for f in frames]), camera=index)
        self.zoom([states.get(f, first) for f in self.frames()], index)
        self.notes.keep("cameras")

    def zoom(self, states, index):
        word = "orthographic/ymag" if states[0].kind == "ORTHO" else "perspective/yfov"
        rows = [[s.half if s.kind == "ORTHO" else 2 * math.atan(s.half)] for s in states]
        if moves(numpy.array(rows)):
            self.document.channel(self.times(self.frames()), rows, pointer=f"/cameras/{index}/{word}")

    @staticmethod
    def camera_extras(states):
        """Each value once, or as a list by frame where it changes."""
        extras = {}
        for name in states[0].extras:
            values = [s.extras.get(name, states[0].extras[name]) for s in states]
            extras[name] = values[0] if all(v == values[0] for v in values) else values
        return extras

    def add_cut(self):
        """One camera that jumps as the markers say."""
        used = list(dict.fromkeys(self.record.cameras.values()))
        self.camera_name = self.record.items[used[0]].name if used else None
        if len(used) < 2:
            return
        items = {frame: self.record.items[key] for frame, key in self.record.cameras.items()}
        states = [items[f].states[f] for f in self.frames()]
        if len({tuple(round(s, 6) for s in state.shift) for state in states}) > 1 or len({state.kind for state in states}) > 1:
            self.notes.lost(Damage.CAMERA, "the cuts", "cameras of the markers differ in shift or kind, which one camera cannot: render each range "
                                                       "with CAMERA=NAME")
        camera = {"name": "Cuts", **states[0].gltf()}
        if any(abs(s) > 1e-9 for s in states[0].shift):
            camera["extras"] = {"lens_shift": [float(s) for s in states[0].shift]}
        index = self.document.append("cameras", camera)
        cuts = copy.copy(items[self.first])
        cuts.name, cuts.extras = "Cuts", {}
        places = {f: unscaled(gltf.TO_GLTF @ items[f].places[f]) for f in self.frames()}
        self.node(cuts, places, extras=self.camera_extras(states), camera=index)
        self.zoom(states, index)
        self.camera_name = "Cuts"
        self.notes.baked("the cuts", f"{len(used)} cameras of the markers are one camera, Cuts")


# ---- small things -------------------------------------------------------------------------------------------

def distinct(places):
    return list({place.tobytes(): place for place in places.values()}.values())


def moves(rows):
    return bool((abs(rows - rows[0]) > 1e-6 * numpy.maximum(1e-3, abs(rows[0]))).any())


def unscaled(matrix):
    """Cameras and lamps have no scale; a mirrored one keeps its view axis."""
    result = matrix.copy()
    scale = numpy.linalg.norm(matrix[:3, :3], axis=0)
    result[:3, :3] = matrix[:3, :3] / numpy.where(scale > 0, scale, 1)
    if numpy.linalg.det(result[:3, :3]) < 0:
        result[:3, 0] *= -1
    return result


def unturned(matrix):
    result = numpy.eye(4)
    result[:3, 3] = matrix[:3, 3]
    return result


def scale_by_nodes(tree, states):
    """A lamp's emission node multiplies its light."""
    from .values import is_constant, as_tuple, resolve
    node = next((n for n in tree.nodes if n.type == "EMISSION" and n.outputs[0].is_linked), None)
    if node is None:
        return
    colour, strength = (resolve(node.inputs[name]) for name in ("Color", "Strength"))
    if is_constant(colour) and is_constant(strength):
        for state in states:
            state.power = state.power * numpy.array(as_tuple(colour)) * as_number(strength)


def megabytes(size):
    return f"{size / 1e6:.1f} MB" if size >= 1e5 else f"{size / 1e3:.0f} kB"


def pattern_of(path):
    """The file with its last number as ####, if it or a file of its series exists; None without."""
    folder, name = os.path.split(path)
    found = list(re.finditer(r"\d+", os.path.splitext(name)[0]))
    if not os.path.isdir(folder):
        return None
    if found:
        a, b = found[-1].span()
        shape = re.compile(re.escape(name[:a]) + r"\d+" + re.escape(name[b:]) + "$")
        if any(shape.match(other) for other in os.listdir(folder)):
            return os.path.join(folder, name[:a] + "#" * (b - a) + name[b:])
    return path if os.path.isfile(path) else None

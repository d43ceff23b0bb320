"""What a render of each frame would see: objects, instances, lamps, cameras, materials, from the depsgraph of the render.

Blender gives this depsgraph only to render engines. So a render engine of our own "renders" the shot: in place of pixels it takes notes.
All that the render's state decides is thereby right: levels of subdivision, modifiers shown in the render, hidden objects, excluded
collections, instances of geometry nodes, particles and linked collections, constraints, drivers, simulations.
"""

import hashlib

import bpy
import numpy

from .cameras import camera_state
from .lamps import lamp_state
from .notes import Damage
from .shapes import read_shape

GEOMETRY = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
RAYS = 64, 36            # of the look that finds which share of the picture a thing covers


class Item:
    """An object or an instance over all frames."""

    def __init__(self, name, kind, original, instanced):
        self.name, self.kind, self.original, self.instanced = name, kind, original, instanced
        self.places, self.shapes, self.states = (
            {},
            {},
            {},
        )  # by frame: world matrix; key of the shape; of a lamp or camera
        self.flags, self.extras = set(), {}
        self.label = original.name                            # in what the user reads


class Record:
    """The shot: `items` by key, `shapes` by key, `looks[material][frame]` of materials that change."""

    def __init__(self, shot):
        self.shot, self.items, self.shapes, self.baking = shot, {}, {}, {}
        self.looks, self.materials, self.cameras = {}, {}, {}   # cameras: {frame: name of the scene's camera}
        self.fingerprints, self.changing, self.shares = {}, None, {}

    # ---- one frame ----

    def take(self, depsgraph, frame):
        seen = {}
        for instance in depsgraph.object_instances:
            thing = instance.object
            if not instance.show_self or thing is None:
                continue
            name = thing.name
            with self.shot.notes.guard(Damage.OBJECT, name, "is left out"):
                self.take_instance(depsgraph, frame, instance, thing, seen)
        self.take_materials(depsgraph, frame)
        self.take_camera(depsgraph, frame)

    def take_instance(self, depsgraph, frame, instance, thing, seen):
        kind = "mesh" if thing.type in GEOMETRY else thing.type.lower()
        original = thing.original if thing.original else thing
        parent = instance.parent.original if instance.is_instance and instance.parent else None
        numbers = tuple(n for n in instance.persistent_id if n not in (2 ** 31 - 1, -2 ** 31)) if parent else ()
        key = (parent.name_full if parent else "", numbers, original.name_full, kind)
        while key in seen:                                    # two geometries of one object
            key = (*key, "again")
        if kind not in ("mesh", "light", "camera"):
            self.take_other(original, kind)
            return
        if kind == "mesh" and not len(self.mesh_of(thing)):
            return
        seen[key] = True
        place = numpy.array(instance.matrix_world, "f8")
        if not numpy.isfinite(place).all():
            raise ValueError("its place is not a number")
        shape = state = None
        if kind == "mesh":
            shape = self.shape_key(depsgraph, thing, original, frame)
        elif kind == "light":
            state = lamp_state(thing.data, place)
        else:
            state = camera_state(thing, place, self.shot.scene)
        if key not in self.items:                             # all that may fail has been done
            name = original.name
            if parent is not None:
                name = f"{parent.name} {'' if parent == original else original.name + ' '}{'.'.join(map(str, numbers))}"
            item = Item(name.strip(), kind, original, parent is not None)
            item.extras, item.flags = own_properties(original), flags_of(original, self.shot.layer)
            self.items[key] = item
        item = self.items[key]
        item.places[frame] = place
        if shape is not None:
            item.shapes[frame] = shape
        else:
            item.states[frame] = state

    @staticmethod
    def mesh_of(thing):
        """Vertices of an evaluated mesh; of other kinds, that have no such list, something with a length."""
        return thing.data.vertices if thing.type == "MESH" else (0,)

    def take_other(self, original, kind):
        self.shot.others.setdefault(kind, {})[original.name] = original

    # ---- shapes ----

    def shape_key(self, depsgraph, thing, original, frame):
        """Key of what the object looks like at this frame; the shape is read when it is new."""
        slots = tuple(
            (slot.link, slot.material.original.name_full if slot.material else "") for slot in thing.material_slots
        )
        if thing.type == "MESH":
            mark = (fingerprint(thing.data), slots, thing.data.name)
            if mark in self.fingerprints:
                return self.fingerprints[mark]
            mesh, made = thing.data, False
        else:
            mesh, made = thing.to_mesh(), True
            mark = (fingerprint(mesh), slots, original.name_full)
        try:
            if mark not in self.fingerprints:
                shape = read_shape(mesh, thing)
                key = self.fingerprints[mark] = shape.key()
                self.shapes.setdefault(key, shape)
                for material in shape.materials:
                    if material:
                        self.materials.setdefault(material.name_full, material)
                self.keep_for_baking(depsgraph, thing, key)
        finally:
            if made:
                thing.to_mesh_clear()
        return self.fingerprints[mark]

    def keep_for_baking(self, depsgraph, thing, key):
        """A copy of the mesh with all that materials may read of it, if one of them may need to be baked."""
        if key in self.baking or not self.shot.needs_bake(self.shapes[key].materials):
            return
        topology = self.shapes[key].topology()
        if topology in self.baking:
            return
        mesh = bpy.data.meshes.new_from_object(thing, preserve_all_data_layers=True, depsgraph=depsgraph)
        shape = self.shapes[key]
        if len(mesh.loops) != len(shape.vertex):
            bpy.data.meshes.remove(mesh)
            return
        for slot, material in enumerate(shape.materials):      # those of the object, where they are not the mesh's
            if slot < len(mesh.materials):
                mesh.materials[slot] = material
            else:
                mesh.materials.append(material)
        self.baking[topology] = mesh, numpy.array(thing.matrix_world, "f8")

    # ---- materials, camera ----

    def take_materials(self, depsgraph, frame):
        """What changes in materials by frame: their own keys and drivers, and those of node groups."""
        for name, material in list(self.materials.items()):
            if not changes(material):
                continue
            with self.shot.notes.guard(Damage.MATERIAL, f"material {name}", "its changes are not exported"):
                self.looks.setdefault(name, {})[frame] = self.shot.look_of(material.evaluated_get(depsgraph))

    def take_camera(self, depsgraph, frame):
        bound = sorted((m for m in self.shot.scene.timeline_markers if m.camera), key=lambda m: m.frame)
        before = [m.camera for m in bound if m.frame <= frame]
        camera = before[-1] if before else bound[0].camera if bound else self.shot.camera
        if camera is None:
            return
        key = ("", (), camera.name_full, "camera")
        self.cameras[frame] = key
        item = self.items.get(key)
        if item is None or frame not in item.places:          # hidden from the render, which hides no camera
            evaluated = camera.evaluated_get(depsgraph)
            item = self.items.setdefault(key, Item(camera.name, "camera", camera, False))
            item.places[frame] = numpy.array(evaluated.matrix_world, "f8")
            item.states[frame] = camera_state(evaluated, item.places[frame], self.shot.scene)

    def look(self, depsgraph, frame):
        """Which share of the picture is covered by each object and material: first hits of a coarse grid of rays."""
        item = self.items.get(self.cameras.get(frame))
        if item is None:
            return
        from mathutils import Vector
        state, place, hits = item.states[frame], item.places[frame], {}
        for row in range(RAYS[1]):
            for column in range(RAYS[0]):
                origin, way = state.ray(place, (column + .5) / RAYS[0], (row + .5) / RAYS[1])
                found, _, _, face, thing, _ = depsgraph.scene.ray_cast(depsgraph, Vector(origin), Vector(way))
                if not found:
                    continue
                names = {thing.name}
                mesh = thing.evaluated_get(depsgraph).data
                if thing.type == "MESH" and 0 <= face < len(mesh.polygons):
                    slot = mesh.polygons[face].material_index
                    if slot < len(mesh.materials) and mesh.materials[slot]:
                        names.add("material " + mesh.materials[slot].name)
                for name in names:
                    hits[name] = hits.get(name, 0) + 1
        self.shares = {name: n / (RAYS[0] * RAYS[1]) for name, n in hits.items()}


def fingerprint(mesh):
    """Of positions and texture coordinates: another one, another shape."""
    digest = hashlib.blake2b(digest_size=16)
    points = numpy.empty(3 * len(mesh.vertices), "f4")
    mesh.vertices.foreach_get("co", points)
    digest.update(points)
    digest.update(str((len(mesh.loops), len(mesh.polygons))).encode())
    for layer in mesh.uv_layers:
        coordinates = numpy.empty(2 * len(mesh.loops), "f4")
        layer.data.foreach_get("uv", coordinates)
        digest.update(coordinates)
    return digest.digest()


def changes(material):
    """Can a material's values change by frame?"""
    trees, seen = [material, material.node_tree], set()
    while trees:
        tree = trees.pop()
        if tree is None or tree in seen:
            continue
        seen.add(tree)
        motion = tree.animation_data
        if motion and (motion.action or motion.drivers or motion.nla_tracks):
            return True
        trees += [node.node_tree for node in getattr(tree, "nodes", ()) if node.type == "GROUP"]
    return False


def own_properties(thing):
    """Custom properties that JSON can hold, which go into the node's extras."""
    found = {}
    for key in thing.keys():
        value = thing[key]
        value = value.to_list() if hasattr(value, "to_list") else value
        if (
            isinstance(value, (bool, int, float, str))
            or isinstance(value, list)
            and all(isinstance(v, (int, float, str)) for v in value)
        ):
            found[key] = value
    return found


def flags_of(original, layer):
    """What Cycles hides of an object from which rays, and what it is in a compositor's hands."""
    flags = {
        name
        for name in (
            "visible_camera",
            "visible_diffuse",
            "visible_glossy",
            "visible_transmission",
            "visible_volume_scatter",
            "visible_shadow",
        )
        if not getattr(original, name, True)
    }
    if getattr(original, "is_shadow_catcher", False):
        flags.add("is_shadow_catcher")
    for flag, ask in (("holdout", "holdout_get"), ("indirect_only", "indirect_only_get")):
        try:
            if getattr(original, ask)(view_layer=layer):
                flags.add(flag)
        except (AttributeError, RuntimeError, TypeError):
            pass
    if getattr(original, "is_holdout", False):
        flags.add("holdout")
    linking = getattr(original, "light_linking", None)
    if linking and (linking.receiver_collection or linking.blocker_collection):
        flags.add("light_linking")
    return flags


TIMED = {
    "WAVE",
    "OCEAN",
    "BUILD",
    "MESH_CACHE",
    "MESH_SEQUENCE_CACHE",
    "NODES",
    "CLOTH",
    "SOFT_BODY",
    "FLUID",
    "DYNAMIC_PAINT",
    "EXPLODE",
    "PARTICLE_SYSTEM",
    "PARTICLE_INSTANCE",
    "COLLISION",
    "SURFACE",
}  # modifiers that may follow the time without a key


def stands_still(scene):
    """Can nothing change from frame to frame? Then one frame is enough."""
    if scene.rigidbody_world or len(bpy.data.actions) or any(m.camera for m in scene.timeline_markers):
        return False
    owners = [
        block
        for name in (
            "objects",
            "meshes",
            "materials",
            "node_groups",
            "lights",
            "cameras",
            "worlds",
            "curves",
            "shape_keys",
            "scenes",
            "armatures",
            "lattices",
            "metaballs",
        )
        for block in getattr(bpy.data, name, ())
    ]
    owners += [block.node_tree for block in owners if getattr(block, "node_tree", None)]
    if any(
        o.animation_data and (o.animation_data.drivers or o.animation_data.action or o.animation_data.nla_tracks)
        for o in owners
    ):
        return False
    if any(image.source in ("SEQUENCE", "MOVIE") for image in bpy.data.images):
        return False
    return not any(m.type in TIMED for thing in bpy.data.objects for m in thing.modifiers)


# ---- the render engine -------------------------------------------------------------------------------------

class TempoluxRecorder(bpy.types.RenderEngine):
    bl_idname, bl_label, bl_use_preview = "TEMPOLUX_RECORD", "tempolux export", False
    job, trouble = None, None

    def render(self, depsgraph):
        kind = type(self)
        try:
            if kind.job:
                kind.job(self, depsgraph)
        except BaseException as trouble:   # noqa: BLE001: Blender would print it and go on
            kind.trouble = trouble
        finally:
            kind.job = None                # one view layer


def record(shot):
    """Walks through the frames of the shot."""
    result, scene = Record(shot), shot.scene

    def walk(engine, depsgraph):
        frames = shot.frames()
        for frame in frames:
            engine.frame_set(frame, 0.0)
            result.take(depsgraph, frame)
            if frame == shot.look_frame():
                with shot.notes.guard(Damage.DETAIL, "the scene", "shares of the picture are not known"):
                    result.look(depsgraph, frame)

    bpy.utils.register_class(TempoluxRecorder)
    render = scene.render
    kept = {
        name: getattr(render, name)
        for name in ("engine", "use_compositing", "use_sequencer", "use_multiview", "filepath")
    }
    frame, eye, used = scene.frame_current, None, shot.layer.use
    TempoluxRecorder.job, TempoluxRecorder.trouble = walk, None
    try:
        render.engine, shot.layer.use = "TEMPOLUX_RECORD", True
        render.use_compositing = render.use_sequencer = render.use_multiview = False
        if scene.camera is None:               # Blender renders nothing without one
            eye = scene.camera = bpy.data.objects.new("tempolux record", bpy.data.cameras.new("tempolux record"))
            shot.notes.lost(Damage.CAMERA, "the scene", "has no camera: tempolux looks at all of it")
        bpy.ops.render.render(scene=scene.name, layer=shot.layer.name)
        if TempoluxRecorder.job == walk:
            bpy.ops.render.render(scene=scene.name)
        if TempoluxRecorder.job == walk:
            raise RuntimeError("Blender renders no view layer of this scene")
    finally:
        if eye:
            scene.camera = None
            bpy.data.objects.remove(eye)
        shot.layer.use = used
        for name, value in kept.items():
            setattr(render, name, value)
        scene.frame_set(frame)
        bpy.utils.unregister_class(TempoluxRecorder)
    if TempoluxRecorder.trouble:
        raise TempoluxRecorder.trouble
    return result

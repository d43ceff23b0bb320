"""Exports a shot of Blender so that tempolux renders what Cycles shows. Page: docs/from-blender.md

    blender -b shot.blend -P tempolux_export.py -- shot.glb     # as a script; the .blend is not changed
    Edit > Preferences > Add-ons > Install, this file           # as an add-on: File > Export > tempolux (.glb)

Written: shot.glb, and shot_world.exr where the world is more than one colour. Printed: what could not be kept, and the make line that
renders the shot. What glTF or its exporter would lose is turned into what they keep, in a scene that is thrown away afterwards:

- shaders other than Principled become the Principled shader that is like them; glass of closed bodies is solid;
- motion by constraints, drivers, NLA strips and bones becomes keys, one a frame; frames keep their numbers;
- area lamps become emitting meshes, point lamps with a radius small balls, of the radiance that Cycles gives them;
- the world becomes an environment map, or a colour;
- lamps keep Blender's watts (lighting mode Unitless: nothing is multiplied by 683);
- the camera's lens, sensor, aperture and the shutter become extras of its node.

Written over an export of before, the file keeps the numbers that have not moved (STILL): Blender's last bits and the order of its triangles
differ from export to export, and each would be another scene, whose light is computed anew.
"""
import json
import math
import os
import shlex
import struct
import sys
import tempfile

import bpy
from mathutils import Matrix

bl_info = {"name": "tempolux export", "author": "tempolux", "version": (1, 0), "blender": (3, 4, 0), "category": "Import-Export",
           "location": "File > Export > tempolux (.glb)", "description": "Export a shot for tempolux"}

BALL_STEPS = 3           # of an icosphere: 642 corners; its mean outline is .6 % less than the ball's, which its radiance makes up for
WORLD_WIDTH = 1024       # pixels of the environment map
STILL = 1e-6             # what differs by less from the export before, as a share of its size, has not moved


class Shot:
    """One export: what was printed, and the names of what was made."""

    def __init__(self, scene, path):
        self.scene, self.path = scene, os.path.abspath(path)
        self.notes, self.sky, self.world_file = [], None, None

    def note(self, text):
        if text not in self.notes:
            self.notes.append(text)

    def frames(self):
        return range(self.scene.frame_start, self.scene.frame_end + 1)


def instanced(scene):
    """Objects of collections that are instanced, which the scene's own list does not have."""
    found, groups = {}, [item.instance_collection for item in scene.objects if item.instance_collection]
    while groups:
        for item in groups.pop().all_objects:
            if item not in found:
                found[item] = True
                groups += [item.instance_collection] if item.instance_collection else []
    return [item for item in found if item.name not in scene.objects]


# ---- motion -----------------------------------------------------------------------------------------------

def is_driven(item):
    """Does something other than keys of its own action, or a plain parent, move it?"""
    motion = item.animation_data
    strips = motion and item.type != "ARMATURE" and motion.nla_tracks
    return (bool(item.constraints) or bool(motion and motion.drivers) or bool(strips)
            or (item.parent and item.parent_type not in ("OBJECT", "ARMATURE")))


def drop_muted_tracks(scene):
    """The glTF exporter writes muted tracks as animations, too; Blender does not play them. (Its importer mutes all but one.)"""
    for item in scene.objects:
        for owner in (item, getattr(item.data, "shape_keys", None)):
            motion = owner.animation_data if owner else None
            for track in list(motion.nla_tracks) if motion else ():
                if track.mute:
                    motion.nla_tracks.remove(track)


def sampled(shot, items):
    """World matrices by frame of each object, all constraints and drivers at work."""
    places = {item: [] for item in items}
    for frame in shot.frames():
        shot.scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for item in items:
            places[item].append(item.evaluated_get(graph).matrix_world.copy())
    return places


def moves(places):
    return any(abs(a - b) > 1e-6 * max(1.0, abs(a)) for m in places[1:] for r, s in zip(places[0], m) for a, b in zip(r, s))


def bake_motion(shot):
    """Driven objects get keys in world space, one a frame, and lose parent, constraints and drivers. Children stay with them."""
    driven = [item for item in shot.scene.objects if is_driven(item)]
    for item, places in sampled(shot, driven).items():
        if item.animation_data:
            item.animation_data_clear()
        item.constraints.clear()
        item.parent = None
        item.matrix_parent_inverse = Matrix.Identity(4)
        item.rotation_mode = "QUATERNION"
        item.delta_location, item.delta_scale = (0, 0, 0), (1, 1, 1)
        item.delta_rotation_euler, item.delta_rotation_quaternion = (0, 0, 0), (1, 0, 0, 0)
        before = None
        for frame, place in zip(shot.frames(), places):
            where, turned, scale = place.decompose()
            if before and before.dot(turned) < 0:
                turned.negate()
            before = turned
            item.location, item.rotation_quaternion, item.scale = where, turned, scale
            if not moves(places):
                break
            for channel in ("location", "rotation_quaternion", "scale"):
                item.keyframe_insert(channel, frame=frame)
        if item.animation_data and item.animation_data.action:
            for curve in item.animation_data.action.fcurves:
                for key in curve.keyframe_points:
                    key.interpolation = "LINEAR"


# ---- lamps ------------------------------------------------------------------------------------------------

def emitter(name, colour, radiance):
    """A material that emits from its front and reflects nothing."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
    shader.inputs["Specular"].default_value = 0
    shader.inputs["Roughness"].default_value = 1
    top = max(max(colour), 1e-9)
    shader.inputs["Emission"].default_value = (*(c / top for c in colour), 1)
    shader.inputs["Emission Strength"].default_value = radiance * top
    return material


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
    """Corners and faces of an icosphere, and the ball's outline by its own, in the mean: a quarter of the surface of each."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=BALL_STEPS, radius=radius)
    made = bpy.context.object
    mesh = made.data
    bpy.data.objects.remove(made)
    return mesh, 4 * math.pi * radius ** 2 / sum(face.area for face in mesh.polygons)


def replace_lamp(shot, item):
    """A mesh of a lamp's shape and light in the lamp's place, or nothing where glTF has such a lamp."""
    item.data = lamp = item.data.copy()   # others may use it
    scale = item.matrix_world.median_scale
    if lamp.type == "AREA":
        corners = outline(lamp)
        mesh = bpy.data.meshes.new(item.name)
        mesh.from_pydata(corners, [], [list(range(len(corners)))])
        radiance = lamp.energy / (4 * area_of(corners) * scale ** 2)   # Cycles: W/m^2/sr of an area lamp of so many watts
        if lamp.spread < math.pi - 1e-3:
            shot.note(f"{item.name}: spread of an area lamp is not kept: it shines to all sides")
    elif lamp.type == "POINT" and lamp.shadow_soft_size > 0:
        mesh, larger = ball(lamp.shadow_soft_size / scale)             # a lamp's radius is in metres, whatever its object's scale
        radiance = larger * lamp.energy / (4 * math.pi ** 2 * lamp.shadow_soft_size ** 2)
    else:
        if lamp.type == "SPOT" and lamp.shadow_soft_size > 0:
            shot.note(f"{item.name}: a spot lamp has no radius in glTF: its shadows are sharp")
        if lamp.type == "SUN" and lamp.angle > 0.001:
            shot.note(f"{item.name}: a sun has no angle in glTF: its shadows are sharp; the sun in the world's map has one")
        return
    mesh.materials.clear()
    mesh.materials.append(emitter(item.name, lamp.color, radiance))
    body = bpy.data.objects.new(item.name + " (light)", mesh)
    for collection in item.users_collection:
        collection.objects.link(body)
    body.parent = item   # the lamp's motion, whatever it is made of
    if lamp.animation_data and lamp.animation_data.action:
        shot.note(f"{item.name}: changes of a lamp's power or colour are not exported; its light is that of frame {shot.scene.frame_current}")
    lamp.type, lamp.energy = "POINT", 0   # taken out of the file (sign)


def replace_lamps(shot):
    shot.scene.frame_set(shot.scene.frame_start)
    for item in [i for i in shot.scene.objects if i.type == "LIGHT" and not i.hide_render]:
        if item.data.use_nodes and any(n.type not in ("EMISSION", "OUTPUT_LIGHT") for n in item.data.node_tree.nodes):
            shot.note(f"{item.name}: nodes of a lamp are not kept, but its power and colour")
        replace_lamp(shot, item)


# ---- world ------------------------------------------------------------------------------------------------

def plain_colour(world):
    """Radiance of a world of one colour; None if there is more to it."""
    if not world.use_nodes:
        return tuple(world.color)
    output = next((n for n in world.node_tree.nodes if n.type == "OUTPUT_WORLD" and n.is_active_output), None)
    shader = output.inputs["Surface"].links[0].from_node if output and output.inputs["Surface"].links else None
    if shader is None:
        return (0.0, 0.0, 0.0)
    if shader.type != "BACKGROUND" or any(i.is_linked for i in shader.inputs):
        return None
    strength = shader.inputs["Strength"].default_value
    return tuple(c * strength for c in shader.inputs["Color"].default_value[:3])


def bake_world(shot):
    """Cycles renders the world alone, all around: the map's middle column is glTF's +z, Blender's -y (formats/conventions.md)."""
    if shot.scene.world is None:
        return
    colour = plain_colour(shot.scene.world)
    if colour is not None:
        shot.sky = colour if max(colour) > 0 else None
        return
    stage = bpy.data.scenes.new("tempolux world")
    stage.world = shot.scene.world
    stage.render.engine = "CYCLES"
    stage.cycles.samples, stage.cycles.use_denoising, stage.cycles.device = 16, False, "CPU"
    stage.cycles.pixel_filter_type = "BOX"
    stage.render.resolution_x, stage.render.resolution_y, stage.render.resolution_percentage = WORLD_WIDTH, WORLD_WIDTH // 2, 100
    stage.render.film_transparent = False
    stage.render.image_settings.file_format, stage.render.image_settings.color_depth = "OPEN_EXR", "32"
    stage.render.image_settings.color_mode = "RGB"
    lens = bpy.data.cameras.new("tempolux world")
    lens.type, lens.cycles.panorama_type = "PANO", "EQUIRECTANGULAR"
    eye = bpy.data.objects.new("tempolux world", lens)
    eye.rotation_euler = (math.pi / 2, 0, math.pi)   # looks along -y
    stage.collection.objects.link(eye)
    stage.camera = eye
    shot.world_file = os.path.splitext(shot.path)[0] + "_world.exr"
    stage.render.filepath = shot.world_file
    bpy.ops.render.render(write_still=True, scene=stage.name)
    bpy.data.scenes.remove(stage)


# ---- materials --------------------------------------------------------------------------------------------

# Inputs of the Principled shader that stands for another: fixed values, and {its input: the other's}. glTF's exporter knows no other
# shader: all else would become white metal.
SHADERS = {
    "BSDF_DIFFUSE": ({"Specular": 0, "Roughness": 1}, {"Base Color": "Color", "Normal": "Normal"}),
    "BSDF_GLOSSY": ({"Metallic": 1}, {"Base Color": "Color", "Roughness": "Roughness", "Normal": "Normal"}),
    "BSDF_GLASS": ({"Transmission": 1}, {"Base Color": "Color", "Roughness": "Roughness", "IOR": "IOR", "Normal": "Normal"}),
    "BSDF_REFRACTION": ({"Transmission": 1}, {"Base Color": "Color", "Roughness": "Roughness", "IOR": "IOR", "Normal": "Normal"}),
    "EMISSION": ({"Base Color": (0, 0, 0, 1), "Specular": 0, "Roughness": 1}, {"Emission": "Color", "Emission Strength": "Strength"}),
}
WRITTEN = {"TEX_IMAGE", "SEPRGB", "SEPARATE_COLOR", "NORMAL_MAP", "VERTEX_COLOR", "ATTRIBUTE", "RGB", "VALUE", "MIX", "MIX_RGB", "MATH",
           "REROUTE"}   # nodes that the exporter of Blender 3.4 can follow
LEFT_OUT = ("Subsurface", "Anisotropic", "Specular Tint", "Transmission Roughness")


def shaders_below(node):
    """The shader, or those that Mix and Add Shader are made of, first things first."""
    if node.type not in ("MIX_SHADER", "ADD_SHADER"):
        return [node]
    return [found for socket in node.inputs if socket.type == "SHADER" and socket.links for found in shaders_below(socket.links[0].from_node)]


def principled(shot, material):
    """The Principled shader of a material; one is made in place of a shader that is like it. None if there is none."""
    tree = material.node_tree
    output = tree.get_output_node("CYCLES") or tree.get_output_node("ALL")
    if not output or not output.inputs["Surface"].links:
        return None
    top = output.inputs["Surface"].links[0].from_node
    parts = shaders_below(top)
    node = next((part for part in parts if part.type == "BSDF_PRINCIPLED" or part.type in SHADERS), None)
    if node is None:
        shot.note(f"material {material.name}: {top.bl_label} is not exported: it becomes grey; use Principled BSDF")
        node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    elif len(parts) > 1:
        shot.note(f"material {material.name}: of its {len(parts)} shaders only {node.bl_label} is exported; use one Principled BSDF")
    if node.type in SHADERS:
        fixed, like = SHADERS[node.type]
        made = tree.nodes.new("ShaderNodeBsdfPrincipled")
        for name, value in fixed.items():
            made.inputs[name].default_value = value
        for name, other in like.items():
            if node.inputs[other].links:
                tree.links.new(node.inputs[other].links[0].from_socket, made.inputs[name])
            elif name != "Normal":
                made.inputs[name].default_value = node.inputs[other].default_value
        node = made
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    return node


def nodes_before(socket):
    """All nodes that an input is computed by, up to images."""
    for link in socket.links:
        yield link.from_node
        for before in link.from_node.inputs if link.from_node.type != "TEX_IMAGE" else ():
            yield from nodes_before(before)


def keep_materials(shot):
    """Every material gets a Principled shader that the exporter can write; what it cannot write is named."""
    used = {slot.material for item in [*shot.scene.objects, *instanced(shot.scene)] if not item.hide_render
            for slot in item.material_slots if slot.material}
    for material in sorted((m for m in used if m.use_nodes), key=lambda m: m.name):
        shader = principled(shot, material)
        for socket in shader.inputs if shader else ():
            lost = sorted({node.bl_label for node in nodes_before(socket)} - {"Image Texture"}) \
                if any(node.type not in WRITTEN for node in nodes_before(socket)) else []
            if lost:
                shot.note(f"material {material.name}: {socket.name} by {', '.join(lost)} is not exported, but the plain value of the input; "
                          "bake it to an image")
                material.node_tree.links.remove(socket.links[0])
        extra = [name for name in LEFT_OUT if shader and (shader.inputs[name].links or shader.inputs[name].default_value > 0)]
        if extra:
            shot.note(f"material {material.name}: {', '.join(extra)} of Principled is not exported")


# ---- glass ------------------------------------------------------------------------------------------------

def transmission_of(material):
    """The Transmission input of a material's Principled shader: its value, 1 if something is linked to it, 0 without such a shader."""
    nodes = material.node_tree.nodes if material and material.use_nodes else ()
    inputs = [node.inputs["Transmission"] for node in nodes if node.type == "BSDF_PRINCIPLED"]
    return max((1.0 if i.is_linked else i.default_value for i in inputs), default=0.0)


def volume_and_area(mesh):
    """(volume, area) of a mesh in its own space, by its triangles; volume None where it is not closed: an edge without two faces."""
    uses = {}
    for face in mesh.polygons:
        for key in face.edge_keys:
            uses[key] = uses.get(key, 0) + 1
    area = sum(face.area for face in mesh.polygons)
    if not uses or any(n != 2 for n in uses.values()):
        return None, area
    mesh.calc_loop_triangles()
    corner = [vertex.co for vertex in mesh.vertices]
    six = sum(corner[a].dot(corner[b].cross(corner[c])) for a, b, c in (t.vertices for t in mesh.loop_triangles))
    return abs(six) / 6, area


def find_solid_glass(shot):
    """{material's name: thickness}: glass of closed meshes is solid, as it is in Cycles; glTF wants a thickness to know. It is the mean
    chord of a body, 4 volume / area (Cauchy), which viewers without refraction use. Glass of open meshes stays a thin sheet."""
    solid, sheets = {}, {}
    graph = bpy.context.evaluated_depsgraph_get()
    for item in [*shot.scene.objects, *instanced(shot.scene)]:
        glass = {slot.material.name for slot in item.material_slots if slot.material and transmission_of(slot.material) > 0}
        if not glass or item.hide_render or item.type not in ("MESH", "CURVE", "SURFACE", "FONT", "META"):
            continue
        body = item.evaluated_get(graph)
        volume, area = volume_and_area(body.to_mesh())
        body.to_mesh_clear()
        for name in glass:
            if volume is None:
                sheets[name] = item.name
            else:
                solid.setdefault(name, 4 * volume / max(area, 1e-30))
    for name in set(solid) & set(sheets):
        del solid[name]
        shot.note(f"material {name}: {sheets[name]} has it and is open, so all that have it become thin sheets of glass; give closed bodies "
                  "a material of their own")
    return solid


# ---- camera, what is lost, the file ------------------------------------------------------------------------

def describe_cameras(shot):
    for item in shot.scene.objects:
        if item.type != "CAMERA":
            continue
        lens = item.data
        item["lens_mm"], item["sensor_width_mm"] = lens.lens, lens.sensor_width
        item["shutter_frames"] = shot.scene.render.motion_blur_shutter if shot.scene.render.use_motion_blur else 0.0
        if lens.dof.use_dof:
            item["f_stop"] = lens.dof.aperture_fstop
            shot.note(f"{item.name}: depth of field is not rendered (f-stop kept in extras)")
        if lens.animation_data and lens.animation_data.action:
            shot.note(f"{item.name}: changes of a camera's lens are not exported")
    if shot.scene.render.use_motion_blur:
        shot.note("motion blur is not rendered (shutter kept in the camera's extras)")


def list_losses(shot):
    for item in shot.scene.objects:
        if item.hide_render:
            continue
        if item.type in ("VOLUME", "GPENCIL", "CURVES", "HAIR", "POINTCLOUD"):
            shot.note(f"{item.name}: {item.type.lower()} is not exported" + ("; give its files by VOLUME=smoke.####.vdb" if item.type == "VOLUME" else ""))
        if item.particle_systems:
            shot.note(f"{item.name}: particles and hair are not exported; make them meshes")
        curves = item.animation_data.action.fcurves if item.animation_data and item.animation_data.action else []
        if any(curve.data_path in ("hide_render", "hide_viewport") for curve in curves):
            shot.note(f"{item.name}: being there or not is not exported; scale it to 0 instead")
    for item in instanced(shot.scene):
        if item.type == "LIGHT" and (item.data.type == "AREA" or item.data.type == "POINT" and item.data.shadow_soft_size > 0):
            shot.note(f"{item.name}: this lamp in an instanced collection " + ("is not exported" if item.data.type == "AREA" else "has no radius")
                      + "; use Object > Apply > Make Instances Real")
    for material in bpy.data.materials:
        tree = material.node_tree
        if material.users and tree and tree.animation_data and tree.animation_data.action:
            shot.note(f"material {material.name}: changes over time are not exported")


def write_gltf(shot, solid):
    words = dict(filepath=shot.path, export_format="GLB", export_cameras=True, export_lights=True, export_extras=True, export_apply=True,
                 export_yup=True, use_renderable=True, use_active_scene=True, export_animations=True, export_frame_range=True,
                 export_force_sampling=True, export_tangents=False)
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    for name in ("convert_lighting_mode", "export_import_convert_lighting_mode"):
        if name in known:
            words[name] = "COMPAT"   # watts as Blender has them
    bpy.ops.export_scene.gltf(**{k: v for k, v in words.items() if k in known})
    sign(shot.path, solid)


def make_solid(document, solid):
    """Gives a thickness to the glass of closed bodies, unless the file has one."""
    for material in document.get("materials", []):
        thickness, extensions = solid.get(material.get("name")), material.get("extensions", {})
        if thickness and "KHR_materials_transmission" in extensions and "KHR_materials_volume" not in extensions:
            extensions["KHR_materials_volume"] = {"thicknessFactor": thickness}
            if "KHR_materials_volume" not in document["extensionsUsed"]:
                document["extensionsUsed"].append("KHR_materials_volume")


def sign(path, solid):
    """The file says that its lamps are not multiplied (lib/scene/light_units.h); lamps that became meshes are taken out. Specular 0 is
    none at all: the exporter blackens its colour, which leaves a gloss at grazing angles that takes 20 % of a wall's light. `solid`: of
    find_solid_glass."""
    data = open(path, "rb").read()
    size = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20:20 + size])
    document["asset"]["generator"] += ", tempolux_export"
    for material in document.get("materials", []):
        gloss = material.get("extensions", {}).get("KHR_materials_specular")
        if gloss and max(gloss.get("specularColorFactor", [1])) == 0:
            gloss["specularFactor"] = 0
    make_solid(document, solid)
    lights = document.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    dark = {i for i, light in enumerate(lights) if light.get("intensity", 1) == 0}
    numbers = {old: new for new, old in enumerate(i for i in range(len(lights)) if i not in dark)}
    for node in document.get("nodes", []):
        use = node.get("extensions", {}).get("KHR_lights_punctual")
        if use is None:
            continue
        if use["light"] in numbers:
            use["light"] = numbers[use["light"]]
            continue
        del node["extensions"]["KHR_lights_punctual"]
        if not node["extensions"]:
            del node["extensions"]
    if dark:
        document["extensions"]["KHR_lights_punctual"]["lights"] = [light for i, light in enumerate(lights) if i not in dark]
        if not numbers:
            del document["extensions"]["KHR_lights_punctual"]
            if not document["extensions"]:
                del document["extensions"]
            for words in ("extensionsUsed", "extensionsRequired"):
                if "KHR_lights_punctual" in document.get(words, []):
                    document[words].remove("KHR_lights_punctual")
                    if not document[words]:
                        del document[words]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size:]
    with open(path, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)) + struct.pack("<I4s", len(text), b"JSON") + text + rest)


# ---- what has not moved since the last export ----------------------------------------------------------------

def read_glb(path):
    data = open(path, "rb").read()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), bytearray(data[28 + size:])


def column(document, binary, number):
    """An accessor as an array (elements, components) that lies in `binary`; None where it is sparse or interleaved."""
    import numpy
    accessor = document["accessors"][number]
    kinds = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
    parts = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
    if "bufferView" not in accessor or "sparse" in accessor or accessor["type"] not in parts:
        return None
    view = document["bufferViews"][accessor["bufferView"]]
    if "byteStride" in view:
        return None
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    shape = accessor["count"], parts[accessor["type"]]
    return numpy.frombuffer(binary, kinds[accessor["componentType"]], shape[0] * shape[1], start).reshape(shape)


def near(a, b):
    import numpy
    if a is None or b is None or a.shape != b.shape or a.dtype != b.dtype:
        return False
    if a.dtype.kind != "f":
        return bool((a == b).all())
    extent = float(max(numpy.ptp(a, axis=0).max(), abs(a).max())) if a.size else 0
    return bool((abs(a - b) <= STILL * extent).all())


def corners(document, binary, primitive):
    """All attributes at each corner of each triangle: (triangles, 3, numbers). None where a column cannot be read."""
    import numpy
    columns = [column(document, binary, i) for _, i in sorted(primitive["attributes"].items(), key=lambda item: (item[0] != "POSITION", item[0]))]
    order = column(document, binary, primitive["indices"]) if "indices" in primitive else None
    if order is None or any(c is None or c.dtype.kind != "f" for c in columns) or len(order) % 3:
        return None
    rows = numpy.concatenate(columns, axis=1)
    return rows[order[:, 0].astype(int)].reshape(-1, 3, rows.shape[1])


def in_one_order(a, b):
    """Two lists of triangles, both in an order that neither the file's order nor the last bits change: by ranks of the numbers of both, where numbers that
    follow each other by less than what counts as still have one rank."""
    import numpy
    both = numpy.concatenate([a.reshape(-1, a.shape[2]), b.reshape(-1, b.shape[2])])
    ranks = numpy.empty(both.shape, int)
    for k in range(both.shape[1]):
        size = abs(both[:, :3] if k < 3 else both[:, 3:]).max()   # of positions; of all else
        order = numpy.argsort(both[:, k], kind="stable")
        steps = numpy.diff(both[order, k]) > STILL * float(size)
        ranks[order, k] = numpy.concatenate([[0], numpy.cumsum(steps)])
    def ordered(rows, ranks):
        ranks = ranks.reshape(rows.shape)
        first = numpy.lexsort(numpy.moveaxis(ranks, 2, 0)[::-1], axis=-1)[:, :1]     # each triangle from its least corner on
        index = numpy.arange(len(rows))[:, None], (numpy.arange(3) + first) % 3
        return rows[index][numpy.lexsort(ranks[index].reshape(len(rows), -1).T[::-1])]
    return ordered(a, ranks[:a.shape[0] * 3]), ordered(b, ranks[a.shape[0] * 3:])


def same_triangles(new, old, a, b):
    before, after = corners(*old, b), corners(*new, a)
    if before is None or after is None or before.shape != after.shape:
        return False
    before, after = in_one_order(before, after)
    return near(after[..., :3].reshape(-1, 3), before[..., :3].reshape(-1, 3)) and near(after[..., 3:].reshape(len(after), -1),
                                                                                         before[..., 3:].reshape(len(before), -1))


def settle_primitive(new, old, a, b):
    """Puts the old numbers of a primitive in place of the new ones if they are the same triangles."""
    uses = [(a["attributes"][k], b["attributes"].get(k)) for k in a["attributes"]] + [(a.get("indices"), b.get("indices"))]
    pairs = [(column(*new, i), column(*old, j)) for i, j in uses if i is not None and j is not None]
    if len(pairs) != len(uses) or any(x is None or y is None or x.shape != y.shape or x.dtype != y.dtype for x, y in pairs):
        return
    if not all(near(x, y) for x, y in pairs) and not same_triangles(new, old, a, b):
        return
    for (i, j), (x, y) in zip(uses, pairs):
        x[:] = y
        for bound in ("min", "max"):
            if bound in old[0]["accessors"][j]:
                new[0]["accessors"][i][bound] = old[0]["accessors"][j][bound]


def settled(new, old):
    """JSON with the old numbers where they have not moved."""
    if isinstance(new, dict) and isinstance(old, dict):
        return {key: settled(value, old.get(key)) for key, value in new.items()}
    if isinstance(new, list) and isinstance(old, list) and len(new) == len(old):
        numbers = [abs(v) for v in new if isinstance(v, float)]
        if numbers and len(numbers) == len(new) and all(isinstance(v, (int, float)) for v in old):
            return old if all(abs(a - b) <= STILL * max(numbers) for a, b in zip(new, old)) else new
        return [settled(a, b) for a, b in zip(new, old)]
    if isinstance(new, float) and isinstance(old, (int, float)):
        return old if abs(new - old) <= STILL * abs(new) else new
    return new


def settle(path, before):
    """Rewrites the file with the numbers of the export before, (document, binary), where nothing has moved."""
    new, old = read_glb(path), before
    by_name = {mesh.get("name"): mesh for mesh in old[0].get("meshes", [])}
    for mesh in new[0].get("meshes", []):
        same = by_name.get(mesh.get("name"), {"primitives": []})
        for a, b in zip(mesh["primitives"], same["primitives"]):
            settle_primitive(new, old, a, b)
    curves = {animation.get("name"): animation for animation in old[0].get("animations", [])}
    for animation in new[0].get("animations", []):
        for a, b in zip(animation["samplers"], curves.get(animation.get("name"), {"samplers": []})["samplers"]):
            for end in ("input", "output"):
                x, y = column(*new, a[end]), column(*old, b[end])
                if near(x, y):
                    x[:] = y
    document, binary = settled(new[0], old[0]), new[1]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON") + text)
        out.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def make_line(shot):
    render = shot.scene.render
    width, height = (int(side * render.resolution_percentage / 100) for side in (render.resolution_x, render.resolution_y))
    name = os.path.splitext(os.path.basename(shot.path))[0]
    words = [f"SCENE={shot.path}", f"FRAMES={shot.scene.frame_start}-{shot.scene.frame_end}", f"SIZE={width}x{height}", f"OUT={name}", "QUALITY=draft"]
    options = []
    rate = render.fps / render.fps_base
    if abs(rate - 24) > 1e-6:
        options.append(f"--fps {rate:g}")
    if shot.sky:
        words.append("SKY=" + ",".join(f"{c:.6g}" for c in shot.sky))
    if options:
        words.append("TIME=" + " ".join(options))
    if shot.world_file:
        words.append(f"ENVIRONMENT={shot.world_file}")
    if sum(item.type == "CAMERA" for item in shot.scene.objects) > 1 and shot.scene.camera:
        words.append(f"CAMERA={shot.scene.camera.name}")
    return "make -f Makefile.example " + " ".join(map(shlex.quote, words))


def export(scene, path):
    """Writes the files; returns notes and the make line. Changes the open file: undo, or do not save."""
    shot = Shot(scene, path)
    if bpy.context.object and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    list_losses(shot)
    keep_materials(shot)
    solid = find_solid_glass(shot)
    drop_muted_tracks(scene)
    bake_motion(shot)
    replace_lamps(shot)
    bake_world(shot)
    describe_cameras(shot)
    try:
        before = read_glb(shot.path)
    except (OSError, ValueError, struct.error):
        before = None   # none, or no .glb
    write_gltf(shot, solid)
    if before:
        settle(shot.path, before)
    return shot.notes, make_line(shot)


# ---- as an add-on, as a script ------------------------------------------------------------------------------

class ExportTempolux(bpy.types.Operator):
    """Export a shot for tempolux; the scene is as before afterwards"""
    bl_idname, bl_label, bl_options = "export_scene.tempolux", "Export for tempolux", {"UNDO"}
    filepath: bpy.props.StringProperty(subtype="FILE_PATH", default="shot.glb")

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        bpy.ops.ed.undo_push(message="before the export for tempolux")
        notes, line = export(context.scene, bpy.path.ensure_ext(self.filepath, ".glb"))
        bpy.ops.ed.undo_push(message="export for tempolux")
        bpy.ops.ed.undo()
        for text in notes:
            self.report({"WARNING"}, text)
        self.report({"INFO"}, line)
        print(line)
        return {"FINISHED"}


def menu(self, context):
    self.layout.operator(ExportTempolux.bl_idname, text="tempolux (.glb)")


def register():
    bpy.utils.register_class(ExportTempolux)
    bpy.types.TOPBAR_MT_file_export.append(menu)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(menu)
    bpy.utils.unregister_class(ExportTempolux)


class Quiet:
    """Keeps what Blender prints from the terminal, hundreds of lines, and shows it if the export fails."""

    def __enter__(self):
        sys.stdout.flush()
        self.terminal, self.said = os.dup(1), tempfile.TemporaryFile()
        os.dup2(self.said.fileno(), 1)

    def __exit__(self, kind, *_):
        sys.stdout.flush()
        os.dup2(self.terminal, 1)
        os.close(self.terminal)
        if kind:
            self.said.seek(0)
            sys.stderr.write(self.said.read().decode(errors="replace"))


def main():
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if len(words) != 1 or not words[0].endswith(".glb"):
        sys.exit("tempolux_export.py: name the file to write: blender -b shot.blend -P tempolux_export.py -- shot.glb")
    with Quiet():
        notes, line = export(bpy.context.scene, words[0])
    for text in notes:
        print("tempolux_export.py:", text, file=sys.stderr)
    print(line)


if __name__ == "__main__" and bpy.app.background:
    main()
elif __name__ == "__main__":
    register()

"""Sets 40 properties of a .blend to odd values, one by one, and looks for each in the exported file or in what the exporter says.

    build/peers/bpy-5.0.1/bin/python tests/pipelines/blender_properties.py [FOLDER]

or blender -b --factory-startup -P tests/pipelines/blender_properties.py. Printed: property, the part of the file that changed, or the new line.
Exit 1 if one is in neither. A property that this Blender lacks is left out.
"""

import json
import math
import os
import pathlib
import struct
import sys
import tempfile

import bpy

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(TOP / "pipelines/blender"))
import tempolux_addon  # noqa: E402


def base():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.frame_start, scene.frame_end = "CYCLES", 1, 3
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    bpy.ops.mesh.primitive_cube_add(size=1)
    cube = bpy.context.object
    made = bpy.data.materials.new("M")
    if made.node_tree is None:
        made.use_nodes = True
    cube.data.materials.append(made)
    for name, kind in (("Sun", "SUN"), ("Spot", "SPOT"), ("Point", "POINT"), ("Area", "AREA")):
        lamp = bpy.data.lights.new(name, kind)
        if hasattr(lamp, "shadow_soft_size") and kind != "POINT":
            lamp.shadow_soft_size = 0
        if kind == "POINT":
            lamp.shadow_soft_size = .1
        if kind == "SUN":
            lamp.angle = 0
        thing = bpy.data.objects.new(name, lamp)
        thing.location.z = 3
        thing.visible_camera = True
        scene.collection.objects.link(thing)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0, -5, 1), (math.radians(80), 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    return scene


def socket(*names, value):
    def change(scene):
        inputs = bpy.data.materials["M"].node_tree.nodes["Principled BSDF"].inputs
        name = next(n for n in names if n in inputs)
        inputs[name].default_value = value
        if name.startswith(("Sheen T", "Emission C")):
            inputs["Sheen Weight" if name.startswith("Sheen") else "Emission Strength"].default_value = 1
        if name == "Thin Film IOR":
            inputs["Thin Film Thickness"].default_value = 300
        if name in ("Anisotropic Rotation",):
            inputs["Anisotropic"].default_value = .5
        if name in ("Coat Roughness", "Coat Tint", "Coat IOR", "Clearcoat Roughness"):
            inputs[next(n for n in ("Coat Weight", "Clearcoat") if n in inputs)].default_value = 1
        if name in ("Sheen Roughness",):
            inputs["Sheen Weight"].default_value = 1
    return change


def put(kind, name, word, value):
    def change(scene):
        thing = {"object": bpy.data.objects, "lamp": bpy.data.lights, "camera": bpy.data.cameras}[kind][name]
        if not hasattr(thing, word):
            raise AttributeError(word)
        setattr(thing, word, value)
    return change


def render(word, value):
    return lambda scene: setattr(scene.render, word, value)


def modifier(kind, **values):
    def change(scene):
        made = bpy.data.objects["Cube"].modifiers.new(kind, kind)
        for word, value in values.items():
            setattr(made, word, value)
    return change


def depth(scene):
    scene.camera.data.dof.use_dof, scene.camera.data.dof.aperture_fstop = True, 1.7


def cropped(scene):
    scene.render.use_border = scene.render.use_crop_to_border = True
    scene.render.border_max_x, scene.render.border_min_x, scene.render.border_min_y, scene.render.border_max_y = (
        0.6,
        0.1,
        0,
        1,
    )


def background(word, value):
    def change(scene):
        scene.world.node_tree.nodes["Background"].inputs[word].default_value = value
    return change


def noise(scene):
    tree = bpy.data.materials["M"].node_tree
    tree.links.new(
        tree.nodes.new("ShaderNodeTexNoise").outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"]
    )


def marker(scene):
    other = bpy.data.objects.new("Other", bpy.data.cameras.new("Other"))
    scene.collection.objects.link(other)
    other.location = (1, -4, 1)
    scene.timeline_markers.new("a", frame=1).camera = scene.camera
    scene.timeline_markers.new("b", frame=2).camera = other


PROPERTIES = {
    "Base Color": socket("Base Color", value=(0.1, 0.2, 0.3, 1)),
    "Metallic": socket("Metallic", value=0.7),
    "Roughness": socket("Roughness", value=0.31),
    "IOR": socket("IOR", value=1.7),
    "Alpha": socket("Alpha", value=0.4),
    "Specular level": socket("Specular IOR Level", "Specular", value=0.2),
    "Specular Tint": socket("Specular Tint", value=(1, 0.2, 0.1, 1)),
    "Transmission": socket("Transmission Weight", "Transmission", value=0.6),
    "Coat": socket("Coat Weight", "Clearcoat", value=0.5),
    "Coat Roughness": socket("Coat Roughness", "Clearcoat Roughness", value=0.2),
    "Coat Tint": socket("Coat Tint", value=(1, 0.2, 0.1, 1)),
    "Coat IOR": socket("Coat IOR", value=1.9),
    "Sheen": socket("Sheen Weight", "Sheen", value=0.5),
    "Sheen Roughness": socket("Sheen Roughness", value=0.2),
    "Sheen Tint": socket("Sheen Tint", value=(1, 0.2, 0.1, 1)),
    "Emission Color": socket("Emission Color", "Emission", value=(1, 0.5, 0.1, 1)),
    "Emission Strength": socket("Emission Strength", value=2.5),
    "Anisotropic": socket("Anisotropic", value=0.6),
    "Anisotropic Rotation": socket("Anisotropic Rotation", value=0.3),
    "Thin Film": socket("Thin Film Thickness", value=400),
    "Thin Film IOR": socket("Thin Film IOR", value=1.6),
    "Subsurface": socket("Subsurface Weight", "Subsurface", value=0.5),
    "Diffuse Roughness": socket("Diffuse Roughness", value=0.8),
    "a procedural colour": noise,
    "lamp power": put("lamp", "Area", "energy", 33),
    "lamp colour": put("lamp", "Point", "color", (1, 0.5, 0.2)),
    "lamp exposure": put("lamp", "Spot", "exposure", 2),
    "lamp temperature": lambda s: (
        put("lamp", "Point", "use_temperature", True)(s),
        put("lamp", "Point", "temperature", 2500)(s),
    ),
    "lamp normalize": put("lamp", "Area", "normalize", False),
    "lamp radius": put("lamp", "Point", "shadow_soft_size", 0.3),
    "spot radius": put("lamp", "Spot", "shadow_soft_size", 0.3),
    "spot size": put("lamp", "Spot", "spot_size", 0.5),
    "spot blend": put("lamp", "Spot", "spot_blend", 0.9),
    "sun angle": put("lamp", "Sun", "angle", 0.1),
    "area size": put("lamp", "Area", "size", 2),
    "area shape": put("lamp", "Area", "shape", "DISK"),
    "area spread": put("lamp", "Area", "spread", 1),
    "lens": put("camera", "Camera", "lens", 77),
    "sensor width": put("camera", "Camera", "sensor_width", 22),
    "sensor fit": put("camera", "Camera", "sensor_fit", "VERTICAL"),
    "shift_x": put("camera", "Camera", "shift_x", 0.3),
    "orthographic": put("camera", "Camera", "type", "ORTHO"),
    "panorama": put("camera", "Camera", "type", "PANO"),
    "depth of field": depth,
    "motion blur": render("use_motion_blur", True),
    "pixel aspect": render("pixel_aspect_x", 2),
    "border": render("use_border", True),
    "cropped border": cropped,
    "fps": render("fps", 30),
    "percentage": render("resolution_percentage", 50),
    "holdout": put("object", "Cube", "is_holdout", True),
    "shadow catcher": put("object", "Cube", "is_shadow_catcher", True),
    "visible_camera": put("object", "Cube", "visible_camera", False),
    "visible_shadow": put("object", "Cube", "visible_shadow", False),
    "visible_glossy": put("object", "Cube", "visible_glossy", False),
    "hide_render": put("object", "Cube", "hide_render", True),
    "delta scale": put("object", "Cube", "delta_scale", (1, 2, 1)),
    "negative scale": put("object", "Cube", "scale", (-1, 1, 1)),
    "lamp visible_camera": put("object", "Area", "visible_camera", False),
    "array": modifier("ARRAY", count=3),
    "subdivision of the render": modifier("SUBSURF", levels=0, render_levels=2),
    "wave": modifier("WAVE"),
    "a modifier off in the render": modifier("SUBSURF", render_levels=2, show_render=False),
    "world colour": background("Color", (0.2, 0.3, 0.4, 1)),
    "world strength": background("Strength", 3),
    "camera markers": marker,
    "view exposure": lambda s: setattr(s.view_settings, "exposure", 1.5),
    "view gamma": lambda s: setattr(s.view_settings, "gamma", 1.2),
    "view transform": lambda s: setattr(s.view_settings, "view_transform", "Raw"),
}
NOTHING_CHANGES = {"a modifier off in the render", "view transform"}   # the second: a hint of the base goes


def exported(folder, name):
    path = os.path.join(folder, "property.glb")
    if os.path.exists(path):
        os.remove(path)
    lines, line = tempolux_addon.export(bpy.context.scene, path, bake=64)
    data = open(path, "rb").read()
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + size])
    return dict(flat(document)), data[28 + size:], lines, line


def flat(value, path=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from flat(inner, f"{path}/{key}")
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from flat(inner, f"{path}/{i}")
    else:
        yield path, value


def main():
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]
    folder = words[0] if words else tempfile.mkdtemp()
    base()
    before, data_before, said, line_before = exported(folder, "base")
    lost = counted = 0
    for name, change in PROPERTIES.items():
        scene = base()
        try:
            change(scene)
        except (AttributeError, StopIteration, TypeError, KeyError, ValueError):
            print(f"{name:28} is not in this Blender")
            continue
        after, data, lines, line = exported(folder, name)
        changed = sorted(
            {p for p in {**before, **after} if before.get(p) != after.get(p)} - {"/buffers/0/byteLength"}, key=len
        )
        changed = [p for p in changed if "bufferViews" not in p and "accessors" not in p] or changed
        new = [text for text in lines if text not in said and not text.startswith(("kept:", "baked:", "lost or"))]
        where = ", ".join(changed[:2]) or ("the data" if data != data_before else "")
        where = where or ("the make line" if line != line_before else "")
        counted += 1
        missing = not where and not new and name not in NOTHING_CHANGES
        lost += missing
        print(f"{name:28} {'LOST' if missing else where or '-'}{' | ' + new[0] if new else ''}")
    print(f"{counted} properties, {lost} in neither the file nor the notes")
    sys.exit(1 if lost else 0)


main()

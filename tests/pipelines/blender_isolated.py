"""One lamp above a floor, or one material on a ball, by Cycles of this Blender and, exported, by our path tracer: ratios of the means.

    build/peers/bpy/bin/python tests/pipelines/blender_isolated.py BIN_DIR [lamps] [balls]

Cycles with caustics, no clamping, no denoising. Blender 4.2 or later.
"""
import math
import pathlib
import subprocess
import sys
import tempfile

import bpy

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOP / "pipelines/blender"), str(TOP / "tests/stress")]
import exr  # noqa: E402
import tempolux_addon  # noqa: E402

LAMPS = {
    "area": ("AREA", dict(energy=50, size=1)), "area, a disk": ("AREA", dict(energy=50, shape="DISK", size=1)),
    "area, Normalize off": ("AREA", dict(energy=50, size=2, normalize=False)), "area, spread 140": ("AREA", dict(energy=50, size=1, spread=2.443)),
    "point": ("POINT", dict(energy=50, shadow_soft_size=.2)), "point, Normalize off": ("POINT", dict(energy=50, shadow_soft_size=.2, normalize=False)),
    "point, radius 0": ("POINT", dict(energy=50, shadow_soft_size=0)),
    "point, radius 0, Normalize off": ("POINT", dict(energy=50, shadow_soft_size=0, normalize=False)),
    "point, 2700 K": ("POINT", dict(energy=50, shadow_soft_size=.2, use_temperature=True, temperature=2700)),
    "spot, 2 stops": ("SPOT", dict(energy=10, exposure=2, shadow_soft_size=0)), "spot, radius .2": ("SPOT", dict(energy=50, shadow_soft_size=.2)),
    "spot, blend 1": ("SPOT", dict(energy=50, shadow_soft_size=0, spot_blend=1, spot_size=1)),
    "spot, blend 0": ("SPOT", dict(energy=50, shadow_soft_size=0, spot_blend=0, spot_size=1)),
    "sun, 6 degrees": ("SUN", dict(energy=2, angle=.1)), "sun, Normalize off": ("SUN", dict(energy=2, angle=.1, normalize=False)),
}
PRINCIPLED = "ShaderNodeBsdfPrincipled"
BALLS = {
    "Diffuse": ("ShaderNodeBsdfDiffuse", dict(Color=(.8, .6, .4, 1))), "Principled": (PRINCIPLED, {}),
    "Principled, roughness 1": (PRINCIPLED, {"Roughness": 1}), "Principled, dark, roughness .9": (PRINCIPLED, {"Roughness": .9, "Base Color": (.05, .05, .05, 1)}),
    "Principled, IOR 2, roughness .2": (PRINCIPLED, {"IOR": 2, "Roughness": .2}),
    "Principled, red specular tint": (PRINCIPLED, {"Specular Tint": (1, .2, .1, 1), "Roughness": .2}),
    "metal, roughness .15": (PRINCIPLED, {"Metallic": 1, "Roughness": .15, "Base Color": (1, .72, .3, 1)}),
    "metal, roughness .35": (PRINCIPLED, {"Metallic": 1, "Roughness": .35}), "metal, roughness .7": (PRINCIPLED, {"Metallic": 1, "Roughness": .7}),
    "Metallic .5": (PRINCIPLED, {"Metallic": .5, "Roughness": .4, "Base Color": (.9, .3, .1, 1)}),
    "Glass": ("ShaderNodeBsdfGlass", {"Roughness": 0}), "Glass, roughness .3": ("ShaderNodeBsdfGlass", {"Roughness": .3}),
    "Principled glass, roughness .25": (PRINCIPLED, {"Transmission Weight": 1, "Roughness": .25}),
    "Translucent": ("ShaderNodeBsdfTranslucent", {}),
}


def put(scene, data, place, turn=(0, 0, 0)):
    thing = bpy.data.objects.new(data.name, data)
    thing.location, thing.rotation_euler = place, turn
    scene.collection.objects.link(thing)
    return thing


def start(size):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start = scene.frame_end = 1
    scene.render.resolution_x = scene.render.resolution_y = size
    return scene


def dressed(thing, kind, values):
    made = bpy.data.materials.new(kind)
    if made.node_tree is None:
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs[0])
    for name, value in values.items():
        shader.inputs[name].default_value = value
    thing.data.materials.append(made)


def lamp_scene(kind, values):
    scene = start(32)
    bpy.ops.mesh.primitive_plane_add(size=20)
    dressed(bpy.context.object, "ShaderNodeBsdfDiffuse", {})
    lamp = bpy.data.lights.new("Lamp", kind)
    for word, value in values.items():
        setattr(lamp, word, value)
    thing = put(scene, lamp, (0, 0, 2), (.3, 0, 0))
    thing.scale = (1.3, .8, 1) if kind == "AREA" else (1, 1, 1)
    lens = bpy.data.cameras.new("Camera")
    lens.type, lens.ortho_scale = "ORTHO", 6
    scene.camera = put(scene, lens, (0, 0, 1.5))
    return scene, 0, "0,0,0"


def ball_scene(kind, values):
    scene = start(48)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1)
    ball = bpy.context.object
    for face in ball.data.polygons:
        face.use_smooth = True
    dressed(ball, kind, values)
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (.2, .2, .2, 1)
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size = 400, 3
    put(scene, lamp, (2, -4, 4), (.84, 0, .45))
    lens = bpy.data.cameras.new("Camera")
    lens.type, lens.ortho_scale = "ORTHO", 1.4
    scene.camera = put(scene, lens, (0, -5, 0), (math.pi / 2, 0, 0))
    return scene, 16, ".2,.2,.2"


def compare(name, scene, bounces, sky, binaries, folder):
    glb, theirs, ours = (folder / f"one{end}" for end in (".glb", "_cycles.exr", "_ours.exr"))
    tempolux_addon.export(scene, str(glb))
    scene.render.engine = "CYCLES"
    cycles, settings = scene.cycles, scene.render.image_settings
    cycles.samples, cycles.use_denoising, cycles.max_bounces, cycles.blur_glossy, cycles.sample_clamp_indirect = 128, False, bounces, 0, 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    settings.file_format, settings.color_depth, settings.exr_codec, settings.color_mode = "OPEN_EXR", "32", "ZIP", "RGB"
    scene.render.filepath = str(theirs)
    bpy.ops.render.render(write_still=True)
    size = scene.render.resolution_x
    subprocess.run([binaries / "frame-render", glb, "--frame", "1", "--size", f"{size}x{size}", "--integrator", "path", "--environment", sky,
                    "--spp", "256", "-o", ours], check=True, capture_output=True)
    a, b = exr.read(ours), exr.read(theirs)
    ratios = [a.mean(c) / b.mean(c) for c in "RGB"]
    print(f"RATIO {name:34} " + " ".join(f"{r:.3f}" for r in ratios), flush=True)


def main():
    binaries, *words = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        for word, cases, make in (("lamps", LAMPS, lamp_scene), ("balls", BALLS, ball_scene)):
            for name, (kind, values) in cases.items() if not words or word in words else ():
                try:
                    made = make(kind, values)
                except (AttributeError, KeyError):
                    print(f"RATIO {name:34} is not in this Blender")
                    continue
                compare(name, *made, pathlib.Path(binaries).resolve(), pathlib.Path(folder))


main()

"""One lamp above a floor, or one material on a ball, by Cycles of this Blender and, exported, by our path tracer: ratios of the means.

    build/peers/bpy/bin/python tests/pipelines/blender_isolated.py BIN_DIR [lamps] [balls] [planes] [part of a case's name]...

A ball is seen as a whole, its outermost .06 aside. Cycles with caustics, no clamping, no denoising. Blender 4.2 or later.
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
    "area": ("AREA", dict(energy=50, size=1)),
    "area, a disk": ("AREA", dict(energy=50, shape="DISK", size=1)),
    "area, Normalize off": ("AREA", dict(energy=50, size=2, normalize=False)),
    "area, spread 140": ("AREA", dict(energy=50, size=1, spread=2.443)),
    "point": ("POINT", dict(energy=50, shadow_soft_size=0.2)),
    "point, Normalize off": ("POINT", dict(energy=50, shadow_soft_size=0.2, normalize=False)),
    "point, radius 0": ("POINT", dict(energy=50, shadow_soft_size=0)),
    "point, radius 0, Normalize off": ("POINT", dict(energy=50, shadow_soft_size=0, normalize=False)),
    "point, 2700 K": ("POINT", dict(energy=50, shadow_soft_size=0.2, use_temperature=True, temperature=2700)),
    "spot, 2 stops": ("SPOT", dict(energy=10, exposure=2, shadow_soft_size=0)),
    "spot, radius .2": ("SPOT", dict(energy=50, shadow_soft_size=0.2)),
    "spot, blend 1": ("SPOT", dict(energy=50, shadow_soft_size=0, spot_blend=1, spot_size=1)),
    "spot, blend 0": ("SPOT", dict(energy=50, shadow_soft_size=0, spot_blend=0, spot_size=1)),
    "sun, 6 degrees": ("SUN", dict(energy=2, angle=0.1)),
    "sun, Normalize off": ("SUN", dict(energy=2, angle=0.1, normalize=False)),
}
PRINCIPLED = "ShaderNodeBsdfPrincipled"
BALLS = {
    "Diffuse": ("ShaderNodeBsdfDiffuse", dict(Color=(0.8, 0.6, 0.4, 1))),
    "Principled": (PRINCIPLED, {}),
    "Principled, roughness 1": (PRINCIPLED, {"Roughness": 1}),
    "Principled, dark, roughness .9": (PRINCIPLED, {"Roughness": 0.9, "Base Color": (0.05, 0.05, 0.05, 1)}),
    "Principled, IOR 2, roughness .2": (PRINCIPLED, {"IOR": 2, "Roughness": 0.2}),
    "Principled, red specular tint": (PRINCIPLED, {"Specular Tint": (1, 0.2, 0.1, 1), "Roughness": 0.2}),
    "metal, roughness .15": (PRINCIPLED, {"Metallic": 1, "Roughness": 0.15, "Base Color": (1, 0.72, 0.3, 1)}),
    "metal, roughness .35": (PRINCIPLED, {"Metallic": 1, "Roughness": 0.35}),
    "metal, roughness .7": (PRINCIPLED, {"Metallic": 1, "Roughness": 0.7}),
    "Metallic .5": (PRINCIPLED, {"Metallic": 0.5, "Roughness": 0.4, "Base Color": (0.9, 0.3, 0.1, 1)}),
    "Glass": ("ShaderNodeBsdfGlass", {"Roughness": 0}),
    "Glass, roughness .3": ("ShaderNodeBsdfGlass", {"Roughness": 0.3}),
    "Principled glass, roughness .25": (PRINCIPLED, {"Transmission Weight": 1, "Roughness": 0.25}),
    "Principled glass, tinted, roughness .25": (
        PRINCIPLED,
        {"Transmission Weight": 1, "Roughness": 0.25, "Base Color": (0.75, 0.9, 1, 1)},
    ),
    "frosted shell": (
        PRINCIPLED,
        {"Transmission Weight": 1, "Roughness": 0.25, "Base Color": (0.75, 0.9, 1, 1), "shell": 0.1},
    ),
    "Metallic .3, red": (PRINCIPLED, {"Metallic": 0.3, "Roughness": 0.5, "Base Color": (0.6, 0.03, 0.02, 1)}),
    "Metallic .5, white": (PRINCIPLED, {"Metallic": 0.5, "Roughness": 0.3}),
    "green Diffuse, .25 of Glossy": (
        "MIX",
        {"factor": 0.25, "matte": (0.05, 0.4, 0.1, 1), "gloss": (0.8, 0.8, 0.8, 1), "roughness": 0.12},
    ),
    "red Diffuse, .6 of golden Glossy": (
        "MIX",
        {"factor": 0.6, "matte": (0.6, 0.1, 0.1, 1), "gloss": (1, 0.7, 0.3, 1), "roughness": 0.4},
    ),
    "black, roughness .3": (PRINCIPLED, {"Base Color": (0.02, 0.02, 0.02, 1), "Roughness": 0.3}),
    "Coat": (PRINCIPLED, {"Coat Weight": 1, "Base Color": (0.6, 0.03, 0.02, 1)}),
    "Sheen": (
        PRINCIPLED,
        {"Sheen Weight": 1, "Sheen Roughness": 0.4, "Base Color": (0.08, 0.14, 0.3, 1), "Roughness": 0.8},
    ),
    "Subsurface": (PRINCIPLED, {"Subsurface Weight": 1, "Subsurface Scale": 0.5}),
    "Anisotropic .8": (PRINCIPLED, {"Metallic": 1, "Anisotropic": 0.8, "Roughness": 0.35}),
    "thin film on glass": (
        PRINCIPLED,
        {"Transmission Weight": 1, "Roughness": 0, "IOR": 1.33, "Thin Film Thickness": 420, "Thin Film IOR": 1.5},
    ),
    "Translucent": ("ShaderNodeBsdfTranslucent", {}),
    "Principled glass, roughness .25, even light": (
        PRINCIPLED,
        {"Transmission Weight": 1, "Roughness": 0.25, "even": 1},
    ),
    "frosted shell, even light": (PRINCIPLED, {"Transmission Weight": 1, "Roughness": 0.25, "shell": 0.1, "even": 1}),
    "black, roughness .3, even light": (PRINCIPLED, {"Base Color": (0, 0, 0, 1), "Roughness": 0.3, "even": 1}),
    "black, smooth, even light": (PRINCIPLED, {"Base Color": (0, 0, 0, 1), "Roughness": 0, "even": 1}),
    "Diffuse, .5 of Translucent": ("SHADE", {"matte": (0.9, 0.82, 0.65, 1), "through": (0.9, 0.75, 0.5, 1)}),
}


# A white matte surface below a smooth reflection in the light of a sun, or a black one in even light; degrees between
# the normal and the sun, or the eye. The expected ratio is a closed form: see expected().
PLANES = {
    **{f"matte below a reflection, sun at {angle} degrees": ("sun", angle) for angle in (0, 45, 60, 75)},
    **{f"black, seen at {angle} degrees": ("eye", angle) for angle in (0, 45, 60, 75)},
}


def expected(kind, angle):
    """Ours / Cycles. glTF: Schlick's rise from .04, and a matte part that loses what is reflected at both directions
    (lib/material/bsdf.h). Cycles: Fresnel's equations, and a matte part that loses what is reflected towards the eye."""
    c = math.cos(math.radians(angle))
    g = math.sqrt(1.5**2 - 1 + c * c)
    fresnel = ((g - c) / (g + c)) ** 2 / 2 * (1 + ((c * (g + c) - 1) / (c * (g - c) + 1)) ** 2)
    schlick = 0.04 + 0.96 * (1 - c) ** 5
    return schlick / fresnel if kind == "eye" else (1 - schlick) / (1 - (20 * 0.04 + 1) / 21)


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
    thing.data.materials.append(made)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    if kind in ("MIX", "SHADE"):
        mixed(tree, output, values)
        return
    shader = tree.nodes.new(kind)
    tree.links.new(shader.outputs[0], output.inputs[0])
    for name, value in values.items():
        if name == "even":
            continue
        if name == "shell":
            thing.modifiers.new("Shell", "SOLIDIFY").thickness = value
        else:
            shader.inputs[name].default_value = value


def mixed(tree, output, values):
    """Diffuse and Glossy, or Diffuse and Translucent."""
    mix, matte, other = (tree.nodes.new(f"ShaderNode{word}") for word in (
        "MixShader", "BsdfDiffuse", "BsdfAnisotropic" if "gloss" in values else "BsdfTranslucent"))
    mix.inputs[0].default_value = values.get("factor", .5)
    matte.inputs[0].default_value, other.inputs[0].default_value = (
        values["matte"],
        values.get("gloss") or values["through"],
    )
    if "gloss" in values:
        other.inputs["Roughness"].default_value = values["roughness"]
    for k, node in enumerate((matte, other)):
        tree.links.new(node.outputs[0], mix.inputs[k + 1])
    tree.links.new(mix.outputs[0], output.inputs[0])


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


def even(scene, light):
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (light, light, light, 1)


def ball_scene(kind, values):
    scene = start(48)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1)
    ball = bpy.context.object
    for face in ball.data.polygons:
        face.use_smooth = True
    dressed(ball, kind, values)
    even(scene, .2)
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size = 0 if "even" in values else 400, 3
    put(scene, lamp, (2, -4, 4), (.84, 0, .45))
    lens = bpy.data.cameras.new("Camera")
    lens.type, lens.ortho_scale = "ORTHO", 2
    scene.camera = put(scene, lens, (0, -5, 0), (math.pi / 2, 0, 0))
    return scene, 64, ".2,.2,.2"     # ours has no limit; 16 bounces take 8 % from a shell of rough glass


def plane_scene(kind, angle):
    scene = start(8)
    bpy.ops.mesh.primitive_plane_add(size=2000)
    grey = 0.8 if kind == "sun" else 0
    dressed(bpy.context.object, PRINCIPLED, {"Base Color": (grey, grey, grey, 1), "Roughness": 0})
    turn = math.radians(angle)
    if kind == "sun":
        lamp = bpy.data.lights.new("Lamp", "SUN")
        lamp.energy, lamp.angle = 3, 0
        put(scene, lamp, (0, 0, 5), (0, turn, 0))
        turn = 0
    else:
        even(scene, 1)
    lens = bpy.data.cameras.new("Camera")
    lens.type, lens.ortho_scale = "ORTHO", 1
    scene.camera = put(scene, lens, (0, -5 * math.sin(turn), 5 * math.cos(turn)), (turn, 0, 0))
    return scene, 8, "0,0,0" if kind == "sun" else "1,1,1"


def compare(name, scene, bounces, sky, binaries, folder):
    glb, theirs, ours = (folder / f"one{end}" for end in (".glb", "_cycles.exr", "_ours.exr"))
    tempolux_addon.export(scene, str(glb))
    scene.render.engine = "CYCLES"
    cycles, settings = scene.cycles, scene.render.image_settings
    cycles.samples, cycles.use_denoising, cycles.max_bounces, cycles.blur_glossy, cycles.sample_clamp_indirect = (
        128,
        False,
        bounces,
        0,
        0,
    )
    cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.caustics_reflective = cycles.caustics_refractive = True
    settings.file_format, settings.color_depth, settings.exr_codec, settings.color_mode = "OPEN_EXR", "32", "ZIP", "RGB"
    scene.render.filepath = str(theirs)
    bpy.ops.render.render(write_still=True)
    size = scene.render.resolution_x
    subprocess.run(
        [
            binaries / "frame-render",
            glb,
            "--frame",
            "1",
            "--size",
            f"{size}x{size}",
            "--integrator",
            "path",
            "--environment",
            sky,
            "--spp",
            "256",
            "-o",
            ours,
        ],
        check=True,
        capture_output=True,
    )
    a, b = exr.read(ours), exr.read(theirs)
    inside = [
        y * size + x
        for y in range(size)
        for x in range(size)
        if math.hypot(x + 0.5 - size / 2, y + 0.5 - size / 2) < 0.47 * size
    ]
    means = [[math.fsum(image.channels[c][i] for i in inside) / len(inside) for c in "RGB"] for image in (a, b)]
    print(
        f"RATIO {name:44} "
        + " ".join(f"{x / y:.3f}" for x, y in zip(*means))
        + f"   green: ours {means[0][1]:.4f}, Cycles {means[1][1]:.4f}"
        + (f"   expected {expected(*PLANES[name]):.3f}" if name in PLANES else ""),
        flush=True,
    )


def main():
    binaries, *words = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        for word, cases, make in (("lamps", LAMPS, lamp_scene), ("balls", BALLS, ball_scene), ("planes", PLANES, plane_scene)):
            for name, (kind, values) in cases.items():
                if words and word not in words and not any(w in name for w in words):
                    continue
                try:
                    made = make(kind, values)
                except (AttributeError, KeyError):
                    print(f"RATIO {name:34} is not in this Blender")
                    continue
                compare(name, *made, pathlib.Path(binaries).resolve(), pathlib.Path(folder))


main()

"""Ten frames of what moves in Blender: a cloth that falls on a ball, a wave modifier, a box that appears at frame 6, instances of geometry
nodes, a camera with a shift, a cut to a second camera by a marker at frame 8. Ours above, Cycles below.

    build/peers/bpy/bin/python tests/pipelines/blender_motion.py BIN_DIR OUT

Written: OUT/sheet.png, the ten frames of both at one exposure; printed: how far the pictures are apart, ours over Cycles by frame, and how far
the outlines of what is coloured are apart: the share of coloured pixels that have another colour in the other picture.
"""

import math
import pathlib
import subprocess
import sys

import bpy

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOP / "pipelines/blender"), str(TOP / "tests/stress")]
import exr  # noqa: E402
import tempolux_addon  # noqa: E402

SIZE, FRAMES = (192, 108), range(1, 11)
RED, BLUE, GREEN, YELLOW = (.8, .15, .08), (.08, .25, .8), (.1, .7, .2), (.9, .8, .1)


def matte(name, colour):
    made = bpy.data.materials.new(name)
    if made.node_tree is None:
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.inputs[0].default_value = (*colour, 1)
    tree.links.new(shader.outputs[0], output.inputs[0])
    return made


def put(scene, name, data, place, turn=(0, 0, 0)):
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.rotation_euler = place, turn
    scene.collection.objects.link(thing)
    return thing


def made(name, colour):
    """The mesh that an operator has just added, named and dressed."""
    thing = bpy.context.object
    thing.name = name
    thing.data.materials.append(matte(name, colour))
    return thing


def cloth():
    bpy.ops.mesh.primitive_uv_sphere_add(radius=.4, location=(-1.3, .3, .6))
    ball = made("ball", (.6, .6, .6))
    ball.modifiers.new("Collision", "COLLISION")
    ball.data.shade_smooth()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=1.3, location=(-1.3, .3, 1.15))
    sheet = made("cloth", RED)
    sheet.data.shade_smooth()
    modifier = sheet.modifiers.new("Cloth", "CLOTH")
    modifier.settings.time_scale = 3                # ten frames are short
    modifier.settings.effector_weights.gravity = 1


def wave():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=48, y_subdivisions=48, size=1.5, location=(.4, .8, .45))
    thing = made("wave", BLUE)
    thing.data.shade_smooth()
    modifier = thing.modifiers.new("Wave", "WAVE")
    modifier.height, modifier.width, modifier.narrowness, modifier.speed, modifier.time_offset = .3, .6, 2.5, .12, -8


def appearing():
    bpy.ops.mesh.primitive_cube_add(size=.5, location=(1.7, 0, .25))
    box = made("appears at 6", GREEN)
    for frame, hidden in ((1, True), (6, False)):
        box.hide_render = hidden
        box.keyframe_insert("hide_render", frame=frame)


def instances():
    bpy.ops.mesh.primitive_cube_add(size=.12, location=(0, 0, -9))
    source = made("source", YELLOW)
    source.hide_render = True
    group = bpy.data.node_groups.new("row", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    line, info, points, output = (group.nodes.new(kind) for kind in ("GeometryNodeMeshLine", "GeometryNodeObjectInfo",
                                                                     "GeometryNodeInstanceOnPoints", "NodeGroupOutput"))
    line.inputs["Offset"].default_value = (.3, 0, .05)
    info.inputs["Object"].default_value = source
    for a, b, name in (
        (line.outputs[0], points, "Points"),
        (info.outputs["Geometry"], points, "Instance"),
        (points.outputs[0], output, 0),
    ):
        group.links.new(a, b.inputs[name])
    bpy.ops.mesh.primitive_cube_add(size=.1, location=(-1.4, -.9, .1))
    bpy.context.object.modifiers.new("Row", "NODES").node_group = group


def build():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FRAMES[0], FRAMES[-1]
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (.3, .3, .3, 1)
    bpy.ops.mesh.primitive_plane_add(size=12)
    made("floor", (.5, .5, .5))
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size = 400, 2
    put(scene, "Lamp", lamp, (2, -3, 5), (.5, .3, 0))
    cloth()
    wave()
    appearing()
    instances()
    lenses = [bpy.data.cameras.new(name) for name in ("First", "Second")]
    for lens in lenses:
        lens.shift_x, lens.shift_y = .1, -.12
    lenses[1].lens = 35
    first = put(scene, "First", lenses[0], (0, -6, 2), (math.radians(80), 0, 0))
    second = put(scene, "Second", lenses[1], (3.8, -3.6, 2.6), (math.radians(66), 0, math.radians(45)))
    scene.camera = first
    for name, frame, camera in (("a", 1, first), ("b", 8, second)):
        scene.timeline_markers.new(name, frame=frame).camera = camera
    for frame in FRAMES:                            # fills the cloth's cache
        scene.frame_set(frame)
    return scene


def theirs(scene, out):
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 64, True, False
    scene.render.use_motion_blur = False
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec, settings.color_mode = "OPEN_EXR", "32", "ZIP", "RGB"
    for frame in FRAMES:
        scene.frame_set(frame)
        scene.render.filepath = str(out / f"{frame:04d}_cycles.exr")
        bpy.ops.render.render(write_still=True)


def ours(binaries, glb, camera, out):
    for frame in FRAMES:
        subprocess.run(
            [
                binaries / "frame-render",
                glb,
                "--frame",
                str(frame),
                "--size",
                "x".join(map(str, SIZE)),
                "--integrator",
                "path",
                "--environment",
                ".3,.3,.3",
                "--spp",
                "64",
                *camera,
                "-o",
                out / f"{frame:04d}.exr",
            ],
            check=True,
        )


def colour_of(rgb):
    """grey, or which of the four colours."""
    top = max(rgb)
    if top < 1e-3 or min(rgb) > .45 * top:
        return None
    return min((RED, BLUE, GREEN, YELLOW), key=lambda c: sum((a / top - b / max(c)) ** 2 for a, b in zip(rgb, c)))


def sheet(pairs, out):
    """Ten frames in two rows of five, ours above Cycles' each."""
    width, height = SIZE
    big = {c: [0.0] * (5 * width * 4 * height) for c in "RGB"}
    for k, pair in enumerate(pairs):
        for below, image in enumerate(pair):
            for c in "RGB":
                for y in range(height):
                    start = ((2 * (k // 5) + below) * height + y) * 5 * width + k % 5 * width
                    big[c][start:start + width] = list(image.channels[c][y * width:(y + 1) * width])
    exr.write(out / "sheet.exr", 5 * width, 4 * height, big)


def main():
    binaries, out = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    out.mkdir(parents=True, exist_ok=True)
    scene = build()
    notes, line = tempolux_addon.export(scene, str(out / "motion.glb"))
    print(*notes, line, sep="\n")
    word = next((w for w in line.split() if w.startswith(("CAMERA=", "'CAMERA="))), None)
    ours(binaries, out / "motion.glb", ["--camera", word.strip("'").split("=", 1)[1]] if word else [], out)
    theirs(scene, out)
    pairs = []
    for frame in FRAMES:
        a, b = exr.read(out / f"{frame:04d}.exr"), exr.read(out / f"{frame:04d}_cycles.exr")
        pairs.append((a, b))
        hues = [
            [colour_of([image.channels[c][i] for c in "RGB"]) for i in range(SIZE[0] * SIZE[1])] for image in (a, b)
        ]
        coloured = sum(h is not None for h in hues[1])
        apart = sum(p != q for p, q in zip(*hues)) / coloured
        print(
            f"frame {frame:2}: ours / Cycles {a.mean('R') / b.mean('R'):.3f} {a.mean('G') / b.mean('G'):.3f} {a.mean('B') / b.mean('B'):.3f}; "
            f"coloured pixels {coloured}, of another colour in ours {apart:.1%}"
        )
    sheet(pairs, out)
    subprocess.run(
        [binaries / "tempolux-info", "--png", out / "sheet.png", out / "sheet.exr"], check=True, capture_output=True
    )


main()

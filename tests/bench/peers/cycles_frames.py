"""Frames of a glTF file by Cycles, in the Python of build/peers/cycles (package bpy): reads jobs from standard input, one JSON a line.

    {"scene": FILE, "size": "320x180", "light_units": "spec", "world": FILE or null, "sky": [R, G, B] or null, "camera": NAME or null,
     "smoke": {"file": FILE.vdb, "sigma_t": 10, "albedo": [R, G, B]} or null}    once, first
    {"frame": 10, "samples": 16, "seed": 1, "denoise": true, "defaults": false, "output": FILE.exr, "shutter": 0.5 or null,
     "lens": {"f_stop": 2.8, "focus_m": 3} or null}     as our --shutter 180 --f-stop 2.8 --focus 3
    {"export": FILE.npz, "frame": 10}           the scene as triangles, for other renderers

Answers each by a line: {"cpu_s": ...} of the job. The importer is Blender's own; all its NLA tracks are unmuted, lamps get no size, the world is
the one given. defaults: Blender's clamping, bounces and filter; else none is clamped and bounces are as many as ours.
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import serve  # before others: it takes standard output
import bpy
from smoke_of_cycles import place_smoke


def load(job):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=job["scene"], import_scene_extras=False,
                              export_import_convert_lighting_mode="SPEC" if job["light_units"] == "spec" else "RAW")
    scene = bpy.context.scene
    for data in (
        *bpy.data.objects,
        *bpy.data.lights,
        *bpy.data.materials,
        *bpy.data.cameras,
        *(m.shape_keys for m in bpy.data.meshes if m.shape_keys),
    ):
        if data.animation_data:
            for track in data.animation_data.nla_tracks:
                track.mute = False
    for light in bpy.data.lights:
        if light.type in ("POINT", "SPOT"):
            light.shadow_soft_size = 0
        elif light.type == "SUN":
            light.angle = 0
    scene.render.fps = 24
    scene.camera = next(
        (o for o in scene.objects if o.type == "CAMERA" and job.get("camera") in (None, "auto", o.name)), None
    )
    world = scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    nodes, link = world.node_tree.nodes, world.node_tree.links.new
    background = next(n for n in nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = [*(job.get("sky") or (0, 0, 0)), 1]
    if job.get("world"):
        picture = nodes.new("ShaderNodeTexEnvironment")
        picture.image = bpy.data.images.load(job["world"])
        picture.image.colorspace_settings.name = "Linear Rec.709"
        link(picture.outputs["Color"], background.inputs["Color"])
        turn, coordinates = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
        turn.inputs["Rotation"].default_value[2] = math.pi / 2  # our maps have their middle at glTF's +Z, Blender's -Y; Cycles' at +X
        link(coordinates.outputs["Generated"], turn.inputs["Vector"])
        link(turn.outputs["Vector"], picture.inputs["Vector"])
    if job.get("smoke"):
        place_smoke(**job["smoke"])
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = map(int, job["size"].split("x"))
    render.resolution_percentage = 100
    settings = render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec, settings.color_mode = "OPEN_EXR", "32", "ZIP", "RGB"
    render.use_file_extension = False
    scene.view_settings.view_transform = "Raw"
    scene.cycles.device = "CPU"


def blur(scene, job):
    """Shutter and lens of a job. Our f-stop means a sensor of 36 mm along the picture's longer side."""
    scene.render.use_motion_blur = bool(job.get("shutter"))
    if job.get("shutter"):
        scene.render.motion_blur_shutter, scene.render.motion_blur_position = job["shutter"], "CENTER"
    camera = scene.camera.data
    camera.dof.use_dof = bool(job.get("lens"))
    if job.get("lens"):
        corner = camera.view_frame(scene=scene)[0]
        half = max(abs(corner.x), abs(corner.y)) / abs(corner.z)
        camera.dof.focus_distance = job["lens"]["focus_m"]
        camera.dof.aperture_fstop = camera.lens / (18 / half) * job["lens"]["f_stop"]


def render(job):
    scene = bpy.context.scene
    cycles = scene.cycles
    cycles.samples, cycles.seed, cycles.use_adaptive_sampling = job["samples"], job["seed"], False
    cycles.use_denoising = job["denoise"]
    if job["denoise"]:
        cycles.denoiser = "OPENIMAGEDENOISE"
    if not job.get("defaults"):
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
        cycles.caustics_reflective = cycles.caustics_refractive = True
        for name in ("max", "diffuse", "glossy", "transmission", "volume"):
            setattr(cycles, f"{name}_bounces", 1024)
        cycles.transparent_max_bounces = 1024
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    blur(scene, job)
    scene.render.filepath = job["output"]
    scene.frame_set(job["frame"])
    bpy.ops.render.render(write_still=True)


def other(job):
    if "export" in job:
        import scene_of_blender
        scene_of_blender.export(job)
    else:
        render(job)


serve.jobs(load, other)

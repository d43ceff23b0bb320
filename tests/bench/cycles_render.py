"""Renders a frame of a glTF file by Cycles. Runs inside Blender 3.4:

    blender -b --factory-startup -noaudio --python cycles_render.py -- SCENE FRAME WIDTHxHEIGHT SAMPLES SEED SKY LIGHTS OUT.exr

SKY: radiance of the sky as R,G,B, W/m^2/sr. LIGHTS: SPEC or COMPAT, the importer's word for files whose lights are or are not in lumens. Path
tracing without clamping, adaptive sampling and denoising; as many bounces as ours; a box of one pixel as filter. Cycles subdivides no emitter here.
"""
import sys

import bpy
import numpy

numpy.bool = bool      # a name that Blender 3.4's importer uses and Debian 12's numpy 1.24 has dropped
scene_file, frame, size, samples, seed, sky, lights, output = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=scene_file, convert_lighting_mode=lights)

scene = bpy.context.scene
scene.camera = scene.camera or next(o for o in scene.objects if o.type == "CAMERA")
scene.world = bpy.data.worlds.new("World")
scene.world.use_nodes = True
background = scene.world.node_tree.nodes["Background"]
background.inputs["Color"].default_value = [*map(float, sky.split(",")), 1]

render, cycles = scene.render, scene.cycles
render.engine = "CYCLES"
render.fps = 24
render.resolution_x, render.resolution_y = map(int, size.split("x"))
render.resolution_percentage = 100
render.filepath, render.use_file_extension = output, False
render.image_settings.file_format, render.image_settings.color_depth, render.image_settings.exr_codec = "OPEN_EXR", "32", "ZIP"
render.image_settings.color_mode = "RGB"
cycles.device, cycles.samples, cycles.seed = "CPU", int(samples), int(seed)
cycles.use_adaptive_sampling = cycles.use_denoising = False
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
cycles.blur_glossy = 0
cycles.caustics_reflective = cycles.caustics_refractive = True
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = cycles.transparent_max_bounces = 1024
cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
scene.frame_set(int(frame))
bpy.ops.render.render(write_still=True)

"""Renders a frame of a glTF file by Cycles. Runs inside Blender 3.4:

    blender -b --factory-startup -noaudio --python cycles_render.py -- SCENE FRAME WIDTHxHEIGHT SAMPLES SEED SKY LIGHTS OUT.exr [SMOKE.vdb SIGMA_T ALBEDO]

SCENE: a glTF file, or a .blend, which is rendered as it is: SKY and LIGHTS say nothing. SKY: radiance of the sky as R,G,B, W/m^2/sr. LIGHTS: SPEC or COMPAT, the importer's word for files whose lights are or are not in lumens. Path
tracing without clamping, adaptive sampling and denoising; as many bounces as ours; a box of one pixel as filter. Cycles subdivides no emitter here.
Smoke: grid `density`, placed as the glTF is; extinction of density 1 in 1/m; albedo R,G,B, scattered evenly.
"""
import json
import struct
import sys
from pathlib import Path

import bpy
import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent / "peers"))
from smoke_of_cycles import place_smoke

numpy.bool = bool      # a name that Blender 3.4's importer uses and Debian 12's numpy 1.24 has dropped
scene_file, frame, size, samples, seed, sky, lights, output, *smoke = sys.argv[sys.argv.index("--") + 1:]
as_it_is = scene_file.endswith(".blend")
if as_it_is:
    bpy.ops.wm.open_mainfile(filepath=scene_file)
else:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=scene_file, convert_lighting_mode=lights)


def be_as_the_file_says(file):
    """KHR_materials_specular, which this importer does not know: all would have a gloss of 4 %. What is matte becomes Lambert's, not Burley's diffuse."""
    with open(file, "rb") as data:
        head = data.read(20)
        text = data.read(struct.unpack_from("<I", head, 12)[0]) if head[:4] == b"glTF" else head + data.read()
    for entry in json.loads(text).get("materials", []):
        material = bpy.data.materials.get(entry.get("name", ""))
        factor = entry.get("extensions", {}).get("KHR_materials_specular", {}).get("specularFactor", 1)
        for node in [n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED"] if material and material.use_nodes else ():
            node.inputs["Specular"].default_value *= factor
            looks = entry.get("pbrMetallicRoughness", {})
            if factor > 0 or looks.get("metallicFactor", 1) > 0 or set(looks) - {"baseColorFactor", "metallicFactor", "roughnessFactor"} or "emissiveFactor" in entry:
                continue
            matte = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
            matte.inputs["Color"].default_value = node.inputs["Base Color"].default_value
            for link in list(node.outputs["BSDF"].links):
                material.node_tree.links.new(matte.outputs["BSDF"], link.to_socket)


if not as_it_is:
    be_as_the_file_says(scene_file)
if smoke:
    file, sigma_t, albedo = smoke
    place_smoke(file, float(sigma_t), [*map(float, albedo.split(","))])
scene = bpy.context.scene
scene.camera = scene.camera or next(o for o in scene.objects if o.type == "CAMERA")
if not as_it_is:
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
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = cycles.transparent_max_bounces = cycles.volume_bounces = 1024
cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
scene.frame_set(int(frame))
bpy.ops.render.render(write_still=True)

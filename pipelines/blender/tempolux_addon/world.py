"""The world as one colour, or as an environment map that Cycles renders."""
import math
import os

import bpy

from .colour import rec709
from .notes import Damage
from .values import is_constant, resolve, follow, as_tuple, as_number

WIDTH = 1024             # pixels of the environment map


def plain_colour(world):
    """Radiance of a world of one colour; None if there is more to it."""
    if world.node_tree is None or not getattr(world, "use_nodes", True):
        return rec709(world.color)
    output = next((n for n in world.node_tree.nodes if n.type == "OUTPUT_WORLD" and n.is_active_output), None)
    if output is None:
        return (0.0, 0.0, 0.0)
    _, shader, _, stack = follow(output.inputs["Surface"], ())
    if shader is None:
        return (0.0, 0.0, 0.0)
    if shader.type != "BACKGROUND":
        return None
    colour, strength = (resolve(shader.inputs[name], stack) for name in ("Color", "Strength"))
    if not is_constant(colour) or not is_constant(strength):
        return None
    return tuple(c * as_number(strength) for c in rec709(as_tuple(colour)))


def bake_world(shot):
    """The map's middle column is glTF's +z, Blender's -y (formats/conventions.md)."""
    world = shot.scene.world
    if world is None:
        return
    motion = [world.animation_data, world.node_tree.animation_data if world.node_tree else None]
    if any(m and (m.action or m.drivers) for m in motion):
        shot.notes.lost(
            Damage.LIGHT, f"world {world.name}", f"its changes are left out: it is that of frame {shot.first}"
        )
    if world.node_tree and any(
        n.type == "OUTPUT_WORLD" and n.inputs["Volume"].is_linked for n in world.node_tree.nodes
    ):
        shot.notes.lost(Damage.LIGHT, f"world {world.name}", "its fog is left out")
    colour = plain_colour(world)
    if colour is not None:
        shot.sky = colour if max(colour) > 0 else None
        shot.notes.keep("worlds")
        return
    with shot.notes.guard(Damage.LIGHT, f"world {world.name}", "is left out: no light comes from it"):
        render_map(shot, world)
        shot.notes.keep("worlds")


def render_map(shot, world):
    stage = bpy.data.scenes.new("tempolux world")
    try:
        stage.world = world
        stage.render.engine = "CYCLES"
        stage.cycles.samples, stage.cycles.use_denoising, stage.cycles.device = 16, False, "CPU"
        stage.cycles.pixel_filter_type = "BOX"
        render = stage.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, WIDTH // 2, 100
        render.film_transparent = False
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        render.image_settings.color_mode = "RGB"
        lens = bpy.data.cameras.new("tempolux world")
        lens.type = "PANO"
        where = lens if hasattr(lens, "panorama_type") else lens.cycles
        where.panorama_type = "EQUIRECTANGULAR"
        eye = bpy.data.objects.new("tempolux world", lens)
        eye.rotation_euler = (math.pi / 2, 0, math.pi)   # looks along -y
        stage.collection.objects.link(eye)
        stage.camera = eye
        stage.frame_set(shot.first)
        path = os.path.splitext(shot.path)[0] + "_world.exr"
        render.filepath = path
        bpy.ops.render.render(write_still=True, scene=stage.name)
        if not os.path.isfile(path):
            raise RuntimeError("Cycles wrote no map")
        shot.world_file = path
    finally:
        bpy.data.scenes.remove(stage)

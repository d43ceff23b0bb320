"""For from_blender.sh, run by `blender -b -P`: a shot with what a plain export loses, as a .blend of the name that follows `--`."""
import sys

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.frame_start, scene.frame_end, scene.render.fps = 3, 6, 30
bpy.ops.mesh.primitive_plane_add(size=4)
for name, kind, energy in (("Panel", "AREA", 60), ("Bulb", "POINT", 15), ("Spot", "SPOT", 10)):
    lamp = bpy.data.lights.new(name, kind)
    lamp.energy = energy
    if kind == "AREA":
        lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", 0.8, 0.4
    if kind == "POINT":
        lamp.shadow_soft_size = 0.05
    item = bpy.data.objects.new(name, lamp)
    item.location = (0, 0, 2)
    scene.collection.objects.link(item)
twin = bpy.data.objects.new("Panel.twin", bpy.data.lights["Panel"])   # two objects, one lamp
scene.collection.objects.link(twin)
eye = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
scene.collection.objects.link(eye)
scene.camera = eye
aim = bpy.data.objects.new("Aim", None)
scene.collection.objects.link(aim)
follow = eye.constraints.new("TRACK_TO")
follow.target, follow.track_axis, follow.up_axis = aim, "TRACK_NEGATIVE_Z", "UP_Y"
for frame, x in ((3, -1), (6, 1)):
    eye.location = (x, -3, 1)
    eye.keyframe_insert("location", frame=frame)
scene.world = bpy.data.worlds.new("World")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.6, 0.8, 1)
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 2
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[sys.argv.index("--") + 1])

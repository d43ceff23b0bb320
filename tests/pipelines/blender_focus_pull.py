"""The shot of make_room.py with a pull of the focus from the table, 2 m, to the wall, 5 m, over frames 8 to 20.

    build/peers/bpy/bin/python tests/pipelines/blender_focus_pull.py ROOM.blend OUT.blend [F_STOP]
"""

import sys

import bpy

room, out, *f_stop = sys.argv[1:]
bpy.ops.wm.open_mainfile(filepath=room)
lens = bpy.context.scene.camera.data.dof
lens.focus_object = None
if f_stop:
    lens.aperture_fstop = float(f_stop[0])
for frame, metres in ((8, 2), (20, 5)):
    lens.focus_distance = metres
    lens.keyframe_insert("focus_distance", frame=frame)
bpy.ops.wm.save_as_mainfile(filepath=out, compress=True)

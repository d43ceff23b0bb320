"""python as_blender.py SHOT.blend|- SCRIPT WORD...: what `blender -b SHOT.blend -P SCRIPT -- WORD...` does, with Blender as a Python module."""

import runpy
import sys

import bpy

shot, script, *words = sys.argv[1:]
if shot != "-":
    bpy.ops.wm.open_mainfile(filepath=shot)
sys.argv = ["blender", "-b", shot, "-P", script, "--", *words]
runpy.run_path(script, run_name="__main__")

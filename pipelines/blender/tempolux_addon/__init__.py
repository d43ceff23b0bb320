"""Exports a shot of Blender so that tempolux renders what Cycles shows. Page: docs/from-blender.md

As an add-on: File > Export > tempolux (.glb). As a script: ../tempolux_export.py.
"""
import os
import shlex
import struct

import bpy

from . import settle
from .cameras import picture_size
from .shot import Shot

bl_info = {
    "name": "tempolux export",
    "author": "tempolux",
    "version": (2, 0),
    "blender": (3, 4, 0),
    "category": "Import-Export",
    "location": "File > Export > tempolux (.glb)",
    "description": "Export a shot for tempolux",
}


def makefile():
    """Path of Makefile.example if the add-on lies in the project, else its name."""
    path = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "..", "Makefile.example")
    return os.path.normpath(path) if os.path.isfile(path) else "Makefile.example"


def make_line(shot):
    """The command that renders the shot, from any folder."""
    width, height = picture_size(shot.scene.render)
    step = f"x{shot.scene.frame_step}" if shot.scene.frame_step > 1 else ""
    words = [f"SCENE={shot.path}", f"FRAMES={shot.first}-{shot.last}{step}", f"SIZE={width}x{height}",
             f"OUT={os.path.splitext(shot.path)[0]}", "QUALITY=draft",
             f"EXPOSURE={shot.scene.view_settings.exposure:.6g}"]
    if shot.sky:
        words.append("SKY=" + ",".join(f"{c:.6g}" for c in shot.sky))
    if abs(shot.rate() - 24) > 1e-6:
        words.append(f"TIME=--fps {shot.rate():g}")
    if shot.world_file:
        words.append(f"ENVIRONMENT={shot.world_file}")
    if shot.smoke:
        words += [f"VOLUME={shot.smoke}", "VOLUME_OPTIONS=--volume-up z"]
    if len(shot.document.json.get("cameras", [])) > 1 and shot.camera_name:
        words.append(f"CAMERA={shot.camera_name}")
    return "make -f " + " ".join(map(shlex.quote, [makefile(), *words]))


def export(scene, path, **options):
    """Writes the files; returns the lines for the user and the make line. The open file is as before."""
    if bpy.context.object and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    shot = Shot(scene, path, **options)
    try:
        before = settle.read_glb(shot.path)
    except (OSError, ValueError, struct.error):
        before = None   # none, or no .glb
    shot.export()
    if before:
        settle.settle(shot.path, before)
    return shot.notes.text(), make_line(shot)


class ExportTempolux(bpy.types.Operator):
    """Export a shot for tempolux"""
    bl_idname, bl_label = "export_scene.tempolux", "Export for tempolux"
    filepath: bpy.props.StringProperty(subtype="FILE_PATH", default="shot.glb")
    bake: bpy.props.IntProperty(
        name="Bake", default=1024, min=0, description="Largest side of a baked texture; 0: none is baked"
    )
    deform: bpy.props.BoolProperty(name="Deformation", default=True)

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        lines, line = export(
            context.scene, bpy.path.ensure_ext(self.filepath, ".glb"), bake=self.bake, deform=self.deform
        )
        for text in lines:
            self.report({"WARNING"}, text)
        self.report({"INFO"}, line)
        print(line)
        return {"FINISHED"}


def menu(self, context):
    self.layout.operator(ExportTempolux.bl_idname, text="tempolux (.glb)")


def register():
    bpy.utils.register_class(ExportTempolux)
    bpy.types.TOPBAR_MT_file_export.append(menu)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(menu)
    bpy.utils.unregister_class(ExportTempolux)

"""Exports a shot of Blender so that tempolux renders what Cycles shows. Page: docs/from-blender.md

    blender -b shot.blend -P tempolux_export.py -- shot.glb [--bake 1024 | --no-bake] [--no-deform]

Written: shot.glb, and shot_world.exr where the world is more than one colour. Printed: what is lost or baked, the worst first, and the make
line that renders the shot. The .blend is not changed. The work is done by the folder tempolux_addon beside this file.
"""
import argparse
import os
import sys
import tempfile
import traceback

import bpy

KNOWN = (3, 4), (5, 3)   # versions that the tests have seen, first and last

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
sys.dont_write_bytecode = True


class Quiet:
    """Keeps what Blender prints from the terminal, hundreds of lines, and shows it if the export fails."""

    def __enter__(self):
        sys.stdout.flush()
        sys.stderr.flush()
        self.kept, self.said = [os.dup(1), os.dup(2)], tempfile.TemporaryFile()
        for stream in (1, 2):
            os.dup2(self.said.fileno(), stream)

    def __exit__(self, kind, *_):
        sys.stdout.flush()
        sys.stderr.flush()
        for stream, kept in zip((1, 2), self.kept):
            os.dup2(kept, stream)
            os.close(kept)
        if kind or os.environ.get("TEMPOLUX_LOUD"):
            self.said.seek(0)
            sys.stderr.write(self.said.read().decode(errors="replace"))


def say(text):
    print("tempolux_export.py:", text, file=sys.stderr)


def read_words():
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="blender -b shot.blend -P tempolux_export.py --")
    parser.add_argument("path", metavar="shot.glb", help="the file to write")
    parser.add_argument("--bake", type=int, default=1024, metavar="N", help="largest side of a baked texture in pixels (1024)")
    parser.add_argument("--no-bake", action="store_true", help="write the mean of what would be baked")
    parser.add_argument("--no-deform", action="store_true", help="meshes keep the shape of the first frame")
    chosen = parser.parse_args(words)
    if not chosen.path.endswith(".glb"):
        parser.error("the file to write must end in .glb")
    return chosen


def main():
    chosen = read_words()
    if not KNOWN[0] <= bpy.app.version[:2] <= KNOWN[1]:
        say(f"Blender {bpy.app.version_string} is not known to this script ({'.'.join(map(str, KNOWN[0]))} to "
            f"{'.'.join(map(str, KNOWN[1]))} are); it tries")
    try:
        import numpy  # noqa: F401
    except ImportError:
        say("Blender's Python has no numpy; on Debian: apt-get install python3-numpy (No module named 'numpy')")
        sys.exit(2)
    import tempolux_addon
    try:
        with Quiet():
            lines, line = tempolux_addon.export(bpy.context.scene, chosen.path, bake=0 if chosen.no_bake else chosen.bake,
                                                deform=not chosen.no_deform)
    except Exception as trouble:   # noqa: BLE001: one line for the user
        place = traceback.extract_tb(trouble.__traceback__)[-1]
        say(f"{chosen.path} is not written: {type(trouble).__name__}: {trouble} (at {os.path.basename(place.filename)}:{place.lineno})")
        if os.environ.get("TEMPOLUX_LOUD"):
            traceback.print_exc()
        sys.exit(2)
    for text in lines:
        say(text)
    print(line)


if __name__ == "__main__" and bpy.app.background:
    main()

"""Exports .blend files made by scripts from each Blender that is there, and prints what was kept, baked and lost.

    python3 tests/bench/blender_cases.py [--cases FOLDER] [--only c06 ...] [--blender PATH ...] [--out FOLDER]

FOLDER has CASE.py that write the .blend they are told to (../shared/scenes/blender). A Blender is a program, or the Python of a virtual
environment with bpy; without --blender all of build/peers/bpy-*/bin/python, and blender on PATH. Exit 1 if one raises or writes no file.
"""

import argparse
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = TOP / "pipelines/blender/tempolux_export.py"
MAKE = """import runpy, sys, os
case, out = sys.argv[-2:]
sys.path.insert(0, os.path.dirname(case)); sys.argv = [case, out]; sys.dont_write_bytecode = True
runpy.run_path(case, run_name="__main__")
"""
OPEN = """import bpy, runpy, sys
blend, script, *words = sys.argv[1:]
bpy.ops.wm.open_mainfile(filepath=blend)
sys.argv = ["blender", "-b", blend, "-P", script, "--", *words]
runpy.run_path(script, run_name="__main__")
"""


def blenders():
    found = sorted(map(str, TOP.glob("build/peers/bpy-*/bin/python")))
    return found + ([shutil.which("blender")] if shutil.which("blender") else [])


def is_module(blender):
    return os.path.basename(blender).startswith("python")


def run(words):
    """Debian's Blender takes the numpy of the first python3 on PATH."""
    path = os.environ["PATH"] if is_module(words[0]) else "/usr/bin:" + os.environ["PATH"]
    return subprocess.run(
        list(map(str, words)), capture_output=True, text=True, timeout=600, env={**os.environ, "PATH": path}
    )


def make(blender, case, blend, helper):
    """Writes the case's .blend; the tail of what was said if the case cannot exist in this Blender."""
    helper.write_text(MAKE)
    done = run([blender, "-B", helper, case, blend] if is_module(blender) else
               [blender, "-b", "--factory-startup", "-P", helper, "--", case, blend])
    return None if blend.exists() else " ".join((done.stderr + done.stdout).split("\n")[-4:])


def export(blender, blend, glb, helper, options=()):
    helper.write_text(OPEN)
    if is_module(blender):
        return run([blender, "-B", helper, blend, SCRIPT, glb, *options])
    return run([blender, "-b", "--factory-startup", blend, "-P", SCRIPT, "--", glb, *options])


def version_of(blender):
    said = run(
        [blender, "-c", "import bpy; print(bpy.app.version_string)"] if is_module(blender) else [blender, "--version"]
    ).stdout
    return said.replace("Blender", "").split()[0] if said.split() else "none"


def contents(glb):
    """How many of each kind the file holds."""
    data = glb.read_bytes()
    document = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])
    counts = {kind: len(document.get(kind, [])) for kind in ("nodes", "meshes", "materials", "images", "cameras")}
    channels = sum(len(a["channels"]) for a in document.get("animations", []))
    return (
        ", ".join(f"{n} {kind}" for kind, n in {**counts, "channels": channels}.items() if n)
        + f", {len(data) // 1000} kB"
    )


def show(case, done, glb):
    said = [
        line.replace("tempolux_export.py: ", "")
        for line in done.stderr.splitlines()
        if line.startswith("tempolux_export.py: ")
    ]
    raised = done.returncode != 0 or "Traceback" in done.stderr + done.stdout or not glb.exists()
    print(f"  {case}: {'RAISES' if raised else contents(glb)}")
    for line in (done.stderr + done.stdout).splitlines()[-12:] if raised else said:
        print("     ", line)
    return raised


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=pathlib.Path, default=TOP.parent / "shared/scenes/blender")
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--blender", nargs="*", default=None)
    parser.add_argument("--out", type=pathlib.Path, default=TOP / "build/cases")
    words = parser.parse_args()
    failed = 0
    cases = [c for c in sorted(words.cases.glob("c[0-9]*.py")) if not words.only or c.stem.split("_")[0] in words.only]
    for blender in words.blender or blenders():
        version = version_of(blender)
        folder = words.out / version
        folder.mkdir(parents=True, exist_ok=True)
        print(f"Blender {version}")
        for case in cases:
            blend, glb = folder / f"{case.stem}.blend", folder / f"{case.stem}.glb"
            for file in (blend, glb):
                file.unlink(missing_ok=True)
            missing = make(blender, case, blend, folder / "make.py")
            if missing:
                print(f"  {case.stem}: the case cannot exist here: {missing[-160:]}")
                continue
            failed += show(case.stem, export(blender, blend, glb, folder / "open.py"), glb)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()

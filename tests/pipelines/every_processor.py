#!/usr/bin/env python3
"""Every stage gives the same bytes on every processor: every_processor.py BIN [--long] [--only NAME] [--models MODEL...]

Run at the top of the tree; BIN is the folder with the tools. Small chains run on this processor, then under qemu-user, which
emulates other ones. The names of all files agree (they end in keys), and so do the digests of all files. Emulated processors
compute an estimate such as rcpps differently from every maker.

All chains run on the first model and one chain on each. The plan is made on this processor, because its pilots take a minute
there. With --long all chains run on all models, the plan is emulated, too, and so is the example of formats/plan/plan.md. Helper programs that read images, packed meshes and OpenVDB are started by the tools and not
emulated. Without qemu-x86_64 the test is skipped.
"""

import argparse
import array
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

# scenes made by scripts
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "stress"))
from family_environment import write_hdr  # noqa: E402
from scenes import Scene, box_mesh, sphere_mesh  # noqa: E402

for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
    os.environ.pop(name, None)

MODELS = ["Haswell", "EPYC"]
SMALL = {
    "SIZE": "16x9",
    "PHOTONS": "1k",
    "POINTS": "--point-count 200 --light-samples 1",
    "CACHE": "--rays 64 --error-bound 1",
    "INDIRECT": "records",
}


def room(camera_moves=False):
    scene = Scene()
    scene.room((-2, 0, -2), (2, 2.5, 2), scene.material((0.7, 0.6, 0.5)))
    scene.quad(
        (-0.4, 2.4, -0.4), (0.4, 2.4, -0.4), (0.4, 2.4, 0.4), (-0.4, 2.4, 0.4), scene.material(0, 8.0, one_sided=True)
    )
    camera = scene.camera((0, 1.2, 1.8), (0, 0.9, 0))
    if camera_moves:
        scene.animate(camera, "translation", [0, 8 / 24], [(0, 1.2, 1.8), (0.4, 1.2, 1.6)])
    return scene


def glass(folder):
    """A glass ball, a rough glass box with colour, metal; lamps of all kinds."""
    scene = room(True)
    scene.mesh(*sphere_mesh((0.4, 0.5, 0), (0.4, 0.4, 0.4), 6, False)[:2], scene.glass())
    scene.mesh(*box_mesh((-0.9, 0, -0.5), (-0.3, 0.7, 0.1)), scene.glass(0.2, 1.4, (0.5, 0.3)))
    scene.mesh(
        *box_mesh((0.9, 0, -0.9), (1.4, 1.1, -0.4)),
        scene.material((0.9, 0.7, 0.4), metallic=1, roughness=0.3, specular=1),
    )
    scene.point_light((1.2, 2, 0.8), 2)
    scene.spot_light((-1.2, 2, 1), (0, 0.3, 0), 4, 0.3, 0.6)
    return {
        "SCENE": scene.save(folder / "glass.gltf"),
        "FRAMES": "0-1",
        "SPLIT": "on",
        "FILTER": "3",
        "CHANNELS": "RGBA,layers,Z,N,id,P,albedo",
    }


def skinned(scene):
    """A bar that bends: the upper joint turns by half a radian over eight frames."""
    positions, joints, weights, triangles = array.array("f"), array.array("H"), array.array("f"), array.array("I")
    for i in range(5):
        for x, z in ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)):
            positions.extend((x, i * 0.25, z))
            joints.extend((0, 1, 0, 0))
            weights.extend((1 - i / 4, i / 4, 0, 0))
    for i in range(4):
        for k in range(4):
            a, b = 4 * i + k, 4 * i + (k + 1) % 4
            triangles.extend((a, b, a + 4, b, b + 4, a + 4))
    bar = scene.mesh(positions, triangles, scene.material((0.2, 0.5, 0.8)))
    attributes = scene.document["meshes"][-1]["primitives"][0]["attributes"]
    attributes["JOINTS_0"] = scene._accessor(array.array("I", joints.tobytes()), "SCALAR", 5125)
    scene.document["accessors"][attributes["JOINTS_0"]].update({"componentType": 5123, "type": "VEC4", "count": 20})
    attributes["WEIGHTS_0"] = scene._accessor(weights, "VEC4", 5126)
    tip = len(scene.document["nodes"])
    scene.document["nodes"].append({"translation": [0, 0.5, 0]})
    root = scene.node(children=[tip])
    scene.document["skins"] = [
        {
            "joints": [root, tip],
            "inverseBindMatrices": scene._accessor(
                array.array(
                    "f",
                    [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5, 0, 1],
                ),
                "VEC4",
                5126,
            ),
        }
    ]
    scene.document["accessors"][-1].update({"type": "MAT4", "count": 2})
    scene.document["nodes"][bar]["skin"] = 0
    scene.animate(tip, "rotation", [0, 8 / 24], [(0, 0, 0, 1), (0, 0, math.sin(0.25), math.cos(0.25))])


def skins(folder, **variables):
    scene = room()
    skinned(scene)
    return {"SCENE": scene.save(folder / "skins.gltf"), "FRAMES": "0-2", **variables}


def sky(folder):
    """Under a map of light with a sun; the camera walks."""
    rows = [(1, bytes([90, 110, 160, 128])), (1, bytes([120, 140, 170, 128])), (2, bytes([60, 50, 40, 127]))]
    scene = Scene()
    scene.quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3), scene.material((0.5, 0.4, 0.3)))
    scene.mesh(*box_mesh((-0.5, 0, -0.5), (0.5, 1, 0.5)), scene.material(0.6, roughness=0.4, specular=1))
    scene.sun((-0.4, -1, -0.3), 2)
    camera = scene.camera((0, 1, 3), (0, 0.5, 0))
    scene.animate(camera, "translation", [0, 8 / 24], [(0, 1, 3), (0.6, 1.1, 2.8)])
    return {"SCENE": scene.save(folder / "sky.gltf"), "FRAMES": "0-4", "METHOD": "walkthrough", "KEY_DISTANCE": "4",
            "ENVIRONMENT": write_hdr(folder / "sky.hdr", 8, rows)}


def smoke(folder, tools):
    """A ball of smoke; the second frame's photons update the first's."""
    for frame in (0, 1):
        values = b"".join(
            struct.pack("<f", max(0.0, 1 - math.dist((x, y + frame / 2, z), (4, 4, 4)) / 3))
            for x in range(8)
            for y in range(8)
            for z in range(8)
        )
        subprocess.run(
            [
                tools.parent / "tests" / "make-vdb",
                folder / f"smoke_000{frame}.vdb",
                "8",
                "8",
                "8",
                ".12",
                "-.5",
                ".6",
                "-.5",
            ],
            input=values,
            check=True,
        )
    scene = room()
    return {
        "SCENE": scene.save(folder / "smoke.gltf"),
        "FRAMES": "0-1",
        "VOLUME": folder / "smoke_####.vdb",
        "VOLUME_OPTIONS": "--sigma-t 6 --albedo .8 --volume-frames 0-1",
        "UPDATE": "30%",
    }


def chains(folder, tools):
    yield "glass", glass(folder)
    yield "skins, light over time", skins(folder, MOVING="time", QUALITY="draft")
    yield "skins, changes of records", skins(folder, MOVING="records", QUALITY="draft")
    yield "skins, preview", skins(folder, METHOD="preview", FRAMES="0-1", INDIRECT="auto")
    yield "map of light, walkthrough", sky(folder)
    if (tools.parent / "tests" / "make-vdb").exists():
        yield "smoke", smoke(folder, tools)
    else:
        print("left out: smoke, as the tools are built without volumes")


def digests(tools, out):
    """{name: digest} of all files but statistics, plans' notes and markers."""
    files = [
        p
        for p in sorted(out.rglob("*"))
        if p.is_file() and p.suffix != ".json" and p.relative_to(out).parts[0] not in ("state", "shown")
    ]
    found = {}
    for path in files:
        done = subprocess.run([tools / "tempolux-info", "--digest", path], capture_output=True, text=True)
        found[str(path.relative_to(out))] = (
            done.stdout.split()[0] if done.returncode == 0 else str(hash(path.read_bytes()))
        )
    return found


def run(tools, out, variables, emulator=None):
    values = [f"{k}={v}" for k, v in (SMALL | variables | ({"RUN": emulator} if emulator else {})).items()]
    done = subprocess.run(
        [
            "nice",
            "make",
            "-f",
            "Makefile.example",
            "--no-print-directory",
            "demo",
            f"OUT={out}",
            f"BIN={tools}",
            *values,
        ],
        capture_output=True,
        text=True,
        timeout=1500,
    )
    if done.returncode:
        raise RuntimeError((done.stdout + done.stderr)[-1500:])
    return digests(tools, out)


def emulator_of(model, folder, plan_too):
    """A program for RUN that starts tools under qemu."""
    path = folder / f"on-{model}"
    native = "" if plan_too else 'case $1 in */scene-plan) exec "$@" ;; esac\n'
    path.write_text(f"""#!/bin/sh
{native}log=$(mktemp)
qemu-x86_64 -cpu {model} "$@" 2> "$log"; code=$?
grep -v 'TCG does' "$log" >&2
rm -f "$log"
exit $code
""")
    path.chmod(0o755)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=Path)
    parser.add_argument("--long", action="store_true", help="the plan is emulated, too")
    parser.add_argument("--only", default="")
    parser.add_argument("--models", nargs="*", default=MODELS)
    arguments = parser.parse_args()
    if not shutil.which("qemu-x86_64"):
        print("skipped: qemu-x86_64 (package qemu-user) is not there")
        return 77
    tools, failed = arguments.bin.resolve(), 0
    with tempfile.TemporaryDirectory(prefix="processors") as folder:
        folder = Path(folder)
        emulators = {model: emulator_of(model, folder, arguments.long) for model in arguments.models}
        for number, (title, variables) in enumerate(chains(folder, tools)):
            if arguments.only not in title:
                continue
            expected = run(tools, folder / f"{number}", variables)
            for model, emulator in list(emulators.items())[:None if arguments.long or number == 0 else 1]:
                there = run(tools, folder / f"{number}-{model}", variables, emulator)
                differing = sorted(f for f in expected.keys() | there.keys() if expected.get(f) != there.get(f))
                failed += bool(differing)
                print(
                    f"{'FAILED' if differing else 'ok'}: {title}, {model}: {len(differing)} of {len(expected)} files differ"
                    + "".join(
                        f"\n    {f}: {expected.get(f, 'not made')} {there.get(f, 'not made')}" for f in differing
                    ),
                    flush=True,
                )
        if arguments.long and arguments.only in "plan":
            for model, emulator in emulators.items():
                done = subprocess.run(
                    ["sh", "tests/pipelines/plan_example.sh", f"{emulator} {tools}"], capture_output=True, text=True
                )
                failed += done.returncode != 0
                print(
                    f"{'FAILED' if done.returncode else 'ok'}: the example of plan.md, {model}"
                    + (done.stdout if done.returncode else ""),
                    flush=True,
                )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

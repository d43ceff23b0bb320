"""Canaries: the smallest chain of each part of the evidence. What it made (digests) and how much it did (instructions).

Digests are equal on every processor and for every compiler that keeps to the rules of the build. Instructions are
those of callgrind, one thread. They belong to a compiler and its libraries (stamp): where these differ from the stored
ones, digests alone are compared, and the command says so. Without valgrind, too, digests alone are compared.
"""
import hashlib
import math
import multiprocessing
import os
import re
import shutil
import struct
import subprocess
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pipeline
from measure import Missing, Steps

WITHIN = 0.02         # of the instructions; placement of memory moves them by less than a thousandth
KINDS = ("photons", "irradpoints", "irradcache", "radsamples", "meshirrad", "exr")
SMALL = {
    "SIZE": "32x18",
    "PHOTONS": "4k",
    "POINTS": "--point-count 1k",
    "CACHE": "--rays 20 --error-bound 1",
    "PIXELS": "--spp 2 --pixel-error 0",
    "FILTER": "1",
}
BARE = SMALL | {"FILTER": "none"}     # for parts that do not measure the filter: a change of it names none of them
S1, S2, S3 = (f"pipelines/scenes/{name}.glb" for name in ("S1_cornell", "S2_cornell_moving", "S3_indirect_room"))

# By make: variables of Makefile.example.
MADE = {
    "still": {"SCENE": S2, "FRAMES": "10", "INDIRECT": "records", **SMALL},
    "day": {"SCENE": "day.gltf", "FRAMES": "0", "SKY": "1,1.2,1.5", "INDIRECT": "records", "METHOD": "frames", **SMALL},
    "sky": {"SCENE": S1, "FRAMES": "0", "SKY": "1,1,1", "METHOD": "frames", **SMALL},
    "walk": {
        "SCENE": "pan.glb",
        "FRAMES": "0-4",
        "INDIRECT": "records",
        "METHOD": "walkthrough",
        "KEY_DISTANCE": "4",
        **SMALL,
    },
    "warp": {
        "SCENE": "pan.glb",
        "FRAMES": "0-4",
        "INDIRECT": "records",
        "METHOD": "walkthrough",
        "KEY_DISTANCE": "4",
        **BARE,
    },
    "localised": {"SCENE": S2, "FRAMES": "0-2", "INDIRECT": "records", "MOVING": "records", **BARE},
    "temporal": {"SCENE": S2, "FRAMES": "0-2", "INDIRECT": "records", "MOVING": "time", **BARE},
    "split": {"SCENE": S3, "FRAMES": "0", "INDIRECT": "records", "SPLIT": "on", **BARE},
    "filter": {"SCENE": S2, "FRAMES": "9-11", "INDIRECT": "paths", **SMALL, "FILTER": "5"},
    "preview": {"SCENE": S2, "FRAMES": "0-1", "METHOD": "preview", "SIZE": "32x18", "PHOTONS": "4k", "FILTER": "none"},
    "smoke": {
        "SCENE": S1,
        "FRAMES": "0-1",
        "INDIRECT": "gather",
        "VOLUME": "smoke_####.vdb",
        "VOLUME_OPTIONS": "--sigma-t 6 --albedo .8 --volume-frames 0-1",
        "UPDATE": "20%",
        **BARE,
    },
}
# By the tools: words of each command; a word that ends in .exr or .photons without a folder is a file of the canary's own.
TYPED = {
    "paths": [
        ["frame-render", S2, "--frame", "10", "--size", "32x18", "--integrator", "path", "--spp", "4", "-o", "p.exr"]
    ],
    "photons": [["photon-trace", S2, "--frame", "10", "--photons", "20k", "-o", "p.photons"]],
    "help": [[tool, "--help"] for tool in ("photon-trace", "irradcache-build", "frame-render", "scene-plan")],
    "nearest": [["tests/nearest", "20000", "2000", "1"]],
    "replace": [["tests/replace_photons", "--replaced", "300", "--short"]],
}
NAMES = (*MADE, *TYPED)


def stamp(bench):
    """Compiler and libraries that the instructions belong to."""
    compiler = subprocess.run(["c++", "--version"], capture_output=True, text=True).stdout.partition("\n")[0]
    linked = subprocess.run(["ldd", bench.bin / "frame-render"], capture_output=True, text=True).stdout
    libraries = sorted(set(re.findall(r"lib(?:embree|OpenEXR|tbb|c)\S*\.so\.\S*", linked)))
    return f"{compiler}, {' '.join(libraries)}"


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def digests(bench, folder):
    """Of all data in a folder, by folder and kind, without the files' names; {} for none."""
    found = {}
    for file in sorted(p for p in folder.rglob("*") if p.suffix[1:] in KINDS and ".plan" not in p.name):
        inside = file.relative_to(folder).parts
        found.setdefault((inside[0] if len(inside) > 1 else file.name), []).append(file)
    def of(files):
        told = bench.run([bench.bin / "tempolux-info", "--digest", *files]).stdout
        return digest("\n".join(line.split()[0] for line in told.splitlines()))
    return {name: of(files) for name, files in found.items()}


def instructions(logs):
    """By tool."""
    total = {}
    for file in logs.iterdir():
        counted = re.search(r"Collected : (\d+)", file.read_text(errors="replace"))
        if counted:
            tool = file.name.rpartition(".")[0]
            total[tool] = total.get(tool, 0) + int(counted.group(1))
    return total


def planned(bench, variables):
    """What the preset decides about the scene at its usual size: words of all commands, without the keys in names."""
    wish = {name: value for name, value in variables.items() if name not in SMALL or name == "FILTER"} | {
        "SIZE": "320x180"
    }
    with tempfile.TemporaryDirectory() as out:
        pipeline.run_make(bench.project, bench.bin, out, "plan", **wish)
        words = re.findall(r"^\S+: words := .*$", (Path(out) / "plan.mk").read_text(), re.M)
    return digest("\n".join(sorted(re.sub(r"-[0-9a-f]{10}(?![0-9a-f])", "", line) for line in words)))


def inputs(bench, name, folder):
    """Scenes that a canary makes; the variables with their places."""
    variables = {
        k: str(bench.project / v) if k == "SCENE" and v.startswith("pipelines/") else v for k, v in MADE[name].items()
    }
    if variables["SCENE"] == "pan.glb":
        variables["SCENE"] = str(folder / "pan.glb")
        bench.run(
            [
                "python3",
                "-B",
                bench.project / "pipelines" / "scenes" / "make_walkthrough.py",
                "pan",
                bench.project / S3,
                variables["SCENE"],
            ]
        )
    if variables["SCENE"] == "day.gltf":
        variables["SCENE"] = str(folder / "day.gltf")
        bench.run(["python3", "-B", Path(__file__).with_name("day_room.py"), variables["SCENE"]])
    if "VOLUME" in variables:
        variables["VOLUME"] = str(folder / variables["VOLUME"])
        make_vdb = bench.programs.parent / "make-vdb"
        if not make_vdb.exists():
            raise Missing("built without volumes")
        for frame in range(2):
            ball = [
                max(0.0, 1 - math.dist((7.5, 5 + frame, 7.5), (x, y, z)) / 5)
                for x in range(16)
                for y in range(16)
                for z in range(16)
            ]
            subprocess.run([make_vdb, folder / f"smoke_{frame:04d}.vdb", *map(str, (16, 16, 16, .06, -.45, .5, -.45))],
                           input=struct.pack(f"<{len(ball)}f", *ball), check=True)
    return variables


def run(bench, name):
    """{"digests": by folder or file, "instructions": by tool}"""
    folder = Path(tempfile.mkdtemp(prefix="canary."))
    logs, out = folder / "logs", folder / "out"
    counted = ["sh", str(Path(__file__).with_name("counted.sh")), str(logs)]
    try:
        logs.mkdir()
        out.mkdir()
        made = {}
        if name in MADE:
            variables = inputs(bench, name, folder)
            made["plan"] = planned(bench, variables)
            os.environ |= {
                "TEMPOLUX_THREADS": "1",
                "UNCOUNTED": "tempolux-info" + ("" if name == "still" else " scene-plan"),
            }  # its pilots are slow
            pipeline.run_make(bench.project, bench.bin, out, "demo", RUN=" ".join(counted), **variables)
        for command in TYPED.get(name, ()):
            tool = bench.programs / command[0][6:] if command[0].startswith("tests/") else bench.bin / command[0]
            words = [
                (
                    str(bench.project / w)
                    if w.startswith("pipelines/")
                    else str(out / w) if re.fullmatch(r"\w+\.(exr|photons)", w) else w
                )
                for w in command[1:]
            ]
            bench.run([*counted, tool, *words], {"TEMPOLUX_THREADS": "1"})
        return {"digests": made | digests(bench, out), "instructions": instructions(logs)}
    finally:
        for variable in ("TEMPOLUX_THREADS", "UNCOUNTED"):
            os.environ.pop(variable, None)
        shutil.rmtree(folder, ignore_errors=True)


shared = None  # the Bench of run_all(), which the processes inherit: it cannot be sent to them


def run_shared(name):
    return run(shared, name)


def run_all(bench, names):
    """What these canaries do with these programs; each runs once, four at a time at most."""
    known = Steps(bench.out / "steps" / "canaries.json", bench.programs_digest())
    ran = {}
    global shared
    shared = bench
    # Processes, since run() sets variables of the environment.
    with ProcessPoolExecutor(min(4, os.cpu_count() or 1), multiprocessing.get_context("fork")) as workers:
        running = {name: workers.submit(run_shared, name) for name in names if name not in known.kept["found"]}
        for name in names:
            try:
                ran[name] = known(name, lambda: running[name].result())
            except Missing as reason:
                print(f"canary {name}: left out: {reason}", flush=True)
    return ran


def differences(row, ran, stamp_now):
    """Words on what a row's canaries do otherwise than when it was measured."""
    words = []
    for name, now in ran.items():
        was = row["canary"].get(name)
        if not was:
            words.append(f"{name}: no run of the canary was stored when the part was measured")
            continue
        words += [
            f"{name}: {part} differ" for part in now["digests"] if was["digests"].get(part) != now["digests"][part]
        ]
        if row["compiler"] != stamp_now:
            continue
        for tool, count in now["instructions"].items():
            before = was["instructions"].get(tool)
            if before and abs(count / before - 1) > WITHIN:
                words.append(f"{name}: {tool} takes {100 * (count / before - 1):+.1f} % instructions")
    return words

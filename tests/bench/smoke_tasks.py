#!/usr/bin/env python3
"""The eight tasks of table 1 in paper B (Jimenez, Myszkowski, Pueyo 2005), by our tools: CPU seconds a frame of each.

    python3 tests/bench/smoke_tasks.py build/release [--folder DIR]

S6 (../shared/scenes), frames 5 to 12 from the map of frame 4 on, as a range: of 299 880 and 999 810 paths a tenth is traced again in each frame,
pilots (3 %) counted, chosen by the first difference in the extinction as in the paper. All light, direct too, is counted from photons, in
cells of the smoke and in light textures of the surfaces, and shown by a ray a pixel. Printed are CPU seconds as a processor would
take whose bare walk is NORMAL_WALK (tests/bench/measure.py), threads together; the paper's are seconds of two Pentium IV at 1.7 GHz with a
Radeon 9700 Pro, one thread for lighting and one for rendering.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import pipeline  # noqa: E402
from measure import NORMAL_WALK, Bench, walk_speed  # noqa: E402

FIRST, LAST, SIZE = 5, 12, "640x360"
PAPER = {299880: (0.52, 0.17), 999810: (1.58, 0.32)}
#: Task of the paper: tool and its phases that do it.
LIGHTING = [
    ("compute the new frame (read and place the smoke)", {"trace": ["evaluate", "build"]}),
    ("send the pilot photons", {"trace": ["pilots"]}),
    ("sort the priority array", {"trace": ["choose"]}),
    ("delete the photons of a group, re-shoot them, write the map", {"trace": ["trace", "commit"]}),
]
RENDERING = [
    ("derive the histogram: smoke", {"compose": ["photons"]}),
    ("derive the histogram: surfaces", {"textures": ["read photons", "build", "count"]}),
    ("apply the smoothing filter: smoke", {"compose": ["filter"]}),
    ("apply the smoothing filter: surfaces", {"textures": ["filter", "write"]}),
    ("project the textures: smoke", {"compose": ["build", "march", "write"]}),
    ("project the textures: surfaces, a lamp sampled at each pixel", {"render": ["build", "read light texture", "render", "data channels", "write"]}),
]


def measured(folder, programs, scene, paths):
    """Phases of each tool, CPU s a frame."""
    made = scene.parent
    smoke = ["--volume", made / "S6_smoke_vdb/smoke_####.vdb", "--sigma-t", 10, "--albedo", ".85,.85,.88"]
    frames = ["--frames", f"{FIRST}-{LAST}"]

    def run(name, tool, *options):
        stats = folder / f"{name}.json"
        subprocess.run([programs / tool, *map(str, options), "-q", "--stats", stats], check=True)
        data = json.loads(stats.read_text())
        phases[name] = {}
        for phase in data["phases"]:
            phases[name][phase["name"]] = phases[name].get(phase["name"], 0) + phase["cpu_s"] / (LAST - FIRST + 1)
    phases = {}
    run("plan", "scene-plan", scene, *smoke, "--frames", "0-23", "--update", "10%", "-o", folder / "plan")
    frozen = [*smoke, "--majorants", pipeline.majorants_of(folder / "plan", 0)]
    light = ["--photons", paths, "--kinds", "direct,indirect,volume"]
    photons = folder / "p.####.photons"
    run("first", "photon-trace", scene, *frozen, "--frame", FIRST - 1, *light, "--pilots", "3%", "-o", photons)
    run("fresh", "photon-trace", scene, *frozen, *frames, *light, "-o", folder / "f.####.photons")
    run("trace", "photon-trace", scene, *frozen, *frames, *light, "--update", photons, "--share", "10%", "--strategy", "fde", "-o", photons)
    run("textures", "st-filter", "mesh", scene, *smoke, *frames, "--photons", photons, "--kinds", "direct,indirect", "-o", folder / "t.####.meshirrad")
    run("shown", "st-filter", "mesh", scene, *smoke, *frames, "--photons", photons, "-o", folder / "i.####.meshirrad")
    run("render", "frame-render", scene, *smoke, *frames, "--meshirrad", folder / "i.####.meshirrad", "--size", SIZE, "--spp", 1, "--pixel-error", 0,
        "--channels", "RGBA,layers,Z", "-o", folder / "c.####.exr")
    run("compose", "volume-compose", scene, *smoke, *frames, "--photons", photons, "--base", folder / "c.####.exr", "--direct", "photons", "--spp", 1,
        "-o", folder / "s.####.exr")
    return phases


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--folder", type=Path)
    options = parser.parse_args()
    build = options.build.resolve()
    scene = HERE.parents[2] / "shared/scenes/made/S6_smoke.glb"
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        bench = Bench(build, folder, HERE.parents[1], False, 1)
        bench.walk = walk_speed(bench)
        tables = {paths: measured(folder, build / "bin", scene, paths) for paths in PAPER}

    def seconds(phases, parts):
        return bench.normalised(sum(phases[tool].get(phase, 0) for tool, names in parts.items() for phase in names))
    print(f"Bare walk of this machine: {bench.walk:.2f}; normal is {NORMAL_WALK:.1f}.\n")
    print("| task | " + " | ".join(f"{paths} paths" for paths in PAPER) + " |\n|---|" + "---:|" * len(PAPER))
    for name, tasks, which in (("lighting", LIGHTING, 0), ("rendering", RENDERING, 1)):
        for task, parts in tasks:
            print(f"| {task} | " + " | ".join(f"{seconds(phases, parts):.4f}" for phases in tables.values()) + " |")
        sums = [sum(seconds(phases, parts) for _, parts in tasks) for phases in tables.values()]
        print(f"| **{name}** | " + " | ".join(f"**{s:.3f}**" for s in sums) + " |")
        print(f"| {name}, the paper | " + " | ".join(f"{PAPER[paths][which]:.2f}" for paths in PAPER) + " |")
    print("| reading the first map, once a range | " + " | ".join(
        f"{seconds(phases, {'trace': ['read map']}) * (LAST - FIRST + 1):.3f}" for phases in tables.values()) + " |")
    print("| a fresh map instead of an update | " + " | ".join(
        f"{seconds(phases, {'fresh': ['evaluate', 'build', 'trace', 'commit']}):.3f}" for phases in tables.values()) + " |")


if __name__ == "__main__":
    sys.exit(main())

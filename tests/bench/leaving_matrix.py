#!/usr/bin/env python3
"""What a scene does not need, scene by scene and stage by stage; what an edit costs.

    python3 -B tests/bench/leaving_matrix.py --out OUT   prints it; `make evidence PARTS=leaving-scenes` writes the page

Scenes: frames 0 to 3 at 64x36, QUALITY=draft, by make. A cell is the number of files that a stage makes, 0
if it does not run. A law is checked in each: a stage that only movers, smoke or a choice need has no file
without them, and no command maps the libraries of images and volumes if the scene has none. What breaks a
law is listed, and the exit code is 1. Edits: of the small rooms of tests/pipelines/walk_scenes.py. A cell
is the number of files that a make after one edit makes anew, with their CPU seconds and bytes beside those
of the whole run.
"""

import argparse
import collections
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests" / "pipelines"), str(TOP / "tests" / "stress")]
import walk_scenes  # noqa: E402
from scenes import Scene, sphere_mesh  # noqa: E402

SHARED = TOP.parent / "shared" / "scenes"
FRAMES, SIZE = "0-3", "64x36"
MOVERS = {"touched", "moved", "kept"}  # folders that only movers or light that changes need
SMOKE = {"refined", "smoke", "majorants", "composed"}  # that only a medium needs
WISHES = {
    "split": "split",
    "walk": "walkthrough",
    "walked": "walkthrough",
    "still": "still",
}  # that a decision needs


def ball(path, metal, shines):
    """One ball under a sky, with no lamp: matte, a mirror, or one that shines."""
    scene = Scene()
    material = (
        scene.material(0.0, 1.0)
        if shines
        else scene.material(0.7, metallic=float(metal), roughness=0 if metal else 1, specular=float(metal))
    )
    mesh = sphere_mesh((0, 0, 0), (1, 1, 1), 12, inwards=False)
    scene.mesh(*mesh[:2], material, mesh[2])
    scene.camera((0, 0, 4), (0, 0, 0))
    scene.save(path)
    return path


def the_scenes(folder):
    """(name, variables of make, what the scene has)"""
    made, found = SHARED / "made", SHARED / "found" / "gltf"
    own = TOP / "pipelines" / "scenes"
    sky = {"SKY": "1,1,1"}
    yield "ball, sky", {"SCENE": ball(folder / "matte.gltf", False, False)} | sky, set()
    yield "mirror ball, sky", {"SCENE": ball(folder / "mirror.gltf", True, False)} | sky, set()
    yield "ball that shines", {"SCENE": ball(folder / "shines.gltf", False, True)}, set()
    yield "S1", {"SCENE": own / "S1_cornell.glb"}, set()
    yield "S2", {"SCENE": own / "S2_cornell_moving.glb"}, {"movers"}
    yield "S3", {"SCENE": own / "S3_indirect_room.glb"}, set()
    yield "S4", {"SCENE": own / "S4_atrium.glb"}, set()
    yield "demo", {"SCENE": own / "evening.glb"}, {"movers", "images"}
    yield "S5", {"SCENE": made / "S5_moving_light.glb"}, {"movers"}
    yield "S6", {
        "SCENE": made / "S6_smoke.glb",
        "VOLUME": made / "S6_smoke_vdb" / "smoke_####.vdb",
        "VOLUME_OPTIONS": "--sigma-t 10 --albedo .85",
    }, {"smoke", "movers"}
    yield "S8", {"SCENE": made / "S8_window_room.glb", "LIGHT_UNITS": "spec", "SKY": "1.1,1.5,2"}, {"movers"}
    yield "living_room", {"SCENE": found / "godot" / "living_room.glb"} | sky, {"images"}


def environment(folder, debug):
    """With `debug` the loader lists what is mapped. Readers of images and volumes may not write files, so they
    run without."""
    clean = {
        name: value for name, value in os.environ.items() if not name.startswith("MAKE") and name != "MFLAGS"
    }
    return clean | ({"LD_DEBUG": "files", "LD_DEBUG_OUTPUT": str(folder / "libraries")} if debug else {})


def make(tools, out, variables, libraries, debug=False):
    words = {"FRAMES": FRAMES, "SIZE": SIZE, "QUALITY": "draft", "OUT": out, "BIN": tools} | variables
    shutil.rmtree(libraries, ignore_errors=True)
    libraries.mkdir(parents=True)
    done = subprocess.run(
        ["make", "-s", "-f", TOP / "Makefile.example", "demo", *(f"{n}={v}" for n, v in words.items())],
        cwd=TOP,
        capture_output=True,
        text=True,
        env=environment(libraries, debug),
    )
    if done.returncode:
        raise RuntimeError(f"{variables}: {done.stderr[-500:]}")


def mapped(libraries):
    """Heavy libraries that some process mapped."""
    found = set()
    for file in libraries.iterdir():
        text = file.read_text(errors="replace")
        found |= {name for name in ("OpenImageIO", "openvdb") if f"lib{name}" in text}
    return found


def files_of(out):
    """By folder of a stage: (files, CPU seconds, bytes), of the plan in force."""
    result = collections.defaultdict(lambda: [0, 0.0, 0])
    for stats in Path(out).glob("*/*.json"):
        data = json.loads(stats.read_text())
        if not isinstance(data, dict) or data.get("schema") != "tempolux.stats":
            continue
        entry = result[stats.parent.name]
        entry[0] += 1
        entry[1] += data["cpu_s"]
        entry[2] += sum(f.stat().st_size for f in stats.parent.glob(stats.stem + ".*") if f != stats)
    return result


def laws(name, has, stages, decisions, libraries):
    """Sentences on what ran without need."""
    if "movers" not in has:
        yield from (f"{name}: {folder}, but nothing moves" for folder in MOVERS & set(stages))
    if "smoke" not in has:
        yield from (f"{name}: {folder}, but there is no smoke" for folder in SMOKE & set(stages))
        if "openvdb" in libraries:
            yield f"{name}: OpenVDB is mapped, but there is no smoke"
    for folder, decision in WISHES.items():
        if folder in stages and not any(d.get(decision) for d in decisions):
            yield f"{name}: {folder}, but {decision} was not decided"
    if "images" not in has and "OpenImageIO" in libraries:
        yield f"{name}: OpenImageIO is mapped, but there are no images"
    kinds = {kind for d in decisions for kind in d.get("photon_kinds", "").split(",") if kind}
    if not kinds and {"photons", "stands"} & set(stages):
        yield f"{name}: photons, but no kind was decided"


def of_scenes(tools, folder):
    rows, broken, columns = [], [], []
    folder.mkdir(parents=True, exist_ok=True)
    for name, variables, has in the_scenes(folder):
        if not Path(variables["SCENE"]).exists():
            rows.append((name, None, "not here", 0))
            continue
        out, libraries = folder / "out", folder / "libraries"
        shutil.rmtree(out, ignore_errors=True)
        make(tools, out, variables, libraries, debug=not has & {"images", "smoke"})
        plan = json.loads((out / "plan.json").read_text())
        columns = columns or [stage["folder"] for stage in plan["stages"]]
        stages = files_of(out)
        decisions = [segment["decisions"] for segment in plan["segments"]]
        broken += laws(name, has, stages, decisions, mapped(libraries))
        because = {stage["folder"]: stage.get("because", "") for stage in plan["stages"]}
        rows.append((name, stages, because, sum(entry[1] for entry in stages.values())))
        print(name, {folder: entry[0] for folder, entry in stages.items()}, flush=True)
    return rows, columns, broken


def of_edits(tools, folder):
    """(scene, edit, files made anew of all, CPU s, bytes)"""
    rows = []
    for name, maker in (("box", walk_scenes.box_scene), ("open", walk_scenes.open_scene)):
        place, out, libraries = folder / "scene", folder / "edited", folder / "libraries"
        shutil.rmtree(out, ignore_errors=True)

        def run(edits, **more):
            shutil.rmtree(place, ignore_errors=True)
            place.mkdir()
            for file, data in maker(edits).items():
                (place / file).write_bytes(data)
            scene = next(place.glob("scene.g*"))
            before = {f: f.stat().st_mtime_ns for f in out.glob("*/*.json")} if out.exists() else {}
            make(tools, out, {"SCENE": scene, "FRAMES": "0-7"} | more, libraries)
            new = [f for f in out.glob("*/*.json") if before.get(f) != f.stat().st_mtime_ns]
            data = [(f, json.loads(f.read_text())) for f in new]
            data = [(f, d) for f, d in data if isinstance(d, dict) and d.get("schema") == "tempolux.stats"]
            return (
                collections.Counter(f.parent.name for f, _ in data),
                sum(d["cpu_s"] for _, d in data),
                sum(g.stat().st_size for f, _ in data for g in f.parent.glob(f.stem + ".*") if g != f),
            )

        rows.append((name, "the whole run", *run({})))
        edits = ["lamp", "object", "camera", "colour"] + (["texture"] if name == "open" else [])
        for edit in edits:
            rows.append((name, edit, *run({edit: 1})))
            run({})
        rows.append((name, "ERROR=.2", *run({}, ERROR=".2")))
        rows.append((name, "FRAMES=0-3", *run({}, FRAMES="0-3")))
        print(name, "edited", flush=True)
    return rows


def scenes_table(rows, columns):
    """(header, rows of cells) of the stages that run in some scene."""
    used = [c for c in columns if any(stages and c in stages for _, stages, *_ in rows)]
    table = [
        [
            name,
            *((str(stages[c][0]) if c in stages else "") if stages else "not here" for c in used),
            f"{cpu:.2f}",
        ]
        for name, stages, _, cpu in rows
    ]
    return ["scene", *used, "CPU s"], table


def edits_table(edits):
    return [
        [
            name,
            edit,
            ", ".join(f"{count} {folder}" for folder, count in sorted(counts.items())) or "none",
            f"{cpu:.2f}",
            f"{size / 1e3:.0f}",
        ]
        for name, edit, counts, cpu, size in edits
    ]


EDITS_HEADER = ["scene", "edit", "files made anew", "CPU s", "kB"]


REASONS_HEADER = ["scene", "stage", "why the plan takes it or leaves it out"]


def reasons(rows):
    return [
        [name, folder, why]
        for name, stages, because, _ in rows
        if stages
        for folder, why in because.items()
        if why
    ]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--build", type=Path, default=TOP / "build" / "release", help="build folder [build/release]"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder for runs")
    args = parser.parse_args()
    tools, folder = (args.build / "bin").resolve(), args.out.resolve()
    rows, columns, broken = of_scenes(tools, folder)
    edits = of_edits(tools, folder)
    header, cells = scenes_table(rows, columns)
    tables = [header, *cells, EDITS_HEADER, *edits_table(edits), REASONS_HEADER, *reasons(rows)]
    print("\n".join([" | ".join(row) for row in tables] + broken))
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()

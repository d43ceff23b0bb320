#!/usr/bin/env python3
"""Photons over time in figures: the tables of docs/notebook/density.md.

    python3 tests/bench/density.py BIN WORK static|alarms|period|events|equal|preview ... [--shared FOLDER] [--frames N]

static    a room in which nothing moves: error of the elements over frames in the window, against 1/sqrt(frames)
alarms    the same room: share of windows that close early
period    a room whose lamp changes by 30 % with a period of 60 and 240 frames: photons saved at equal error
events    a lamp switched, a block put elsewhere, a block born: elements whose window reaches across
equal     S2, S5, a furnished room: 25 k photons a frame with windows against 33 times as many in one frame, and against 25 k without windows:
          without blur by elements, smoothed by pictures
preview   METHOD=preview against QUALITY=draft: CPU seconds, seen error and flicker over a range of frames

The error of an element is that of sums / area / frames, without the filter in space, against a map of many photons; the mean over area of its square, divided by the
mean irradiance. Pictures are compared by aqm-compare, their references are path-traced halves or maps of many photons.
"""
import argparse
import json
import math
import os
import statistics
import subprocess
import sys
from pathlib import Path

here = Path(__file__).resolve()
for folder in ("stress", "formats"):
    sys.path.insert(0, str(here.parents[1] / folder))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import exr  # noqa: E402
import read_meshirrad as mesh  # noqa: E402
import pixels  # noqa: E402
from scenes import Scene  # noqa: E402
from seen import Seen, code  # noqa: E402

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("bin", type=lambda p: Path(p).resolve())
parser.add_argument("work", type=lambda p: Path(p).resolve())
parser.add_argument("what", nargs="+", choices=("static", "alarms", "period", "events", "equal", "preview"))
parser.add_argument("--shared", type=lambda p: Path(p).resolve(), default=here.parents[3] / "shared" / "scenes")
parser.add_argument("--frames", type=int, default=0, help="of a range; 0: as the row has it")
parser.add_argument("--scenes", default="S2,S5,room", help="of equal and preview, by names separated by commas")
parser.add_argument("--size", default="320x180")
parser.add_argument("--reference", type=int, default=256, help="samples per pixel of a half of preview's references")
options = parser.parse_args()
options.work.mkdir(parents=True, exist_ok=True)
MIDDLE = 16


def run(folder, tool, *words):
    """Runs a tool in WORK/folder; its CPU seconds."""
    (options.work / folder).mkdir(parents=True, exist_ok=True)
    before = os.times()
    subprocess.run([options.bin / tool, *map(str, words), "-q"], check=True, cwd=options.work / folder)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def room(change=None):
    """A box of 4 x 4 x 3 m with a block in it and a lamp under its ceiling, which `change` may animate."""
    scene = Scene()
    scene.room((-2, 0, -2), (2, 3, 2), scene.material(0.6))
    block = scene.room((-0.4, 0.02, -0.4), (0.4, 0.8, 0.4), scene.material(0.5))
    lamp = scene.quad((-0.5, 0, -0.5), (0.5, 0, -0.5), (0.5, 0, 0.5), (-0.5, 0, 0.5), scene.material(0.0, 10.0), translation=[0, 2.9, 0])
    scene.camera((0, 1.5, 1.9), (0, 1, 0), fov=1.2)
    if change:
        change(scene, block, lamp)
    return scene


def photons(folder, scene, frames, count, pattern="p.####.photons", *words):
    run(folder, "photon-trace", scene, "--frames", frames, "--photons", count, "--seed-mode", "frame", "--kinds", "indirect", "-o", pattern, *words)


def elements(folder, name):
    """Of each element that photons may reach: (surface, triangle, side, cell): (irradiance by its sums, area, frames before, after)."""
    m = mesh.read_meshirrad(options.work / folder / name)
    unit = float(m.header["unit"])
    found = {}
    for e in m.elements:
        frames = e[mesh.BEFORE] + 1 + e[mesh.AFTER]
        if e[mesh.AREA] > 0:
            found[e[mesh.SURFACE], e[mesh.TRIANGLE], e[mesh.SIDE], e[mesh.CELL]] = (
                sum(e[mesh.SUMS:mesh.SUMS + 3]) * unit / e[mesh.AREA] / frames, e[mesh.AREA], e[mesh.BEFORE], e[mesh.AFTER])
    return found


def error(estimate, reference):
    """Relative RMS error over the area of the reference's elements."""
    area = math.fsum(r[1] for r in reference.values())
    mean = math.fsum(r[0] * r[1] for r in reference.values()) / area
    none = (0, 0, 0, 0)
    return math.sqrt(math.fsum((estimate.get(k, none)[0] - r[0]) ** 2 * r[1] for k, r in reference.items()) / area) / mean


def static():
    scene = room().save(options.work / "static.gltf")
    words = ("--cell", 0.25, "--segment", 64)
    photons("static", scene, "0-32", "25k", "p.####.photons", "--segment", 64)
    photons("static", scene, "40", "8M", "many.####.photons", "--segment", 64)
    run("static", "st-filter", "mesh", scene, "--frame", 40, "--photons", "many.0040.photons", "--cell", 0.25, "--segment", 64, "--filter", "none", "-o", "many.meshirrad")
    reference = elements("static", "many.meshirrad")
    noise = 0                                    # of the reference: 1/320 of a frame's
    print("| frames in the window | error | sqrt(frames) x error |\n|---:|---:|---:|")
    for reach in (0, 1, 2, 4, 8, 16):
        run("static", "gather-temporal", "density", scene, "--frames", f"{MIDDLE - reach}-{MIDDLE + reach}", "--photons", "p.####.photons", *words,
            "--filter-width", 0.1, "-o", "d.####.meshirrad")
        square = error(elements("static", f"d.{MIDDLE:04}.meshirrad"), reference) ** 2
        noise = noise or square / 321
        e = math.sqrt(square - noise)
        print(f"| {2 * reach + 1} | {100 * e:.2f} % | {100 * e * math.sqrt(2 * reach + 1):.2f} % |", flush=True)


def alarms():
    scene = room().save(options.work / "alarms.gltf")
    frames = options.frames or 96
    photons("alarms", scene, f"0-{frames - 1}", "25k", "p.####.photons", "--segment", frames)
    for share in (0.05, 0.01, 0.003):
        run("alarms", "gather-temporal", "density", scene, "--frames", f"0-{frames - 1}", "--photons", "p.####.photons", "--segment", frames, "--false-alarms", share,
            "-o", "d.####.meshirrad")
        early = windows = 0
        for f in range(16, frames - 16):
            for e in mesh.read_meshirrad(options.work / "alarms" / f"d.{f:04}.meshirrad").elements:
                if e[mesh.PHOTONS]:
                    windows += 1
                    early += e[mesh.BEFORE] + e[mesh.AFTER] < 32
        print(f"stated {100 * share:.3g} %: {early} of {windows} windows of stationary light close early, {100 * early / windows:.2f} %", flush=True)


def period():
    """Windows beside the best one of a size for all elements and frames, which nobody knows beforehand: the most that a window can save."""
    print("| period | photons an element and frame | error, one frame | window | photons saved | best window of one size for all | saves |\n|---:|---:|---:|---:|---:|---:|---:|")
    for frames in (60, 240):
        keys = [f / 24 for f in range(0, 129)]

        def change(scene, _, lamp):
            # A lamp's power goes with its area: both edges by the fourth root would move light; its height alone changes one edge.
            scene.animate(lamp, "scale", keys, [(0.7 * (1 + 0.3 * math.sin(2 * math.pi * f / frames)), 1, 1) for f in range(129)])
        scene = room(change).save(options.work / f"period{frames}.gltf")
        folder = f"period{frames}"
        words = ("--segment", 129, "--cell", 0.68, "--filter-width", 0.135)   # 30 photons an element and frame
        photons(folder, scene, "0-128", "25k", "p.####.photons", "--segment", 129)
        run(folder, "gather-temporal", "density", scene, "--frames", "0-128", "--photons", "p.####.photons", *words, "--reach", 0, "-o", "one.####.meshirrad")
        run(folder, "gather-temporal", "density", scene, "--frames", "0-128", "--photons", "p.####.photons", *words, "-o", "w.####.meshirrad")
        ones = [elements(folder, f"one.{f:04}.meshirrad") for f in range(129)]
        window, sizes, hits = [], [[] for _ in range(MIDDLE + 1)], []
        for f in range(16, 113, 4):
            photons(folder, scene, f, "1M", "many.####.photons", "--segment", 129, "--seed", 7)   # no path of the window's
            run(folder, "gather-temporal", "density", scene, "--frame", f, "--photons", "many.####.photons", *words, "-o", "many.meshirrad")
            reference = elements(folder, "many.meshirrad")
            window.append(error(elements(folder, f"w.{f:04}.meshirrad"), reference) ** 2)
            for reach, errors in enumerate(sizes):
                span = ones[f - reach:f + reach + 1]
                mean = {k: (math.fsum(one[k][0] for one in span if k in one) / len(span),) for k in reference}
                errors.append(error(mean, reference) ** 2)
            hits.append(statistics.mean(e[mesh.PHOTONS] for e in mesh.read_meshirrad(options.work / folder / f"one.{f:04}.meshirrad").elements))
        sizes = [statistics.mean(errors) for errors in sizes]
        s, w, noise = sizes[0], statistics.mean(window), sizes[0] * 25 / 1025
        best = min(range(MIDDLE + 1), key=lambda reach: sizes[reach])
        print(f"| {frames} | {statistics.mean(hits):.0f} | {100 * math.sqrt(s):.1f} % | {100 * math.sqrt(w - noise):.1f} % | {(s - noise) / (w - noise):.1f} | "
              f"{2 * best + 1} | {(s - noise) / (sizes[best] - noise):.1f} |", flush=True)


def events():
    keys = [f / 24 for f in range(24)]
    changes = {
        "a lamp switched": lambda scene, block, lamp: scene.animate(lamp, "scale", keys, [(1, 1, 1) if f < 12 else (0.5, 1, 1) for f in range(24)], "STEP"),
        "a block put elsewhere": lambda scene, block, lamp: scene.animate(block, "translation", keys, [(0, 0, 0) if f < 12 else (1.2, 0, 0.5) for f in range(24)], "STEP"),
        "a block born": lambda scene, block, lamp: scene.animate(block, "scale", keys, [(0, 0, 0) if f < 12 else (1, 1, 1) for f in range(24)], "STEP"),
    }
    print("| event | windows of frames 8 to 15 that reach across | of |\n|---|---:|---:|")
    for name, change in changes.items():
        folder = name.replace(" ", "-")
        scene = room(change).save(options.work / f"{folder}.gltf")
        photons(folder, scene, "0-23", "25k")
        run(folder, "gather-temporal", "density", scene, "--frames", "0-23", "--photons", "p.####.photons", "-o", "d.####.meshirrad")
        across = count = 0
        for f in range(8, 16):
            for e in mesh.read_meshirrad(options.work / folder / f"d.{f:04}.meshirrad").elements:
                if e[mesh.PHOTONS]:
                    count += 1
                    across += f - e[mesh.BEFORE] < 12 <= f + e[mesh.AFTER]
        print(f"| {name} | {across} | {count} |", flush=True)


def scene_of(name):
    """(file, options of all tools) of a scene."""
    made, found = options.shared / "made", options.shared / "found"
    if name == "room":
        import moving_room
        file = options.work / "room.glb"
        if not file.exists():
            moving_room.make(file, 20_000)
        return file, ()
    if name == "evening":
        return found / "gltf" / "interiors" / "evening_shot.glb", ("--environment", found / "hdri" / "evening_sky.exr", "--light-units", "spec")
    words = ("--environment", "1.1,1.5,2", "--light-units", "spec") if name == "S8" else ()
    return next(made.glob(f"{name}_*.gl*")), words


def layer(path, name="indirect"):
    return exr.read(path).rgb(name)


def rms(values):
    values = list(values)
    return math.sqrt(math.fsum(v * v for v in values) / len(values))


def equal():
    frames, first = options.frames or 8, 20      # in the middle of the segment, where windows are whole
    few = min(3, frames)                         # frames with a reference
    span, judged = f"{first}-{first + frames - 1}", f"{first}-{first + few - 1}"
    print("| scene | error of elements, windows | one frame of 845 k | of 25 k | error of pictures, windows | 845 k | 25 k | flicker, windows / 25 k |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for name in options.scenes.split(","):
        file, words = scene_of(name)
        words = ("--segment", 48, *words)
        folder = f"equal-{name}"
        photons(folder, file, "0-47", "25k", "p.####.photons", *words)
        run(folder, "gather-temporal", "density", file, "--frames", "0-47", "--photons", "p.####.photons", *words, "-o", "windows.####.meshirrad")
        for count, kind in (("845k", "many"), ("25k", "few"), ("8M", "true")):
            own = "p.####.photons"
            if kind != "few":
                own = f"{kind}.####.photons"
                run(folder, "photon-trace", file, "--frames", span if kind == "many" else judged, "--photons", count, "--seed", 7 if kind == "many" else 8, "--kinds", "indirect", "-o", own, *words)
            width = mesh.read_meshirrad(options.work / folder / "windows.0020.meshirrad").header["filter"].split()[1]   # the same blur for all
            run(folder, "st-filter", "mesh", file, "--filter-width", width, "--cell", 2 * float(width), "--frames", span if kind != "true" else judged, "--photons", own, *words, "-o", f"{kind}.####.meshirrad")
        for kind in ("many", "p", "true"):   # the same elements, no blur
            run(folder, "gather-temporal", "density", file, "--frames", judged, "--photons", f"{kind}.####.photons", "--reach", 0, "--filter-width", width,
                *words, "-o", f"one-{kind}.####.meshirrad")

        def element_error(kind):
            return rms(error(elements(folder, f"{kind}.{f:04}.meshirrad"), elements(folder, f"one-true.{f:04}.meshirrad")) for f in range(first, first + few))
        shown = {}
        for kind in ("windows", "many", "few", "true"):
            run(folder, "frame-render", file, "--frames", span if kind != "true" else judged, "--size", options.size, "--meshirrad", f"{kind}.####.meshirrad", *words,
                "--spp", 4, "--channels", "layers", "-o", f"{kind}.####.exr")
            shown[kind] = [layer(options.work / folder / f"{kind}.{f:04}.exr") for f in range(first, first + (frames if kind != "true" else few))]

        def error_of(kind):
            return rms(rms(a - b for a, b in zip(x, t)) for x, t in zip(shown[kind], shown["true"]))

        def flicker(kind):
            return rms((b - a) - (d - c) for x, y, t, u in zip(shown[kind], shown[kind][1:], shown["true"], shown["true"][1:]) for a, b, c, d in zip(x, y, t, u))
        print(f"| {name} | " + " | ".join(f"{100 * element_error(kind):.2f} %" for kind in ("windows", "one-many", "one-p")), end=" ")
        print(f"| {error_of('windows'):.4f} | {error_of('many'):.4f} | {error_of('few'):.4f} | {flicker('windows') / flicker('few'):.2f} |", flush=True)


def preview():
    """CPU seconds over all stages; seen error (seen_error.py) and flicker (evaluation.md, in its codes) of three frames in the middle."""
    frames = options.frames or 24
    judged = range(frames // 2 - 1, frames // 2 + 2)
    print("| scene | | CPU s per frame | seen error, codes | flicker, codes | halves of the reference differ by |\n|---|---|---:|---:|---:|---:|")
    for name in options.scenes.split(","):
        file, words = scene_of(name)
        light = {"--environment": "SKY" if name == "S8" else "ENVIRONMENT", "--light-units": "LIGHT_UNITS"}
        run(f"reference-{name}", "frame-render", file, "--frames", f"{judged[0]}-{judged[-1]}", "--size", options.size, "--integrator", "path", "--halves", "--spp", options.reference,
            "--seed", 1000003, "--seed-mode", "frame", "--channels", "RGBA", *words, "-o", "r.####.exr")
        halves = [[pixels.planes(exr.read(options.work / f"reference-{name}" / f"r.{f:04}_{h}.exr")) for h in "ab"] for f in judged]
        exposure = Seen(*halves[1]).exposure     # one for all frames
        codes = [[code_planes(exposure, half) for half in frame] for frame in halves]
        noise = math.sqrt(product([(a, b, a, b) for a, b in codes]) / 2)
        for method in ("preview", "frames"):
            out = options.work / f"{method}-{name}"
            before = os.times()
            subprocess.run(["make", "-s", "-f", str(here.parents[2] / "Makefile.example"), f"SCENE={file}", f"BIN={options.bin}", f"FRAMES=0-{frames - 1}", f"SIZE={options.size}",
                            "QUALITY=draft", f"METHOD={method}", f"OUT={out}", *(f"{light[k]}={v}" for k, v in zip(words[::2], words[1::2]))], check=True, stdout=subprocess.DEVNULL)
            after = os.times()
            cpu = after.children_user + after.children_system - before.children_user - before.children_system
            shown = [code_planes(exposure, pixels.planes(exr.read(out / "frames" / f"{f:04}.exr"))) for f in judged]
            error_ = math.sqrt(max(0, product([(x, a, x, b) for x, (a, b) in zip(shown, codes)])))
            change = [[y - x for x, y in zip(one, two)] for one, two in zip(shown, shown[1:])]
            changes = [[[y - x for x, y in zip(one[h], two[h])] for h in (0, 1)] for one, two in zip(codes, codes[1:])]
            flicker = math.sqrt(max(0, product([(x, a, x, b) for x, (a, b) in zip(change, changes)])))
            print(f"| {name} | {'preview' if method == 'preview' else 'draft'} | {cpu / frames:.2f} | {error_:.2f} | {flicker:.2f} | {noise:.1f} |", flush=True)


def code_planes(exposure, planes):
    return [code(exposure * v) for plane in planes for v in plane]


def product(parts):
    """Mean of (x - a) (y - b) over all values of all (x, a, y, b)."""
    return math.fsum((x - a) * (y - b) for part in parts for x, a, y, b in zip(*part)) / sum(len(part[0]) for part in parts)


for row in options.what:
    print(f"## {row}\n")
    globals()[row]()
    print()

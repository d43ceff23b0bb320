#!/usr/bin/env python3
"""What gathering over time costs and errs against gathering each frame anew: the table of docs/methods/temporal.md.

    python3 tests/bench/temporal.py BIN SCENE WORK [--frames N] [--size WxH] [--photons N] [--judge F ...]

Points of each frame come from static and dynamic photons, as with MOVING=time. Both sides read the same points. Error: of the indirect layer,
one sample a pixel, against records of 16 times the rays from the same points. Flicker: RMS of the change from one frame to the next beyond that of
the reference. Processor seconds are those of the phase `records`, median over the frames after a segment's first.
"""
import argparse
import json
import statistics
import subprocess
from pathlib import Path

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("bin", type=Path)
parser.add_argument("scene", type=Path)
parser.add_argument("work", type=Path)
parser.add_argument("--frames", type=int, default=24)
parser.add_argument("--size", default="320x180")
parser.add_argument("--photons", default="200k")
parser.add_argument("--judge", type=int, nargs="*", default=[8])
parser.add_argument("--refresh", default="0.05")
options = parser.parse_args()
options.work.mkdir(parents=True, exist_ok=True)


def run(tool, *words):
    subprocess.run([options.bin / tool, *map(str, words), "-q"], check=True, cwd=options.work)


def phase(file, name="records"):
    return sum(p["cpu_s"] for p in json.load(open(options.work / file))["phases"] if p["name"] == name)


scene, frames = options.scene.resolve(), range(options.frames)
last_static = None
stage = {"photons": [], "points": []}
for f in frames:
    first = f // 24 * 24
    if first != last_static:
        run("photon-trace", scene, "--frame", f, "--photons", options.photons, "--kinds", "caustic,indirect", "--map", "static",
            "-o", "s.photons", "--paths", "s.paths")
        run("irradcache-build", "points", scene, "--frame", f, "--map", "static", "--photons", "s.photons", "-o", "s.irradpoints")
        last_static = first
    if not (options.work / f"p.{f:04}.irradpoints").exists():
        run("photon-trace", scene, "--frame", f, "--map", "dynamic", "--static", "s.paths", "-o", "d.photons", "--stats", "d.json")
        run("irradcache-build", "points", scene, "--frame", f, "--photons", "s.photons", "--update", "s.irradpoints", "--dynamic", "d.photons",
            "-o", f"p.{f:04}.irradpoints", "--stats", "p.json")
        stage["photons"].append(json.load(open(options.work / "d.json"))["cpu_s"])
        stage["points"].append(json.load(open(options.work / "p.json"))["cpu_s"])
fresh, kept, shares, records, retraced = [], [], [], [], []
previous = None
for f in frames:   # in turns: what else runs on the machine slows both alike
    name = f"{f:04}"
    run("irradcache-build", "records", scene, "--frame", f, "--points", f"p.{name}.irradpoints", "--size", options.size, "-o",
        f"f.{name}.irradcache", "--stats", "f.json")
    follows = ["--previous", f"s.{f - 1:04}.radsamples"] if f % 24 else []
    run("gather-temporal", "final", scene, "--frame", f, "--points", f"p.{name}.irradpoints", "--size", options.size, "--refresh",
        options.refresh, *follows, "-o", f"s.{name}.radsamples", "--cache", f"t.{name}.irradcache", "--stats", "t.json")
    if f >= 1:
        (options.work / f"s.{f - 1:04}.radsamples").unlink(missing_ok=True)
    counts = json.load(open(options.work / "t.json"))
    anew = json.load(open(options.work / "f.json"))["counts"]
    records.append((f, anew["records"], counts["counts"]["records"]))
    if f % 24:
        fresh.append(phase("f.json"))
        kept.append(phase("t.json"))
        shares.append((counts["counts"]["update_rays"] + counts["counts"]["birth_rays"]) / anew["gather_rays"])
        retraced.append([counts["counts"][k] / counts["counts"]["cells"] for k in ("cells_moved", "cells_lost", "cells_unanchored", "cells_aged")])
print(f"{scene.name}, {options.size}, {options.frames} frames, refresh {options.refresh}")
if stage["photons"]:
    print(f"photons {statistics.median(stage['photons']):.3f} s, points {statistics.median(stage['points']):.3f} s a frame, whole runs")
print(f"records: fresh {statistics.median(fresh):.3f} s, over time {statistics.median(kept):.3f} s: {statistics.median(fresh) / statistics.median(kept):.2f} x")
print(f"rays: {100 * statistics.mean(shares):.1f} % of fresh gathering's; cells traced again: "
      + ", ".join(f"{word} {100 * statistics.mean(r[i] for r in retraced):.1f} %" for i, word in enumerate(("moved", "lost", "unanchored", "aged"))))
print("records by frame (fresh, over time):", *(f"{f}: {a:.0f}, {b:.0f};" for f, a, b in records[:: max(1, len(records) // 6)]))


def picture(cache, f, out):
    run("frame-render", scene, "--frame", f, "--size", options.size, "--spp", 1, "--pixel-error", 0, "--irradcache", cache, "--points",
        f"p.{f:04}.irradpoints", "--channels", "RGBA,layers", "-o", out)


def compared(test, reference, at):
    run("aqm-compare", test, reference, "--layer", "indirect", "--frames", at, "--json", "e.json", "--allow-stale")
    return json.load(open(options.work / "e.json"))


for f in options.judge:
    for g in (f - 1, f):
        for seed in ("fixed", "frame"):
            run("irradcache-build", "records", scene, "--frame", g, "--points", f"p.{g:04}.irradpoints", "--size", options.size, "--seed-mode", seed,
                "-o", f"j{seed}.{g:04}.irradcache")
            picture(f"j{seed}.{g:04}.irradcache", g, f"{seed}.{g:04}.exr")
        run("irradcache-build", "records", scene, "--frame", g, "--points", f"p.{g:04}.irradpoints", "--size", options.size, "--rays", 8000,
            "-o", "r.irradcache")
        picture("r.irradcache", g, f"reference.{g:04}.exr")
        picture(f"t.{g:04}.irradcache", g, f"time.{g:04}.exr")
    for side in ("fixed", "frame", "time"):
        found = compared(f"{side}.####.exr", "reference.####.exr", f"{f - 1}-{f}")
        last = found["frames"][-1]
        print(f"frame {f}: {side}: RMSE {last['rmse']:.6f}, bias {100 * last['bias']:.3f} %, flicker {found['total']['flicker']:.6f}")

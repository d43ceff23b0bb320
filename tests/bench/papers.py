#!/usr/bin/env python3
"""The figures of the paper on final gathering over time (Tawara et al. 2004), with our numbers: `make evidence PARTS=paper-figures`.

    python3 tests/bench/papers.py BIN OUT [--scene S2.glb] [--frames 24] [--size 160x90] [--rays 4000]

OUT/index.md and one SVG each: the draw of cells in three frames, ages of samples and on the hemisphere of one record, that record over time, error by frame,
records by frame with and without removal, rays by reason; tables of times and of disk; and the curve "temporal gathering", error and flicker against time for
--refresh .02 to 1, beside frames anew of 125 to 2000 rays. All frames are of one segment. Reference: records of `--rays` from the same points.
Without removal: records there would be if none of those that were taken out had gone; births are as with removal, which may be too many.
"""
import argparse
import bisect
import itertools
import json
import math
import random
import statistics
import subprocess
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "formats")]
sys.dont_write_bytecode = True
from plot import chart, hemispheres
from read_irradcache import read_irradcache
from read_radsamples import read_radsamples

PROJECT = Path(__file__).resolve().parents[2]
parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("bin", type=Path)
parser.add_argument("out", type=Path)
parser.add_argument("--scene", type=Path, default=PROJECT / "pipelines" / "scenes" / "S2_cornell_moving.glb")
parser.add_argument("--frames", type=int, default=24)
parser.add_argument("--size", default="160x90")
parser.add_argument("--rays", type=int, default=4000, help="of a record of the reference")
options = parser.parse_args()
tools, scene, out = options.bin.resolve(), options.scene.resolve(), options.out.resolve()
work, frames, size = out / "files", range(options.frames), ("--size", options.size)
work.mkdir(parents=True, exist_ok=True)
page = [f"# Final gathering over time: {scene.name}, {options.size}, {options.frames} frames\n"]


def run(tool, *words):
    """Statistics of a run."""
    subprocess.run([tools / tool, *map(str, words), "-q", "--stats", "stats.json"], check=True, cwd=work)
    return json.loads((work / "stats.json").read_text())


def cpu(stats, phase=None):
    return sum(p["cpu_s"] for p in stats["phases"] if p["name"] == phase) if phase else stats["cpu_s"]


def figure(name, words, svg):
    (out / f"{name}.svg").write_text(svg)
    page.append(f"![{name}]({name}.svg)\n\n{words}\n")


def irradiance(file):
    """Mean of the channels by place."""
    return {r.position: sum(r.irradiance) / 3 for r in read_irradcache(str(work / file)).records}


def draws():
    """16 cells, three frames, two drawn in each with probability as age squared."""
    rng, ages, series = random.Random(1), [1 + i % 5 for i in range(16)], []
    for frame in range(3):
        weights = [a * a for a in ages]
        steps = list(itertools.accumulate(weights))
        left, drawn = dict(enumerate(weights)), []
        for _ in range(2):
            names, sums = list(left), list(itertools.accumulate(left.values()))
            drawn.append(names[bisect.bisect_right(sums, rng.randrange(sums[-1]))])
            del left[drawn[-1]]
        series.append((f"frame {frame}: drawn {', '.join(map(str, sorted(drawn)))}", [(c, s / steps[-1]) for c, s in enumerate(steps)]))
        ages = [1 if c in drawn else a + 1 for c, a in enumerate(ages)]
    figure("draws", "Sums of the weights, age squared, of 16 cells before the draw of two: a drawn cell's step is the smallest in the next frame.",
           chart("Which cells get a new ray", "cell", "share of the weights up to it", series))


def light():
    """Points of all frames; CPU seconds of photons and of points."""
    kinds = ("--photons", "200k", "--kinds", "caustic,indirect")
    run("photon-trace", scene, "--frame", 0, *kinds, "--map", "static", "-o", "s.photons", "--paths", "s.paths")
    run("irradcache-build", "points", scene, "--frame", 0, "--map", "static", "--photons", "s.photons", "-o", "s.irradpoints")
    spent = []
    for f in frames:
        photons = run("photon-trace", scene, "--frame", f, "--map", "dynamic", "--static", "s.paths", "-o", "d.photons")
        points = run("irradcache-build", "points", scene, "--frame", f, "--photons", "s.photons", "--update", "s.irradpoints", "--dynamic", "d.photons", "-o", f"p.{f:04}.irradpoints")
        spent.append((cpu(photons), cpu(points)))
    whole = run("photon-trace", scene, "--frame", 0, *kinds, "-o", "d.photons")
    return [statistics.median(s) for s in zip(*spent)], [cpu(whole), cpu(run("irradcache-build", "points", scene, "--frame", 0, "--photons", "d.photons", "-o", "g.irradpoints"))]


def gather():
    """Records of all frames: anew with one seed, with a seed each, of many rays; over time. Statistics by side."""
    stats = {"anew": [], "seeds": [], "many": []}
    for f in frames:
        for side, words in (("anew", ()), ("seeds", ("--seed", f + 1)), ("many", ("--rays", options.rays, "--seed", 1000))):
            stats[side].append(run("irradcache-build", "records", scene, "--frame", f, "--points", f"p.{f:04}.irradpoints", *size, "-o", f"{side}.{f:04}.irradcache", *words))
    stats["time"] = run("gather-temporal", "final", scene, "--frames", f"0-{frames[-1]}", "--points", "p.####.irradpoints", *size, "-o", "k.####.radsamples",
                        "--cache", "time.####.irradcache")
    return stats


def compared(side):
    """Frames of a side against those of many rays: aqm-compare's words."""
    run("frame-render", scene, "--frames", f"0-{frames[-1]}", *size, "--spp", 1, "--pixel-error", 0, "--irradcache", f"{side}.####.irradcache", "--points",
        "p.####.irradpoints", "--channels", "indirect", "-o", f"{side}.####.exr")
    if side == "many":
        return None
    run("aqm-compare", f"{side}.####.exr", "many.####.exr", "--frames", f"0-{frames[-1]}", "--layer", "indirect", "--allow-stale", "--json", "e.json")
    return json.loads((work / "e.json").read_text())


def errors(side):
    return [(i, f["rmse"]) for i, f in enumerate(compared(side)["frames"])]


def slope(points):
    """Of the line through the points in logarithms."""
    xs, ys = ([math.log(p[i]) for p in points] for i in (0, 1))
    mx, my = statistics.mean(xs), statistics.mean(ys)
    return sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / sum((x - mx) ** 2 for x in xs)


def curve():
    """Temporal gathering against frame by frame: phase `records`, CPU s a frame, the first of the segment with it; error and flicker."""
    rows = []
    for refresh in (0.02, 0.05, 0.1, 0.25, 0.5, 1):
        spent = run("gather-temporal", "final", scene, "--frames", f"0-{frames[-1]}", "--points", "p.####.irradpoints", *size, "--refresh", refresh,
                    "-o", "c.####.radsamples", "--cache", "curve.####.irradcache")
        rows.append(("over time", f"--refresh {refresh}", cpu(spent, "records") / len(frames), compared("curve")["total"]))
    for side, seed in (("anew, one seed", lambda f: 0), ("anew, a seed a frame", lambda f: f + 1)):
        for rays in (125, 250, 500, 1000, 2000):
            spent = [run("irradcache-build", "records", scene, "--frame", f, "--points", f"p.{f:04}.irradpoints", *size, "--rays", rays, "--seed", seed(f), "-o",
                         f"curve.{f:04}.irradcache") for f in frames]
            rows.append((side, f"--rays {rays}", sum(cpu(s, "records") for s in spent) / len(frames), compared("curve")["total"]))
    names = list(dict.fromkeys(r[0] for r in rows))
    for what, title, unit in (("rmse", "Error", "RMSE, W/m²/sr"), ("flicker", "Flicker", "W/m²/sr a frame")):
        lines = [(name, [(r[2], r[3][what]) for r in rows if r[0] == name]) for name in names]
        figure(f"curve-{what}", "Slopes in logarithms: " + ", ".join(f"{name} {slope(points):.2f}" for name, points in lines) + ".",
               chart(f"Temporal gathering: {title.lower()} against time", "CPU s a frame, phase records", unit, lines, log=True))
    page.append("| curve | run | CPU s a frame | RMSE | bias % | flicker |\n|---|---|---|---|---|---|")
    page.extend(f"| {name} | {words} | {seconds:.3f} | {t['rmse']:.6f} | {100 * t['bias']:.3f} | {t['flicker']:.6f} |" for name, words, seconds, t in rows)
    page.append("")


def disk():
    """Sizes of a first frame's samples by rays a record."""
    page.append("| --rays | records (#E) | samples of a record (N) | MB | MB / 8 N #E |\n|---|---|---|---|---|")
    for rays in (125, 250, 500, 1000):
        run("gather-temporal", "final", scene, "--frame", 0, "--points", "p.0000.irradpoints", *size, "--rays", rays, "-o", "d.radsamples", "--cache", "d.irradcache")
        facts, bytes_ = told("d.radsamples"), (work / "d.radsamples").stat().st_size
        page.append(f"| {rays} | {facts['records']} | {facts['samples'] / facts['records']:.0f} | {bytes_ / 1e6:.1f} | {bytes_ / 8 / facts['samples']:.2f} |")
    page.append("")


def told(file):
    """tempolux-info's words on a file of samples."""
    facts = json.loads(subprocess.run([tools / "tempolux-info", "--json", file], check=True, cwd=work, capture_output=True, text=True).stdout)
    return facts[0] if isinstance(facts, list) else facts


def hemisphere(f, place):
    """Ages of the samples of the record at a place, ring by ring."""
    kept = read_radsamples(str(work / f"k.{f:04}.radsamples"))
    record = min(kept.records, key=lambda r: math.dist(r.position, place))
    ages = [sample.age for sample in record.samples]
    return [ages[j * record.sectors:(j + 1) * record.sectors] for j in range(record.rings)]


def ages(f):
    facts = told(f"k.{f:04}.radsamples")
    counted = facts["age"]["samples_by_age"]
    return facts, [(a, n / facts["samples"]) for a, n in enumerate(counted) if a]


draws()
time_of, anew_of = light()
stats = gather()
found = stats["time"]["results"]
last = frames[-1]
figure("ages", "Every sample has age 1 in the first frame; ages count the updates of a sample's record.",
       chart("Ages of samples", "age, frames", "share of the samples", [("first frame", ages(0)[1]), (f"frame {last}", ages(last)[1])], bars=True))

kept = [irradiance(f"time.{f:04}.irradcache") for f in frames]
seeds, many = ([irradiance(f"{side}.{f:04}.irradcache") for f in frames] for side in ("seeds", "many"))
common = [p for p in kept[0] if all(p in c for c in (*kept, *many))]
place = max(common, key=lambda p: max(c[p] for c in many) - min(c[p] for c in many)) if common else None
if place:
    lines = [(name, [(f, c[place]) for f, c in zip(frames, caches) if place in c]) for name, caches in
             (("over time", kept), ("anew, a seed a frame", seeds), (f"{options.rays} rays", many))]
    figure("record", f"The record of those in all frames whose light changes most, at {', '.join(f'{x:.2f}' for x in place)} m of the scene.",
           chart("Irradiance of one record", "frame", "W/m²", lines, from_zero=False))
    figure("hemisphere", f"The cells of that record from above, rings of equal area: white has age 1, black {last + 1}, a frame each.",
           hemispheres("Ages on a hemisphere", [("first frame", hemisphere(0, place)), (f"frame {last}", hemisphere(last, place))], last + 1))
compared("many")
figure("rms", "Indirect layer, one sample a pixel, against records of many rays from the same points.",
       chart("Error by frame", "frame", "RMSE, W/m²/sr", [(name, errors(side)) for name, side in
                                                         (("over time", "time"), ("anew, one seed", "anew"), ("anew, a seed a frame", "seeds"))]))


def by_frame(name):
    return [found[f"{name}.{f}"] for f in frames]


removed = list(itertools.accumulate(by_frame("records_removed")))
figure("records", "Records that those before them cover fade away in four frames.",
       chart("Records by frame", "frame", "records", [("over time", list(enumerate(by_frame("records")))),
                                                      ("none taken out", [(f, n + r) for f, n, r in zip(frames, by_frame("records"), removed)]),
                                                      ("anew", [(f, s["counts"]["records"]) for f, s in zip(frames, stats["anew"])])], from_zero=False))
figure("rays", "Cells traced in later frames, and rays of records born: per cent of what a frame anew sends.",
       chart("Rays by reason", "frame", "% of a frame anew", [(name, [(f, 100 * found[f"{key}.{f}"] / stats["anew"][f]["counts"]["gather_rays"]) for f in frames[1:]])
                                                              for name, key in (("moved", "cells_moved"), ("by age", "cells_aged"), ("no point", "cells_unanchored"), ("near hits", "cells_near"), ("births", "birth_rays"))]))

facts, _ = ages(last)
anew_records, time_records = statistics.median(cpu(s, "records") for s in stats["anew"]), cpu(stats["time"], "records") / len(frames)
page.append("| CPU s a frame | T_photons | T_points | T_records | T |\n|---|---|---|---|---|")
for name, (photons, points), records in (("anew", anew_of, anew_records), ("over time", time_of, time_records)):
    page.append(f"| {name} | {photons:.3f} | {points:.3f} | {records:.3f} | {photons + points + records:.3f} |")
records = facts["records"]
page.append(f"\nT_records over time is that of all {len(frames)} frames by their number, the first with it. Disk, frame {last}: {(work / f'k.{last:04}.radsamples').stat().st_size / 1e6:.1f} MB: "
            f"{records} records (#E) of {facts['samples'] / records:.0f} samples (N).\n")
disk()
curve()
(out / "index.md").write_text("\n".join(page))
print("\n".join(page))

#!/usr/bin/env python3
"""What gathering over time costs and errs against gathering each frame anew: the tables of docs/methods/temporal.md.

    python3 tests/bench/temporal.py BIN SCENE WORK [--frames N] [--size WxH] [--photons N] [--judge F ...] [--seeds N] [--light anew] [--pixels] [--paths SPP] [--threads N] [--split]

Points of each frame come from static and dynamic photons, as with MOVING=time, or with `--light anew` from photons of the frame alone: where a lamp
moves no light stands. Both sides read the same points and take turns. Error: of the indirect layer, one sample a pixel, against records of 16 times the
rays from the same points, over N seeds. Flicker: RMS of the change from one frame to the next beyond that of the reference. Processor seconds are those of
the phase `records`, median over the frames after a segment's first. `--pixels`: frames too, as Makefile.example renders them, photons and points anew, and what whole
frames cost on both sides, what stands and a segment's first records counted by 1/24; `--paths SPP`: a frame by path
tracing, its error and that of the chain against 64 SPP samples. `--split`: both sides take the points of photonmap-split, --high; the reference of an error is that of
the whole points. WORK/records.svg: records by frame, and how many there would be if none of those taken out in a segment had gone.
"""
import argparse
import json
import statistics
import subprocess
from pathlib import Path

from plot import chart

SEGMENT = 24
parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("bin", type=Path)
parser.add_argument("scene", type=Path)
parser.add_argument("work", type=Path)
parser.add_argument("--frames", type=int, default=24)
parser.add_argument("--size", default="320x180")
parser.add_argument("--photons", default="200k")
parser.add_argument("--judge", type=int, nargs="*", default=[8])
parser.add_argument("--seeds", type=int, default=4, help="with which error is judged")
parser.add_argument("--refresh", default="0.05")
parser.add_argument("--light", choices=("follows", "anew"), default="follows")
parser.add_argument("--pixels", action="store_true")
parser.add_argument("--paths", type=int, default=0)
parser.add_argument("--threads", type=int, default=2)
parser.add_argument("--split", action="store_true")
options = parser.parse_args()
options.work.mkdir(parents=True, exist_ok=True)
scene, frames, size = options.scene.resolve(), range(options.frames), ("--size", options.size)


def run(tool, *words):
    subprocess.run([options.bin / tool, *map(str, words), "-q", "--threads", str(options.threads)], check=True, cwd=options.work)


def stats(file):
    return json.load(open(options.work / file))


def phase(file, name="records"):
    return sum(p["cpu_s"] for p in stats(file)["phases"] if p["name"] == name)


def points(f):
    return f"p.{f:04}.irradpoints"


def divided(f):
    """--points and what goes with it of a frame or a pattern, as the gatherers take them."""
    name = f"{f:04}" if isinstance(f, int) else f
    return ("--points", f"low.{name}.irradpoints", "--high", f"high.{name}.irradpoints") if options.split else ("--points", f"p.{name}.irradpoints")


def previous(f):
    return f - 1 if f % SEGMENT else None


def light():
    """Points of all frames; CPU seconds of photons and points, of what stands, and of a frame's own."""
    spent = {"photons": [], "points": [], "stands": [], "anew": []}
    for f in frames:
        if (options.work / points(f)).exists():
            continue
        map_of = ("--photons", options.photons, "--kinds", "caustic,indirect")
        if options.light == "anew":
            run("photon-trace", scene, "--frame", f, *map_of, "-o", "d.photons", "--stats", "d.json")
            run("irradcache-build", "points", scene, "--frame", f, "--photons", "d.photons", "-o", points(f), "--stats", "p.json")
        else:
            if f % SEGMENT == 0 or not spent["photons"]:
                run("photon-trace", scene, "--frame", f, *map_of, "--map", "static", "-o", "s.photons", "--paths", "s.paths", "--stats", "d.json")
                run("irradcache-build", "points", scene, "--frame", f, "--map", "static", "--photons", "s.photons", "-o", "s.irradpoints", "--stats", "p.json")
                spent["stands"].append(stats("d.json")["cpu_s"] + stats("p.json")["cpu_s"])
            if options.pixels and f % 8 == 1:
                run("photon-trace", scene, "--frame", f, *map_of, "-o", "g.photons", "--stats", "d.json")
                run("irradcache-build", "points", scene, "--frame", f, "--photons", "g.photons", "-o", "g.irradpoints", "--stats", "p.json")
                spent["anew"].append(stats("d.json")["cpu_s"] + stats("p.json")["cpu_s"])
            run("photon-trace", scene, "--frame", f, "--map", "dynamic", "--static", "s.paths", "-o", "d.photons", "--stats", "d.json")
            run("irradcache-build", "points", scene, "--frame", f, "--photons", "s.photons", "--update", "s.irradpoints", "--dynamic", "d.photons",
                "-o", points(f), "--stats", "p.json")
        if options.split:
            run("photonmap-split", points(f), "--low", f"low.{f:04}.irradpoints", "--high", f"high.{f:04}.irradpoints")
        spent["photons"].append(stats("d.json")["cpu_s"])
        spent["points"].append(stats("p.json")["cpu_s"])
    return {k: statistics.median(v) if v else None for k, v in spent.items()}


def anew(f, out, *words, whole=False):
    run("irradcache-build", "records", scene, "--frame", f, *(("--points", points(f)) if whole else divided(f)), *size, "-o", out, "--stats", "f.json", *words)


def pixels(cache, f, out, *words):
    run("frame-render", scene, "--frame", f, *size, "--irradcache", cache, "--points", points(f), "-o", out, "--stats", "r.json", *words)


def costs():
    """Both sides frame by frame, and their counts."""
    rows = []
    for f in frames:
        name = f"{f:04}"
        anew(f, f"f.{name}.irradcache")
        follows = ["--previous", f"s.{previous(f):04}.radsamples"] if previous(f) is not None else []
        run("gather-temporal", "final", scene, "--frame", f, *divided(f), *size, "--refresh", options.refresh, *follows, "-o",
            f"s.{name}.radsamples", "--cache", f"t.{name}.irradcache", "--stats", "t.json")
        if f >= 1:
            (options.work / f"s.{f - 1:04}.radsamples").unlink(missing_ok=True)
        fresh, over = stats("f.json"), stats("t.json")
        row = {"frame": f, "first": previous(f) is None, "fresh": phase("f.json"), "time": phase("t.json"), "fresh_all": fresh["cpu_s"], "time_all": over["cpu_s"],
               "fresh_records": fresh["counts"]["records"], "time_records": over["counts"]["records"], "removed": over["counts"]["records_removed"], "fresh_rays": fresh["counts"]["gather_rays"],
               **{k: over["counts"][k] for k in ("cells", "cells_moved", "cells_lost", "cells_unanchored", "cells_near", "cells_aged", "birth_rays", "update_rays")}}
        if options.pixels and f % 8 == 1:
            pixels(f"t.{name}.irradcache", f, "pixels.exr", "--spp", 4, "--pixel-error", 0.016)
            row["pixels"] = stats("r.json")["cpu_s"]
        rows.append(row)
    (options.work / "rows.json").write_text(json.dumps(rows))
    return rows


def twice(size):
    return "x".join(str(2 * int(side)) for side in size.split("x"))


def compared(test, reference, at):
    run("aqm-compare", test, reference, "--layer", "indirect", "--frames", at, "--json", "e.json", "--allow-stale")
    return stats("e.json")


def judge(judged):
    """RMSE, bias, flicker of these frames: anew with one seed, anew with a seed for each frame, over time. Each seed is one run over all of the frames."""
    found = {(f, side): [] for f in judged for side in ("fixed", "frame", "time")}
    layer = ("--spp", 1, "--pixel-error", 0, "--channels", "RGBA,layers")
    first = min(judged) // SEGMENT * SEGMENT
    seen = sorted({g for f in judged for g in (f - 1, f) if g >= 0})
    for g in seen:
        run("irradcache-build", "records", scene, "--frame", g, "--points", points(g), "--size", twice(options.size), "-o", "r.irradcache",
            "--rays", 2000, "--error-bound", 0.1, "--seed", 1000)
        pixels("r.irradcache", g, f"reference.{g:04}.exr", *layer)
    for seed in range(options.seeds):
        run("gather-temporal", "final", scene, "--frames", f"{first}-{max(judged)}", *divided("####"), *size, "--refresh", options.refresh, "--seed", seed,
            "-o", "j.####.radsamples", "--cache", "jtime.####.irradcache")
        for g in range(first, max(judged) + 1):
            (options.work / f"j.{g:04}.radsamples").unlink()
        for g in seen:
            anew(g, f"jfixed.{g:04}.irradcache", "--seed", seed)
            anew(g, f"jframe.{g:04}.irradcache", "--seed", 100 * seed + g % 2 + 10)
            for side in ("fixed", "frame", "time"):
                pixels(f"j{side}.{g:04}.irradcache", g, f"{side}.{g:04}.exr", *layer)
        for f, side in found:
            total = compared(f"{side}.####.exr", "reference.####.exr", f"{max(f - 1, 0)}-{f}")
            last = total["frames"][-1]
            found[f, side].append((last["rmse"], 100 * last["bias"], total["total"]["flicker"]))
    for f in judged:
        told(f, {side: found[f, side] for side in ("fixed", "frame", "time")})


def rms(values):
    return (sum(v * v for v in values) / len(values)) ** 0.5


def ratio(over, under):
    """Ratio of two root mean squares over the same seeds, and its standard error with each seed left out in turn."""
    n, whole = len(over), rms(over) / rms(under)
    left = [rms(over[:i] + over[i + 1:]) / rms(under[:i] + under[i + 1:]) for i in range(n)] if n > 1 else []
    return f"{whole:.3f} +- {((n - 1) / n * sum((x - whole) ** 2 for x in left)) ** 0.5:.3f}"


def told(f, found):
    columns = {side: list(zip(*rows)) for side, rows in found.items()}
    for side, (errors, biases, flickers) in columns.items():
        print(f"frame {f}: {side}: RMSE {rms(errors):.6f}, bias {statistics.mean(biases):.3f} %, flicker {rms(flickers):.6f} ({len(errors)} seeds)", flush=True)
    time, fixed, frame = (columns[side] for side in ("time", "fixed", "frame"))
    apart = [t - a for t, a in zip(time[1], fixed[1])]
    spread = statistics.stdev(apart) / len(apart) ** 0.5 if len(apart) > 1 else float("nan")
    print(f"frame {f}: over time by anew: RMSE {ratio(time[0], fixed[0])}; bias apart {statistics.mean(apart):.3f} +- {spread:.3f} %; "
          f"flicker {ratio(time[2], frame[2])} of a seed a frame, {ratio(time[2], fixed[2])} of one seed", flush=True)


def paths(f):
    """A frame by path tracing, and by the chain: relMSE against many paths, CPU seconds."""
    for name, spp, seed in (("paths", options.paths, 0), ("many", 64 * options.paths, 1)):
        run("frame-render", scene, "--frame", f, *size, "--integrator", "path", "--spp", spp, "--seed", seed, "-o", f"{name}.exr", "--stats", f"{name}.json")
    pixels(f"t.{f:04}.irradcache", f, "chain.exr", "--spp", 4, "--pixel-error", 0.016)
    for name in ("paths", "chain"):
        run("aqm-compare", f"{name}.exr", "many.exr", "--json", "e.json", "--allow-stale")
        print(f"frame {f}: {name}: RMSE {stats('e.json')['total']['rmse']:.5f}, {stats('r.json' if name == 'chain' else 'paths.json')['cpu_s']:.2f} CPU s of its pixels")


spent = light()
print(f"{scene.name}, {options.size}, {options.frames} frames, refresh {options.refresh}, light {options.light}", flush=True)
if spent["photons"]:
    print(f"photons {spent['photons']:.3f} s, points {spent['points']:.3f} s a frame, whole runs")
rows = costs()
gone = []
for row in rows:
    gone.append(row["removed"] + (0 if row["first"] else gone[-1]))
(options.work / "records.svg").write_text(chart(f"Records by frame, {scene.stem}, {options.size}", "frame", "records", [
    ("over time", [(r["frame"], r["time_records"]) for r in rows]), ("none taken out", [(r["frame"], r["time_records"] + g) for r, g in zip(rows, gone)]),
    ("anew", [(r["frame"], r["fresh_records"]) for r in rows])]))
later = [r for r in rows if not r["first"]]
if later:
    def median(key):
        return statistics.median(r[key] for r in later)

    def share(*keys, of="cells"):
        return 100 * sum(r[k] for r in later for k in keys) / sum(r[of] for r in later)
    print(f"records: fresh {median('fresh'):.3f} s, over time {median('time'):.3f} s: {median('fresh') / median('time'):.2f} x; "
          f"all frames {sum(r['fresh'] for r in rows) / sum(r['time'] for r in rows):.2f} x; whole runs {median('fresh_all'):.3f}, {median('time_all'):.3f} s")
    print(f"of fresh gathering's rays: traced again {share('cells_moved', 'cells_lost', 'cells_unanchored', 'cells_near', 'cells_aged', of='fresh_rays'):.1f} %, with births and what goes on "
          f"from hits {share('update_rays', 'birth_rays', of='fresh_rays'):.1f} %; of the cells: "
          + ", ".join(f"{k[6:]} {share(k):.2f} %" for k in ("cells_moved", "cells_lost", "cells_unanchored", "cells_near", "cells_aged")))
    print("records by frame (fresh, over time):", *(f"{r['frame']}: {r['fresh_records']:.0f}, {r['time_records']:.0f};" for r in rows[:: max(1, len(rows) // 8)] + rows[-1:]))
    if options.pixels and spent["photons"] and options.light == "anew":
        spent.update(anew=spent["photons"] + spent["points"], stands=0)
    if options.pixels and spent["anew"]:
        lit = statistics.median(r["pixels"] for r in rows if "pixels" in r)
        first = statistics.median(r["time_all"] for r in rows if r["first"])
        whole = (spent["anew"] + median("fresh_all") + lit,
                 spent["photons"] + spent["points"] + median("time_all") + lit + (spent["stands"] + first - median("time_all")) / SEGMENT)
        print(f"photons and points anew {spent['anew']:.3f} s, of what stands {spent['stands']:.3f} s a segment; whole frames: {whole[0]:.3f}, {whole[1]:.3f} s: "
              f"{whole[0] / whole[1]:.2f} x; but for the pixels {(whole[0] - lit) / (whole[1] - lit):.2f} x")
    if options.pixels:
        print(f"pixels {statistics.median(r['pixels'] for r in rows if 'pixels' in r):.3f} s a frame")
if options.paths:
    paths(rows[-1]["frame"])
if options.judge:
    judge(sorted(options.judge))

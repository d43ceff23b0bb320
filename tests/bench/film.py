#!/usr/bin/env python3
"""What a film costs and errs by the chain against path tracing frame by frame: the table "film" of docs/methods/temporal.md.

    python3 tests/bench/film.py BIN SCENE WORK [--frames 0-47] [--size 320x180] [--judge 8 24 47] [--samples 16] [--reference 256] [--moving time]

BIN: folder of all tools. The chain is `make -f Makefile.example demo` with its defaults: its processor seconds are those of all processes of make, pictures and
sheet included. Path tracing: frame-render --integrator path alone, with a seed for each frame, and with one seed. Judged frames and those before them are
compared with two independent halves of a reference, so that its noise is in no figure. Error of path tracing falls as the root of its samples: the
last column is its time for the error of the chain. WORK/sheet.png: every fourth frame, to be looked at.
"""
import argparse
import json
import subprocess
from pathlib import Path

from pipeline import frame_of, run_make

PROJECT = Path(__file__).resolve().parents[2]
parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("bin", type=Path)
parser.add_argument("scene", type=Path)
parser.add_argument("work", type=Path)
parser.add_argument("--frames", default="0-47")
parser.add_argument("--size", default="320x180")
parser.add_argument("--judge", type=int, nargs="*", default=[8, 24, 47])
parser.add_argument("--samples", type=int, default=16, help="of path tracing")
parser.add_argument("--reference", type=int, default=256, help="samples of each half")
parser.add_argument("--moving", default="time")
options = parser.parse_args()
options.bin, options.scene, options.work = (p.resolve() for p in (options.bin, options.scene, options.work))
options.work.mkdir(parents=True, exist_ok=True)
first, last = map(int, options.frames.split("-"))


def run(tool, *words):
    subprocess.run([options.bin / tool, *map(str, words), "-q"], check=True, cwd=options.work)


def read(name):
    return json.loads((options.work / name).read_text())


def chain():
    """CPU seconds of the film, all of it."""
    return run_make(PROJECT, options.bin, options.work / "chain", SCENE=options.scene, FRAMES=options.frames, SIZE=options.size, MOVING=options.moving,
                    CHANNELS="RGBA,layers")


def path(f, name, *words):
    run("frame-render", options.scene, "--frame", f, "--size", options.size, "--integrator", "path", "--channels", "RGBA,layers", "-o", name, "--stats", "s.json", *words)
    return read("s.json")["cpu_s"]


def judged(test, f):
    run("aqm-compare", test, "--reference-halves", "r.####_a.exr", "r.####_b.exr", "--frames", f"{f - 1}-{f}", "--json", "e.json", "--allow-stale")
    found = read("e.json")
    return found["total"]["rmse"], 100 * found["total"]["bias"], found["total"]["flicker"]


spent = chain()
frames = last - first + 1
print(f"{options.scene.name}, {options.size}, {frames} frames, MOVING={options.moving}: {spent:.1f} CPU s, {spent / frames:.3f} a frame", flush=True)
run("tempolux-info", *(frame_of("chain", f) for f in range(first, last + 1, 4)), "--sheet", "sheet.png", "--columns", 4)
print(f"\n| frames | | RMSE | bias | flicker | CPU s a frame | CPU s at the chain's RMSE, over the chain's | flicker there, over the chain's |\n|{'---|' * 8}", flush=True)
for f in options.judge:
    seconds = {"a seed a frame": 0, "one seed": 0}
    for g in (f - 1, f):
        path(g, f"r.{g:04}.exr", "--halves", "--spp", options.reference, "--seed", 1000003 + g)
        seconds["a seed a frame"] += path(g, f"own.{g:04}.exr", "--spp", options.samples, "--seed", g) / 2
        seconds["one seed"] += path(g, f"one.{g:04}.exr", "--spp", options.samples) / 2
    rmse, bias, flicker = judged(frame_of("chain", "####"), f)
    if not rmse * flicker:
        raise SystemExit(f"frame {f}: the reference's noise hides the error; give it more samples than {options.reference}")
    print(f"| {f - 1}, {f} | chain | {rmse:.5f} | {bias:+.2f} % | {flicker:.5f} | {spent / frames:.2f} | 1 | 1 |")
    for name, file in (("a seed a frame", "own"), ("one seed", "one")):
        error, bias, change = judged(f"{file}.####.exr", f)
        times = (error / rmse) ** 2 * seconds[name] / (spent / frames)
        print(f"| | paths, {options.samples} samples, {name} | {error:.5f} | {bias:+.2f} % | {change:.5f} | {seconds[name]:.2f} | {times:.0f} | "
              f"{change * rmse / error / flicker:.2f} |", flush=True)

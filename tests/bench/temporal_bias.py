#!/usr/bin/env python3
"""Does gathering over time lose light? The mean of the indirect layer against fresh records on the same points and seeds, frame by frame.

    python3 tests/bench/temporal_bias.py BIN SCENE WORK [--frames 1-23] [--size WxH] [--photons N] [--seeds N] [--threads N]

Points of each frame come from static and dynamic photons, as with MOVING=time. For each frame the mean over seeds, %, and its standard error. Both sides are
rendered with the same samples of pixels, so that what differs is their records alone.
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
parser.add_argument("--frames", default="1-23", help="of the first segment")
parser.add_argument("--size", default="160x90")
parser.add_argument("--photons", default="300k")
parser.add_argument("--seeds", type=int, default=4)
parser.add_argument("--threads", type=int, default=1)
options = parser.parse_args()
options.work.mkdir(parents=True, exist_ok=True)
first, last = map(int, options.frames.split("-"))
scene, size = options.scene.resolve(), ("--size", options.size)


def run(tool, *words):
    subprocess.run([options.bin.resolve() / tool, *map(str, words), "-q", "--threads", str(options.threads)], check=True, cwd=options.work)


def points(f):
    return f"p.{f:04}.irradpoints"


def make_points():
    run("photon-trace", scene, "--frame", 0, "--photons", options.photons, "--kinds", "caustic,indirect", "--map", "static", "-o", "s.photons", "--paths", "s.paths")
    run("irradcache-build", "points", scene, "--frame", 0, "--map", "static", "--photons", "s.photons", "-o", "s.irradpoints")
    for f in range(last + 1):
        run("photon-trace", scene, "--frame", f, "--map", "dynamic", "--static", "s.paths", "-o", "d.photons")
        run("irradcache-build", "points", scene, "--frame", f, "--photons", "s.photons", "--update", "s.irradpoints", "--dynamic", "d.photons", "-o", points(f))


def layer_mean(cache, f):
    run("frame-render", scene, "--frame", f, *size, "--irradcache", cache, "--points", points(f), "--spp", 4, "--pixel-error", 0, "--channels", "RGBA,layers", "-o", "f.exr")
    told = subprocess.run([options.bin.resolve() / "tempolux-info", "--json", "f.exr"], check=True, cwd=options.work, capture_output=True, text=True).stdout
    means = {c["channel"]: c["mean"] for c in json.loads(told)["channels"]}
    return sum(means[f"indirect.{c}"] for c in "RGB")


make_points()
apart = {f: [] for f in range(first, last + 1)}
for seed in range(options.seeds):
    run("gather-temporal", "final", scene, "--frames", f"0-{last}", "--points", "p.####.irradpoints", *size, "--seed", seed, "-o", "s.####.radsamples", "--cache", "t.####.irradcache")
    for f in apart:
        run("irradcache-build", "records", scene, "--frame", f, "--points", points(f), *size, "--seed", seed, "-o", "fresh.irradcache")
        apart[f].append(100 * (layer_mean(f"t.{f:04}.irradcache", f) / layer_mean("fresh.irradcache", f) - 1))
for f, each in apart.items():
    error = statistics.stdev(each) / len(each) ** 0.5 if len(each) > 1 else float("nan")
    print(f"frame {f}: {statistics.mean(each):+.3f} +- {error:.3f} %")

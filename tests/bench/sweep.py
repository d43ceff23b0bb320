"""Error against time: curves over photons, samples, gather rays and the cache's accuracy, drawn by error-report.

A curve is one entry of `curves`; those of filtering and warping are made by few_samples.py. Each
point costs the CPU seconds of all processes that lead to the frame.
"""
import json
import re
import shutil

import chain
from chain import Settings
from few_samples import filter_runs, warping_runs
from measure import big

FRAMES = {"S1": "Cornell box", "S2": "Cornell box, frame 10", "S3": "room lit by indirect light alone", "spot": "S3 with a narrow lamp",
          "room": "furnished room, a ball moves"}
LAYERS = {"S1": [None, "indirect"], "S2": [None, "indirect"], "S3": [None], "spot": [None], "room": ["indirect"]}   # of S3 indirect light is all there is


def photon_counts(bench):
    return [10**4, 10**5] if bench.tiny else [10**4, 3 * 10**4, 10**5, 3 * 10**5, 10**6, 3 * 10**6, 10**7]


def sample_counts(bench):
    return [1, 4] if bench.tiny else [1, 2, 4, 8, 16, 32, 64, 128, 256]


def growing_neighbours(photons):
    """100 at 10^5 photons, as the cube root: fewer photons blur less, many are used up to be less noisy."""
    return min(512, round(100 * (photons / 1e5) ** (1 / 3)))


def photon_run(bench, name, photons, neighbours, seed):
    """photon-trace, then frame-render that looks the map up directly; frame and the statistics of both."""
    scene, frame = bench.scene(name)
    samples = 2 if bench.tiny else 16
    options = ["--photons", photons, "--neighbours", neighbours, "--spp", samples, "--seed", seed, "--size", bench.size]

    def make(stem):
        files = bench.out / "frames" / stem
        photon_map = bench.memory / f"tempolux-bench-{stem}.photons"
        try:
            bench.run([bench.bin / "photon-trace", scene, "--frame", frame, "--photons", photons, "--seed", seed,
                       "--kinds", "caustic,indirect", "-q", "-o", photon_map, "--stats", f"{files}-photons.json"])
            bench.run([bench.bin / "frame-render", scene, "--frame", frame, "--photons", photon_map, "--neighbours",
                       neighbours, "--spp", samples, "--seed", seed, "--size", bench.size, "--channels",
                       "RGBA,layers,id", "-q", "-o", f"{files}.exr", "--stats", f"{files}.json"])
        finally:
            photon_map.unlink(missing_ok=True)
    inputs = [scene, bench.bin / "photon-trace", bench.bin / "frame-render", frame, *options]
    image, *stats = bench.cached("frames", f"{name}-photons-{photons}-{neighbours}-{seed}", inputs,
                                 [".exr", "-photons.json", ".json"], make)
    return image, stats


def path_run(bench, name, samples, seed):
    image, stats = bench.path_frame(name, samples, seed)
    return image, [stats]


def together(step):
    """Photons, points, rays, accuracy, pixel samples: each step costs about twice the one before."""
    photons, points, rays, bound, samples, pixel_error = [
        (20000, "4k", 100, 0.4, 4, 0.05), (50000, "8k", 200, 0.3, 4, 0.025), (100000, "12k", 300, 0.25, 4, 0.015),
        (200000, "20k", 500, 0.2, 8, 0.01), (400000, "30k", 1000, 0.15, 8, 0.005), (1000000, "60k", 2000, 0.1, 8, 0.0025)][step]
    return Settings(photons, ("--point-count", points), ("--rays", rays, "--error-bound", bound),
                    ("--spp", samples, "--pixel-error", pixel_error))


PIXELS = ("--spp", 8, "--pixel-error", 0.005)    # of the curves that sweep one parameter: direct light out of the way


def gathering_curves(bench):
    """Final gathering and the irradiance cache: all parameters swept together, then each alone, the others as by default."""
    def run(settings_of):
        return lambda name, x, seed: chain.frame(bench, name, seed, settings_of(x))
    short = bench.tiny
    return [
        ("gathering, all together", [0, 1] if short else range(6), run(together)),
        ("gathering, photons", [10**4, 2 * 10**4] if short else [10**4, 3 * 10**4, 10**5, 3 * 10**5, 10**6],
         run(lambda x: Settings(x, pixels=PIXELS))),
        ("gathering, rays", [50, 100] if short else [50, 100, 200, 500, 1000, 2000],
         run(lambda x: Settings(records=("--rays", x), pixels=PIXELS))),
        ("gathering, error bound", [0.5, 0.4] if short else [0.5, 0.35, 0.25, 0.18, 0.12, 0.08],
         run(lambda x: Settings(records=("--error-bound", x), pixels=PIXELS))),
    ]


def split_curves(bench):
    """Bright points sampled explicitly, and not: gather rays."""
    rays = [50, 100] if bench.tiny else [60, 125, 250, 500, 1000, 2000]
    make = lambda split: lambda name, x, seed: chain.frame(bench, name, seed, Settings(records=("--rays", x), pixels=PIXELS, steps=True, split=split))
    return [("gathering, rays", rays, make(False)), ("low and high part, rays", rays, make(True))]


def moving_curves(bench):
    """What moves: each frame anew, gather rays; by what movers change, lower threshold of influence; and records kept from frame to frame, gather rays."""
    pixels = ("--spp", 16, "--pixel-error", 0)
    photons = 10**6
    return [("frame by frame, rays", [50, 100] if bench.tiny else [60, 125, 250, 500, 1000, 2000],
             lambda name, x, seed: chain.frame(bench, name, seed, Settings(photons, records=("--rays", x), pixels=pixels, steps=True))),
            ("static + dynamic, thresholds", [0.06, 0.2] if bench.tiny else [0.5, 0.2, 0.1, 0.06, 0.03, 0.01],
             lambda name, x, seed: chain.updated_frame(bench, name, seed, Settings(photons, pixels=pixels), x)),
            ("temporal gathering, rays", [50, 100] if bench.tiny else [60, 125, 250, 500, 1000, 2000],
             lambda name, x, seed: chain.kept_frame(bench, name, seed, Settings(photons, records=("--rays", x), pixels=pixels)))]


def curves(bench, name):
    """(curve, swept values, what one value and seed make: frame and statistics files)."""
    if name in ("spot", "room"):
        paths = ("path tracing", [1, 4] if bench.tiny else [1, 4, 16, 64], lambda name, x, seed: path_run(bench, name, x, seed))
        return [paths, *(split_curves if name == "spot" else moving_curves)(bench)]
    return [
        ("path tracing", sample_counts(bench), lambda name, x, seed: path_run(bench, name, x, seed)),
        ("photon map, k = 50", photon_counts(bench), lambda name, x, seed: photon_run(bench, name, x, 50, seed)),
        ("photon map, k grows", photon_counts(bench),
         lambda name, x, seed: photon_run(bench, name, x, growing_neighbours(x), seed)),
        *gathering_curves(bench),
    ]


def measure(bench, peers, only=""):
    """Runs every point of the scenes that the regular expression names, and of "filter" and "walk" (few_samples.py), has error-report draw the curves; the
    folder of the report."""
    runs, points = [], []
    for name in (["S1", "spot", "room"] if bench.tiny else FRAMES):
        if not re.search(only, name):
            continue
        halves = bench.reference_halves(name)
        for curve, values, make in curves(bench, name):
            print(f"  {name}: {curve}", flush=True)
            for x in values:
                for seed in ([1] if bench.tiny or (curve == "path tracing" and x > 16) or curve.startswith(("gathering", "low", "frame", "static", "temporal")) or x > 10**5
                             else [1, 2]):
                    image, stats = make(name, x, seed)
                    for layer in LAYERS[name]:
                        title = f"{name}, indirect light alone" if layer else f"{name}, {FRAMES[name]}"
                        comparison = image.with_name(f"{image.stem}-{layer or 'all'}-error.json")
                        bench.compare(image, halves, comparison, layer)
                        runs.append({"scene": title, "curve": curve, "label": big(x) if isinstance(x, int) else str(x), "x": x, "parameters": {"seed": seed},
                                     "stats": [str(s) for s in stats], "comparison": str(comparison)})
        for peer, rows in peers.items():
            points += [{"scene": f"{name}, {FRAMES[name]}", "label": f"{peer}, {row['samples']} samples",
                        "cpu_s": row["cpu_s"], "rmse": row["rmse"]} for row in rows if row["scene"] == name]
    if re.search(only, "filter"):
        name = "S1" if bench.tiny else "S2"
        runs += filter_runs(bench, name, f"{name}, few samples, filtered", bench.reference_halves(name))
    if re.search(only, "walk"):
        runs += warping_runs(bench)
    manifest = {"schema": "tempolux.report", "version": "1.0", "title": "Error against run time",
                "baseline": "path tracing", "runs": runs, "points": points}
    file = bench.out / "report.json"
    file.write_text(json.dumps(manifest, indent=1))
    shutil.rmtree(bench.out / "report", ignore_errors=True)
    bench.run([bench.bin / "error-report", file, "-o", bench.out / "report"])
    return bench.out / "report"

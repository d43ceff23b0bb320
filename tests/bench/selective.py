#!/usr/bin/env python3
"""Selective photon tracing: error of the layer volume by strategy and share of paths traced, and what further photons are worth.

    python3 tests/bench/selective.py build/release/bin [updates] [cost] [refine] [deviation] --make-vdb build/release/tests/make-vdb

updates: S6 (../shared/scenes) and the chimney of chimney.py, 24 frames of one segment each. Of every frame but the first some groups of the
map before are traced again; pilots, 3 % of each group's paths, count as traced. The reference of a frame is a fresh map of the same
seed, as in the paper's figures 5 and 6: what is measured is what groups err that were not traced again. Prints for each strategy the mean
RMSE from the sixth frame on, the share of these frames in which it is below oldest and random, the groups of a frame and CPU seconds.
"plain" is without the factor age. FOLDER/NAME-SHARE.svg draws the errors by frame.

cost: S6, an update of 10 % against a fresh map, CPU seconds of frames 5 to 11 as one process for each and as one for all, in turns; and what that saves
of a whole frame, points, records and 320x180 pixels with smoke included.

refine: S6 at frame 12, 299 880 paths and 54 264 more by --refine, against as many spread evenly (a fresh map of 354 144), several seeds, to
a reference of 6 million; all by the same filter, so that what differs is noise.

deviation: directions of photons from a point lamp in 400 bins of equal solid angle, over 30 passes of --refine; standard deviation over mean, by
flux and by number (the paper's figure 2).
"""
import argparse
import json
import math
import resource
import struct
import subprocess
import sys
from pathlib import Path

import chimney
import pipeline
import smoky_rooms
from plot import chart

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "formats"))
from read_photons import FLUX, KIND, RECORD, read_photons  # noqa: E402

PATHS = 299880
STRATEGIES = {
    "oldest": ["oldest"], "random": ["random"], "census": ["census"], "fde": ["fde"], "dip": ["dip"], "hybrid": ["hybrid"], "path": ["path"],
    "fde plain": ["fde", "--age-power", "0"], "dip plain": ["dip", "--age-power", "0"], "census plain": ["census", "--age-power", "0"],
}


class Runner:
    def __init__(self, options):
        self.bin, self.folder, self.threads = options.bin.resolve(), options.folder, options.threads

    def run(self, tool, *arguments):
        """CPU seconds."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([self.bin / tool, *map(str, arguments), "-q", *(["--threads", str(self.threads)] if self.threads else [])], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def rmse(self, test, reference):
        out = subprocess.run([self.bin / "aqm-compare", test, reference, "--layer", "volume", "--json", "-", "-q", "--allow-stale"],
                             check=True, capture_output=True, text=True).stdout
        return json.loads(out)["total"]["rmse"]


def scenes(options):
    """Name, scene file, options of its smoke, first and last frame."""
    made = Path(__file__).resolve().parents[3] / "shared/scenes/made"
    if (made / "S6_smoke.glb").exists():
        yield "S6", made / "S6_smoke.glb", ["--volume", made / "S6_smoke_vdb/smoke_####.vdb", "--sigma-t", 10, "--albedo", ".85,.85,.88"], 0, 23
    folder = options.folder / "chimney"
    folder.mkdir(exist_ok=True)
    yield ("chimney", chimney.make(folder, options.make_vdb, range(24, 48)),
           ["--volume", folder / "chimney_####.vdb", "--volume-frames", "24-47", *chimney.OPTIONS], 24, 47)


def compose(runner, scene, smoke, frames, photons, out, *more):
    """Frames of this layer; the same rays and samples of the lamp for each map, so that they cancel."""
    base = runner.folder / "base"
    runner.run("volume-compose", scene, *smoke, "--frames", frames, "--photons", photons, "--base", base / "f.####.exr",
               "--spp", 2, "--light-samples", 1, *more, "-o", out)


def measure_updates(options, runner):
    for name, scene, smoke, first, last in scenes(options):
        frames = f"{first}-{last}"
        for part in ("fresh", "base", "update"):
            (runner.folder / part).mkdir(exist_ok=True)
        runner.run("scene-plan", scene, *smoke, "--frames", frames, "--update", "10%", "-o", runner.folder / "plan")
        frozen = [*smoke, "--majorants", pipeline.majorants_of(runner.folder / "plan", first)]
        paths = ["--photons", PATHS, "--kinds", "indirect,volume"]
        fresh = runner.folder / "fresh"
        anew = runner.run("photon-trace", scene, *frozen, "--frames", f"{first + 1}-{last}", *paths, "-o", fresh / "p.####.photons") / (last - first)
        runner.run("photon-trace", scene, *frozen, "--frames", first, *paths, "--pilots", options.pilots, "-o", fresh / "p.####.photons")
        runner.run("frame-render", scene, *smoke, "--frames", frames, "--photons", fresh / "p.####.photons", "--size", options.size, "--spp", 1,
                   "--channels", "RGBA,layers,Z", "-o", runner.folder / "base/f.####.exr")
        compose(runner, scene, smoke, frames, fresh / "p.####.photons", fresh / "f.####.exr")
        print(f"\n{name}, frames {frames}, {PATHS} paths; a fresh map takes {anew:.2f} CPU s\n")
        print("| share | strategy | mean RMSE | below oldest and random | groups a frame | CPU s a frame |\n|---|---|---:|---:|---:|---:|")
        for share in options.shares.split(","):
            rows = {}
            for strategy in options.strategies.split(",") if options.strategies else STRATEGIES:
                folder = runner.folder / "update"
                for old in folder.iterdir():
                    old.unlink()
                (folder / f"p.{first:04d}.photons").write_bytes((fresh / f"p.{first:04d}.photons").read_bytes())
                stats = folder / "stats.json"
                cpu = runner.run("photon-trace", scene, *frozen, "--frames", f"{first + 1}-{last}", "--photons", PATHS, "--kinds", "indirect,volume",
                                 "--update", folder / "p.####.photons", "--share", share, "--strategy", *STRATEGIES[strategy],
                                 "-o", folder / "p.####.photons", "--stats", stats)
                compose(runner, scene, smoke, f"{first + 1}-{last}", folder / "p.####.photons", folder / "f.####.exr")
                errors = [runner.rmse(folder / f"f.{f:04d}.exr", fresh / f"f.{f:04d}.exr") for f in range(first + 1, last + 1)]
                groups = json.loads(stats.read_text())["counts"]["groups_updated"] / (last - first)
                rows[strategy] = (errors, groups, cpu / (last - first))
            for strategy, (errors, groups, cpu) in rows.items():
                judged = range(5, len(errors))               # of frames first + 1 ...: from the sixth on
                better = sum(all(errors[i] < rows[other][0][i] for other in ("oldest", "random") if other in rows and other != strategy) for i in judged)
                print(f"| {share} | {strategy} | {sum(errors[i] for i in judged) / len(judged):.5f} | {better} of {len(judged)} | {groups:.0f} | {cpu:.3f} |",
                      flush=True)
            stem = runner.folder / f"{name}-{share.rstrip('%')}"
            stem.with_suffix(".json").write_text(json.dumps({s: r[0] for s, r in rows.items()}))
            stem.with_suffix(".svg").write_text(chart(f"{name}: {share} of the paths traced again, pilots counted", "frame", "RMSE of the layer volume, W/m²/sr",
                                                      [(s, list(enumerate(r[0], first + 1))) for s, r in rows.items()]))


def measure_cost(options, runner):
    _, scene, smoke, _, _ = next(scenes(options))
    runner.run("scene-plan", scene, *smoke, "--frames", "0-23", "--update", "10%", "-o", runner.folder / "plan")
    frozen = [*smoke, "--majorants", pipeline.majorants_of(runner.folder / "plan", 0)]
    photons, frames, common = runner.folder / "cost.####.photons", range(5, 12), [scene, *frozen, "--kinds", "caustic,indirect,volume"]
    first = runner.folder / "cost.0004.photons"
    others = None
    print("\n| paths | strategy | a process for each frame, CPU s | of a fresh map | one for all, CPU s | of fresh maps | a whole frame, of one with a fresh map |\n|---:|---|---:|---:|---:|---:|---:|")
    for paths in (PATHS, 999810):
        common_paths = [*common, "--photons", paths]
        ways = {"fresh": [], **{s: ["--update", photons, "--share", "10%", "--strategy", s] for s in ("oldest", "census", "fde", "dip", "hybrid")}}
        single, ranges = {w: [] for w in ways}, {w: [] for w in ways}
        for _ in range(options.rounds):
            for way, words in ways.items():
                runner.run("photon-trace", *common_paths, "--frame", 4, "--pilots", options.pilots, "-o", first)
                single[way].append(sum(runner.run("photon-trace", *common_paths, "--frame", f, *words, "-o", photons) for f in frames) / len(frames))
                runner.run("photon-trace", *common_paths, "--frame", 4, "--pilots", options.pilots, "-o", first)
                ranges[way].append(runner.run("photon-trace", *common_paths, "--frames", "5-11", *words, "-o", photons) / len(frames))
        if others is None:                     # from a fresh map of the last frame
            runner.run("photon-trace", *common_paths, "--frame", 11, "-o", photons)
            others = whole_frame(runner, [scene, *smoke, "--frame", 11], runner.folder / "cost.0011.photons")
        least = {w: (min(single[w]), min(ranges[w])) for w in ways}
        for way, (one, many) in least.items():
            print(f"| {paths} | {way} | {one:.3f} | {one / least['fresh'][0]:.2f} | {many:.3f} | {many / least['fresh'][1]:.2f} | {(others + many) / (others + least['fresh'][1]):.2f} |", flush=True)
    print(f"\nPoints, records, pixels and smoke: {others:.2f} CPU s.")


def whole_frame(runner, common, photons):
    """CPU seconds of all but the photons."""
    points, records, clear = (runner.folder / f"cost.{end}" for end in ("irradpoints", "irradcache", "exr"))
    size, light = ["--size", "320x180"], ["--photons", photons]
    return (runner.run("irradcache-build", "points", *common, *light, "-o", points)
            + runner.run("irradcache-build", "records", *common, "--points", points, *size, "-o", records)
            + runner.run("frame-render", *common, *light, "--points", points, "--irradcache", records, *size, "--spp", 8, "--pixel-error", 0.02,
                         "--channels", "RGBA,layers,Z", "-o", clear)
            + runner.run("volume-compose", *common, *light, "--points", points, "--base", clear, "--spp", 4, "-o", runner.folder / "cost.smoke.exr"))


def measure_refine(options, runner):
    _, scene, smoke, _, _ = next(scenes(options))
    runner.run("scene-plan", scene, *smoke, "--frames", "0-23", "--update", "10%", "-o", runner.folder / "plan")
    frozen = [*smoke, "--majorants", pipeline.majorants_of(runner.folder / "plan", 0)]
    kinds = ["--kinds", "indirect,volume", "--frame", 12]
    (runner.folder / "base").mkdir(exist_ok=True)
    maps = {name: runner.folder / f"{name}.photons" for name in ("reference", "plain", "refined", "even")}
    runner.run("photon-trace", scene, *frozen, *kinds, "--photons", "6M", "--seed", 999, "-o", maps["reference"])
    runner.run("frame-render", scene, *smoke, "--frame", 12, "--photons", maps["reference"], "--size", options.size, "--spp", 1,
               "--channels", "RGBA,layers,Z", "-o", runner.folder / "base/f.0012.exr")
    frame = {name: runner.folder / f"{name}.exr" for name in maps}
    width = ["--filter-width", 1]              # cells, of all: else more photons would be smoothed less
    compose(runner, scene, smoke, 12, maps["reference"], frame["reference"], *width)
    sums = dict.fromkeys(("plain", "refined", "even"), 0.0)
    for seed in range(options.seeds):
        common = [scene, *frozen, *kinds, "--seed", seed]
        runner.run("photon-trace", *common, "--photons", PATHS, "-o", maps["plain"])
        runner.run("photon-trace", *common, "--photons", PATHS, "--update", maps["plain"], "--refine", 54264, "-o", maps["refined"])
        runner.run("photon-trace", *common, "--photons", PATHS + 54264, "-o", maps["even"])
        for name in sums:
            compose(runner, scene, smoke, 12, maps[name], frame[name], *width)
            sums[name] += runner.rmse(frame[name], frame["reference"]) ** 2 / options.seeds
    print("\n| S6, frame 12 | MSE of the layer volume | over even |\n|---|---:|---:|")
    for name, words in (("plain", f"{PATHS} paths"), ("even", "54 264 more, evenly"), ("refined", "54 264 more, --refine")):
        print(f"| {words} | {sums[name]:.3e} | {sums[name] / sums['even']:.3f} |")


def deviation(path):
    """Standard deviation over mean in 20 x 20 bins of equal solid angle around (0, 1, 0): by flux, by number of photons."""
    n = 20
    flux, number = [0.0] * n * n, [0] * n * n
    for block in read_photons(path).blocks:
        for v in RECORD.iter_unpack(block.records):
            if v[KIND] != 0:
                continue
            x, y, z = v[0], v[1] - 1, v[2]
            row = int((y / math.sqrt(x * x + y * y + z * z) + 1) / 2 * n * 0.9999999)
            column = int((math.atan2(z, x) / (2 * math.pi) + 0.5) * n * 0.9999999)
            flux[row * n + column] += v[FLUX]
            number[row * n + column] += 1
    def spread(values):
        mean = sum(values) / len(values)
        return math.sqrt(sum((v - mean) ** 2 for v in values) / len(values)) / mean
    return spread(flux), spread(number)


def measure_deviation(options, runner):
    """A box 2 m wide, black, with a point lamp in its middle and a ball of smoke to one side, so thin that light arrives everywhere."""
    folder = runner.folder / "deviation"
    folder.mkdir(exist_ok=True)
    black = smoky_rooms.material((0, 0, 0))
    smoky_rooms.write_scene(folder / "lamp.glb", {"parts": [("Room", black, smoky_rooms.box((-1, 0, -1), (1, 2, 1), inwards=True))], "point": (0, 1, 0)})
    n = 16
    ball = [max(0.0, 1 - math.dist((x, y, z), (7.5,) * 3) / 8) for x in range(n) for y in range(n) for z in range(n)]
    (folder / "ball.vdb").unlink(missing_ok=True)
    subprocess.run([options.make_vdb, folder / "ball.vdb", *map(str, (n, n, n, 0.04, 0.3, 0.7, -0.3))],
                   input=struct.pack(f"<{len(ball)}f", *ball), check=True)
    smoke = ["--volume", folder / "ball.vdb", "--sigma-t", 0.01, "--albedo", 0]
    runner.run("scene-plan", folder / "lamp.glb", *smoke, "--frames", 0, "--update", "10%", "-o", folder / "plan")
    common = [folder / "lamp.glb", *smoke, "--majorants", pipeline.majorants_of(folder / "plan", 0), "--photons", PATHS, "--kinds", "direct,volume"]
    path = folder / "p.photons"
    runner.run("photon-trace", *common, "-o", path)
    print("\n| pass | by flux | by number |\n|---:|---:|---:|")
    for i in range(options.passes + 1):
        if i in (0, 1, 2, 5, 10, 20, 30):
            print("| {} | {:.5f} | {:.5f} |".format(i, *deviation(path)), flush=True)
        runner.run("photon-trace", *common, "--update", path, "--refine", 54264, "-o", path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("parts", nargs="*")
    parser.add_argument("--make-vdb", default="make-vdb")
    parser.add_argument("--folder", type=Path, default=Path("selective"))
    parser.add_argument("--shares", default="5%,10%,20%")
    parser.add_argument("--strategies", default="")
    parser.add_argument("--pilots", default="3%")
    parser.add_argument("--size", default="96x54")
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--passes", type=int, default=30)
    parser.add_argument("--rounds", type=int, default=2, help="of cost: the least of them counts")
    parser.add_argument("--threads", type=int, default=0)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    runner = Runner(options)
    for part in options.parts or ("updates", "cost", "refine", "deviation"):
        {"updates": measure_updates, "cost": measure_cost, "refine": measure_refine, "deviation": measure_deviation}[part](options, runner)


if __name__ == "__main__":
    main()

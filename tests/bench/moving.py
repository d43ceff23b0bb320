#!/usr/bin/env python3
"""What updates cost and err where something moves: a segment's frames anew and by what movers change, as Markdown.

    python3 tests/bench/moving.py BIN FOLDER [--scene room.glb] [--frames 8-13] [--photons 1M] [--size 320x180] [--reference A-B] [--in-turns N]

BIN: folder of the tools. FOLDER: for their files. Without --scene the furnished room of moving_room.py. Both chains run in the same order, frame
by frame, with one seed. --reference (slow: 4 times the photons, points and rays, twice, by two other seeds, for these frames): flicker and errors
against the two as halves, so that their own noise is out of them, flicker of a chain with a seed for each frame, and errors apart where light is
updated, in part or in full gathered (the blend of `--channels influence`). --in-turns: nothing but the photons and points of one frame, the first of
--frames, N times by both ways in turns: medians. CPU seconds are those of `--stats`, all phases.
"""
import argparse
import json
import statistics
import subprocess
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[n] / folder) for n, folder in ((1, "formats"), (2, "docs"))]
sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import moving_room  # noqa: E402
from draw import read_png
from exr_files import exr
from read_irradcache import read_irradcache

LOW = 0.06                                   # lower threshold of influence, frame-render --influence
SEGMENT = 24                                 # frames for which what stands is made once: the tools' --segment
REFERENCES = {"r": 1000, "q": 2000}          # two halves of the reference, by seed
PARTS = {"updated": lambda blend: blend == 0, "in between": lambda blend: 0 < blend < 255, "gathered": lambda blend: blend == 255}


class Chain:
    def __init__(self, options):
        self.bin, self.out, self.scene = Path(options.bin), Path(options.folder), Path(options.scene or Path(options.folder) / "room.glb")
        self.frames, self.photons, self.size = frames_of(options.frames), options.photons, options.size
        self.judged = frames_of(options.reference) if options.reference else ()
        self.cost = {}

    def file(self, *parts):
        return self.out / ".".join(str(p) for p in parts)

    def run(self, stage, tool, *arguments):
        stats = self.out / "stats.json"
        subprocess.run([self.bin / tool, *map(str, arguments), "-q", "--stats", stats], check=True)
        found = json.loads(stats.read_text())
        self.cost.setdefault(stage, []).append(found)
        return found

    def median(self, stage):
        return statistics.median(map(cpu, self.cost[stage]))

    def render(self, kind, frame, *arguments):
        if frame in self.judged:
            self.run(f"{kind} pixels", "frame-render", self.scene, "--frame", frame, "--irradcache", self.file(kind, frame, "irradcache"), "--points",
                     self.file(kind, frame, "irradpoints"), "--size", self.size, "--spp", 16, "--pixel-error", 0, "--channels", "indirect",
                     "-o", self.out / f"{kind}.{frame:04d}.exr", *arguments)

    def stands(self, f):
        """What stands in the segment of f; what another segment left makes room."""
        self.run("stands photons", "photon-trace", self.scene, "--frame", f, "--map", "static", "--photons", self.photons, "--kinds", "indirect",
                 "-o", self.file("s.photons"), "--paths", self.file("s.paths"))
        self.run("stands points", "irradcache-build", "points", self.scene, "--frame", f, "--map", "static", "--photons", self.file("s.photons"),
                 "-o", self.file("s.irradpoints"))
        self.run("stands records", "irradcache-build", "records", self.scene, "--frame", f, "--map", "static", "--points",
                 self.file("s.irradpoints"), "--size", self.size, "-o", self.file("s.irradcache"))

    def updated_light(self, f):
        """Photons and points of f from those of what stands."""
        dynamic = self.file("u", f, "photons")
        self.run("u photons", "photon-trace", self.scene, "--frame", f, "--map", "dynamic", "--static", self.file("s.paths"), "-o", dynamic)
        self.run("u points", "irradcache-build", "points", self.scene, "--frame", f, "--update", self.file("s.irradpoints"), "--photons",
                 self.file("s.photons"), "--dynamic", dynamic, "-o", self.file("u", f, "irradpoints"))

    def updated(self, f):
        self.updated_light(f)
        dynamic = [self.file("u", g, "photons") for g in (f, f - 1, f - 2) if g in self.frames and g // SEGMENT == f // SEGMENT]
        self.run("u records", "irradcache-build", "records", self.scene, "--frame", f, "--update", self.file("s.irradcache"), "--points",
                 self.file("u", f, "irradpoints"), "--dynamic", *dynamic, "--size", self.size, "-o", self.file("u", f, "irradcache"))
        self.render("u", f)
        if f in self.judged:
            self.run("blend", "frame-render", self.scene, "--frame", f, "--irradcache", self.file("u", f, "irradcache"), "--points", self.file("u", f, "irradpoints"),
                     "--size", self.size, "--spp", 1, "--pixel-error", 0, "--channels", "influence", "-o", self.file("blend", f, "exr"))

    def light_anew(self, kind, f, photons, points=(), common=()):
        self.run(f"{kind} photons", "photon-trace", self.scene, "--frame", f, "--photons", photons, "--kinds", "indirect", *common,
                 "-o", self.file("all.photons"))
        self.run(f"{kind} points", "irradcache-build", "points", self.scene, "--frame", f, "--photons", self.file("all.photons"), *points, *common,
                 "-o", self.file(kind, f, "irradpoints"))

    def anew(self, kind, f, photons, points=(), records=(), common=()):
        self.light_anew(kind, f, photons, points, common)
        self.run(f"{kind} records", "irradcache-build", "records", self.scene, "--frame", f, "--points", self.file(kind, f, "irradpoints"),
                 "--size", self.size, *records, *common, "-o", self.file(kind, f, "irradcache"))
        self.render(kind, f, *common)

    def mean(self, stage, value):
        runs = self.cost[stage][min(2, len(self.cost[stage]) - 1):] if stage[0] in "ua" else self.cost[stage]   # with two frames before
        return sum(map(value, runs)) / len(runs)

    def compare(self, kind, frames, *words):
        tested, *halves = [self.out / f"{k}.%04d.exr" for k in (kind, *REFERENCES)]
        subprocess.run([self.bin / "aqm-compare", tested, "--reference-halves", *halves, "--frames", frames, "--layer", "indirect", "--allow-stale", *words,
                        "--json", self.out / "c.json", "-q"], check=True, stdout=subprocess.DEVNULL)
        return json.loads((self.out / "c.json").read_text())["total"]

    def parts(self, f):
        """Masks of frame f: by name of a part its file and how many pixels it has."""
        picture = self.file("blend.png")
        subprocess.run([self.bin / "tempolux-info", self.file("blend", f, "exr"), "--png", picture, "--layer", "blend", "--exposure", "0", "-q"], check=True)
        rows = read_png(picture)
        for name, holds in PARTS.items():
            values = [float(holds(pixel[0])) for row in rows for pixel in row]
            mask = self.file("mask.exr")
            mask.write_bytes(exr(len(rows[0]), len(rows), {"mask": ("float", values)}))
            yield name, mask, sum(values)


def frames_of(text):
    first, last = map(int, text.split("-"))
    return range(first, last + 1)


def cpu(stats):
    return sum(p["cpu_s"] for p in stats["phases"])


def update_error(chain):
    """E_t against E_y at places of both kinds of records where influence is low: mean of the ratio - 1, and 99 % of its size."""
    ratios, weights = [], []
    for f in chain.frames:
        gathered = {tuple(r.position): r for r in read_irradcache(str(chain.file("a", f, "irradcache"))).records}
        for r in read_irradcache(str(chain.file("u", f, "irradcache"))).records:
            twin = gathered.get(tuple(r.position))
            # A dark place has no ratio, and no weight.
            if r.set == 0 and twin and sum(twin.irradiance) > 0 and r.influence <= LOW * max(r.irradiance):
                ratios.append(sum(r.update) / sum(twin.irradiance) - 1)
                weights.append(sum(twin.irradiance))
    size = sorted(map(abs, ratios))
    if not size:
        return 0, 0, 0
    return sum(r * w for r, w in zip(ratios, weights)) / sum(weights), size[int(0.99 * len(size))], len(size)


def in_turns(chain, times):
    """Photons and points of one frame by both ways, one after the other: the medians of their CPU seconds as a table."""
    f = chain.frames[0]
    chain.stands(f)
    for _ in range(times):
        chain.updated_light(f)
        chain.light_anew("a", f, chain.photons)
    counts = [chain.cost[f"{k} photons"][0]["counts"] for k in "ua"]
    print(f"{100 * counts[0]['touched_paths'] / counts[1]['paths']:.1f} % of the paths are touched\n")
    print(f"| frame {f}, CPU s, median of {times} | anew | updated | updated / anew |\n|---|---|---|---|")
    for stage in ("photons", "points"):
        updated, anew = (chain.median(f"{k} {stage}") for k in "ua")
        print(f"| {stage} | {anew:.3f} | {updated:.3f} | {updated / anew:.3f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("folder")
    parser.add_argument("--scene")
    parser.add_argument("--frames", default="8-13")
    parser.add_argument("--photons", default="1M")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--reference", metavar="A-B")
    parser.add_argument("--in-turns", type=int, default=0, metavar="N")
    options = parser.parse_args()
    Path(options.folder).mkdir(parents=True, exist_ok=True)
    chain = Chain(options)
    if not options.scene:
        moving_room.make(chain.scene)
    if options.in_turns:
        in_turns(chain, options.in_turns)
        return
    for f in chain.frames:
        if f == chain.frames[0] or f % SEGMENT == 0:
            chain.stands(f)
        chain.updated(f)
        chain.anew("a", f, options.photons)
    touched = chain.mean("u photons", lambda s: s["counts"]["touched_paths"]) / chain.mean("a photons", lambda s: s["counts"]["paths"])
    print(f"{100 * touched:.1f} % of the paths are touched\n")
    print("| CPU s a frame | photons | points | phase `records` | records |\n|---|---|---|---|---|")

    def phase(stats):
        return next(p["cpu_s"] for p in stats["phases"] if p["name"] == "records")
    rows = {name: [chain.mean(f"{k} photons", cpu), chain.mean(f"{k} points", cpu), chain.mean(f"{k} records", phase),
                   chain.mean(f"{k} records", lambda s: s["counts"]["records"])] for k, name in (("a", "anew"), ("u", "updated"), ("stands", "what stands, once"))}
    for name, row in rows.items():
        print(f"| {name} | " + " | ".join(f"{x:.2f}" for x in row[:3]) + f" | {row[3]:.0f} |")
    print("| updated / anew | " + " | ".join(f"{u / a:.2f}" for u, a in zip(rows["updated"], rows["anew"])) + " |\n")
    bias, worst, count = update_error(chain)
    print(f"E_t / E_y - 1 at {count} places of low influence: mean {100 * bias:.2f} %, 99 % of them within {100 * worst:.1f} %")
    if not options.reference:
        return
    for f in chain.judged:
        for kind, seed in REFERENCES.items():
            chain.anew(kind, f, "4M", ("--point-count", "80k"), ("--rays", 2400, "--error-bound", 0.14), ("--seed", seed))
        chain.anew("f", f, options.photons, common=("--seed", f))
    print("\n| against the reference, indirect light | relMSE | bias | flicker |\n|---|---|---|---|")
    for kind, name in (("u", "updated"), ("a", "anew, one seed"), ("f", "anew, a seed for each frame")):
        total = chain.compare(kind, options.reference)
        print(f"| {name} | {total['relmse']:.6f} | {100 * total['bias']:.2f} % | {total['flicker']:.6f} |")
    print("\n| where light is | pixels | relMSE, updated | anew |\n|---|---|---|---|")
    sums = {name: [0, 0, 0] for name in PARTS}
    for f in chain.judged:
        for name, mask, pixels in chain.parts(f):
            if pixels:
                errors = (chain.compare(kind, str(f), "--mask", mask)["relmse"] for kind in "ua")
                sums[name] = [s + v for s, v in zip(sums[name], (pixels, *(pixels * e for e in errors)))]
    for name, (pixels, updated, anew) in sums.items():
        if pixels:
            print(f"| {name} | {pixels / len(chain.judged):.0f} | {updated / pixels:.6f} | {anew / pixels:.6f} |")


if __name__ == "__main__":
    main()

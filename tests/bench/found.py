#!/usr/bin/env python3
"""Scenes made by others, path-traced and by the photon chain: does each render, and do the layers agree?

    python3 tests/bench/found.py                        all of ../shared/scenes/found/gltf
    python3 tests/bench/found.py --only 'Fox|17_ior'    some of them; the others' rows are kept, with the commit they are of

A file without a camera is copied to a temporary folder and gets one that sees all of it, and a ground below; a file without
a light gets a lamp and a dim sky; in one with lights without extent no surface is smoother than a roughness of 0.1: the path
tracer cannot find those in a mirror, and hardly in gloss or glass as smooth as that (the variance of their light goes with
roughness^-4), so such layers may stay undecided; one scene is made rougher still (ROUGHER). Where things stand (skins, morphs,
instances) is learnt from a few photons of a sun. The photon chain takes 12 million photons (4, if those fill 200 MB or more: in
closed rooms each is stored many times; 36, if they fill less than 30, and 108, if less than 8: few meet anything, and what few
there are is blurred over edges), 80k points, 16 shadow rays for each, 64 samples per pixel and 8 photons to a caustic one's
footprint, not its defaults: between seeds photons and rays make most of the difference, and cost less than more seeds; points nearer
to each other and small footprints tell the light on both sides of a narrow gap apart (the ground is put just below). Records are the
default's. Prints a table; writes found-layers.json and found.png (path tracer left, photon chain right, each pair at its own
exposure) to --out.
A first run of either way tells the variance and the cost of every layer; then as many samples per pixel of the one and seeds of
the other are spent as bring all error bars below 1 % for the least CPU time, or the widest as low as --cpu allows. Where a layer
would stay undecided, once more: below half of that, for four times the CPU time. An error bar is that of 95 %, by Student's t
for the few seeds. A layer agrees if the means differ by at most 1.5 % and the bar is no wider than that; it does not if they
differ by more than 1.5 % plus the bar; else it is undecided. Layers below 0.1 % of the picture are listed, but not judged.
"""
import argparse
import json
import math
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import pipeline
from furnish import LEAST_ROUGHNESS, Asset, furnished, roughened, with_sun
from measure import Bench, Missing, commit_of, figure

LAYERS = ("emission", "specular", "direct", "caustic", "indirect")
JUDGED = 0.001          # of the picture: layers below are listed only
LIMIT = 0.015           # of a layer's mean: what the two may differ by
WANTED_BAR = 0.01       # of a judged layer's mean
PILOT, PILOT_SEEDS = 32, 3   # samples per pixel and seeds that tell how many are needed
MOST_SEEDS = 60
PATIENCE = 4            # times --cpu where a layer would stay undecided
ROUGHER = {"24_animation_pointer": 0.7}   # black but for spots of lights without extent: at 0.1 one path in 10^5 brings half of a layer
LARGE_MAP, SMALL_MAP, TINY_MAP = 200e6, 30e6, 8e6   # bytes of a third of the photons: then that is enough; 3, 9 times as many do not hurt
POINTS, LIGHT_SAMPLES = "80k", 16   # irradiance points, shadow rays for each
FRAME = 10
FRAME_OPTIONS = ["--spp", 64, "--caustic-neighbours", 8]


class Refused(Exception):
    """A tool ended with another code than 0: (code, first line of its message)."""


class Found:
    """How the scenes are rendered, and what is kept."""

    def __init__(self, bench, folder, size, cpu, photons):
        self.bench, self.folder, self.size, self.cpu, self.photons = bench, folder, size, cpu, photons
        self.sky, self.pictures = [], bench.out / "found"
        self.pictures.mkdir(exist_ok=True)

    def tool(self, name, *arguments):
        """Its statistics and its warnings; Refused if it ends badly."""
        stats = self.folder / "stats.json"
        command = [self.bench.bin / name, *arguments, "--stats", stats]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        lines = done.stderr.splitlines()
        if done.returncode != 0:
            message = next((line for line in lines if name in line), done.stderr[:200])
            raise Refused(done.returncode, re.sub(re.escape(str(self.folder)) + r"/\w+/", "", message))
        return json.loads(stats.read_text()), [line for line in lines if "warning" in line]

    def usable(self, file):
        """(scene with camera and light, what it was given); sets the sky"""
        self.sky = []
        asset = Asset(file)
        rougher = ""
        if asset.hides_light:
            least = ROUGHER.get(file.stem, LEAST_ROUGHNESS)
            rougher = f"roughness of {least} at least"
            file = roughened(asset, self.folder / "roughened", least)
            asset = Asset(file)
        if asset.has_camera and asset.has_light:
            return file, rougher
        if not asset.has_light:
            self.sky = ["--environment", "0.1,0.12,0.15"]
        if not asset.gltf.get("meshes"):
            return self.placed(asset, [-2] * 3, [2] * 3, rougher)
        sun = with_sun(asset, self.folder / "sun")
        photons = self.folder / "sun.photons"
        self.tool("photon-trace", sun, "--frame", FRAME, "--photons", "20k", "-q", "-o", photons)
        bounds = json.loads(self.bench.run([self.bench.bin / "tempolux-info", "--json", photons]).stdout)["bounds_m"]
        return self.placed(asset, bounds["min"], bounds["max"], rougher)

    def placed(self, asset, lower, upper, rougher):
        scene, added = furnished(asset, self.folder / "furnished", lower, upper)
        return scene, ", ".join(filter(None, [added, rougher]))

    def by_paths(self, scene, size, spp, *options):
        image = self.folder / "path.exr"
        stats, warnings = self.tool("frame-render", scene, "--frame", FRAME, "--size", size, "--integrator", "path", "--spp", spp,
                                    "--halves", "--channels", "RGBA,layers", "--compression", "none", "-o", image, *self.sky, *options)
        return image, stats["cpu_s"], warnings

    def reference(self, scene, spp):
        """Path-traced picture, its halves, CPU seconds, warnings."""
        image, cpu, warnings = self.by_paths(scene, self.size, spp)
        return exr.read(image), [exr.read(image.with_name(f"path_{h}.exr")) for h in "ab"], cpu, warnings

    def by_photons(self, scene, size, photons, seed, *options):
        common = [scene, "--frame", FRAME, "-q", "--seed", seed, *self.sky, *options]
        runs = pipeline.chain(self.tool, common, self.folder / "chain", ["--photons", photons],
                              ["--point-count", POINTS, "--light-samples", LIGHT_SAMPLES], ["--size", size],
                              ["--size", size, *FRAME_OPTIONS, "--channels", "RGBA,layers", "--compression", "none"], map_beside=True)
        return self.folder / "chain.exr", sum(stats["cpu_s"] for stats, _ in runs)

    def chains(self, scene, seeds, photons):
        """Pictures by the photon chain, CPU seconds of all."""
        images, sum_cpu = [], 0
        for seed in seeds:
            image, cpu = self.by_photons(scene, self.size, photons, seed)
            images.append(exr.read(image))
            sum_cpu += cpu
        return images, sum_cpu

    def compare(self, file):
        """A row: both ways, layer by layer."""
        row = {"file": file.name, "layers": {}}
        try:
            scene, row["given"] = self.usable(file)
            path, halves, row["path_cpu_s"], row["warnings"] = self.reference(scene, PILOT)
            photons = self.photons // 3
            self.by_photons(scene, self.size, photons, 1)
            size = (self.folder / "chain.photons").stat().st_size
            if size < LARGE_MAP:
                photons = self.photons * (9 if size < TINY_MAP else 3 if size < SMALL_MAP else 1)
            chain, row["chain_cpu_s"] = self.chains(scene, range(1, PILOT_SEEDS + 1), photons)
            pilot = path, halves, row["path_cpu_s"], chain, row["chain_cpu_s"]
            for patience in (1, PATIENCE):
                widest, spp, seeds = samples_wanted(*pilot, patience * self.cpu, WANTED_BAR if patience == 1 else WANTED_BAR / 2)
                if widest > LIMIT and patience == 1:
                    continue
                if spp > PILOT:
                    path, halves, row["path_cpu_s"], _ = self.reference(scene, spp)
                if seeds > len(chain):
                    more, cpu = self.chains(scene, range(len(chain) + 1, seeds + 1), photons)
                    chain, row["chain_cpu_s"] = chain + more, row["chain_cpu_s"] + cpu
                row["layers"] = {layer: layer_row(layer, path, halves, chain) for layer in LAYERS}
                if all(layer["verdict"] != "undecided" for layer in row["layers"].values()):
                    break
            row |= {"spp": spp, "seeds": len(chain), "photons": photons}
        except Refused as refusal:
            row["exit"], row["message"] = refusal.args
            return row
        row["exit"] = 0
        row["not_finite"] = path.not_finite() + chain[0].not_finite()
        scale = brightness(path)
        for picture, image in zip(self.shown(file), (path, chain[0])):
            exr.write(picture, image.width, image.height, {c: [v * scale for v in image.channels[c]] for c in "RGB"})
        return row

    def shown(self, file):
        """By paths, by photons: pictures at an exposure of their own, for the sheet."""
        return [self.pictures / f"{file.stem}-{way}.exr" for way in ("path", "photons")]

    def same_for_threads(self, file):
        """Are the bytes of photons, cache and frames the same for 1, 2, 3 and 7 threads?"""
        scene, _ = self.usable(file)
        found = set()
        for threads in (1, 2, 3, 7):
            images = [self.by_paths(scene, "64x36", 4, "--threads", threads)[0],
                      self.by_photons(scene, "64x36", "20k", 1, "--threads", threads)[0]]
            files = images + [self.folder / "chain.photons", self.folder / "chain.irradcache"]
            found.add(b"".join(f.read_bytes().replace(f"--threads {threads}".encode(), b"") for f in files))
        return len(found) == 1


def mean(image, layer=""):
    """Of all three colours together."""
    values = image.rgb(layer)
    return math.fsum(values) / len(values)


def error_of_mean(halves, layer):
    """Standard error of a path-traced layer's mean. Pixels are independent, the colours of one are not: three times the
    variance of independent values."""
    a, b = (half.rgb(layer) for half in halves)
    return math.sqrt(3 * math.fsum((x - y) ** 2 for x, y in zip(a, b)) / 4) / len(a)


def student(freedom):
    """Quantile of 97.5 % of Student's t, right to 0.5 %."""
    return 1.96 + 2.37 / freedom + 2.8 / freedom ** 2 + 3.2 / freedom ** 3


def error_bar(path_error, chain_error, seeds):
    return math.hypot(1.96 * path_error, student(seeds - 1) * chain_error)


def is_judged(path, layer, chain):
    return max(mean(path, layer), chain) >= JUDGED * mean(path)


def samples_wanted(path, halves, path_cpu, chain, chain_cpu, most_cpu, wanted_bar):
    """(widest error bar, samples per pixel, seeds) by a first run of both: see above."""
    variances = []    # of one sample per pixel, of one seed; of the mean
    for layer in LAYERS:
        seeds, size = [mean(image, layer) for image in chain], mean(path, layer)
        if size > 0 and is_judged(path, layer, statistics.mean(seeds)):
            variances.append((error_of_mean(halves, layer) ** 2 * PILOT / size ** 2, statistics.variance(seeds) / size ** 2))
    best = (math.inf, 0, PILOT, PILOT_SEEDS)
    for seeds in range(PILOT_SEEDS, MOST_SEEDS + 1):
        left = [wanted_bar ** 2 - student(seeds - 1) ** 2 * v / seeds for _, v in variances]
        wanted = max((1.96 ** 2 * v / room if room > 0 else math.inf for (v, _), room in zip(variances, left)), default=0)
        paid = (most_cpu - seeds * chain_cpu / len(chain)) / (path_cpu / PILOT)
        spp = max(PILOT, 16 * math.ceil(min(wanted, paid) / 16))
        widest = max((error_bar(math.sqrt(v / spp), math.sqrt(w / seeds), seeds) for v, w in variances), default=0)
        cost = seeds * chain_cpu / len(chain) + spp * path_cpu / PILOT
        if seeds == PILOT_SEEDS or cost <= 1.1 * most_cpu:
            best = min(best, (max(widest, wanted_bar), cost, spp, seeds))
    return best[0], *best[2:]


def layer_row(layer, path, halves, chain):
    """Means, their standard errors, the relative difference with its bar, and the verdict: None if the layer is too dark."""
    seeds = [mean(image, layer) for image in chain]
    ours, theirs = mean(path, layer), statistics.mean(seeds)
    path_error, chain_error = error_of_mean(halves, layer), statistics.stdev(seeds) / math.sqrt(len(seeds))
    row = {"path": ours, "path_error": path_error, "chain": theirs, "chain_error": chain_error,
           "of_picture": ours / max(mean(path), 1e-30), "verdict": None}
    if ours > 0:
        row |= {"difference": theirs / ours - 1, "bar": error_bar(path_error, chain_error, len(seeds)) / ours}
    if is_judged(path, layer, theirs):
        row["verdict"] = verdict(row.get("difference", math.inf), row.get("bar", 0))
    return row


def verdict(difference, bar):
    if abs(difference) > LIMIT + bar:
        return "apart"
    return "agrees" if abs(difference) <= LIMIT and bar <= LIMIT else "undecided"


def brightness(image):
    """What brings all but two in a hundred values of a picture below 0.9."""
    values = sorted(image.rgb())
    return 0.9 / max(values[int(0.98 * (len(values) - 1))], 1e-9)


def expected_refusal(file, row):
    """What a file packs its geometry with and nothing here reads (Draco or meshopt, for example) is refused by name, whether the
    file says that it requires it, or only uses it and has no plain copy."""
    gltf = Asset(file).gltf
    used = {*gltf.get("extensionsRequired", []), *gltf.get("extensionsUsed", [])}
    return row["exit"] == 2 and any(f"{name} is not supported" in row["message"] for name in used)


def is_good(file, row):
    if row["exit"] != 0:
        return expected_refusal(file, row)
    return (not row["not_finite"] and row.get("same_bytes", True)
            and all(r["verdict"] in ("agrees", None) for r in row["layers"].values()))


def table_rows(name, row):
    """Strings: the file's line, one for each layer that is not black."""
    if row["exit"] != 0:
        return [[name, f"exit {row['exit']}: {row['message']}", "", "", "", ""]]
    cpu = f"{row['path_cpu_s']:.1f} ({row['spp']} samples), {row['chain_cpu_s']:.1f} ({row['seeds']} seeds, {row['photons'] / 1e6:g} M photons)"
    lines = [[name, "rendered" + (f" ({row['given']})" if row["given"] else ""), "", "", "", cpu]]
    for layer, r in row["layers"].items():
        if r["path"] or r["chain"]:
            relative = f"{100 * r['difference']:+.2f} ± {100 * r['bar']:.2f} %" if r["path"] else "-"
            said = {"agrees": "", "apart": " (!)", "undecided": " (?)", None: " (below 0.1 % of the picture)"}[r["verdict"]]
            lines.append(["", layer, f"{r['path']:.4g} ± {r['path_error']:.1g}", f"{r['chain']:.4g} ± {r['chain_error']:.1g}",
                          relative + said, ""])
    return lines


def summary(rows):
    """Sentences: how many layers agree, and which do not, are undecided, are not judged."""
    layers = [(f"{Path(name).stem} {layer}", r) for name, row in rows.items() for layer, r in row["layers"].items()
              if r["path"] or r["chain"]]
    names = {v: [name for name, r in layers if r["verdict"] == v] for v in ("agrees", "apart", "undecided", None)}
    notes = [f"{len(names['agrees'])} of {len(layers) - len(names[None])} layers agree within 1.5 %, by an error bar (95 %) no wider; "
             f"{len(names['apart'])} do not (!), {len(names['undecided'])} are undecided (?); "
             f"{len(names[None])} below 0.1 % of their picture are listed without a verdict."]
    notes += [f"Beyond 1.5 % and the error bar: {', '.join(names['apart'])}."] if names["apart"] else []
    return notes + ([f"Undecided: {', '.join(names['undecided'])}."] if names["undecided"] else [])


def found(bench, _=None, only="", size="320x180", cpu=120, photons=12_000_000):
    """The figure: every found scene, by both ways."""
    folder = bench.project / ".." / "shared" / "scenes" / "found" / "gltf"
    if not folder.is_dir():
        raise Missing("../shared/scenes/found/gltf is absent")
    if bench.tiny:
        only, size, cpu, photons = only or "CornellBox|BoxDraco", bench.size, 0, 10_000
    files = {str(p.relative_to(folder)): p for p in sorted(folder.rglob("*.gl*")) if p.suffix in (".gltf", ".glb")}
    kept, commit = bench.out / "found-layers.json", commit_of(bench.project)
    rows = json.loads(kept.read_text()) if only and kept.exists() and not bench.tiny else {}
    measured = [name for name in files if re.search(only, name)]
    with tempfile.TemporaryDirectory(dir=bench.out) as temporary:
        work = Found(bench, Path(temporary), size, cpu, photons)
        for name in measured:
            rows[name] = work.compare(files[name]) | {"commit": commit}
            for line in table_rows(name, rows[name]):
                print("  ".join(line), flush=True)
            kept.write_text(json.dumps(rows, indent=1))
        rows = {name: rows[name] for name in files if name in rows}
        rendered = [name for name, row in rows.items() if row["exit"] == 0]
        for name in rendered[::max(1, len(rendered) // 5)][:0 if bench.tiny else 5]:
            if name in measured or "same_bytes" not in rows[name]:
                rows[name]["same_bytes"] = work.same_for_threads(files[name])
        pictures = [picture for name in rendered for picture in work.shown(files[name])]
    kept.write_text(json.dumps(rows, indent=1))
    good = all(is_good(files[name], row) for name, row in rows.items())
    notes = [f"{name}: {warning}" for name, row in rows.items() for warning in row.get("warnings", [])]
    notes += [f"{Path(name).name}: {'the same' if row['same_bytes'] else 'OTHER'} bytes with 1, 2, 3 and 7 threads."
              for name, row in rows.items() if "same_bytes" in row]
    notes += [f"Photon chain: {POINTS} irradiance points, {LIGHT_SAMPLES} shadow rays for each, frame-render {' '.join(map(str, FRAME_OPTIONS))}, else its defaults. Where a least "
              "roughness is named (lights without extent beside smooth surfaces), both ways render surfaces so rough."]
    notes += [f"Measured at commit {other}: {', '.join(Path(name).stem for name, row in rows.items() if row['commit'] == other)}."
              for other in sorted({row["commit"] for row in rows.values()} - {commit})]
    notes += summary(rows)
    if pictures:
        bench.run([bench.bin / "tempolux-info", "--sheet", bench.out / "found.png", "--columns", 6, "--exposure", 0, *pictures])
    return figure("Scenes made by others, path tracer and photon chain",
                  "all render or are refused by name; means of layers within 1.5 %; the same bytes for any number of threads",
                  ["file, layer", "", "path tracer, mean", "photon chain, mean", "chain / path - 1, error bar", "CPU s, path tracer and chain"],
                  [line for name, row in rows.items() for line in table_rows(name, row)],
                  good if len(rows) == len(files) and not bench.tiny else None, notes)


def main():
    project = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=project / "build" / "release", help="build folder [build/release]")
    parser.add_argument("--out", type=Path, default=project / "out" / "found", help="sheet, table as JSON [out/found]")
    parser.add_argument("--only", default="", help="regular expression: files whose path it is found in")
    parser.add_argument("--size", default="320x180", help="[320x180]")
    parser.add_argument("--cpu", type=float, default=120, help="CPU s for a scene, about; more for hard ones [120]")
    parser.add_argument("--photons", type=int, default=12_000_000, help="a third where that fills 200 MB, three times as many where it fills less than 30, nine less than 8 [12000000]")
    args = parser.parse_args()
    bench = Bench(args.build.resolve(), args.out.resolve(), project, False, 0)
    try:
        result = found(bench, None, args.only, args.size, args.cpu, args.photons)
    except Missing as reason:
        print(f"left out: {reason}")
        return 0
    print("\n".join(result["notes"]))
    print(f"asked: {result['asked']}: {'met' if result['met'] else 'not judged' if result['met'] is None else 'NOT met'}")
    return 1 if result["met"] is False else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""What explicit samples of bright spots cost and gain against today's refining gather, as Markdown: the tables of docs/methods/split.md.

    python3 tests/bench/split.py BIN FOLDER [--scene room.glb] [--frame 0] [--size 160x90] [--photons 700k] [--seeds 8] [--rays 500]

BIN: folder of the tools. FOLDER: for their files. Without --scene that of spot_room.py. Photons and points are those of one seed; records, and pixels
without records, are made with each seed from the whole points and from their two parts in turn, and compared between seeds: what differs is
the noise of gathering alone. Unsplit records get as many rays more as make the processor seconds equal. --curve: rays 125 to 2000, both ways.
"""
import argparse
import json
import math
import statistics
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import spot_room  # noqa: E402

EXPLICIT = 4  # explicit samples of a camera path (KnownLight::bright_samples)
PAPER = (("Tawara et al. 2004, scene 1", "768", "21 min"), ("the same, split", "48 + 230", "9 min"), ("scene 2, split, a cache", "300 + 98", "10 min"))


class Runs:
    def __init__(self, options):
        self.bin, self.out, self.options = Path(options.bin).resolve(), Path(options.folder).resolve(), options
        self.out.mkdir(parents=True, exist_ok=True)
        self.scene = Path(options.scene).resolve() if options.scene else self.out / "spot.glb"
        if not options.scene:
            spot_room.make(self.scene)
        self.view = ["--frame", options.frame, "--size", options.size]

    def tool(self, name, *words):
        subprocess.run([self.bin / name, *map(str, words), "-q", "--stats", self.out / "stats.json"], check=True, cwd=self.out)
        return json.loads((self.out / "stats.json").read_text())

    def points(self):
        frame = ["--frame", self.options.frame]
        self.tool("photon-trace", self.scene, *frame, "--photons", self.options.photons, "-o", "p.photons")
        self.tool("irradcache-build", "points", self.scene, *frame, "--photons", "p.photons", "-o", "p.irradpoints")
        stats = self.tool("photonmap-split", "p.irradpoints", "--low", "l.irradpoints", "--high", "h.irradpoints")
        return stats["counts"]["high"]

    def read(self, kind):
        return ["--points", "l.irradpoints", "--high", "h.irradpoints"] if kind == "split" else ["--points", "p.irradpoints"]

    def image(self):
        return exr.read(str(self.out / "f.exr")).rgb("indirect")

    def records(self, kind, seed, rays):
        """The layer indirect, and what the records cost: processor seconds of their process, samples of a record."""
        stats = self.tool("irradcache-build", "records", self.scene, *self.view, *self.read(kind), "--rays", rays, "--seed", seed, "-o", "c.irradcache")
        self.tool("frame-render", self.scene, *self.view, "--irradcache", "c.irradcache", "--points", "p.irradpoints", "--spp", 4, "--pixel-error", 0,
                  "--channels", "indirect", "-o", "f.exr")
        count = stats["counts"]
        return self.image(), stats["cpu_s"], count["gather_rays"] / count["records"], count["shadow_rays"] / count["records"]

    def pixels(self, kind, seed, samples):
        stats = self.tool("frame-render", self.scene, *self.view, *self.read(kind), "--spp", samples, "--pixel-error", 0, "--seed", seed,
                          "--channels", "indirect", "-o", "f.exr")
        return self.image(), stats["cpu_s"], samples, samples * EXPLICIT if kind == "split" else 0


class Kind:
    """Images of one way by several seeds."""

    def __init__(self):
        self.images, self.cpu, self.rays, self.explicit = [], [], [], []

    def add(self, run):
        for values, value in zip((self.images, self.cpu, self.rays, self.explicit), run):
            values.append(value)

    def variances(self, without=None):
        """By value of the image (pixel and channel), over the seeds but for one."""
        images = [image for i, image in enumerate(self.images) if i != without]
        return [statistics.variance(values) for values in zip(*images)]

    def means(self):
        return [sum(values) / len(values) for values in zip(*self.images)]

    def image_means(self):
        return [sum(image) / len(image) for image in self.images]


def compare(plain, split):
    """variance plain / split over the image, its standard error; of relative variances; of the median pixel;
    difference of means and its standard error."""
    a, b, mean = plain.variances(), split.variances(), plain.means()
    dark = (0.1 * sum(mean) / len(mean)) ** 2
    relative = [sum(v / (m * m + dark) for v, m in zip(var, mean)) for var in (a, b)]
    ratios = sorted(x / y for x, y in zip(a, b) if y > 0)
    means = [kind.image_means() for kind in (plain, split)]
    of_mean = sum(means[0]) / len(means[0])
    error = math.sqrt(sum(statistics.variance(m) / len(m) for m in means))
    difference = sum(means[1]) / len(means[1]) - of_mean
    apart, seeds = math.nan, range(len(plain.images))
    if len(seeds) > 2:      # the jackknife
        left_out = [sum(plain.variances(i)) / sum(split.variances(i)) for i in seeds]
        apart = math.sqrt((len(seeds) - 1) * statistics.pvariance(left_out))
    median = ratios[len(ratios) // 2]
    return sum(a) / sum(b), apart, relative[0] / relative[1], median, difference / of_mean, error / of_mean


def row(name, kind):
    split = f" + {statistics.mean(kind.explicit):.0f}" if sum(kind.explicit) > 0 else ""
    print(f"| {name} | {statistics.mean(kind.rays):.0f}{split} | {statistics.median(kind.cpu):.2f} s |")


def measured(runs, what, make_plain, make_split, seeds):
    plain, split = Kind(), Kind()
    for seed in range(1, seeds + 1):
        plain.add(make_plain(seed))
        split.add(make_split(seed))
    print(f"\n| {what} | samples | CPU |\n|---|---|---|")
    row("rays alone", plain)
    row("split", split)
    variance, apart, relative, median, difference, error = compare(plain, split)
    cost = statistics.median(plain.cpu) / statistics.median(split.cpu)
    print(f"\nvariance, rays alone / split: {variance:.1f} +- {apart:.1f}; of relative variance {relative:.1f}; "
          f"of the median pixel {median:.1f}; CPU {cost:.2f}; "
          f"means differ by {100 * difference:.2f} +- {100 * error:.2f} %")


def equal_rays(runs, rays):
    """Rays of unsplit records that cost what split ones of `rays` do."""
    times = {kind: min(runs.records(kind, seed, rays)[1] for seed in (101, 102, 103)) for kind in ("plain", "split")}
    return round(rays * times["split"] / times["plain"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("folder")
    parser.add_argument("--scene")
    parser.add_argument("--frame", type=int, default=0)
    parser.add_argument("--size", default="160x90")
    parser.add_argument("--photons", default="700k")
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--rays", type=int, default=500)
    parser.add_argument("--curve", action="store_true")
    options = parser.parse_args()
    runs = Runs(options)
    print(f"{runs.points()} points have a high part")
    if options.curve:
        print("\n| rays | way | CPU s | standard deviation, relative |\n|---|---|---|---|")
        for rays in (125, 250, 500, 1000, 2000):
            for kind in ("plain", "split"):
                some = Kind()
                for seed in range(1, max(2, options.seeds // 2) + 1):
                    some.add(runs.records(kind, seed, rays))
                mean = some.means()
                dark = (0.1 * sum(mean) / len(mean)) ** 2
                spread = sum(v / (m * m + dark) for v, m in zip(some.variances(), mean)) / len(mean)
                print(f"| {rays} | {kind} | {statistics.median(some.cpu):.2f} | {math.sqrt(spread):.4f} |", flush=True)
        return
    more = equal_rays(runs, options.rays)
    measured(runs, "a record", lambda s: runs.records("plain", s, more), lambda s: runs.records("split", s, options.rays), options.seeds)
    measured(runs, "a pixel without records", lambda s: runs.pixels("plain", s, 128), lambda s: runs.pixels("split", s, 48), options.seeds)
    print("\n| the paper | samples | time |\n|---|---|---|")
    for line in PAPER:
        print("| " + " | ".join(line) + " |")


if __name__ == "__main__":
    main()

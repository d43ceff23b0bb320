#!/usr/bin/env python3
"""Every way to light in many scenes: what it costs and leaves, beside what the plan believed.

    ways.py [--build build/release] [--out OUT] [--scenes 'S2|S8'] [--size 160x90] [--json FILE] [--judge FILE ...]

Renders one frame of each scene by paths, gathering and records, with two seeds. Prints for each way:
- microseconds and counts of a sample;
- CPU seconds of the picture with what it alone reads, and of light that the pictures of a segment share;
- noise of the picture: root of the mean square over boxes of 1, 5 and 15 pixels;
- CPU seconds times squared noise over those of the best way, for the picture alone and for one of 24 that share light,
  and the plan's own products over the least of them.
At the end it prints the CPU time of single counts (Work in lib/pilot/rough_frame.h). Each scene has its own time of a
unit; the ratios of the times are those of all scenes. --judge shows stored rows again.
"""
import argparse
import json
import math
import re
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import cases
import pipeline
import pixels
import steady
from measure import Bench
from seen import blurred
from shipped import Side, Unfinished

TOP = Path(__file__).resolve().parents[2]
WAYS = ("paths", "gather", "records")
SCENES = ("S2", "S3", "S4", "S5", "S8", "demo", "furnished_day", "evening_shot", "living_room", "house-sun", "house",
          "hut-50-inside-both", "street-both", "leaves", "lamps", "level_two_lamps", "S8-day", "S8-paper")
PICTURES = 24          # that share the light of a segment
# Counts with an own time, by what they are counted in.
OF_FRAMES = ("rays", "shadow", "points_read", "records_read", "caustics_read")
OF_LIGHT = ("light_rays", "points_made", "gather_rays", "gather_shadow", "records_made")


def phase(stats, name):
    return sum(p["cpu_s"] for p in stats["phases"] if p["name"] == name)


def noise2(one, two):
    """Mean squared noise in codes, mean over the boxes of steady.py, of two pictures."""
    (difference,) = steady.differences([pixels.planes(one)], [pixels.planes(two)])
    boxed = [blurred(p, one.width, one.height, n // 2) if n > 1 else p for n in steady.BOXES for p in difference]
    return statistics.fmean(steady.rms(p) ** 2 for p in boxed)


def believed(plan):
    """The plan's products of work and squared error by way, whichever source of caustic light is better."""
    text = json.dumps(plan)
    found = {}
    product = r"(paths|gather|records)(?: beside caustics of photons)? (?:at least )?(\d[\d.]*(?:e[+-]?\d+)?)"
    for way, value in re.findall(product, text.partition("work x squared error")[2]):
        found[way] = min(found.get(way, math.inf), float(value))
    return found


def row_of(side, case, way):
    images = []
    for seed in (1, 2):
        image, cpu, *_ = side.chain(seed, variables={"INDIRECT": way}, leave=True)
        images.append(image)
    all_stats, plan = pipeline.stats_of(side.folder), pipeline.plan_of(side.folder)
    frame, = (s for s in all_stats if s["tool"] == "frame-render")
    counts, known = frame["counts"], frame["counts"].get("lookups", 0)
    light_folders = pipeline.folders_of(side.folder, ("photons", "points", "cache"))
    of_static = [f for f in light_folders if f.startswith(("stands", "touched"))]
    one_state = "1 state of light" in json.dumps(plan) or not of_static
    folders = light_folders if one_state else of_static
    shared = sum(s["cpu_s"] for s in pipeline.stats_in(side.folder, *folders))
    light = []
    for s in all_stats:
        c = s["counts"]
        if s["tool"] == "photon-trace" and phase(s, "trace") > 0.03:
            light.append({"cpu_s": phase(s, "trace"), "light_rays": c["rays"]})
        if c.get("points") and "points_changed" not in c and phase(s, "points") > 0.03:
            light.append({"cpu_s": phase(s, "points"), "points_made": c["points"]})
        if c.get("records") and phase(s, "records") > 0.03:
            light.append({"cpu_s": phase(s, "records"), "gather_rays": c["gather_rays"],
                          "gather_shadow": c["shadow_rays"], "records_made": c["records"]})
    reads_map = "--photons " in frame["command"]
    of_frame = {"cpu_s": phase(frame, "render"), "rays": counts["camera_rays"] + counts["bounce_rays"],
                "shadow": counts["shadow_rays"], "points_read": counts.get("points_read", 0),
                "records_read": known if way == "records" else 0,
                "caustics_read": known + counts.get("gathered_in_pixels", 0) if reads_map else 0}
    samples = images[0].width * images[0].height * frame["results"]["samples_per_pixel"]
    return {"scene": case.name, "way": way, "samples": samples, "of_frame": of_frame, "light": light,
            "picture": cpu - shared, "shared": shared, "noise2": noise2(*images), "believed": believed(plan)}


def scores(rows):
    """By way (CPU x noise^2 of a picture alone, of one of many, the plan's) of one scene, each over the least."""
    def over_least(values):
        least = min(values.values(), default=1)
        return {way: v / least if least > 0 else 1 for way, v in values.items()}
    alone = over_least({r["way"]: (r["picture"] + r["shared"]) * r["noise2"] for r in rows})
    many = over_least({r["way"]: (r["picture"] + r["shared"] / PICTURES) * r["noise2"] for r in rows})
    plan = over_least(rows[-1]["believed"])
    return {r["way"]: (alone[r["way"]], many[r["way"]], plan.get(r["way"], math.nan)) for r in rows}


def show(rows):
    """The rows of one scene."""
    of_way = scores(rows)
    for r in rows:
        n, f = r["samples"], r["of_frame"]
        counts = " ".join(f"{c} {f[c] / n:4.1f}" for c in OF_FRAMES)
        print(f"{r['scene']:19} {r['way']:8} {1e6 * f['cpu_s'] / n:5.1f} us ", counts,
              f" {r['picture']:6.1f} + {r['shared']:5.1f} CPU s, noise {math.sqrt(r['noise2']):5.2f};",
              "alone %5.2f many %5.2f plan %5.2f" % of_way[r["way"]], flush=True)


def fit(rows):
    """Times of single counts over that of a ray, and by scene the seconds of a ray."""
    names = OF_FRAMES + OF_LIGHT
    parts = [(r["scene"], part) for r in rows for part in (r["of_frame"], *r["light"])]
    weight = dict.fromkeys(names, 1.0) | {"points_made": 40.0, "records_made": 100.0}

    def off(weight):
        """(sum of absolute and squared differences of logarithms, seconds of a unit by scene)"""
        error, of_scene = [], {}
        for scene, part in parts:
            units = sum(weight[c] * part.get(c, 0) for c in names)
            error.append((scene, "rays" in part, math.log(part["cpu_s"] / units)))
        for scene in {s for s, *_ in error}:
            of_scene[scene] = statistics.fmean(e for s, frame, e in error if s == scene and frame)
        rest = [e - of_scene[s] for s, _, e in error]
        return sum(abs(e) + 0.3 * e * e for e in rest), of_scene
    best, improved = off(weight)[0], True
    while improved:
        improved = False
        for name in names[1:]:
            for factor in (1.5, 1 / 1.5, 1.1, 1 / 1.1, 1.02, 1 / 1.02):
                other = weight | {name: max(0.01, weight[name] * factor)}
                if (value := off(other)[0]) < best - 1e-6:
                    best, weight, improved = value, other, True
    print("times of a count over that of a ray:", "  ".join(f"{name} {w:.2f}" for name, w in weight.items()))
    print("nanoseconds of a ray:", "  ".join(f"{s} {1e9 * math.exp(t):.0f}" for s, t in sorted(off(weight)[1].items())))


def judge(rows):
    loss = {"alone": [], "many": []}
    for scene in dict.fromkeys(r["scene"] for r in rows):
        some = [r for r in rows if r["scene"] == scene]
        show(some)
        of_way = scores(some)
        chosen = min(of_way.values(), key=lambda s: s[2] if s[2] == s[2] else math.inf)
        loss["alone"].append(chosen[0])
        loss["many"].append(chosen[1])
    for kind, values in loss.items():
        print(f"the plan's way over the best, {kind}: median {statistics.median(values):.2f}, geometric mean",
              f"{statistics.geometric_mean(values):.2f}, largest {max(values):.2f}")
    fit(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=TOP / "build" / "release")
    parser.add_argument("--out", type=Path, default=TOP / "build" / "ways")
    parser.add_argument("--scenes", default="|".join(SCENES))
    parser.add_argument("--size", default="160x90")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--judge", type=Path, nargs="+")
    options = parser.parse_args()
    if options.judge:
        return judge([row for file in options.judge for row in json.loads(file.read_text())])
    bench = Bench(options.build.resolve(), options.out.resolve(), TOP, True, 0)
    wanted, rows, seen = re.compile(options.scenes).fullmatch, [], set()
    for case in (*cases.of_curves(bench), *cases.all_cases(bench, wanted, True)):
        if not wanted(case.name) or case.name in seen:
            continue
        seen.add(case.name)
        some = []
        for way in WAYS:
            try:
                some.append(row_of(Side(bench, case, options.size, 1000), case, way))
            except Unfinished as reason:
                print(f"{case.name} {way}: {reason}", flush=True)
        if some:
            show(some)
        rows += some
        if options.json:
            options.json.write_text(json.dumps(rows, indent=1))
    print()
    return judge(rows)


if __name__ == "__main__":
    main()

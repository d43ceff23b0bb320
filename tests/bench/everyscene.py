#!/usr/bin/env python3
"""The shipped preset against our own path tracer in every scene: error, time, bias of each layer, dots.

    python3 tests/bench/bench.py --only everyscene                          all scenes at 320x180, 8 seeds, into RESULTS.md
    python3 tests/bench/everyscene.py --quick                               a dozen scenes at 160x90, 3 seeds: some minutes
    python3 tests/bench/everyscene.py --quick --json new.json --against old.json      two programs compared
    python3 tests/bench/everyscene.py --scenes 'hut|S8' --sizes 320x180,960x540 --seeds 8

The chain is run as Makefile.example runs it (`make OUT/frames/NNNN.exr`), all processes counted. Beside it, in turn, the path
tracer with as many samples as take about the same time. Errors are those against the halves of a reference (pixels.py), which is
kept in OUT/every/reference and grows until its own standard error is below a third of the chain's squared error and of the
limits of bias, or until --reference-cpu.

speed-up: CPU seconds that path tracing takes for the chain's error over the chain's; its error is read off between the samples
measured, the reference's halves among them. Bias: chain / reference - 1 of each layer with an error bar of three standard
errors (Student's t for the few seeds); `!` significant and above its limit, `?` undecided as the bar is wider than the limit.
The limit is 1 % of the picture's mean, and 2 % of the layer where that is a tenth of the light.
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
import exr
import pixels
from comparing import compared
from measure import Bench, figure, machine, percent, quantity, walk_speed
from references import Law, Reference
from shipped import STAGES, YARDSTICK, Side, Unfinished, frames_without_camera

PILOT = 16                       # samples per pixel of the first path-traced picture
OF_PICTURE, OF_LAYER, TENTH = 0.01, 0.02, 0.1
HEADER = ["scene", "CPU s: all = photons + points + records + frame + rest", "RMSE / mean", "paths' CPU s", "speed-up", "bias of the picture",
          "layers that differ", "indirect", "dots, paths'", "tail"]


def student(freedom):
    """What three standard errors of a known deviation are for one estimated with so many degrees of freedom: the quantile of
    99.865 % of Student's t, right to 2 % from 2 degrees on."""
    return {1: 235.8, 2: 19.2, 3: 9.22, 4: 6.62, 5: 5.51, 6: 4.90, 7: 4.53}.get(freedom, 3 + 9.6 / freedom)


def bias(images, halves, layer, picture):
    """{chain, reference, difference, bar, verdict} of a layer's mean; "" is the picture. Verdict: ok, apart, undecided."""
    means = [pixels.mean(image, layer) for image in images]
    reference, error = pixels.mean_of_halves(*halves, layer)
    spread = statistics.stdev(means) / math.sqrt(len(means)) if len(means) > 1 else math.inf
    difference, bar = statistics.mean(means) - reference, math.hypot(3 * error, student(len(means) - 1) * spread if len(means) > 1 else math.inf)
    limit = OF_PICTURE * picture
    if reference >= TENTH * picture:
        limit = min(limit, OF_LAYER * reference)
    apart = abs(difference) > max(limit, bar)
    verdict = "apart" if apart else "ok" if abs(difference) + bar <= limit else "undecided" if bar > limit else "ok"
    return {"chain": statistics.mean(means), "reference": reference, "difference": difference / picture, "bar": bar / picture,
            "share": reference / picture, "verdict": verdict}


def enough(images, mse):
    """Are a reference's halves good enough to judge these pictures by? See above."""
    def sufficient(a, b):
        picture, _ = pixels.mean_of_halves(a, b)
        if pixels.squared_error(images[0], a, b)[1] > mse(a, b) / 3:
            return False
        for layer in ("", *pixels.LAYERS):
            mean, error = pixels.mean_of_halves(a, b, layer)
            limit = OF_PICTURE * picture if mean < TENTH * picture else min(OF_PICTURE * picture, OF_LAYER * mean)
            if 3 * error > limit / 3:
                return False
        return True
    return sufficient


def measure(bench, case, size, seeds, patience, reference_cpu):
    """A row of the JSON file: one scene at one size."""
    side = Side(bench, case, size, patience)
    row = {"scene": case.name, "size": size, "kind": case.kind, "note": case.note, "seeds": seeds}
    picture, fixed, rate = side.paths(PILOT, 1)
    reference = Reference(bench, case, size, YARDSTICK)
    if not reference.agrees_with(picture):
        reference.forget()
    path_images, fixeds, rates = [(PILOT, picture)], [fixed], [rate]
    images, cpus, stages, spp = [], [], [], None
    for seed in range(1, seeds + 1):
        image, cpu, of_stages = side.chain(seed)
        images.append(image)
        cpus.append(cpu)
        stages.append(of_stages)
        spp = spp or max(4, min(256, 2 ** round(math.log2(max(1, (cpu - fixed) / rate)))))
        picture, fixed_again, rate_again = side.paths(spp, seed + 1)
        path_images.append((spp, picture))
        fixeds.append(fixed_again)
        rates.append(rate_again)

    def squared(a, b):
        return max(1e-30, statistics.mean(pixels.squared_error(image, a, b)[0] for image in images))
    row["reference_sufficient"] = reference.until(enough(images, squared), reference_cpu)
    a, b = reference.halves
    law = Law([(n, pixels.squared_error(image, a, b)[0]) for n, image in path_images] + [(reference.facts["spp"] / 2, pixels.half_error(a, b))])
    errors = [pixels.squared_error(image, a, b) for image in images]
    mse, cpu = max(1e-30, statistics.mean(e for e, _ in errors)), statistics.mean(cpus)
    samples, inside = law.samples(mse)
    path_cpu = statistics.median(fixeds) + samples * statistics.median(rates)
    mean, _ = pixels.mean_of_halves(a, b)
    uncertain = [errors[0][1] / mse, statistics.stdev(cpus) / math.sqrt(len(cpus)) / cpu if len(cpus) > 1 else 0,
                 statistics.stdev(e for e, _ in errors) / math.sqrt(len(errors)) / mse if len(errors) > 1 else 0]
    if mean <= 0:
        raise Unfinished("the picture is black")
    return row | {"cpu_s": cpu, "stages": {s: statistics.mean(st[s] for st in stages) for s in STAGES}, "mse": mse, "mean": mean,
                  "mse_error": errors[0][1], "path_cpu_s": path_cpu, "path_spp": samples, "inside": inside, "path_rate": statistics.median(rates),
                  "reference_spp": reference.facts["spp"], "speed_up": path_cpu / cpu, "uncertain": math.hypot(*uncertain),
                  "path_points": [[math.exp(n), math.exp(e)] for n, e in law.points],
                  "bias": {layer or "picture": bias(images, (a, b), layer, mean) for layer in ("", *pixels.LAYERS)},
                  "indirect": pixels.mean_of_halves(a, b, "indirect")[0] / mean,
                  "dots": statistics.mean(pixels.dots(image, a, b) for image in images[:3]), "path_dots": pixels.dots(path_images[1][1], a, b),
                  "tail": pixels.tail(images[0], a, b), "not_finite": images[0].not_finite(),
                  "pillars": beside_partition(images, a, b) if case.name == "partition" else None,
                  "shown": shown(bench, case, size, (path_images[1][1], images[0]))}


def shown(bench, case, size, both):
    """Path tracer and chain as files for a sheet, at an exposure of their own."""
    folder = bench.out / "every" / "shown"
    folder.mkdir(parents=True, exist_ok=True)
    scale = 0.9 / max(1e-30, sorted(pixels.grey(both[0]))[int(0.97 * both[0].width * both[0].height)])
    files = [folder / f"{case.name}-{size}-{which}.exr" for which in ("path", "chain")]
    for file, image in zip(files, both):
        exr.write(file, image.width, image.height, {c: [v * scale for v in image.channels[c]] for c in "RGB"})
    return [str(file) for file in files]


def beside_partition(images, a, b):
    """Relative bias of the three columns of pixels on either side of the picture's middle, from left to right, each with its
    standard error by the halves."""
    width, height, found = a.width, a.height, []
    for x in range(width // 2 - 3, width // 2 + 3):
        def column(image):
            return [sum(plane[y * width + x] for plane in pixels.planes(image)) for y in range(height)]
        p, q = column(a), column(b)
        reference = sum(p) + sum(q)
        ours = statistics.mean(2 * sum(column(image)) for image in images)
        found.append([ours / reference - 1, math.sqrt(sum((u - v) ** 2 for u, v in zip(p, q))) / reference])
    return found


# ---- what is printed

def line(row):
    if "refused" in row:
        return [f"{row['scene']} {row['size']}", row["refused"]] + [""] * (len(HEADER) - 2)
    rest = row["cpu_s"] - sum(row["stages"].values())
    parts = " + ".join(quantity(row["stages"][s], 2) for s in STAGES) + f" + {quantity(rest, 2)}"
    said = [f"{name} {100 * r['difference']:+.1f}±{100 * r['bar']:.1f}%{'!' if r['verdict'] == 'apart' else '?'}"
            for name, r in row["bias"].items() if r["verdict"] != "ok" and name != "picture"]
    whole = row["bias"]["picture"]
    mark = ("" if row["inside"] else "~") + ("" if row["reference_sufficient"] else "?")
    return [f"{row['scene']} {row['size']}", f"{quantity(row['cpu_s'])} = {parts}", percent(math.sqrt(row["mse"]) / row["mean"], 1),
            quantity(row["path_cpu_s"]), f"{mark}{quantity(row['speed_up'])} ± {percent(row['uncertain'], 0)}",
            f"{100 * whole['difference']:+.2f} ± {100 * whole['bar']:.2f} %{'!' if whole['verdict'] == 'apart' else ''}", ", ".join(said),
            percent(row["indirect"], 0), f"{row['dots']:.0f}, {row['path_dots']}", quantity(row["tail"], 2)]


def summary(rows):
    """Sentences: speed-ups by kind and size, biases, what is missing."""
    notes, good = [], [row for row in rows if "refused" not in row]
    for size in dict.fromkeys(row["size"] for row in good):
        for kind in ("open", "window", "closed"):
            found = sorted((row["speed_up"], row["scene"]) for row in good if (row["size"], row["kind"]) == (size, kind))
            if found:
                below = [f"{name} {quantity(v, 2)}" for v, name in found if v < 0.95]
                notes.append(f"{size}, {kind}: median speed-up {quantity(statistics.median(v for v, _ in found))}, least "
                             f"{quantity(found[0][0])} ({found[0][1]}), most {quantity(found[-1][0])} ({found[-1][1]}); below .95: "
                             f"{len(below)} of {len(found)}" + (f": {', '.join(below)}." if below else "."))
    for verdict in ("apart", "undecided"):
        names = [f"{row['scene']} {layer}" for row in good for layer, r in row["bias"].items() if r["verdict"] == verdict]
        notes.append(f"Layers {'that differ significantly' if verdict == 'apart' else 'undecided'}: {len(names)}"
                     + (f": {', '.join(names)}." if names else "."))
    for row in good:
        if row["pillars"]:
            notes.append(f"partition {row['size']}, columns beside the board: " + ", ".join(f"{100 * v:+.1f} ± {100 * e:.1f} %" for v, e in row["pillars"]) + ".")
        if row["not_finite"]:
            notes.append(f"{row['scene']}: not finite: {row['not_finite']}")
    notes += [f"{row['scene']} {row['size']}: {row['refused']}" for row in rows if "refused" in row]
    return notes


def met(rows):
    """Whether the required figures hold, at the sizes measured."""
    good = [row for row in rows if "refused" not in row]
    for size, medians in (("320x180", {"open": 1.5}), ("960x540", {"open": 2})):
        for kind, least in medians.items():
            speeds = [row["speed_up"] for row in good if (row["size"], row["kind"]) == (size, kind)]
            if speeds and statistics.median(speeds) < least:
                return False
    return all(row["speed_up"] >= 0.95 and all(r["verdict"] != "apart" for r in row["bias"].values()) and not row["not_finite"] for row in good)


def run(bench, only, sizes, seeds, patience, reference_cpu, kept):
    """Rows of all wanted scenes; those measured before are kept in the file `kept` and replaced one by one."""
    def wanted(name):
        return name in cases.QUICK if only == "quick" else bool(re.search(only, name))
    rows = {f"{r['scene']} {r['size']}": r for r in json.loads(kept.read_text())["rows"]} if kept.exists() else {}
    print("  ".join(HEADER), flush=True)
    measured = []
    for case in cases.all_cases(bench, wanted, frames_without_camera(bench)):
        for size in sizes:
            try:
                row = measure(bench, case, size, seeds, patience, reference_cpu)
            except (Unfinished, RuntimeError) as reason:
                row = {"scene": case.name, "size": size, "kind": case.kind, "refused": str(reason).replace(str(case.file.parent) + "/", "")[:200]}
            measured.append(f"{case.name} {size}")
            rows[measured[-1]] = row
            print("  ".join(line(row)), flush=True)
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps({"machine": machine(bench), "walk": walk_speed(bench), "rows": list(rows.values())}, indent=1))
    return list(rows.values()), [rows[name] for name in measured]


def everyscene(bench, _=None, only="", sizes=("320x180",), seeds=8, patience=600, reference_cpu=600):
    """The preset against our path tracer in every scene."""
    if bench.tiny:
        only, sizes, seeds, reference_cpu = "^hut-50-inside-both$", (bench.size,), 2, 0
    rows, _ = run(bench, only, sizes, seeds, patience, reference_cpu, bench.out / "every" / "rows.json")
    return figure("The preset against our path tracer in every scene",
                  "no scene slower than path tracing at equal error; median 1.5 in the open; no layer off by more than 1 %",
                  HEADER, [line(row) for row in rows], None if bench.tiny else met(rows), summary(rows))


def main():
    project = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=project / "build" / "release", help="build folder [build/release]")
    parser.add_argument("--out", type=Path, default=project / "out" / "bench", help="references, pictures [out/bench]")
    parser.add_argument("--quick", action="store_true", help="a dozen scenes at 160x90, 3 seeds, small references")
    parser.add_argument("--scenes", help="regular expression: scenes whose name it is found in")
    parser.add_argument("--sizes", help="by comma, such as 320x180,960x540 [320x180; quick: 160x90]")
    parser.add_argument("--seeds", type=int, help="seeds of the chain [8; quick: 3]")
    parser.add_argument("--patience", type=int, default=0, help="CPU seconds a process may take [600; quick: 60]")
    parser.add_argument("--reference-cpu", type=float, help="CPU seconds a reference may take [600; quick: 40]")
    parser.add_argument("--json", type=Path, help="what was measured [OUT/every/quick.json or rows.json]")
    parser.add_argument("--against", type=Path, help="JSON of an earlier run to compare with")
    parser.add_argument("--list", action="store_true", help="names of the scenes, nothing more")
    args = parser.parse_args()
    bench = Bench(args.build.resolve(), args.out.resolve(), project, False, 0)
    if args.list:
        print(*(case.name for case in cases.all_cases(bench, lambda name: True, False)), sep="\n")
        return
    kept = (args.json or bench.out / "every" / ("quick.json" if args.quick else "rows.json")).resolve()
    _, rows = run(bench, args.scenes if args.scenes is not None else "quick" if args.quick else "",
                  (args.sizes or ("160x90" if args.quick else "320x180")).split(","), args.seeds or (3 if args.quick else 8),
                  args.patience or (60 if args.quick else 600),
                  args.reference_cpu if args.reference_cpu is not None else 40 if args.quick else 600, kept)
    print("\n".join(summary(rows)))
    pictures = [file for row in rows for file in row.get("shown", [])]
    if pictures:
        bench.run([bench.bin / "tempolux-info", "--sheet", kept.with_suffix(".png"), "--columns", 6, "--exposure", 0, *pictures])
        print(f"pictures, paths left: {kept.with_suffix('.png')}")
    if args.against:
        print(compared(json.loads(args.against.read_text()), json.loads(kept.read_text())))


if __name__ == "__main__":
    main()

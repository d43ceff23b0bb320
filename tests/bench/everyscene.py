#!/usr/bin/env python3
"""The shipped preset against our own path tracer in every scene: what is seen wrong, beside CPU seconds.

    python3 tests/bench/everyscene.py                                       all scenes at 320x180, 8 seeds: hours
    python3 tests/bench/everyscene.py --quick                               a dozen scenes at 160x90: some minutes
    python3 tests/bench/everyscene.py --quick --json new.json --against old.json      two programs compared
    python3 tests/bench/everyscene.py --scenes 'hut|S8' --sizes 320x180,960x540 --seeds 8
    python3 tests/bench/everyscene.py --scenes S8 --set 'PIXELS=--spp 4 --seen-error 2'

The chain is run as Makefile.example runs it (`make OUT/frames/NNNN.exr`), all processes counted. Beside it the path tracer with 4,
16, 64, ... samples until it is better, which gives its curve. Both are judged against the halves of a reference, which is kept in
OUT/every/reference and grows until its noise is below half of the chain's seen error, or until --reference-cpu.

Columns. Seen error, blobs, grain: seen.py. Noise said: what the frame itself says, after the filter: as in make's last line. AQM: the share of the
pixels in which a viewer sees a difference to the reference, and to a reference without the noise of a half (docs/methods/vision.md). Paths' CPU: what
path tracing takes for the chain's seen error, read off between the samples measured; speed-up: that over the chain's CPU; `~` beyond
the curve, `?` the reference is not converged. Layers: chain / reference - 1 in percent of the picture, with three standard errors;
`!` significant and above 1 % of the picture, or 1.5 % of a layer that is 5 % of the picture. Audit: what the frame says of its layers.
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
from measure import Bench, machine, percent, quantity, walk_speed
from references import Curve, Reference
from seen import Seen
from shipped import STAGES, YARDSTICK, Side, Unfinished, frames_without_camera

FIRST_PATHS, TIMES = 4, 4      # samples a pixel of the curve
MOST_CPU = 25                  # times the chain's, of one path-traced picture: what is better still is marked `~`
OF_PICTURE, OF_LAYER, LARGE_LAYER = 0.01, 0.015, 0.05
LEAST = {"closed": 10, "window": 4, "open": 1.2}      # median speed-up asked of a class
BLOBS = 0                                             # share of the picture
HEADER = ["scene", "CPU s: all = photons + points + records + frame + rest", "seen error", "noise said", "AQM %; of the reference", "paths' CPU", "speed-up", "blobs %", "grain, paths'",
          "layers that differ", "audit"]


def student(freedom):
    """What three standard errors of a known deviation are for one estimated with so many degrees of freedom: the quantile of
    99.865 % of Student's t, right to 2 % from 2 degrees on."""
    return {0: math.inf, 1: 235.8, 2: 19.2, 3: 9.22, 4: 6.62, 5: 5.51, 6: 4.90, 7: 4.53}.get(freedom, 3 + 9.6 / freedom)


def bias(images, halves, layer, picture):
    """A layer's difference to the reference and its bar, in shares of the picture; "" is the picture. Of one image the bar is the reference's alone."""
    means = [pixels.mean(image, layer) for image in images]
    reference, error = pixels.mean_of_halves(*halves, layer)
    spread = student(len(means) - 1) * statistics.stdev(means) / math.sqrt(len(means)) if len(means) > 1 else 0
    difference, bar = statistics.mean(means) - reference, math.hypot(3 * error, spread)
    limit = min(OF_PICTURE * picture, OF_LAYER * reference if reference >= LARGE_LAYER * picture else math.inf)
    return {"difference": difference / picture, "bar": bar / picture, "share": reference / picture, "apart": abs(difference) > max(limit, bar)}


def path_curve(side, seen, error, cpu):
    """(curve of path tracing: CPU seconds over seen error, its last picture), enclosing `error` if that takes at most MOST_CPU x `cpu`."""
    points, spp = [], FIRST_PATHS
    while not points or (points[-1][1] > error and points[-1][0] * TIMES <= MOST_CPU * cpu):
        image, fixed, rate = side.paths(spp, spp)
        points.append((fixed + rate * spp, seen.error(pixels.planes(image))))
        spp *= TIMES
    return Curve(points), image


def measure(bench, case, size, seeds, patience, reference_cpu, variables):
    """A row of the JSON file: one scene at one size."""
    side = Side(bench, case, size, patience)
    runs = [side.chain(seed, variables=variables) for seed in range(1, seeds + 1)]
    images, said = [image for image, *_ in runs], runs[0][3]
    reference = Reference(bench, case, size, YARDSTICK)
    if not reference.agrees_with(images[0]):
        reference.forget()

    def error(seen):
        return math.sqrt(statistics.mean(seen.error(pixels.planes(image)) ** 2 for image in images))

    def enough(a, b):
        seen = Seen(pixels.planes(a), pixels.planes(b))
        return seen.halves_differ() < error(seen) / 2
    reference.until(enough, reference_cpu)
    a, b = reference.halves
    seen = Seen(pixels.planes(a), pixels.planes(b))
    ours, cpu, (mean, _) = error(seen), statistics.mean(run[1] for run in runs), pixels.mean_of_halves(a, b)
    if mean <= 0:
        raise Unfinished("the picture is black")
    curve, by_paths = path_curve(side, seen, ours, cpu)
    path_cpu, inside = curve.cost(ours)
    shape = (images[0].width, images[0].height, seen.flat(images[0].width, images[0].height))
    return {"scene": case.name, "size": size, "kind": case.kind, "family": case.family, "note": case.note, "seeds": seeds,
            "cpu_s": cpu, "stages": {s: statistics.mean(run[2][s] for run in runs) for s in STAGES}, "seen": ours, "noise_said": said.get("noise.codes"),
            "aqm": viewer(bench, images[0], reference.files),
            "converged": seen.halves_differ() < 2 * ours, "reference_noise": seen.halves_differ(), "path_cpu_s": path_cpu, "inside": inside,
            "speed_up": path_cpu / cpu, "path_curve": curve.points, "blobs": statistics.mean(seen.blobs(pixels.planes(i), *shape) for i in images),
            "grain": seen.grain(pixels.planes(images[0]), *shape), "path_grain": seen.grain(pixels.planes(by_paths), *shape),
            "bias": {layer or "picture": bias(images, (a, b), layer, mean) for layer in ("", *pixels.LAYERS)},
            "audit": {layer: [said[f"audit.{layer}"], said[f"audit.{layer}_error"]] for layer in pixels.LAYERS if f"audit.{layer}" in said},
            "not_finite": images[0].not_finite(), "shown": shown(bench, case, size, (a, by_paths, images[0]))}


def viewer(bench, image, halves):
    """AQM % of the picture against the reference, and AQM % of a half's own noise."""
    judged, found = (bench.out / "every" / name for name in ("judged.exr", "judged.json"))
    exr.write(judged, image.width, image.height, {c: image.channels[c] for c in "RGB"})

    def percent(*words):
        bench.run([bench.bin / "aqm-compare", *words, "--metric", "aqm", "--json", found, "--allow-stale", "-q"])
        return json.loads(found.read_text())["total"]["aqm"]["percent"]
    return [percent(judged, "--reference-halves", *halves), percent(*halves, "--either")]


def shown(bench, case, size, three):
    """Reference, path tracer and chain as files for a sheet, at an exposure of their own."""
    folder = bench.out / "every" / "shown"
    folder.mkdir(parents=True, exist_ok=True)
    scale = 0.9 / max(1e-30, sorted(pixels.grey(three[0]))[int(0.97 * three[0].width * three[0].height)])
    files = [folder / f"{case.name}-{size}-{which}.exr" for which in ("reference", "path", "chain")]
    for file, image in zip(files, three):
        exr.write(file, image.width, image.height, {c: [v * scale for v in image.channels[c]] for c in "RGB"})
    return [str(file) for file in files]


# ---- what is printed

def line(row):
    if "refused" in row:
        return [f"{row['scene']} {row['size']}", row["refused"]] + [""] * (len(HEADER) - 2)
    rest = row["cpu_s"] - sum(row["stages"].values())
    parts = " + ".join(quantity(row["stages"][s], 2) for s in STAGES) + f" + {quantity(rest, 2)}"
    off = [f"{name} {100 * r['difference']:+.1f}±{100 * r['bar']:.1f}!" for name, r in row["bias"].items() if r["apart"]]
    audit = [f"{name} {100 * v:+.1f}±{100 * e:.1f}" for name, (v, e) in row["audit"].items()]
    mark = ("" if row["inside"] else "~") + ("" if row["converged"] else "?")
    return [f"{row['scene']} {row['size']}", f"{quantity(row['cpu_s'])} = {parts}", quantity(row["seen"]), quantity(row["noise_said"] or 0),
            "; ".join(quantity(v, 2) for v in row.get("aqm", ())), quantity(row["path_cpu_s"]), mark + quantity(row["speed_up"]), f"{100 * row['blobs']:.2f}",
            f"{quantity(row['grain'], 2)}, {quantity(row['path_grain'], 2)}", ", ".join(off), ", ".join(audit)]


def by_family(rows, size, kind):
    """Speed-ups of a class; scenes of one family (huts on all grounds) count as one, by their median."""
    families = {}
    for row in rows:
        if (row["size"], row["kind"]) == (size, kind):
            families.setdefault(row["family"], []).append(row["speed_up"])
    return sorted((statistics.median(values), name) for name, values in families.items())


def summary(rows):
    """Sentences: speed-ups by kind and size, what is wrong, what is missing."""
    notes, good = [], [row for row in rows if "refused" not in row]
    for size in dict.fromkeys(row["size"] for row in good):
        for kind in LEAST:
            found = by_family(good, size, kind)
            if found:
                notes.append(f"{size}, {kind}: median speed-up {quantity(statistics.median(v for v, _ in found))} of {len(found)}, least "
                             f"{quantity(found[0][0])} ({found[0][1]}), most {quantity(found[-1][0])} ({found[-1][1]}).")
    for what, names in (("Slower than path tracing", [f"{r['scene']} {quantity(r['speed_up'], 2)}" for r in good if r["speed_up"] < 0.9]),
                        ("Blobs", [f"{r['scene']} {100 * r['blobs']:.2f} %" for r in good if r["blobs"] > BLOBS]),
                        ("Grain above 1 code", [f"{r['scene']} {quantity(r['grain'], 2)}" for r in good if r["grain"] > 1]),
                        ("Layers that differ", [f"{r['scene']} {layer}" for r in good for layer, b in r["bias"].items() if b["apart"]]),
                        ("Not finite", [f"{r['scene']}: {r['not_finite']}" for r in good if r["not_finite"]])):
        notes.append(f"{what}: {', '.join(names) or 'none'}.")
    said = [(r["noise_said"] / r["seen"], r["scene"]) for r in good if r["noise_said"] and r["seen"] > 0]
    within = sum(1 / 1.3 <= ratio <= 1.3 for ratio, _ in said)
    if said:
        notes.append(f"Noise said within 1.3 of the seen error: {within} of {len(said)}; least {quantity(min(said)[0])} ({min(said)[1]}), most {quantity(max(said)[0])} ({max(said)[1]}).")
    return notes + [f"{row['scene']} {row['size']}: {row['refused']}" for row in rows if "refused" in row]


def run(bench, only, sizes, seeds, patience, reference_cpu, kept, variables=None):
    """Rows of all wanted scenes; those measured before are kept in the file `kept` and replaced one by one."""
    def wanted(name):
        return name in cases.QUICK if only == "quick" else bool(re.search(only, name))
    rows = {f"{r['scene']} {r['size']}": r for r in json.loads(kept.read_text())["rows"]} if kept.exists() else {}
    print(" | ".join(HEADER), flush=True)
    measured, of_machine = [], {"machine": machine(bench), "walk": walk_speed(bench)}
    for case in cases.all_cases(bench, wanted, frames_without_camera(bench)):
        for size in sizes:
            try:
                row = measure(bench, case, size, seeds, patience, reference_cpu, variables or {})
            except (Unfinished, RuntimeError) as reason:
                row = {"scene": case.name, "size": size, "kind": case.kind, "refused": str(reason).replace(str(case.file.parent) + "/", "")[:200]}
            measured.append(f"{case.name} {size}")
            rows[measured[-1]] = row
            print(" | ".join(line(row)), flush=True)
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps(of_machine | {"rows": list(rows.values())}, indent=1))
    return list(rows.values()), [rows[name] for name in measured]


def main():
    project = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=project / "build" / "release", help="build folder [build/release]")
    parser.add_argument("--out", type=Path, default=project / "out" / "bench", help="references, pictures [out/bench]")
    parser.add_argument("--quick", action="store_true", help="a dozen scenes at 160x90, 1 seed, small references")
    parser.add_argument("--scenes", help="regular expression: scenes whose name it is found in")
    parser.add_argument("--sizes", help="by comma, such as 320x180,960x540 [320x180; quick: 160x90]")
    parser.add_argument("--seeds", type=int, help="seeds of the chain [8; quick: 1]")
    parser.add_argument("--patience", type=int, default=0, help="CPU seconds a process may take [600; quick: 60]")
    parser.add_argument("--reference-cpu", type=float, help="CPU seconds a reference may take [600; quick: 40]")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="a variable of Makefile.example")
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
                  (args.sizes or ("160x90" if args.quick else "320x180")).split(","), args.seeds or (1 if args.quick else 8),
                  args.patience or (60 if args.quick else 600),
                  args.reference_cpu if args.reference_cpu is not None else 40 if args.quick else 600, kept,
                  dict(word.split("=", 1) for word in args.set))
    print("\n".join(summary(rows)))
    pictures = [file for row in rows for file in row.get("shown", [])]
    if pictures:
        bench.run([bench.bin / "tempolux-info", "--sheet", kept.with_suffix(".png"), "--columns", 6, "--exposure", 0, *pictures])
        print(f"pictures: reference, paths, chain: {kept.with_suffix('.png')}")
    if args.against:
        print(compared(json.loads(args.against.read_text()), json.loads(kept.read_text())))


if __name__ == "__main__":
    main()

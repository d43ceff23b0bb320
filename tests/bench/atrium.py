"""The required figures of S4, a hall with mirrors and glass: its layers at final settings, a fast still frame, an animation.

Functions as in required.py.
"""
import math
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import pipeline
from chain import Settings
from estimate import spent
from measure import Missing, figure, median, percent, quantity, running_processes
from shipped import preset

LAYERS = (None, "emission", "direct", "specular", "caustic", "indirect")
FAST = Settings(300000, ("--point-count", "4k", "--light-samples", 2), ("--rays", 50, "--error-bound", 0.6),
                ("--spp", 4, "--pixel-error", 0.0115), steps=True, caustics=True)


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def without_caustics(bench, image, halves):
    """(MSE, relMSE, bias) of the image without its caustic layer as aqm-compare has them: with a and b the halves without
    theirs and r their mean, the mean of (x - a)(x - b), of that over r^2 + (mean r / 10)^2, channels averaged, and
    mean x / mean r - 1."""
    frames = [exr.read(file).channels for file in (image, *halves)]
    x, a, b = ([[v - w for v, w in zip(f[c], f[f"caustic.{c}"])] for c in "RGB"] for f in frames)
    squares, scales, total = [0.0] * len(x[0]), [0.0] * len(x[0]), 0.0
    mine = sum(map(sum, x)) / 3
    for planes in zip(x, a, b):
        for i, (p, q, r) in enumerate(zip(*planes)):
            squares[i] += (p - q) * (p - r) / 3
            scales[i] += (0.5 * (q + r)) ** 2 / 3
            total += 0.5 * (q + r) / 3
    soft = (0.1 * total / len(squares)) ** 2
    return mean(squares), mean(s / (r + soft) for s, r in zip(squares, scales)), mine / total - 1


def quality(bench, _):
    """All layers of a final frame, at the demo's settings."""
    size = "64x36" if bench.tiny else "640x360"
    try:
        bench.scene("S4")
    except Missing as reason:
        return figure("S4, a final frame", "-", ["layer"], [], None, [f"left out: {reason}"])
    halves = bench.reference_halves("S4", size, bench.reference_samples // 8)
    rows, more, costs, rest = [], [], [], []
    runs = {layer: [] for layer in LAYERS}
    for seed in range(1, 2 if bench.tiny else 5):
        image, cpu = preset(bench, "S4", seed, size)
        costs.append(cpu)
        rest.append(without_caustics(bench, image, halves))
        for layer in LAYERS:
            runs[layer].append(bench.compare(image, halves, image.with_name(f"{image.stem}-{layer}.json"), layer)["total"])
    for layer, totals in runs.items():
        rows.append([layer or "image", quantity(math.sqrt(max(0, mean(t["mse"] for t in totals)))),
                     quantity(mean(t["relmse"] for t in totals)) if layer is None else "-",
                     percent(mean(t["bias"] or 0 for t in totals)), percent(totals[0]["bias_standard_error"] or 0)])
    relmse, bias = mean(r[1] for r in rest), mean(r[2] for r in rest)
    rows.append(["image without caustics", quantity(math.sqrt(max(0, mean(r[0] for r in rest)))), quantity(relmse), percent(bias), "-"])
    for o in runs[None][0]["objects"]:
        if o["pixels"] < 100 or o["bias"] is None:
            continue
        same = [next(p for p in t["objects"] if p["id"] == o["id"]) for t in runs[None]]
        more.append([o["id"], o["pixels"], mean(p["bias"] for p in same), percent(o["bias_standard_error"] or 0),
                     percent(mean(p["share_of_squared_error"] for p in same), 1)])
    more.sort(key=lambda row: -abs(row[2]))
    found = figure("S4, a final frame at 640x360", "relMSE at most 2e-3 and bias at most 1 %, of the image without caustics",
                   ["layer", "RMSE", "relMSE", "bias", "standard error of one"], rows,
                   None if bench.tiny else relmse <= 2e-3 and abs(bias) <= 0.01,
                   [f"Settings of Makefile.example, {quantity(median(costs))} CPU s; against our path tracer, halves of "
                    f"{bench.reference_samples // 16} samples. relMSE of a layer would divide by the reference's noise."])
    found["more"] = {"title": "S4's image by object", "header": ["object", "pixels", "bias", "standard error",
                     "share of squared error"], "rows": [[*row[:2], percent(row[2]), *row[3:]] for row in more]}
    return found


def speed(bench, _):
    """A fast still frame of 320x180 against Cycles' reference."""
    from gathering import HEADER, judged
    title, asked = "S4, a still frame at 320x180", "Cycles' RMSE of 256 samples (.038) in 1/20 of its CPU seconds (2.5)"
    try:
        bench.scene("S4")
        halves = bench.reference_halves("S4") if bench.tiny else bench.third_party_halves("S4")
    except Missing as reason:
        return figure(title, asked, HEADER, [], None, [f"left out: {reason}"])
    rows, met = judged(bench, "S4", bench.size, halves, [(0.038, 2.5, FAST)])
    return figure(title, asked, HEADER, rows, None if bench.tiny else met, ["Median and mean of 5 seeds, everything counted."])


def animation(bench, _):
    """A walk through the hall, as `make -f Makefile.example SCENE=...` renders it."""
    frames, size = ("0-1", "48x28") if bench.tiny else ("0-47", "640x360")
    title, asked = f"S4, frames {frames} at {size}, camera moving", "below 150 normalised CPU s, all processes"
    header = ["photons", "points", "cache", "frames", "pictures to look at and all else", "CPU s in all", "a frame", "normalised in all"]
    try:
        scene, _ = bench.scene("S4")
    except Missing as reason:
        return figure(title, asked, header, [], None, [f"left out: {reason}"])
    out, load = bench.out / "tmp" / "walk", running_processes()
    shutil.rmtree(out, ignore_errors=True)
    all_cpu, _ = spent(bench, out, SCENE=scene.resolve(), FRAMES=frames, SIZE=size)
    stages = list(pipeline.cpu_of(out).values())
    pictures = len(pipeline.plan_of(out)["pictures"])
    samples = mean(stats["results"]["samples_per_pixel"] for stats in pipeline.stats_of(out, ("frames",)) if "samples_per_pixel" in stats["results"])
    shutil.rmtree(out)
    rows = [[*map(quantity, stages), quantity(all_cpu - sum(stages)), quantity(all_cpu), quantity(all_cpu / pictures), quantity(bench.normalised(all_cpu))]]
    return figure(title, asked, header, rows, None if bench.tiny else bench.normalised(all_cpu) < 150,
                  [f"`make -f Makefile.example SCENE=S4_atrium.glb FRAMES={frames} SIZE={size}`, its final settings: "
                   f"{samples:.1f} samples a pixel. {load} other processes wanted a processor at its beginning."])


FIGURES = {"s4-quality": quality, "s4-speed": speed, "s4-animation": animation}

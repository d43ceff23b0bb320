"""The required figures of S4, a hall with mirrors and glass: its layers at final settings, and a fast still frame.

Functions as in required.py.
"""
import dataclasses
import math
import struct
import sys

import chain
from chain import Settings
from measure import Missing, figure, median, percent, quantity

LAYERS = (None, "emission", "direct", "specular", "caustic", "indirect")
FAST = Settings(300000, ("--point-count", "4k", "--light-samples", 2), ("--rays", 50, "--error-bound", 0.6),
                ("--spp", 8, "--pixel-error", 0.015, "--caustic-radius", 0.15), steps=True, caustics=True)


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def read(bench, file):
    """Values of all pixels by channel."""
    sys.path.insert(0, str(bench.project / "tests" / "lib" / "image"))
    from read_frame import FORMAT, SIZE, Frame, unzip
    frame = Frame(file)
    planes = {name: [] for name, _ in frame.channels}
    line = frame.width * sum(SIZE[kind] for _, kind in frame.channels)
    for first in range(0, frame.height, frame.lines):
        (at,) = struct.unpack_from("<Q", frame.data, frame.table + 8 * (first // frame.lines))
        size = struct.unpack_from("<ii", frame.data, at)[1]
        samples, offset = unzip(frame.data[at + 8:at + 8 + size], line * min(frame.lines, frame.height - first)), 0
        while offset < len(samples):
            for name, kind in frame.channels:
                planes[name] += struct.unpack_from(f"<{frame.width}{FORMAT[kind]}", samples, offset)
                offset += SIZE[kind] * frame.width
    return planes


def without_caustics(bench, image, halves):
    """(MSE, relMSE) of the image without its caustic layer as aqm-compare has them: with a and b the halves without
    theirs and r their mean, the mean of (x - a)(x - b), and of that over r^2 + (mean r / 10)^2, channels averaged."""
    frames = [read(bench, file) for file in (image, *halves)]
    x, a, b = ([[v - w for v, w in zip(f[c], f[f"caustic.{c}"])] for c in "RGB"] for f in frames)
    squares, scales, total = [0.0] * len(x[0]), [0.0] * len(x[0]), 0.0
    for planes in zip(x, a, b):
        for i, (p, q, r) in enumerate(zip(*planes)):
            squares[i] += (p - q) * (p - r) / 3
            scales[i] += (0.5 * (q + r)) ** 2 / 3
            total += 0.5 * (q + r) / 3
    soft = (0.1 * total / len(squares)) ** 2
    return mean(squares), mean(s / (r + soft) for s, r in zip(squares, scales))


def quality(bench, _):
    """All layers of a final frame."""
    size = "64x36" if bench.quick else "640x360"
    settings = dataclasses.replace(chain.final(bench.project), caustics=True)
    try:
        bench.scene("S4")
    except Missing as reason:
        return figure("S4, a final frame", "-", ["layer"], [], None, [f"left out: {reason}"])
    halves = bench.reference_halves("S4", size, bench.reference_samples // 8)
    rows, more, spent, rest = [], [], [], []
    runs = {layer: [] for layer in LAYERS}
    for seed in range(1, 2 if bench.quick else 5):
        image, stats = chain.frame(bench, "S4", seed, settings, size)
        spent.append(chain.cost(stats))
        rest.append(without_caustics(bench, image, halves))
        for layer in LAYERS:
            runs[layer].append(bench.compare(image, halves, image.with_name(f"{image.stem}-{layer}.json"), layer,
                                             "--min-object-pixels", 100)["total"])
    for layer, totals in runs.items():
        rows.append([layer or "image", quantity(math.sqrt(max(0, mean(t["mse"] for t in totals)))),
                     quantity(mean(t["relmse"] for t in totals)) if layer is None else "-",
                     percent(mean(t["bias"] or 0 for t in totals)), percent(totals[0]["bias_standard_error"] or 0)])
    rows.append(["image without caustics", quantity(math.sqrt(max(0, mean(r[0] for r in rest)))),
                 quantity(mean(r[1] for r in rest)), "-", "-"])
    for o in runs[None][0]["objects"]:
        if o["few_pixels"] or o["bias"] is None:
            continue
        same = [next(p for p in t["objects"] if p["id"] == o["id"]) for t in runs[None]]
        more.append([o["id"], o["pixels"], mean(p["bias"] for p in same), percent(o["bias_standard_error"] or 0),
                     percent(mean(p["share_of_squared_error"] for p in same), 1)])
    more.sort(key=lambda row: -abs(row[2]))
    found = figure("S4, a final frame at 640x360", "the image's and its layers' error, with and without caustics",
                   ["layer", "RMSE", "relMSE", "bias", "standard error of one"], rows, None,
                   [f"Settings of Makefile.example, {quantity(median(spent))} CPU s; against our path tracer, halves of "
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
        halves = bench.reference_halves("S4") if bench.quick else bench.third_party_halves("S4")
    except Missing as reason:
        return figure(title, asked, HEADER, [], None, [f"left out: {reason}"])
    rows, met = judged(bench, "S4", bench.size, halves, [(0.038, 2.5, FAST)])
    return figure(title, asked, HEADER, rows, None if bench.quick else met, ["Median and mean of 5 seeds, everything counted."])


FIGURES = {"s4-quality": quality, "s4-speed": speed}

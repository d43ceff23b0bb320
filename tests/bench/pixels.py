"""Figures of one picture against the two halves of a reference, in the standard library. Images: tests/stress/exr.py.

x is the picture, a and b the halves, independent of each other and of x, r their mean. Values of a pixel are means over
its three colours, which vary together; pixels are taken to vary independently.
"""
import math

LAYERS = ("emission", "specular", "direct", "caustic", "indirect")


def planes(image, layer=""):
    """R, G, B of the picture or of a layer of it. A file without R, G, B has the picture as the sum of its layers."""
    if layer or "R" in image.channels:
        return [image.channels[(layer and layer + ".") + c] for c in "RGB"]
    found = [planes(image, name) for name in (*LAYERS, "volume") if name + ".R" in image.channels]
    if not found:
        raise SystemExit("no channels R, G, B and no layers: render with --channels RGBA or layers")
    return [[sum(values) for values in zip(*planes_of)] for planes_of in zip(*found)]


def mean(image, layer=""):
    return sum(map(sum, planes(image, layer))) / (3 * image.width * image.height)


def mean_of_halves(a, b, layer=""):
    """(mean of r, its standard error): that of a pixel of r is |a - b| / 2."""
    squares = sum(((p - q) + (s - t) + (u - v)) ** 2 for p, q, s, t, u, v in zip(
        *(plane for pair in zip(planes(a, layer), planes(b, layer)) for plane in pair)))
    count = a.width * a.height
    return (mean(a, layer) + mean(b, layer)) / 2, math.sqrt(squares) / (6 * count)


def squared_error(x, a, b):
    """(mean of (x - a)(x - b), its standard error due to the reference). With e the true squared error of a pixel and v the variance of r
    there, estimated by (a - b)^2 / 4, that of a pixel has the variance 4 e v + 4 v^2; v estimated from one difference has
    E v^2 three times too large."""
    total = variance = 0.0
    for p, q, s in zip(planes(x), planes(a), planes(b)):
        total += sum((u - v) * (u - w) for u, v, w in zip(p, q, s))
    columns = [plane for image in (x, a, b) for plane in planes(image)]
    for x0, x1, x2, a0, a1, a2, b0, b1, b2 in zip(*columns):
        e = (x0 - a0) * (x0 - b0) + (x1 - a1) * (x1 - b1) + (x2 - a2) * (x2 - b2)
        v = ((a0 - b0) ** 2 + (a1 - b1) ** 2 + (a2 - b2) ** 2) / 4
        variance += 4 * max(0.0, e) * v + 4 / 3 * v * v
    count = x.width * x.height
    return total / (3 * count), math.sqrt(variance) / (3 * count)


def half_error(a, b):
    """Mean squared error of one half: its samples are half of the reference's."""
    return sum(sum((p - q) ** 2 for p, q in zip(*pair)) for pair in zip(planes(a), planes(b))) / (6 * a.width * a.height)


# ---- pixels unlike those around them

def grey(*images):
    """Mean over images and colours, pixel by pixel."""
    columns = [plane for image in images for plane in planes(image)]
    return [sum(values) / len(columns) for values in zip(*columns)]


def patches(values, width, height):
    """Of every pixel not at the border (place, the 25 values of its 5x5)."""
    for y in range(2, height - 2):
        rows = [values[i * width:(i + 1) * width] for i in range(y - 2, y + 3)]
        for x in range(2, width - 2):
            yield y * width + x, [v for row in rows for v in row[x - 2:x + 3]]


def dotted(values, width, height, limit):
    """Places of pixels that differ from the median of their 5x5 by more than `limit`."""
    return {at for at, patch in patches(values, width, height) if abs(values[at] - sorted(patch)[12]) > limit}


def dots(x, a, b):
    """How many pixels differ from the median of their 5x5 by more than the picture's mean, where the reference does not."""
    reference = grey(a, b)
    limit = sum(reference) / len(reference)
    found = dotted(grey(x), x.width, x.height, limit)
    return len(found - dotted(reference, x.width, x.height, limit)) if found else 0


def tail(x, a, b):
    """How heavy the tail of the noise is where the picture is flat: the 99.9th percentile of |u| over 3.29 times the 68.27th, where u is
    (pixel - mean of its 5x5) / mean of the reference's 5x5; 1 for a normal distribution. Flat: the reference's 5x5
    spreads by less than a tenth of its mean beyond its own noise. None if fewer than 1000 pixels are flat."""
    reference, noise = grey(a, b), [((p - q) / 2) ** 2 for p, q in zip(grey(a), grey(b))]
    ours, found = grey(x), []
    for (at, r), (_, n), (_, v) in zip(*(patches(values, x.width, x.height) for values in (reference, noise, ours))):
        middle = sum(r) / 25
        if middle > 0 and sum(p * p for p in r) / 25 - middle * middle < (0.1 * middle) ** 2 + 2 * sum(n) / 25:
            found.append(abs(ours[at] - sum(v) / 25) / middle)
    if len(found) < 1000:
        return None
    found.sort()
    usual = found[int(0.6827 * len(found))]
    return found[int(0.999 * len(found))] / (3.29 * usual) if usual > 0 else None

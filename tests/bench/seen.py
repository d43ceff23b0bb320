"""What a person sees wrong in a picture: codes, blobs and grain, in the standard library.

A code is 255 times the sRGB curve of the exposed value, cut to [0, 1], not rounded; one exposure puts the median of the reference's
pixel means at .18. Images: tests/stress/exr.py. Pixels are taken to vary independently.
"""
import math
import statistics

import pixels

STEPS = 1 << 14
CURVE = [255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055) for v in (i / STEPS for i in range(STEPS + 2))]
FLAT, BLOB = 2, 8        # codes: steepest flat region, least difference of a blob


def code(value):
    """From a table with straight lines between its entries: right to .02 codes."""
    if not value > 0:
        return 0.0
    if value >= 1:
        return 255.0
    if value <= 0.0031308:
        return 255 * 12.92 * value
    place = value * STEPS
    i = int(place)
    return CURVE[i] + (place - i) * (CURVE[i + 1] - CURVE[i])


def blurred(values, width, height, reach=2):
    """Means over the box around each pixel, `reach` pixels to each side (5x5), over what there is of it at the border."""
    def along(values, step, count, rest, stride):
        out = [0.0] * len(values)
        for line in range(rest):
            at = [line * stride + i * step for i in range(count)]
            sums = [0.0]
            for p in at:
                sums.append(sums[-1] + values[p])
            for i, p in enumerate(at):
                a, b = max(0, i - reach), min(count, i + reach + 1)
                out[p] = (sums[b] - sums[a]) / (b - a)
        return out
    return along(along(values, 1, width, height, width), width, height, width, 1)


class Seen:
    """The codes of a reference in two halves, against which pictures are judged."""

    def __init__(self, a, b):
        """R, G, B planes of each half."""
        self.count = len(a[0])
        median = statistics.median(sum(values) for values in zip(*a, *b)) / 6
        self.exposure = 0.18 / median if median > 0 else 1
        self.a, self.b = self.codes(a), self.codes(b)

    def codes(self, planes):
        return [[code(self.exposure * v) for v in plane] for plane in planes]

    def halves_differ(self):
        """RMS of the halves' mean against the truth, as the halves' difference has it."""
        return self.half_error() / math.sqrt(2)

    def half_error(self):
        """RMS of one half against the truth, as the halves' difference has it."""
        return math.sqrt(sum((p - q) ** 2 for u, v in zip(self.a, self.b) for p, q in zip(u, v)) / (6 * self.count))

    def squares(self, planes):
        """By pixel the squared error, mean over its colours: (x - a) (x - b) has no noise of the reference's own."""
        parts = [[(x - p) * (x - q) for x, p, q in zip(*three)] for three in zip(self.codes(planes), self.a, self.b)]
        return [sum(values) / 3 for values in zip(*parts)]

    def error(self, planes):
        return math.sqrt(max(0.0, math.fsum(self.squares(planes)) / self.count))

    def flat(self, width, height):
        """By pixel: does the reference, blurred by 5x5, change by less than FLAT codes from pixel to pixel?"""
        grey = blurred([sum(v) / 6 for v in zip(*self.a, *self.b)], width, height)

        def slope(p, x, y):
            right = grey[p + 1] - grey[p] if x + 1 < width else 0
            below = grey[p + width] - grey[p] if y + 1 < height else 0
            return math.hypot(right, below)
        return [slope(y * width + x, x, y) < FLAT for y in range(height) for x in range(width)]

    def blobs(self, planes, width, height, flat):
        """Share of the picture: flat pixels whose blurred difference to both halves is above BLOB codes, to the same side."""
        mine = [sum(v) / 3 for v in zip(*self.codes(planes))]
        halves = [[sum(v) / 3 for v in zip(*half)] for half in (self.a, self.b)]
        to_a, to_b = (blurred([x - r for x, r in zip(mine, half)], width, height) for half in halves)
        return sum(f and min(abs(p), abs(q)) > BLOB and p * q > 0 for f, p, q in zip(flat, to_a, to_b)) / self.count

    def grain(self, planes, width, height, flat):
        """RMS in flat pixels of the difference to the median of the 5x5 around, in codes."""
        mine = [sum(v) / 3 for v in zip(*self.codes(planes))]
        squares = [(mine[p] - sorted(patch)[12]) ** 2 for p, patch in pixels.patches(mine, width, height) if flat[p]]
        return math.sqrt(sum(squares) / len(squares)) if squares else 0.0

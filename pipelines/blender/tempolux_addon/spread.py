"""An area lamp with a spread as spot lamps in its place, whose sum shines as Cycles lets it.

Cycles gives direction t, from the lamp's axis, an intensity of sin(h - t), h half of the spread. A spot of glTF gives the square of a line in
cos t, from 1 at its axis to 0 at its cone. A few cones with weights of 0 or more come near.
"""

import itertools
import math

import numpy

CONES, EDGES, GRID = (
    4,
    (0, 0.4, 0.7),
    4,
)  # cones and inner cones, as a share of them, that are tried; spots along each side


def cones_for(half):
    """[(outer angle, inner angle, intensity on the axis)] of spots of 1 W together."""
    angles = numpy.linspace(0, half, 200)
    wanted, solid = numpy.sin(half - angles) / math.sin(half), numpy.sqrt(numpy.sin(angles))
    tried = [
        (outer, edge * outer)
        for outer in (min(math.pi / 2, half * (k + 1) / CONES) for k in range(CONES))
        for edge in EDGES
    ]
    curves = [numpy.clip((numpy.cos(angles) - math.cos(o)) / (math.cos(i) - math.cos(o)), 0, 1) ** 2 for o, i in tried]
    best = None
    for size in (1, 2, 3):
        for chosen in itertools.combinations(range(len(tried)), size):
            matrix = numpy.stack([curves[k] for k in chosen], axis=1)
            weights, *_ = numpy.linalg.lstsq(matrix * solid[:, None], wanted * solid, rcond=None)
            error = float((((matrix @ weights - wanted) * solid) ** 2).sum())
            if (weights > 0).all() and (best is None or error < .8 * best[0]):
                best = error, [(*tried[k], float(w)) for k, w in zip(chosen, weights)]
    flux = sum(w * 2 * math.pi * (1 - math.cos(i) + (math.cos(i) - math.cos(o)) / 3) for o, i, w in best[1])
    return [(o, i, w / flux) for o, i, w in best[1]]


def places_on(outline, is_round):
    """Places of the spots on a lamp's surface, in its own axes."""
    extent = numpy.abs(numpy.array(outline)).max(axis=0)
    steps = (numpy.arange(GRID) + .5) * 2 / GRID - 1
    return [(x * extent[0], y * extent[1], 0.0) for x in steps for y in steps if not is_round or x * x + y * y <= 1]

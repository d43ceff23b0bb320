#!/usr/bin/env python3
"""Read and write .irradpoints files. Written from formats/irradpoints/irradpoints.md and formats/conventions.md alone.

    read_irradpoints.py FILE            header and totals as JSON
    read_irradpoints.py FILE COPY       also write it again

As a module: read_irradpoints(path) -> Irradpoints; write_irradpoints(path, points). Another estimator is a few lines:

    p = read_irradpoints("in.irradpoints")
    for point in p.points:
        point.irradiance["direct"] = my_estimate(point.position, point.normal)
    write_irradpoints("out.irradpoints", p)
"""
import dataclasses
import math
import struct

from containers import cut, encode_container, exact_sums, integers, read_container, reals, refuse, save, second_reader

MAGIC, MARK = b"\x89TIRPT\r\n", b"IRPT"
RECORD = struct.Struct("<3f2HHBBf")             # section 3: position, normal, object, set, reserved, radius
IRRADIANCE = struct.Struct("<3f")               # section 4
END = "<Q9d"                                    # section 5, without mark and chain
KINDS = ["direct", "caustic", "indirect"]
REQUIRED = ["kinds", "origin", "spacing", "emitted"]
KEYS = ["kinds", "columns", "part", "origin", "spacing", "emitted"]
SINCE = {"part": 1, "columns": 2}                              # section 9
RULES = {
    "kinds": lambda v: v != "" and ",".join(k for k in KINDS if k in v.split(",")) == v,
    "columns": lambda v: v == "noise",
    "part": lambda v: v in ("low", "high"),
    "spacing": lambda v: (reals(v, 1) or [0])[0] > 0,
    "emitted": lambda v: integers(v, 1, 0, 2**64 - 1),
}


@dataclasses.dataclass
class Point:
    position: tuple
    normal: tuple           # two codes
    object: int
    set: int                # 0 static, 1 dynamic
    radius: float
    irradiance: dict        # kind: three numbers
    noise: tuple = (0, 0, 0)


@dataclasses.dataclass
class Irradpoints:
    header: dict            # key: text as in the file
    history: list           # lines
    points: list


def kinds_of(header):
    return header["kinds"].split(",")


def columns_of(header):
    return len(kinds_of(header)) + ("columns" in header)


def is_good(point):
    values = [point.radius] + [x for e in point.irradiance.values() for x in e]
    return (all(map(math.isfinite, values)) and min(values) >= 0 and all(map(math.isfinite, (*point.position, *point.noise))) and
            max(point.normal) <= 65534 and point.set <= 1)


def read_irradpoints(path):
    header, history, blocks, end = read_container(path, MAGIC, MARK, REQUIRED, RULES,
                                                  lambda h: [RECORD.size] + [IRRADIANCE.size] * columns_of(h), END, SINCE)
    points = []
    for offset, _, parts in blocks:
        columns = list(zip(*(IRRADIANCE.iter_unpack(column) for column in parts[1:])))
        for i, v in enumerate(RECORD.iter_unpack(parts[0])):
            points.append(Point(v[0:3], v[3:5], v[5], v[6], v[8], dict(zip(kinds_of(header), columns[i]))))
            if "columns" in header:
                points[-1].noise = columns[i][-1]
            if not is_good(points[-1]):
                refuse(offset + RECORD.size * i, f"point out of range: {points[-1]}")
    p = Irradpoints(header, history, points)
    if end != totals(p):
        refuse(0, "totals are not those of the points")
    return p


def totals(p):
    """Number of points, then three sums of each kind."""
    zero = (0.0, 0.0, 0.0)
    sums = [exact_sums(point.irradiance.get(kind, zero) for point in p.points) for kind in KINDS]
    return (len(p.points), *sums[0], *sums[1], *sums[2])


def encode_irradpoints(p):
    """The bytes of a file, in blocks of 65536."""
    blocks = []
    for points in cut(p.points):
        parts = [b"".join(RECORD.pack(*q.position, *q.normal, q.object, q.set, 0, q.radius) for q in points)]
        parts += [b"".join(IRRADIANCE.pack(*q.irradiance[kind]) for q in points) for kind in kinds_of(p.header)]
        if "columns" in p.header:
            parts.append(b"".join(IRRADIANCE.pack(*q.noise) for q in points))
        blocks.append((len(points), parts))
    return encode_container(MAGIC, MARK, KEYS, p.header, p.history, blocks, struct.pack(END, *totals(p)),
                            2 if "columns" in p.header else int("part" in p.header))


def write_irradpoints(path, p):
    save(path, encode_irradpoints(p))


def summary(p):
    sums = totals(p)
    return {"header": p.header, "history": p.history, "points": sums[0],
            "irradiance": {kind: sums[1 + 3 * k:4 + 3 * k] for k, kind in enumerate(KINDS)}}


if __name__ == "__main__":
    second_reader(__doc__, read_irradpoints, summary, write_irradpoints)

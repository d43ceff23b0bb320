#!/usr/bin/env python3
"""Read and write .meshirrad files. Written from formats/meshirrad/meshirrad.md and formats/conventions.md alone.

    read_meshirrad.py FILE            header and totals as JSON
    read_meshirrad.py FILE COPY       also write it again

As a module: read_meshirrad(path) -> Mesh; write_meshirrad(path, mesh).
"""
import dataclasses
import math
import re
import struct

from containers import REAL, cut, encode_container, read_container, refuse, save, second_reader

MAGIC, MARK = b"\x89TMESH\r\n", b"MESH"
# section 3: surface, triangle, cell, cuts, side, position, normal, area, photons, sums, irradiance, object, before, after
RECORD = struct.Struct("<3I2H3f2HfI3q3fH2B")
SURFACE, TRIANGLE, CELL, CUTS, SIDE, POSITION, NORMAL, AREA, PHOTONS, SUMS, IRRADIANCE, OBJECT, BEFORE, AFTER = 0, 1, 2, 3, 4, 5, 8, 10, 11, 12, 15, 18, 19, 20
END = "<QQ"                                     # section 4, without mark and chain
KINDS = ["direct", "caustic", "indirect"]
KEYS = ["kinds", "origin", "cell", "unit", "filter"]
SINCE = {"holds": 1, "jump": 1}                 # minor versions


def positive(text):
    return re.fullmatch(REAL, text) and math.isfinite(float(text)) and float(text) > 0


RULES = {
    "kinds": lambda v: v != "" and ",".join(k for k in KINDS if k in v.split(",")) == v,
    "cell": positive,
    "unit": positive,
    "holds": lambda v: v in ("frame", "counts", "windows"),
    "jump": lambda v: v == "yes",
    "filter": lambda v: v == "none" or (v.split(" ")[0] in ("box", "gaussian", "bilateral") and v.count(" ") == 1 and positive(v.split(" ")[1])),
}


@dataclasses.dataclass
class Mesh:
    header: dict            # key: text as in the file
    history: list           # lines
    elements: list          # of tuples as RECORD has them


def read_meshirrad(path):
    header, history, blocks, end = read_container(path, MAGIC, MARK, KEYS, RULES, lambda h: [RECORD.size], END, SINCE)
    m = Mesh(header, history, [])
    holds = header.get("holds", "frame")
    if holds == "counts" and header["filter"] != "none" or "jump" in header and holds != "counts":
        refuse(0, "counts have no filter, and they alone say that light jumps")
    last, following = None, None               # side done last; (side, cuts, cell) that must come next
    for offset, _, parts in blocks:
        for i, e in enumerate(RECORD.iter_unpack(parts[0])):
            side = e[SURFACE], e[TRIANGLE], e[SIDE]
            in_order = (side, e[CUTS], e[CELL]) == following if following else e[CELL] == 0 and (last is None or side > last)
            numbers = e[POSITION:POSITION + 3] + (e[AREA],) + e[IRRADIANCE:IRRADIANCE + 3]
            good = (1 <= e[CUTS] <= 1024 and e[SIDE] <= 1 and all(map(math.isfinite, numbers)) and min(numbers[3:]) >= 0 and
                    max(e[NORMAL:NORMAL + 2]) <= 65534 and min(e[SUMS:SUMS + 3]) >= 0 and (holds == "windows" or e[BEFORE] == e[AFTER] == 0))
            if not (in_order and good):
                refuse(offset + RECORD.size * i, "element out of range or order")
            last, following = side, None if e[CELL] + 1 == e[CUTS] ** 2 else (side, e[CUTS], e[CELL] + 1)
            m.elements.append(e)
    if following or end != totals(m):
        refuse(0, "cells are missing, or totals are not those of the elements")
    return m


def totals(m):
    return len(m.elements), sum(e[PHOTONS] for e in m.elements)


def encode_meshirrad(m):
    """The bytes of a file, in blocks of 65536."""
    blocks = [(len(some), [b"".join(RECORD.pack(*e) for e in some)]) for some in cut(m.elements)]
    return encode_container(MAGIC, MARK, KEYS + list(SINCE), m.header, m.history, blocks, struct.pack(END, *totals(m)), int("holds" in m.header))


def write_meshirrad(path, m):
    save(path, encode_meshirrad(m))


def cell_of(n, u, v):
    """Section 3: the cell of barycentrics u, v (of corners 1 and 2)."""
    x, y = u * n, v * n
    j = min(int(y), n - 1)
    i = min(int(x), n - 1 - j)
    tip = i + j + 1 < n and (x - i) + (y - j) > 1
    return j * (2 * n - j) + 2 * i + tip


if __name__ == "__main__":
    second_reader(__doc__, read_meshirrad,
                  lambda file: {"header": file.header, "history": file.history, "elements": totals(file)[0], "photons": totals(file)[1]},
                  write_meshirrad)

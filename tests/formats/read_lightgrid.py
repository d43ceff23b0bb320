#!/usr/bin/env python3
"""Read and write .lightgrid files. Written from formats/lightgrid/lightgrid.md and formats/conventions.md alone.

    read_lightgrid.py FILE            header and totals as JSON
    read_lightgrid.py FILE COPY       also write it again

As a module: read_lightgrid(path) -> Grid; write_lightgrid(path, grid).
"""
import dataclasses
import math
import re
import struct

from containers import REAL, encode_container, integers, read_container, refuse, save, second_reader

MAGIC, MARK = b"\x89TLGRD\r\n", b"CELL"
FIXED = struct.Struct("<3iI2f")                 # section 3: place, facing, sky, suns; then the parts
END = "<Q"                                      # section 4, without mark and chain
KEYS = ["origin", "edge", "parts"]
FARTHEST, BLOCK = 524286, 1024

RULES = {
    "edge": lambda v: re.fullmatch(REAL, v) and math.isfinite(float(v)) and float(v) > 0,
    "parts": lambda v: integers(v, 2, 1, 256),
}


@dataclasses.dataclass
class Grid:
    header: dict            # key: text as in the file
    history: list           # lines
    cells: list             # of (x, y, z, facing, sky, suns, [end of each part])


def parts_of(header):
    across, down = integers(header["parts"], 2, 1, 256)
    return across * down


def good(cell):
    *place, facing, sky, suns, end = cell
    ascending = all(a <= b for a, b in zip([0] + end, end + [1]))   # false of NaN
    return (all(-FARTHEST <= x <= FARTHEST for x in place) and facing <= 5 and 0 <= sky <= 1 and 0 <= suns <= 1 and
            sky + suns <= 1 + 2**-20 and ascending and end[-1] == 1)


def read_lightgrid(path):
    size = lambda header: [FIXED.size + 4 * parts_of(header)]
    header, history, blocks, end = read_container(path, MAGIC, MARK, KEYS, RULES, size, END)
    g = Grid(header, history, [])
    record = size(header)[0]
    for offset, n, parts in blocks:
        for i in range(n):
            data = parts[0][i * record:(i + 1) * record]
            cell = *FIXED.unpack_from(data), list(struct.unpack_from(f"<{parts_of(header)}f", data, FIXED.size))
            if not good(cell) or (g.cells and cell[:4] <= g.cells[-1][:4]):
                refuse(offset + record * i, "cell out of range or order")
            g.cells.append(cell)
    if end != (len(g.cells),):
        refuse(0, "totals are not those of the cells")
    return g


def encode(header, history, cells, end=None, magic=MAGIC, mark=MARK, minor=0, keys=KEYS):
    """The bytes of a file, in blocks of 1024; of whatever it is given."""
    pack = lambda cell: FIXED.pack(*cell[:6]) + struct.pack(f"<{len(cell[6])}f", *cell[6])
    some = [cells[i:i + BLOCK] for i in range(0, len(cells), BLOCK)]
    blocks = [(len(part), [b"".join(map(pack, part))]) for part in some]
    return encode_container(magic, mark, keys, header, history, blocks, struct.pack(END, len(cells) if end is None else end), minor)


def write_lightgrid(path, g):
    save(path, encode(g.header, g.history, g.cells))


if __name__ == "__main__":
    second_reader(__doc__, read_lightgrid, lambda file: {"header": file.header, "history": file.history, "cells": len(file.cells)}, write_lightgrid)

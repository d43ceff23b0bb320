#!/usr/bin/env python3
"""Read and write .paths files. Written from formats/paths/paths.md and formats/conventions.md alone.

    read_paths.py FILE            header and totals as JSON
    read_paths.py FILE COPY       also write it again

As a module: read_paths(path) -> Paths; write_paths(path, paths).
"""
import dataclasses
import re
import struct

from containers import cut, encode_container, integers, read_container, refuse, save, second_reader

MAGIC, MARK = b"\x89TPATH\r\n", b"PATH"
RECORD = struct.Struct("<QQ")                   # section 3: path, intervals
END = "<QQ"                                     # section 4, without mark and chain
KINDS = ["direct", "caustic", "indirect", "volume"]
KEYS = ["kinds", "origin", "groups", "emitted", "seed", "movers"]
RULES = {
    "kinds": lambda v: v != "" and ",".join(k for k in KINDS if k in v.split(",")) == v,
    "groups": lambda v: integers(v, 1, 1, 2**24),
    "emitted": lambda v: integers(v, 1, 0, 2**64 - 1),
    "seed": lambda v: integers(v, 1, 0, 2**64 - 1),
    "movers": lambda v: len(v.split(" ")) <= 64 and all(re.fullmatch("[!-~]{1,128}", word) for word in v.split(" ")),
    "emission": lambda v: re.fullmatch("[!-~]{1,128}", v),
}


@dataclasses.dataclass
class Paths:
    header: dict            # key: text as in the file
    history: list           # lines
    paths: list             # of (path, intervals)


def read_paths(path):
    header, history, blocks, end = read_container(path, MAGIC, MARK, KEYS + ["frames"], RULES, lambda h: [RECORD.size], END)
    p = Paths(header, history, [])
    first, last = (int(v) for v in header["frames"].split(" "))
    intervals, groups = len(header["movers"].split(" ")), int(header["groups"])
    if intervals > last - first + 1:
        refuse(16, "more movers than frames")
    for offset, _, parts in blocks:
        for i, (number, bits) in enumerate(RECORD.iter_unpack(parts[0])):
            after = not p.paths or (p.paths[-1][0] % groups, p.paths[-1][0]) < (number % groups, number)
            if not (number < int(header["emitted"]) and 0 < bits < 2**intervals and after):
                refuse(offset + RECORD.size * i, "path out of range or order")
            p.paths.append((number, bits))
    if end != totals(p):
        refuse(0, "totals are not those of the paths")
    return p


def totals(p):
    return len(p.paths), sum(bits.bit_count() for _, bits in p.paths)


def encode_paths(p):
    """The bytes of a file, in blocks of 65536."""
    blocks = [(len(some), [b"".join(RECORD.pack(*q) for q in some)]) for some in cut(p.paths)]
    return encode_container(MAGIC, MARK, KEYS + ["emission"], p.header, p.history, blocks, struct.pack(END, *totals(p)))


def write_paths(path, p):
    save(path, encode_paths(p))


if __name__ == "__main__":
    second_reader(__doc__, read_paths,
                  lambda file: {"header": file.header, "history": file.history, "paths": totals(file)[0], "intervals": totals(file)[1]},
                  write_paths)

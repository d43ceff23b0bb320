#!/usr/bin/env python3
"""Read and write .irradcache files. Written from formats/irradcache/irradcache.md and formats/conventions.md alone.

    read_irradcache.py FILE            header and totals as JSON
    read_irradcache.py FILE COPY       also write it again

As a module: read_irradcache(path) -> Irradcache; write_irradcache(path, cache). A filter is a few lines:

    c = read_irradcache("in.irradcache")
    c.records = [r for r in c.records if r.set == 0]
    write_irradcache("out.irradcache", c)
"""
import dataclasses
import math
import struct

from containers import cut, encode_container, exact_sums, integers, read_container, reals, refuse, save, second_reader

MAGIC, MARK = b"\x89TIRRC\r\n", b"IRRC"
# Section 3: position, normal, object, set, reserved, irradiance, rotational, translational, radius, radius_unclamped
RECORD = struct.Struct("<3f3fHBB3f9f9fff")
INFLUENCE, UPDATE, CLEARANCE, NOISE = map(struct.Struct, ("<f", "<3f", "<f16B", "<3f"))               # section 4
END = "<Q3d"                                                       # section 5, without mark and chain
NAMES = ["influence", "update", "clearance", "noise", "apart"]
COLUMNS = {",".join(some) or "none": some for some in ([n for i, n in enumerate(NAMES) if bits >> i & 1] for bits in range(32))}
SIZES = {"influence": INFLUENCE.size, "update": UPDATE.size, "clearance": CLEARANCE.size, "noise": NOISE.size, "apart": 0}
KEYS = ["columns", "origin", "rays", "error-bound", "least-cosine", "lamps-apart", "radii", "placed"]
SINCE = {"least-cosine": 1, "clearance": 2, "noise": 3, "apart": 4, "lamps-apart": 4}   # section 9; clearance, noise, apart are columns


def good_radii(text):
    radii = reals(text, 2)
    return radii and 0 <= radii[0] <= radii[1] and radii[1] > 0


def good_ranges(text):
    numbers = integers(text, text.count(" ") + 1, -2**31, 2**31 - 1)
    if not numbers or len(numbers) % 2:
        return False
    ranges = list(zip(numbers[::2], numbers[1::2]))
    return all(a <= b for a, b in ranges) and all(y[0] > x[1] + 1 for x, y in zip(ranges, ranges[1:]))


RULES = {
    "columns": lambda v: v in COLUMNS,
    "rays": lambda v: integers(v, 1, 1, 2**32 - 1),
    "error-bound": lambda v: (reals(v, 1) or [0])[0] > 0,
    "least-cosine": lambda v: 0 <= (reals(v, 1) or [-1])[0] < 1,
    "lamps-apart": lambda v: (reals(v, 1) or [0])[0] > 0,
    "radii": good_radii,
    "placed": good_ranges,
}


@dataclasses.dataclass
class Record:
    position: tuple
    normal: tuple
    object: int
    set: int                # 0 static, 1 dynamic
    irradiance: tuple
    rotational: tuple       # nine numbers: three of R, of G, of B
    translational: tuple
    radius: float
    radius_unclamped: float
    influence: float = 0
    update: tuple = (0, 0, 0)
    clearance: tuple = (0,) * 17      # reach, then a share for each spoke
    noise: tuple = (0, 0, 0)


@dataclasses.dataclass
class Irradcache:
    header: dict            # key: text as in the file
    history: list           # lines
    records: list


def is_good(r):
    finite = [*r.position, *r.normal, *r.irradiance, *r.rotational, *r.translational, r.radius, r.influence, *r.update, *r.noise]
    return (all(map(math.isfinite, finite)) and abs(sum(x * x for x in r.normal) - 1) <= 2e-4 and r.set <= 1 and
            min(r.irradiance) >= 0 and r.radius > 0 and r.radius_unclamped >= 0 and r.influence >= 0)


def read_irradcache(path):
    header, history, blocks, end = read_container(
        path, MAGIC, MARK, ["columns"], RULES,
        lambda h: [RECORD.size] + [SIZES[c] for c in COLUMNS[h["columns"]]], END, SINCE)
    if ("apart" in COLUMNS[header["columns"]]) != ("lamps-apart" in header):
        refuse(0, "column apart and lamps-apart do not come together")
    records = []
    for offset, _, parts in blocks:
        columns = dict(zip(COLUMNS[header["columns"]], parts[1:]))
        for i, v in enumerate(RECORD.iter_unpack(parts[0])):
            r = Record(v[0:3], v[3:6], v[6], v[7], v[9:12], v[12:21], v[21:30], v[30], v[31])
            if "influence" in columns:
                r.influence, = INFLUENCE.unpack_from(columns["influence"], INFLUENCE.size * i)
            if "update" in columns:
                r.update = UPDATE.unpack_from(columns["update"], UPDATE.size * i)
            if "clearance" in columns:
                r.clearance = CLEARANCE.unpack_from(columns["clearance"], CLEARANCE.size * i)
            if "noise" in columns:
                r.noise = NOISE.unpack_from(columns["noise"], NOISE.size * i)
            if not is_good(r) or ("clearance" in columns and not r.clearance[0] > 0):
                refuse(offset + RECORD.size * i, f"record out of range: {r}")
            records.append(r)
    c = Irradcache(header, history, records)
    if end != totals(c):
        refuse(0, "totals are not those of the records")
    return c


def totals(c):
    """Number of records, sum of their irradiance."""
    return (len(c.records), *exact_sums(r.irradiance for r in c.records))


def encode_irradcache(c):
    """The bytes of a file, in blocks of 65536."""
    blocks = []
    for records in cut(c.records):
        parts = [b"".join(RECORD.pack(*r.position, *r.normal, r.object, r.set, 0, *r.irradiance, *r.rotational,
                                      *r.translational, r.radius, r.radius_unclamped) for r in records)]
        columns = COLUMNS[c.header["columns"]]
        if "influence" in columns:
            parts.append(b"".join(INFLUENCE.pack(r.influence) for r in records))
        if "update" in columns:
            parts.append(b"".join(UPDATE.pack(*r.update) for r in records))
        if "clearance" in columns:
            parts.append(b"".join(CLEARANCE.pack(*r.clearance) for r in records))
        if "noise" in columns:
            parts.append(b"".join(NOISE.pack(*r.noise) for r in records))
        blocks.append((len(records), parts))
    columns = COLUMNS.get(c.header["columns"], [])
    minor = 4 if "lamps-apart" in c.header else 3 if "noise" in columns else 2 if "clearance" in columns else int("least-cosine" in c.header)
    return encode_container(MAGIC, MARK, KEYS, c.header, c.history, blocks, struct.pack(END, *totals(c)), minor)


def write_irradcache(path, c):
    save(path, encode_irradcache(c))


def summary(c):
    sums = totals(c)
    return {"header": c.header, "history": c.history, "records": sums[0], "irradiance": sums[1:],
            "records_by_set": [sum(r.set == s for r in c.records) for s in (0, 1)]}


if __name__ == "__main__":
    second_reader(__doc__, read_irradcache, summary, write_irradcache)

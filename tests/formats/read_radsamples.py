#!/usr/bin/env python3
"""Read and write .radsamples files. Written from formats/radsamples/radsamples.md alone; needs containers.py beside it.

    read_radsamples.py FILE [COPY]      prints a summary as JSON; writes the file again

    from read_radsamples import read_radsamples
    f = read_radsamples("0012.radsamples")
    for r in f.records: print(r.position, len(r.samples), r.samples[0].radiance, r.samples[0].distance)
"""
import collections
import dataclasses
import math
import os
import re
import struct
import zlib

from containers import IDENTITY, cut, exact_sums, integers, parse_text, reals, refuse, save, second_reader

MAGIC = b"\x89TRADS\r\n"
POINT = struct.Struct("<3f")
# Section 3, in its order.
RECORD = struct.Struct("<3f3fQII2fHHIHBBIffff f3f9f9ff16sffI".replace(" ", ""))
FIELDS = ("position normal key surface triangle barycentric rings sectors updates object set fading narrows_from footprint expected_share "
          "lit_share radius radius_unclamped irradiance rotational translational clearance_reach clearance further_share birth_weight kept_from").split()
COUNTS = {"position": 3, "normal": 3, "barycentric": 2, "irradiance": 3, "rotational": 9, "translational": 9}
SAMPLE, ANCHOR, END = struct.Struct("<4BHH"), struct.Struct("<I"), struct.Struct("<QQQ3d")
NO_ANCHOR = 0xFFFFFFFF
VALID, DYNAMIC, MISS, NEAR, ANCHORED = (1 << bit for bit in range(11, 16))
RULES = {
    "columns": lambda v: v in ("none", "anchor"),
    "diagonal": lambda v: (reals(v, 1) or [0])[0] > 0,
    "segment": lambda v: (s := integers(v, 2, -2**31, 2**31 - 1)) and s[0] <= s[1],
    "points": lambda v: re.fullmatch("[!-~]{1,128}", v),
}
BASE_RULES = {      # since 1.1
    "base": lambda v: v not in (".", "..") and re.fullmatch("[^\x00-\x1f\x7f/]+", v),
    "base-digest": lambda v: re.fullmatch("[0-9a-f]{32}", v),
}
HIGH_RULES = {      # since 1.2
    "high": lambda v: re.fullmatch("[!-~]{1,128}", v),
}


@dataclasses.dataclass
class Sample:
    rgbe: tuple             # three mantissas, exponent
    half: int               # the distance's bits
    flags: int
    anchor: int = NO_ANCHOR
    radiance: tuple = ()    # W/m^2/sr
    distance: float = 0     # m; 0: nothing was met

    @property
    def age(self):
        return self.flags & 2047


Record = collections.namedtuple("Record", FIELDS + ["samples"])


@dataclasses.dataclass
class Radsamples:
    header: dict
    history: list
    point_light: list
    records: list


def decoded(sample, diagonal):
    scale = 2.0 ** (sample.rgbe[3] - 136) if sample.rgbe[3] >= 10 else 0
    sample.radiance = tuple(m * scale for m in sample.rgbe[:3])
    sample.distance = struct.unpack("<e", struct.pack("<H", sample.half))[0] * diagonal / 1024
    return sample


def good_record(r):
    finite = [*r.position, *r.normal, *r.barycentric, r.footprint, r.expected_share, r.lit_share, r.radius, *r.irradiance, *r.rotational,
              *r.translational, r.further_share, r.birth_weight]
    shares = [*r.barycentric, r.footprint, r.expected_share, r.lit_share, r.further_share, r.birth_weight, *r.irradiance]
    return (all(map(math.isfinite, finite)) and abs(sum(x * x for x in r.normal) - 1) <= 2e-4 and min(shares) >= 0 and
            sum(r.barycentric) <= 1.0001 and r.rings >= 1 and r.sectors >= 3 and r.set <= 1 and r.fading <= 3 and r.radius > 0 and
            r.radius_unclamped >= 0 and r.clearance_reach > 0)


def good_sample(s, points):
    if s.age == 0:
        return False
    if not s.flags & VALID:
        return s.flags <= 2047 and s.rgbe == (0, 0, 0, 0) and s.half == 0 and s.anchor == NO_ANCHOR
    if s.flags & MISS:
        if s.half or s.flags & (DYNAMIC | NEAR | ANCHORED):
            return False
    elif not 0x0400 <= s.half < 0x7C00:
        return False
    return bool(s.flags & ANCHORED) == (s.anchor != NO_ANCHOR) and (s.anchor == NO_ANCHOR or s.anchor < points)


def read_radsamples(path, is_base=False):
    with open(path, "rb") as stream:
        data = stream.read()
    at = 0

    def take(size):
        nonlocal at
        if at + size > len(data):
            refuse(len(data), "truncated")
        at += size
        return data[at - size:at]

    fixed = take(16)
    found, major, minor, text_size = struct.unpack("<8sHHI", fixed)
    if found != MAGIC or major != 1 or text_size > 1 << 20:
        refuse(0, "not a file of this format, version 1")
    text = take(text_size)
    chain = take(4)
    if struct.unpack("<I", chain)[0] != zlib.crc32(fixed + text):
        refuse(at - 4, "wrong checksum of the header")
    header, history = parse_text(text, minor > 2, ["columns", "diagonal", "segment"],
                                 RULES | (BASE_RULES if minor >= 1 else {}) | (HIGH_RULES if minor >= 2 else {}))
    anchors = header["columns"] == "anchor"
    if anchors != ("points" in header):
        refuse(16, "points go with the column anchor")
    overlay = "base" in header
    if overlay != ("base-digest" in header) or (overlay and is_base):
        refuse(16, "base and base-digest go together, and a base has none")
    mark = take(4)

    def blocks(wanted, size):
        """The entries of all blocks of this mark: (offset, bytes of a block, number)."""
        nonlocal mark, chain
        while mark == wanted:
            count, crc = struct.unpack("<II", take(8))
            if count > 65536:
                refuse(at - 8, "count above its limit")
            start, body = at, take(count * size)
            if crc != zlib.crc32(body, zlib.crc32(wanted + struct.pack("<I", count))):
                refuse(start - 4, "wrong checksum of a block")
            chain += struct.pack("<I", crc)
            yield start, body, count
            mark = take(4)

    light = []
    for start, body, _ in blocks(b"RADP", POINT.size):
        light += POINT.iter_unpack(body)
    if any(not math.isfinite(x) or x < 0 for l in light for x in l) or (light and not anchors):
        refuse(0, "light of points out of range")
    records = []
    for start, body, _ in blocks(b"RADR", RECORD.size):
        for values in RECORD.iter_unpack(body):
            values, fields = list(values), []
            for name in FIELDS:
                n = COUNTS.get(name)
                fields.append(tuple(values[:n]) if n else values[0])
                del values[:n or 1]
            fields[-1] *= overlay       # reserved without a base
            records.append(Record(*fields, []))
            if not good_record(records[-1]):
                refuse(start, f"record out of range: {records[-1]}")
    wanted, samples = sum(r.rings * r.sectors for r in records if not r.kept_from), []
    for start, body, count in blocks(b"RADS", SAMPLE.size + anchors * ANCHOR.size):
        if len(samples) % 65536:
            refuse(start, "a block of samples before this one is not full")
        tail = body[count * SAMPLE.size:] if anchors else struct.pack("<I", NO_ANCHOR) * count
        for v, (anchor,) in zip(SAMPLE.iter_unpack(body[:count * SAMPLE.size]), ANCHOR.iter_unpack(tail)):
            samples.append(decoded(Sample(v[:4], v[4], v[5], anchor), float(header["diagonal"])))
            if not good_sample(samples[-1], len(light)):
                refuse(start, f"sample out of range: {samples[-1]}")
    if len(samples) != wanted:
        refuse(at, "not as many samples as the records have")
    if mark != b"END!":
        refuse(at - 4, "unknown mark")
    end = mark + take(END.size)
    if struct.unpack("<I", take(4))[0] != zlib.crc32(end, zlib.crc32(chain)):
        refuse(at - 4, "wrong chain")
    if at != len(data):
        refuse(at, "bytes after the end block")
    first = 0
    for r in records:
        if not r.kept_from:
            r.samples.extend(samples[first:first + r.rings * r.sectors])
            first += r.rings * r.sectors
    f = Radsamples(header, history, light, records)
    if END.unpack(end[4:]) != totals(f):
        refuse(at, "totals are not those of the file")
    if overlay:
        take_from_base(f, read_radsamples(os.path.join(os.path.dirname(path), header["base"]), True))
    return f


def take_from_base(f, base):
    """Section 6. The base's digest is not looked at: Python's own library has no XXH3."""
    same = ("columns", "points", "diagonal", "segment")
    if [f.header.get(k) for k in same] != [base.header.get(k) for k in same] or len(f.point_light) != len(base.point_light) or \
            ("high" in f.header) != ("high" in base.header):
        refuse(16, "the base is of other columns, points, diagonal or segment, or another part of the light")
    for r in f.records:
        if r.kept_from:
            there = base.records[r.kept_from - 1] if r.kept_from <= len(base.records) else None
            if not there or (there.rings, there.sectors) != (r.rings, r.sectors):
                refuse(16, "the base has no such record")
            r.samples.extend(there.samples)


def totals(f):
    own = sum(len(r.samples) for r in f.records if not r.kept_from)
    return (len(f.point_light), len(f.records), own, *exact_sums(r.irradiance for r in f.records))


def encode_radsamples(f):
    keys = ["columns", "origin", "diagonal", "segment", "points", "high", "base", "base-digest"] + IDENTITY
    text = "".join([f"{k}: {f.header[k]}\n" for k in keys if k in f.header] + [f"history: {line}\n" for line in f.history]).encode()
    head = struct.pack("<8sHHI", MAGIC, 1, 2 if "high" in f.header else int("base" in f.header), len(text)) + text
    chain = struct.pack("<I", zlib.crc32(head))
    out = [head, chain]

    def block(mark, count, body):
        nonlocal chain
        crc = struct.pack("<I", zlib.crc32(body, zlib.crc32(mark + struct.pack("<I", count))))
        chain += crc
        out.extend([mark, struct.pack("<I", count), crc, body])

    def flat(r):
        for name in FIELDS:
            value = getattr(r, name)
            yield from value if name in COUNTS else [value]

    for some in cut(f.point_light):
        block(b"RADP", len(some), b"".join(POINT.pack(*l) for l in some))
    for some in cut(f.records):
        block(b"RADR", len(some), b"".join(RECORD.pack(*flat(r)) for r in some))
    for some in cut([s for r in f.records if not r.kept_from for s in r.samples]):
        body = b"".join(SAMPLE.pack(*s.rgbe, s.half, s.flags) for s in some)
        if f.header["columns"] == "anchor":
            body += b"".join(ANCHOR.pack(s.anchor) for s in some)
        block(b"RADS", len(some), body)
    end = b"END!" + END.pack(*totals(f))
    return b"".join(out + [end, struct.pack("<I", zlib.crc32(end, zlib.crc32(chain)))])


def summary(f):
    t = totals(f)
    ages = collections.Counter(s.age for r in f.records for s in r.samples)
    samples = sum(ages.values())        # of an overlay: with those of its base
    return {"header": f.header, "history": f.history, "points": t[0], "records": t[1], "samples": samples, "irradiance": t[3:],
            "mean_age": sum(a * n for a, n in ages.items()) / max(1, samples),
            "radiance": math.fsum(s.radiance[1] for r in f.records for s in r.samples),
            "distance": math.fsum(s.distance for r in f.records for s in r.samples)}


if __name__ == "__main__":
    second_reader(__doc__, read_radsamples, summary, lambda path, file: save(path, encode_radsamples(file)))

#!/usr/bin/env python3
"""Read and write .photons files. Written from formats/photons/photons.md alone, to show that the text suffices.

    read_photons.py FILE            header and totals as JSON
    read_photons.py FILE COPY       also write it again

As a module: read_photons(path) -> Photons; write_photons(path, photons). A filter is a few lines:

    p = read_photons("in.photons")
    for block in p.blocks:
        block.records = b"".join(r for r in split(block.records) if RECORD.unpack(r)[KIND] == 1)
    write_photons("out.photons", p)

What it does not do: digests (they need XXH3), so the digest of an overlay's base is not checked.
"""
import dataclasses
import itertools
import json
import math
import os
import re
import struct
import sys
import zlib

MAGIC = b"\x89TPHOT\r\n"
RECORD = struct.Struct("<3f3f2HHBB")                    # section 4: position, flux, normal, object, kind, bounce
POSITION, FLUX, NORMAL, OBJECT, KIND, BOUNCE = 0, 3, 6, 8, 9, 10
ENTRY, DATED_ENTRY = struct.Struct("<I9d"), struct.Struct("<I9diQ")   # section 6
PILOT = struct.Struct("<3Qd")
END = struct.Struct("<4sQ12dI")                         # section 7
KINDS = ["direct", "caustic", "indirect", "volume", "tentative"]
COLUMNS = {"none": [], "direction": ["direction"], "albedo": ["albedo"], "direction,albedo": ["direction", "albedo"]}
HASHES = ["static-geometry", "moving-geometry", "materials", "lights", "media", "emission"]
REQUIRED = ["map", "kinds", "columns", "origin", "groups", "emitted"]
KEYS = REQUIRED[:2] + ["part"] + REQUIRED[2:] + ["frames"] + HASHES + ["majorants", "pilots", "base", "base-digest"]          # and history
SINCE = {"emission": 1, "part": 2, "majorants": 3, "pilots": 4}              # minor version; all others: 0


@dataclasses.dataclass
class Block:
    group: int
    records: bytes
    direction: bytes = b""
    albedo: bytes = b""


@dataclasses.dataclass
class Photons:
    header: dict            # key: text as in the file
    history: list           # lines
    blocks: list            # of Block, groups never descending
    ledger: list            # of (group, nine numbers), with tentative photons also frame, paths and the pilots' bytes; empty if the file has none
    emitted: tuple          # W, three channels
    escaped: tuple
    absorbed: tuple


def split(data, size=32):
    """The records (size 32) or column entries (size 4) one by one."""
    return (data[i:i + size] for i in range(0, len(data), size))


def refuse(offset, reason):
    raise ValueError(f"byte {offset}: {reason}")


def parse_text(text, minor):                                              # section 2
    header, history = {}, []
    if text and not text.endswith(b"\n"):
        refuse(16, "header line without LF")
    for line in text.split(b"\n")[:-1]:
        key, colon, value = line.decode("utf-8", "replace").partition(": ")
        if not colon or any(b < 32 or b == 127 for b in line):
            refuse(16, "header line is not 'key: value'")
        if key == "history":
            history.append(value)
        elif key in header:
            refuse(16, f"key twice: {key}")
        elif key in KEYS and minor >= SINCE.get(key, 0):
            header[key] = value
        elif minor <= 4:
            refuse(16, f"unknown key: {key}")
    for key in REQUIRED:
        if key not in header:
            refuse(16, f"key missing: {key}")
    check_header(header, minor)
    return header, history


def integers(text, count, low, high):
    good = re.fullmatch(" ".join([r"-?[0-9]+"] * count), text)
    values = [int(v) for v in text.split(" ")] if good else []
    return values if values and all(low <= v <= high for v in values) else None


def check_header(h, minor):
    number = r"-?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?"
    kinds = h["kinds"].split(",")
    frames = integers(h.get("frames", "0 0"), 2, -2**31, 2**31 - 1)
    rules = {
        "map": h["map"] in ("global", "static", "dynamic"),
        "kinds": all(k in KINDS for k in kinds) and len(set(kinds)) == len(kinds),
        "majorants": ("tentative" in kinds) == ("majorants" in h) and (minor >= 3 or "tentative" not in kinds) and
                     re.fullmatch("[0-9a-f]{32}", h.get("majorants", "0" * 32)),
        "pilots": "pilots" not in h or ("tentative" in kinds and integers(h["pilots"], 1, 1, 256)),
        "part": h.get("part", "low") in ("low", "high"),
        "columns": h["columns"] in COLUMNS,
        "origin": re.fullmatch(" ".join([number] * 3), h["origin"]) and
                  all(math.isfinite(float(x)) for x in h["origin"].split(" ")),
        "groups": integers(h["groups"], 1, 1, 2**24),
        "emitted": integers(h["emitted"], 1, 0, 2**64 - 1),
        "frames": frames and frames[0] <= frames[1] and ("frames" in h or not any(k in h for k in HASHES)),
        "base": ("base" in h) == ("base-digest" in h) and h.get("base", "x") not in ("", ".", "..") and
                "/" not in h.get("base", "x"),
        "base-digest": re.fullmatch("[0-9a-f]{32}", h.get("base-digest", "0" * 32)),
    }
    for key in HASHES:
        rules[key] = re.fullmatch("[!-~]{1,128}", h.get(key, "x"))
    for key, good in rules.items():
        if not good:
            refuse(16, f"bad value of {key}")


def check_records(records, kinds, signed, start):                         # section 4
    for i, v in enumerate(RECORD.iter_unpack(records)):
        flux = v[FLUX:NORMAL]
        if not (all(map(math.isfinite, v[:NORMAL])) and (signed or min(flux) >= 0) and max(v[NORMAL:OBJECT]) <= 65534
                and v[KIND] in kinds):
            refuse(start + 32 * i, f"photon out of range: {v}")


def check_fluxes(values, signed, offset):
    if not all(math.isfinite(v) and (signed or v >= 0) for v in values):
        refuse(offset, "flux is not finite or is negative")


def stored_flux(blocks):
    """Exact sums, rounded once, of the three channels."""
    records = [RECORD.iter_unpack(b.records) for b in blocks]
    flux = [v[FLUX:NORMAL] for v in itertools.chain.from_iterable(records)]
    return tuple(math.fsum(f[c] for f in flux) for c in range(3))


def column_sums(ledger):
    """The ledger's entries added in its order: nine sums. (Not sum(), which may compensate.)"""
    totals = [0.0] * 9
    for _, values, *_ in ledger:
        totals = [t + v for t, v in zip(totals, values)]
    return tuple(totals)


def parse_photons(stream):
    """One file as it stands."""
    offset = 0

    def take(size):
        nonlocal offset
        data = stream.read(size)
        if len(data) != size:
            refuse(offset + len(data), "truncated")
        offset += size
        return data

    def checksum(expected, *parts):
        crc = 0
        for part in parts:
            crc = zlib.crc32(part, crc)
        if crc != expected:
            refuse(offset, "wrong checksum")
        return struct.pack("<I", crc)

    fixed = take(16)                                                      # section 2
    magic, major, minor, text_size = struct.unpack("<8sHHI", fixed)
    if magic != MAGIC or major != 1 or text_size > 1 << 20:
        refuse(0, "not .photons version 1")
    text = take(text_size)
    chain = checksum(*struct.unpack("<I", take(4)), fixed, text)
    header, history = parse_text(text, minor)
    kinds = [KINDS.index(k) for k in header["kinds"].split(",")]
    signed, columns, groups = header["map"] == "dynamic", COLUMNS[header["columns"]], int(header["groups"])

    blocks, ledger = [], []
    while (mark := take(4)) == b"PHOT":                                   # section 3
        head = take(12)
        group, count, crc = struct.unpack("<III", head)
        if group >= groups or count > 65536 or (blocks and group < blocks[-1].group):
            refuse(offset, "bad head of a block")
        start = offset
        body = [take(32 * count)] + [take(4 * count) for _ in columns]
        chain += checksum(crc, mark, head[:8], *body)
        check_records(body[0], kinds, signed, start)
        block = Block(group, body[0], **dict(zip(columns, body[1:])))
        if any(code == 65535 for code, in struct.iter_unpack("<H", block.direction)):
            refuse(start, "direction above 65534")
        blocks.append(block)
    tentative = "tentative" in header["kinds"].split(",")
    pilots = int(header.get("pilots", 0))
    if mark == (b"LEDP" if pilots else b"LEDU" if tentative else b"LEDG"):                            # section 6
        head = take(8)
        count, crc = struct.unpack("<II", head)
        expected = sorted({b.group for b in blocks}) if "base" in header else range(groups)
        if count != len(expected):
            refuse(offset, "ledger of another size")
        entry = DATED_ENTRY if tentative else ENTRY
        size = entry.size + PILOT.size * pilots
        body = take(size * count)
        chain += checksum(crc, mark, head[:4], body)
        for one in split(body, size):
            v, more = entry.unpack(one[:entry.size]), one[entry.size:]
            if not all(math.isfinite(sketch) for *_, sketch in PILOT.iter_unpack(more)):
                refuse(offset, "a pilot's sum is not finite")
            ledger.append((v[0], v[1:10], *v[10:], *([more] if tentative else [])))
        if [e[0] for e in ledger] != list(expected):
            refuse(offset, "ledger of other groups")
        for _, values, *_ in ledger:
            check_fluxes(values, signed, offset)
        mark, had_ledger = take(4), True
    else:
        had_ledger = False
    if mark != b"END!":                                                   # section 7
        refuse(offset - 4, "unknown mark")
    end = mark + take(END.size - 4)
    values = END.unpack(end)
    checksum(values[-1], chain, end[:108])
    if values[1] != sum(len(b.records) // 32 for b in blocks) or values[2:5] != stored_flux(blocks):
        refuse(offset, "count or stored flux of the end block is wrong")
    check_fluxes(values[5:14], signed, offset)
    if had_ledger and column_sums(ledger) != values[5:14]:
        refuse(offset, "totals are not the ledger's")
    if ("base" in header or tentative) and not had_ledger:
        refuse(offset, "overlay or tentative photons without ledger")
    if stream.read(1):
        refuse(offset, "bytes after the end block")
    return Photons(header, history, blocks, ledger, values[5:8], values[8:11], values[11:14])


def read_photons(path):
    """A whole map; an overlay comes with its base's other groups in place."""
    with open(path, "rb") as stream:
        p = parse_photons(stream)
    if "base" not in p.header:
        return p
    with open(os.path.join(os.path.dirname(path), p.header["base"]), "rb") as stream:     # section 8
        base = parse_photons(stream)
    same = all(p.header[k] == base.header[k] for k in ("map", "columns", "groups"))
    same = same and all(p.header.get(k) == base.header.get(k) for k in ("majorants", "pilots"))
    same = same and set(p.header["kinds"].split(",")) == set(base.header["kinds"].split(","))
    same = same and [float(x) for x in p.header["origin"].split()] == [float(x) for x in base.header["origin"].split()]
    if "base" in base.header or not base.ledger or not same:
        refuse(0, "not a base of this overlay")
    held = {b.group for b in p.blocks}
    p.blocks = sorted(p.blocks + [b for b in base.blocks if b.group not in held], key=lambda b: b.group)
    p.blocks = [b for b in p.blocks if b.records]
    p.ledger = sorted(p.ledger + [e for e in base.ledger if e[0] not in held])
    sums = column_sums(p.ledger)
    p.emitted, p.escaped, p.absorbed = sums[0:3], sums[3:6], sums[6:9]
    del p.header["base"], p.header["base-digest"]
    return p


def encode_photons(p):
    """The bytes of a file."""
    lines = [f"{key}: {p.header[key]}\n" for key in KEYS if key in p.header] + [f"history: {h}\n" for h in p.history]
    text = "".join(lines).encode()
    head = struct.pack("<8sHHI", MAGIC, 1, max(SINCE.get(key, 0) for key in p.header), len(text)) + text
    crcs = struct.pack("<I", zlib.crc32(head))
    out = [head, crcs]
    for b in p.blocks:
        head = struct.pack("<4sII", b"PHOT", b.group, len(b.records) // 32)
        body = b.records + b.direction + b.albedo
        crc = struct.pack("<I", zlib.crc32(head + body))
        out += [head, crc, body]
        crcs += crc
    totals = p.emitted + p.escaped + p.absorbed
    if p.ledger or "base" in p.header:
        dated = "majorants" in p.header
        head = struct.pack("<4sI", b"LEDP" if "pilots" in p.header else b"LEDU" if dated else b"LEDG", len(p.ledger))
        body = b"".join(DATED_ENTRY.pack(group, *values, *more[:2]) + more[2] if dated else ENTRY.pack(group, *values)
                        for group, values, *more in p.ledger)
        crc = struct.pack("<I", zlib.crc32(head + body))
        out += [head, crc, body]
        crcs += crc
        totals = column_sums(p.ledger)
    end = struct.pack("<4sQ12d", b"END!", sum(len(b.records) // 32 for b in p.blocks), *stored_flux(p.blocks), *totals)
    out += [end, struct.pack("<I", zlib.crc32(end, zlib.crc32(crcs)))]
    return b"".join(out)


def write_photons(path, p):
    """Blocks must not exceed 65536 photons, nor their groups descend."""
    with open(path + ".tmp", "wb") as stream:
        stream.write(encode_photons(p))
    os.replace(path + ".tmp", path)


def summary(p):
    kinds = [0] * len(KINDS)
    for b in p.blocks:
        for v in RECORD.iter_unpack(b.records):
            kinds[v[KIND]] += 1
    return {"header": p.header, "history": p.history, "photons": sum(kinds), "photons_by_kind": dict(zip(KINDS, kinds)),
            "stored_flux": stored_flux(p.blocks), "emitted_flux": p.emitted, "escaped_flux": p.escaped,
            "absorbed_flux": p.absorbed}


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    try:
        photons = read_photons(sys.argv[1])
    except (ValueError, OSError) as error:
        print(f"{sys.argv[1]}: {error}", file=sys.stderr)
        sys.exit(2)
    print(json.dumps(summary(photons), indent=1))
    if len(sys.argv) == 3:
        write_photons(sys.argv[2], photons)

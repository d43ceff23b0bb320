#!/usr/bin/env python3
"""Make radsamples/{accept,refuse} in a folder: small files, each named for what is right or wrong with it.

    make_radsamples_files.py FOLDER          FOLDER is tests/formats

Checksums are right in every file whose name does not say otherwise, so that each is refused for its own reason.
"""
import copy
import os
import struct
import sys
import zlib

from read_radsamples import ANCHORED, DYNAMIC, MISS, NEAR, NO_ANCHOR, VALID, Radsamples, Record, Sample, encode_radsamples

folder = sys.argv[1]
NAN, INF = float("nan"), float("inf")


def record(samples, **other):
    values = dict(position=(1, 2, 3), normal=(0, 1, 0), key=0x0123456789ABCDEF, surface=4, triangle=5, barycentric=(0.25, 0.5), rings=1,
                  sectors=3, updates=2, object=7, set=0, fading=0, narrows_from=0, footprint=0.125, expected_share=0.75, lit_share=0.5,
                  radius=0.5, radius_unclamped=2, irradiance=(0.5, 0.25, 0.125), rotational=(1, 0, 0, 0, 2, 0, 0, 0, 3),
                  translational=(-1, 0, 0, 0, -2, 0, 0, 0, -3), clearance_reach=1, clearance=bytes(range(16)), further_share=0.25,
                  birth_weight=0, kept_from=0)
    return Record(**(values | other), samples=samples)


def samples():
    return [Sample((128, 64, 0, 128), 0x5800, 1 | VALID | ANCHORED, 1), Sample((200, 100, 50, 129), 0x5400, 3 | VALID | NEAR | DYNAMIC),
            Sample((0, 0, 0, 0), 0, 2 | VALID | MISS)]


GOOD = Radsamples({"columns": "anchor", "origin": "0 0 0", "diagonal": "8", "segment": "0 23", "points": "d4", "frames": "2 2",
                   "static-geometry": "a1", "materials": "b2", "lights": "c3"}, ["example"], [(1, 2, 3), (0.5, 0.25, 0)], [record(samples())])
BYTES = encode_radsamples(GOOD)


def save(where, data):
    data = data if isinstance(data, bytes) else encode_radsamples(data)
    path = os.path.join(folder, "radsamples", where + ".radsamples")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as stream:
        stream.write(data)


def changed(**values):
    f = copy.deepcopy(GOOD)
    f.header |= {key.replace("_", "-"): value for key, value in values.items()}
    return f


def with_record(**values):
    return Radsamples(GOOD.header, GOOD.history, GOOD.point_light, [record(samples(), **values)])


def with_sample(at, **values):
    f = copy.deepcopy(GOOD)
    for name, value in values.items():
        setattr(f.records[0].samples[at], name, value)
    return f


def pieces(data):
    """Header, the three blocks, end block."""
    at = 20 + struct.unpack_from("<I", data, 12)[0]
    out = [data[:at]]
    for size in (12, 200, 12):
        end = at + 12 + size * struct.unpack_from("<I", data, at + 4)[0]
        out.append(data[at:end])
        at = end
    return out + [data[at:]]


def rejoin(parts):
    """The file with its chain made right again."""
    chain = zlib.crc32(parts[0][-4:] + b"".join(b[8:12] for b in parts[1:-1]))
    end = parts[-1][:-4]
    return b"".join(parts[:-1]) + end + struct.pack("<I", zlib.crc32(end, chain))


def with_block(which, offset, value):
    parts = pieces(BYTES)
    block = parts[which][:offset] + value + parts[which][offset + len(value):]
    parts[which] = block[:8] + struct.pack("<I", zlib.crc32(block[12:], zlib.crc32(block[:8]))) + block[12:]
    return rejoin(parts)


def with_end(offset, value):
    parts = pieces(BYTES)
    parts[-1] = parts[-1][:offset] + value + parts[-1][offset + len(value):]
    return rejoin(parts)


def with_text(text, major=1, minor=0, magic=b"\x89TRADS\r\n"):
    head = struct.pack("<8sHHI", magic, major, minor, len(text)) + text
    return rejoin([head + struct.pack("<I", zlib.crc32(head))] + pieces(BYTES)[1:])


text = pieces(BYTES)[0][16:-4]
save("accept/worked-example", GOOD)
save("accept/later-minor-version-with-new-key", with_text(text + b"colour-of-ink: blue\n", minor=3))
save("accept/low-part", changed(high="e5"))
plain = copy.deepcopy(GOOD)
plain.header["columns"], plain.point_light = "none", []
del plain.header["points"]
for s in plain.records[0].samples:
    s.anchor, s.flags = NO_ANCHOR, s.flags & ~ANCHORED
save("accept/no-anchors", plain)
empty = copy.deepcopy(GOOD)
empty.records, empty.point_light = [], []
save("accept/no-records", empty)
nameless = copy.deepcopy(GOOD)
for key in ("frames", "static-geometry", "materials", "lights"):
    del nameless.header[key]
save("accept/no-identity", nameless)
save("accept/nothing-near", with_record(radius_unclamped=INF, clearance_reach=INF))
save("accept/fading-and-dynamic", with_record(fading=3, set=1, object=65535))
save("accept/invalid-sample", with_sample(2, flags=9))
save("accept/oldest-and-farthest", with_sample(0, flags=2047 | VALID | ANCHORED, half=0x7BFF))
two = copy.deepcopy(GOOD)
two.records.append(record(samples() * 4, rings=3, sectors=4, narrows_from=1))
save("accept/two-records", two)
save("accept/reserved-not-zero", with_block(2, 12 + 196, b"\x09"))


# Overlays of the worked example, whose digest is on the page: its record as it was, moved, or beside another.
BASE = {"base": "worked-example.radsamples", "base-digest": "aa4789669a6a7579ec3021a5e46ea29b"}


def overlay(*records, **header):
    f = copy.deepcopy(GOOD)
    f.header |= BASE | {"frames": "3 3"} | {key.replace("_", "-"): value for key, value in header.items()}
    f.records = list(records)
    return f


KEPT, OWN = record([], kept_from=1), record(samples() * 4, rings=3, sectors=4)
save("accept/overlay", overlay(record([], kept_from=1, narrows_from=1), OWN))
save("accept/overlay-of-which-nothing-is-kept", overlay(OWN))
save("accept/overlay-all-kept-twice", overlay(KEPT, KEPT))
save("refuse/overlay-of-itself", overlay(KEPT, base="overlay-of-itself.radsamples"))
save("refuse/overlay-base-missing", overlay(KEPT))
save("refuse/overlay-base-in-a-folder", overlay(KEPT, base="../accept/worked-example.radsamples"))
save("refuse/overlay-base-is-the-folder", overlay(KEPT, base="."))
save("refuse/overlay-digest-short", overlay(KEPT, base_digest="aa47"))
as_bytes = encode_radsamples(overlay(KEPT))
overlay_text = as_bytes[16:16 + struct.unpack_from("<I", as_bytes, 12)[0]]
save("refuse/overlay-without-digest", with_text(overlay_text.replace(b"base-digest: " + BASE["base-digest"].encode() + b"\n", b""), minor=1))
save("refuse/overlay-without-base", with_text(overlay_text.replace(b"base: worked-example.radsamples\n", b""), minor=1))
save("refuse/overlay-in-version-1.0", with_text(overlay_text))
low_as_bytes = encode_radsamples(changed(high="e5"))
low_text = low_as_bytes[16:16 + struct.unpack_from("<I", low_as_bytes, 12)[0]]
save("refuse/header-high-in-version-1.1", with_text(low_text, minor=1))
save("refuse/header-high-empty", changed(high=""))
save("refuse/header-high-with-space", changed(high="e 5"))

for name, bad in {"magic": with_text(text, magic=b"\x89TRADX\r\n"), "major-version-2": with_text(text, major=2),
                  "header-key-unknown": with_text(text + b"colour-of-ink: blue\n"),
                  "header-key-missing": with_text(text.replace(b"diagonal: 8\n", b"")),
                  "header-checksum": BYTES.replace(b"diagonal: 8", b"diagonal: 9"), "copied-as-text": BYTES.replace(b"\r\n", b"\n", 1),
                  "empty-file": b"", "ends-inside-header": BYTES[:40], "no-end-block": b"".join(pieces(BYTES)[:-1]),
                  "ends-inside-end-block": BYTES[:-1], "bytes-after-end": BYTES + b"\0", "two-files-in-one": BYTES + BYTES}.items():
    save("refuse/" + name, bad)
for name, values in {"columns-unknown": {"columns": "albedo"}, "diagonal-zero": {"diagonal": "0"}, "diagonal-nan": {"diagonal": "nan"},
                     "segment-backwards": {"segment": "3 2"}, "segment-of-one": {"segment": "3"}, "points-empty": {"points": ""},
                     "points-with-space": {"points": "a b"}, "origin-nan": {"origin": "0 nan 0"}}.items():
    save("refuse/header-" + name, changed(**values))
save("refuse/header-anchor-without-points", with_text(text.replace(b"points: d4\n", b"")))
save("refuse/header-points-without-anchor", with_text(text.replace(b"columns: anchor", b"columns: none")))

parts = pieces(BYTES)
save("refuse/block-mark-unknown", with_block(3, 0, b"RADX"))
save("refuse/block-count-above-limit", with_block(3, 4, struct.pack("<I", 65537)))
save("refuse/block-count-beyond-end", with_block(3, 4, struct.pack("<I", 65536)))
save("refuse/block-checksum", rejoin([parts[0], parts[1][:-1] + b"\x01", *parts[2:]]))
save("refuse/block-lost", b"".join(parts[:2] + parts[3:]))
save("refuse/blocks-in-another-order", rejoin([parts[0], parts[2], parts[1], *parts[3:]]))
save("refuse/samples-lost", rejoin(parts[:3] + parts[4:]))
save("refuse/samples-twice", rejoin(parts[:3] + [parts[3], parts[3]] + parts[4:]))
save("refuse/end-count", with_end(12, struct.pack("<Q", 2)))
save("refuse/end-sum", with_end(28, struct.pack("<d", 0.1)))
save("refuse/point-light-negative", with_block(1, 12, struct.pack("<f", -1)))
save("refuse/point-light-nan", with_block(1, 16, struct.pack("<f", NAN)))
for name, values in {"position-nan": {"position": (0, NAN, 0)}, "normal-long": {"normal": (0, 2, 0)},
                     "place-outside-triangle": {"barycentric": (0.75, 0.5)}, "place-negative": {"barycentric": (-0.25, 0.5)},
                     "no-rings": {"rings": 0}, "sectors-more-than-samples": {"sectors": 4}, "sectors-fewer-than-samples": {"rings": 1, "sectors": 2},
                     "set-2": {"set": 2}, "fading-4": {"fading": 4}, "footprint-negative": {"footprint": -1}, "share-nan": {"lit_share": NAN},
                     "radius-zero": {"radius": 0}, "radius-unclamped-nan": {"radius_unclamped": NAN}, "irradiance-negative": {"irradiance": (0, -1, 0)},
                     "gradient-infinite": {"rotational": (INF,) + (0,) * 8}, "clearance-zero": {"clearance_reach": 0},
                     "birth-weight-negative": {"birth_weight": -1}}.items():
    save("refuse/record-" + name, with_record(**values))
for name, (at, values) in {"age-zero": (0, {"flags": VALID | ANCHORED}), "invalid-with-light": (2, {"flags": 2, "rgbe": (1, 0, 0, 128)}),
                           "invalid-with-flags": (2, {"flags": 2 | MISS}), "miss-with-distance": (2, {"half": 0x5800}),
                           "miss-that-moves": (2, {"flags": 2 | VALID | MISS | DYNAMIC}), "distance-infinite": (0, {"half": 0x7C00}),
                           "distance-nan": (0, {"half": 0x7E00}), "distance-negative": (0, {"half": 0xD800}),
                           "distance-subnormal": (0, {"half": 0x0001}), "hit-without-distance": (0, {"half": 0}),
                           "anchor-without-flag": (1, {"anchor": 0}), "flag-without-anchor": (0, {"anchor": NO_ANCHOR}),
                           "anchor-beyond-points": (0, {"anchor": 2})}.items():
    save("refuse/sample-" + name, with_sample(at, **values))

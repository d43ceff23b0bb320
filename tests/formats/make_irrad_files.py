#!/usr/bin/env python3
"""Make {irradpoints,irradcache,paths}/{accept,refuse} in a folder: small files, each named for what is right or wrong with it.

    make_irrad_files.py FOLDER          FOLDER is tests/formats

Checksums are right in every file whose name does not say otherwise, so that each is refused for its own reason.
"""
import copy
import os
import struct
import sys
import zlib

import containers
import read_irradcache as cache
import read_irradpoints as points
import read_paths as paths
from read_irradcache import Irradcache, Record
from read_irradpoints import Irradpoints, Point

folder = sys.argv[1]
NAN, INF = float("nan"), float("inf")
IDENTITY = {"frames": "0 23", "static-geometry": "a1", "materials": "b2", "lights": "c3"}


class Maker:
    """Files of one format, from a good one."""

    def __init__(self, name, encode, good):
        self.name, self.encode, self.good = name, encode, good
        self.bytes = encode(good)
        self.mark = {"irradcache": cache, "irradpoints": points, "paths": paths}[name].MARK

    def save(self, where, data):
        data = data if isinstance(data, bytes) else self.encode(data)
        path = os.path.join(folder, self.name, where + "." + self.name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as stream:
            stream.write(data)

    def pieces(self, data):
        """Header, blocks, end block."""
        at = 20 + struct.unpack_from("<I", data, 12)[0]
        out = [data[:at]]
        while (next_mark := min((i for i in (data.find(self.mark, at + 4), data.find(b"END!", at)) if i > 0))) != at:
            out.append(data[at:next_mark])
            at = next_mark
        return out + [data[at:]]

    def rejoin(self, parts):
        """The file with its chain made right again."""
        crcs = parts[0][-4:] + b"".join(b[8:12] for b in parts[1:-1])
        end = parts[-1][:-4]
        return b"".join(parts[:-1]) + end + struct.pack("<I", zlib.crc32(end, zlib.crc32(crcs)))

    def with_block(self, offset, value, data=None):
        """The first block changed and its crc made right."""
        parts = self.pieces(data or self.bytes)
        block = parts[1][:offset] + value + parts[1][offset + len(value):]
        crc = struct.pack("<I", zlib.crc32(block[:8] + block[12:]))
        return self.rejoin([parts[0], block[:8] + crc + block[12:]] + parts[2:])

    def with_end(self, offset, value):
        parts = self.pieces(self.bytes)
        parts[-1] = parts[-1][:offset] + value + parts[-1][offset + len(value):]
        return self.rejoin(parts)

    def with_text(self, text, magic=None, major=1, minor=0, size=None):
        parts = self.pieces(self.bytes)
        head = struct.pack("<8sHHI", magic or parts[0][:8], major, minor, len(text) if size is None else size) + text
        return self.rejoin([head + struct.pack("<I", zlib.crc32(head))] + parts[1:])

    def with_header(self, **values):
        p = copy.deepcopy(self.good)
        p.header |= {key.replace("_", "-"): value for key, value in values.items()}
        return p

    def common(self):
        """What is alike in both formats."""
        text = self.pieces(self.bytes)[0][16:-4]
        no_identity = copy.deepcopy(self.good)
        for key in containers.IDENTITY:
            no_identity.header.pop(key, None)
        self.save("refuse/no-identity" if self.name == "paths" else "accept/no-identity", no_identity)
        no_history = copy.deepcopy(self.good)
        no_history.history = []
        self.save("accept/no-history", no_history)
        self.save("accept/origin-far-away", self.with_header(origin="1e+06 -0.5 12345.678901"))
        self.save("accept/later-minor-version-with-new-key", self.with_text(text + b"colour-of-ink: blue\n", minor=7))
        parts = self.pieces(self.bytes)
        empty = self.mark + struct.pack("<I", 0)
        empty += struct.pack("<I", zlib.crc32(empty))
        self.save("accept/empty-block", self.rejoin([parts[0], empty, parts[1], parts[2]]))

        self.save("refuse/magic", self.with_text(text, magic=b"\x89TIRRX\r\n"))
        self.save("refuse/magic-of-photons", self.with_text(text, magic=b"\x89TPHOT\r\n"))
        self.save("refuse/copied-as-text", self.bytes.replace(b"\r\n", b"\n", 1))
        self.save("refuse/major-version-2", self.with_text(text, major=2))
        self.save("refuse/header-size-above-limit", self.with_text(text, size=2**20 + 1))
        self.save("refuse/header-size-beyond-end", self.with_text(text, size=2**19))
        self.save("refuse/header-checksum", self.bytes.replace(b"origin: 0", b"origin: 1"))
        self.save("refuse/header-key-unknown", self.with_text(text + b"colour-of-ink: blue\n"))
        self.save("refuse/header-key-missing", self.with_text(text.replace(b"origin: 0 0 0\n", b"")))
        self.save("refuse/header-key-twice", self.with_text(text + b"origin: 0 0 0\n"))
        self.save("refuse/header-line-without-colon", self.with_text(text + b"points\n"))
        self.save("refuse/header-last-line-without-lf", self.with_text(text + b"history: x"))
        self.save("refuse/header-control-character", self.with_text(text + b"history: \x1b[2J\n"))
        self.save("refuse/header-hashes-without-frames", self.with_text(text.replace(b"frames: 0 23\n", b"")))
        self.headers({"origin-of-two-numbers": {"origin": "0 0"}, "origin-nan": {"origin": "0 nan 0"},
                      "origin-infinite": {"origin": "0 1e999 0"}, "frames-backwards": {"frames": "3 2"},
                      "hash-empty": {"lights": ""}, "hash-with-space": {"lights": "c 3"}})

        self.save("refuse/block-mark-unknown", self.with_block(0, b"PHOX"))
        self.save("refuse/block-count-above-limit", self.with_block(4, struct.pack("<I", 65537)))
        self.save("refuse/block-count-beyond-end", self.with_block(4, struct.pack("<I", 65536)))
        flipped = bytearray(parts[1])
        flipped[12] ^= 1
        self.save("refuse/block-checksum", self.rejoin([parts[0], bytes(flipped), parts[2]]))
        self.save("refuse/block-lost", parts[0] + parts[2])
        self.save("refuse/block-twice", parts[0] + parts[1] + parts[1] + parts[2])
        self.save("refuse/empty-file", b"")
        self.save("refuse/ends-inside-magic", self.bytes[:5])
        self.save("refuse/ends-inside-header", self.bytes[:40])
        self.save("refuse/ends-inside-block-head", parts[0] + parts[1][:6])
        self.save("refuse/ends-inside-block", parts[0] + parts[1][:-1])
        self.save("refuse/no-end-block", parts[0] + parts[1])
        self.save("refuse/ends-inside-end-block", self.bytes[:-1])
        self.save("refuse/bytes-after-end", self.bytes + b"\0")
        self.save("refuse/two-files-in-one", self.bytes + self.bytes)
        self.save("refuse/end-count", self.with_end(4, struct.pack("<Q", 99)))
        self.save("refuse/end-sum", self.with_end(12, struct.pack("<d", 0.1)))
        self.save("refuse/end-sum-nan", self.with_end(12, struct.pack("<d", NAN)))
        self.save("refuse/end-checksum", self.bytes[:-1] + bytes([self.bytes[-1] ^ 1]))

    def headers(self, cases):
        for name, values in cases.items():
            self.save("refuse/header-" + name, self.with_header(**values))

    def records(self, cases, offsets, where="refuse/"):
        """The last record of the file with a field changed."""
        for name, (field, layout, *values) in cases.items():
            self.save(where + name, self.with_block(12 + offsets[field], struct.pack(layout, *values)))


def make_points():
    good = Irradpoints({"kinds": "direct,indirect", "origin": "0 0 0", "spacing": "0.05", "emitted": "1000"} | IDENTITY,
                       ["example"],
                       [Point((1, 2, 3), (32767, 65534), 7, 0, 0.125, {"direct": (0.5, 0.25, 0.125), "indirect": (2, 1, 0.5)}),
                        Point((-1, 0, 0.5), (0, 32767), 8, 1, 0, {"direct": (0, 0, 0), "indirect": (0.25, 0.25, 0.25)})])
    m = Maker("irradpoints", points.encode_irradpoints, good)
    m.common()
    m.save("accept/worked-example", good)
    for kinds in ("direct", "caustic,indirect", "direct,caustic,indirect"):
        p = m.with_header(kinds=kinds)
        for i, q in enumerate(p.points):
            q.irradiance = {kind: (i + 0.5, 3 * i, 1e-3) for kind in kinds.split(",")}
        m.save("accept/kinds-" + kinds.replace(",", "-"), p)
    for part in ("low", "high"):
        m.save("accept/part-" + part, m.with_header(part=part))
    noisy = m.with_header(columns="noise")
    noisy.points[0].noise, noisy.points[1].noise = (0.25, -0.5, 0), (-1e-3, 0, 2)
    m.save("accept/columns-noise", noisy)
    noisy.points[1].noise = (0, NAN, 0)
    m.save("refuse/noise-nan", noisy)
    m.headers({"columns-unknown": {"columns": "influence"}, "columns-none": {"columns": "none"}})
    m.headers({"part-unknown": {"part": "middle"}, "part-empty": {"part": ""}})
    text = m.pieces(m.bytes)[0][16:-4]
    m.save("refuse/header-part-of-a-later-version", m.with_text(text + b"part: low\n"))
    m.save("refuse/header-columns-of-a-later-version", m.with_text(text + b"columns: noise\n", minor=1))
    m.save("refuse/header-key-unknown-1.2", m.with_text(text + b"colour-of-ink: blue\n", minor=2))
    empty = copy.deepcopy(good)
    empty.points = []
    m.save("accept/no-points", empty)
    wide = copy.deepcopy(good)
    wide.points = [Point((0, 0, 0), (0, 0), 0, 0, 0, {"direct": (2.0**e, 2.0**-e, 3.0), "indirect": (2.0**-149, -0.0, 0)})
                   for e in range(-127, 128, 2)]
    m.save("accept/irradiance-from-tiny-to-huge", wide)
    for name, kinds in (("unknown", b"direct,purple"), ("empty", b""), ("twice", b"direct,direct"),
                        ("in-other-order", b"indirect,direct"), ("volume", b"direct,volume")):
        text = m.pieces(m.bytes)[0][16:-4].replace(b"kinds: direct,indirect", b"kinds: " + kinds)
        m.save("refuse/header-kinds-" + name, m.with_text(text))
    text = m.pieces(m.bytes)[0][16:-4].replace(b"direct,indirect", b"direct")
    m.save("refuse/columns-fewer", m.with_text(text))
    m.headers({"spacing-zero": {"spacing": "0"}, "spacing-negative": {"spacing": "-1"}, "spacing-nan": {"spacing": "nan"},
               "emitted-above-64-bits": {"emitted": "18446744073709551616"}, "emitted-not-a-number": {"emitted": "4 "}})
    m.records({"reserved-not-zero": ("reserved", "<B", 9)}, {"reserved": 19}, "accept/")
    offsets = {"position": 0, "normal": 12, "set": 18, "radius": 20, "direct": 48, "indirect": 72}
    m.records({"position-nan": ("position", "<f", NAN), "position-infinite": ("position", "<f", -INF),
               "normal-above-65534": ("normal", "<H", 65535), "set-2": ("set", "<B", 2),
               "radius-negative": ("radius", "<f", -1e-3), "radius-nan": ("radius", "<f", NAN),
               "irradiance-negative": ("direct", "<f", -0.5), "irradiance-negative-and-denormal": ("direct", "<f", -1e-45),
               "irradiance-nan": ("indirect", "<f", NAN), "irradiance-infinite": ("indirect", "<f", INF)}, offsets)


def make_cache():
    record = Record((1, 2, 3), (0, 1, 0), 7, 0, (0.5, 0.25, 0.125), (1, 0, 0, 0, 2, 0, 0, 0, 3),
                    (-1, 0, 0, 0, -2, 0, 0, 0, -3), 0.5, 2)
    good = Irradcache({"columns": "none", "origin": "0 0 0", "rays": "512", "error-bound": "0.25", "radii": "0.01 1.5",
                       "placed": "0 23 30 30"} | IDENTITY, ["example"], [record])
    m = Maker("irradcache", cache.encode_irradcache, good)
    m.common()
    m.save("accept/worked-example", good)
    for columns in ("influence", "update", "influence,update", "clearance", "influence,update,clearance", "noise",
                    "influence,update,clearance,noise"):
        c = m.with_header(columns=columns)
        c.records[0].influence, c.records[0].update = 0.75, (0.5, -0.25, 1)
        c.records[0].clearance = (0.515625, *range(0, 240, 16), 255)
        c.records[0].noise = (0.5, -0.25, 0)
        m.save("accept/columns-" + columns.replace(",", "-"), c)
    empty = copy.deepcopy(good)
    empty.records = []
    m.save("accept/no-records", empty)
    dynamic = copy.deepcopy(good)
    dynamic.records = [record, dataclass_with(record, set=1), dataclass_with(record, object=65535)]
    m.save("accept/both-sets", dynamic)
    unknown = copy.deepcopy(good)
    for key in ("rays", "error-bound", "radii", "placed"):
        del unknown.header[key]
    m.save("accept/gathering-not-known", unknown)
    m.save("accept/least-cosine", m.with_header(least_cosine="0.985"))
    m.save("accept/least-cosine-zero", m.with_header(least_cosine="0"))
    m.headers({f"least-cosine-{name}": {"least-cosine": value}
               for name, value in {"one": "1", "negative": "-0.5", "nan": "nan", "empty": "", "two": "0.9 0.9"}.items()})
    apart = m.with_header(lamps_apart="0.125", columns="apart")
    m.save("accept/lamps-apart", apart)
    apart.header["columns"] = "clearance,noise,apart"
    apart.records[0].clearance, apart.records[0].noise = (0.515625, *range(0, 240, 16), 255), (0.5, -0.25, 0)
    m.save("accept/lamps-apart-with-columns", apart)
    m.headers({f"lamps-apart-{name}": {"lamps-apart": value, "columns": "apart"}
               for name, value in {"zero": "0", "negative": "-0.5", "infinite": "inf", "empty": ""}.items()})
    text = m.pieces(m.bytes)[0][16:-4]
    m.save("refuse/header-key-of-a-later-version", m.with_text(text + b"least-cosine: 0.985\n"))
    m.save("refuse/header-key-unknown-1.1", m.with_text(text + b"colour-of-ink: blue\n", minor=1))
    for key, old, cases in (
            ("columns", "none", {"unknown": "albedo", "empty": "", "in-other-order": "update,influence"}),
            ("rays", "512", {"zero": "0", "above-32-bits": "4294967296"}),
            ("error-bound", "0.25", {"zero": "0", "infinite": "inf"}),
            ("radii", "0.01 1.5", {"one": "1", "backwards": "2 1", "negative": "-1 1", "zero": "0 0"}),
            ("placed", "0 23 30 30", {"odd": "0 23 30", "backwards": "3 2", "overlapping": "0 23 23 30",
                                      "touching": "0 23 24 30", "empty": "", "two-spaces": "0  23"})):
        for name, value in cases.items():
            changed = text.replace(f"{key}: {old}\n".encode(), f"{key}: {value}\n".encode())
            m.save(f"refuse/header-{key}-{name}", m.with_text(changed))
    m.save("refuse/columns-missing", m.with_text(text.replace(b"columns: none", b"columns: influence")))
    m.records({"reserved-not-zero": ("reserved", "<B", 9), "radius-unclamped-infinite": ("unclamped", "<f", INF),
               "radius-unclamped-zero": ("unclamped", "<f", 0)}, {"reserved": 27, "unclamped": 116}, "accept/")
    offsets = {"position": 0, "normal": 16, "set": 26, "irradiance": 36, "rotational": 40, "translational": 108,
               "radius": 112, "unclamped": 116}
    m.records({"position-nan": ("position", "<f", NAN), "position-infinite": ("position", "<f", -INF),
               "normal-not-of-length-1": ("normal", "<f", 1.001), "normal-nan": ("normal", "<f", NAN), "set-2": ("set", "<B", 2),
               "irradiance-negative": ("irradiance", "<f", -0.125), "irradiance-negative-and-denormal": ("irradiance", "<f", -1e-45),
               "irradiance-nan": ("irradiance", "<f", NAN), "irradiance-infinite": ("irradiance", "<f", INF),
               "rotational-nan": ("rotational", "<f", NAN), "translational-infinite": ("translational", "<f", INF),
               "radius-zero": ("radius", "<f", 0), "radius-negative": ("radius", "<f", -1), "radius-infinite": ("radius", "<f", INF),
               "radius-unclamped-nan": ("unclamped", "<f", NAN), "radius-unclamped-minus-infinite": ("unclamped", "<f", -INF)},
              offsets)
    columns = m.with_header(columns="influence,update")
    columns.records = [dataclass_with(record, influence=1, update=(1, 1, 1))]
    data = cache.encode_irradcache(columns)
    m.save("refuse/influence-negative", m.with_block(12 + 120, struct.pack("<f", -1), data))
    cleared = m.with_header(columns="clearance")
    for name, reach in (("zero", 0), ("negative", -1), ("nan", NAN)):
        cleared.records = [dataclass_with(record, clearance=(reach, *[0] * 16))]
        m.save("refuse/clearance-reach-" + name, cache.encode_irradcache(cleared))
    m.save("refuse/clearance-before-1.2", m.with_text(text.replace(b"columns: none", b"columns: clearance"), minor=1))
    m.save("refuse/apart-before-1.4",
           m.with_text(text.replace(b"columns: none", b"columns: apart") + b"lamps-apart: 0.125\n", minor=3))
    m.save("refuse/apart-without-lamps-apart", m.with_text(text.replace(b"columns: none", b"columns: apart"), minor=4))
    m.save("refuse/lamps-apart-without-apart", m.with_text(text + b"lamps-apart: 0.125\n", minor=4))
    m.save("refuse/noise-before-1.3", m.with_text(text.replace(b"columns: none", b"columns: noise"), minor=2))
    noisy = m.with_header(columns="noise")
    noisy.records = [dataclass_with(record, noise=(0, NAN, 0))]
    m.save("refuse/noise-nan", cache.encode_irradcache(noisy))
    m.save("refuse/update-nan", m.with_block(12 + 124, struct.pack("<f", NAN), data))


def make_paths():
    good = paths.Paths({"kinds": "direct,indirect", "origin": "0 0 0", "groups": "2", "emitted": "8", "seed": "3",
                        "movers": "a1 b2 c3", "emission": "d4"} | IDENTITY, ["example"], [(4, 1), (1, 6), (7, 4)])
    m = Maker("paths", paths.encode_paths, good)
    m.common()
    m.save("accept/worked-example", good)
    empty = copy.deepcopy(good)
    empty.paths = []
    m.save("accept/no-paths", empty)
    wide = m.with_header(movers=" ".join(f"m{i}" for i in range(64)), frames="0 63", emitted=str(2**64 - 1))
    wide.paths = [(0, 2**63), (2**64 - 4, 2**64 - 1), (1, 1)]
    m.save("accept/64-intervals", wide)
    m.headers({"kinds-in-other-order": {"kinds": "indirect,direct"}, "groups-zero": {"groups": "0"},
               "groups-above-limit": {"groups": "16777217"}, "seed-negative": {"seed": "-1"}, "movers-empty": {"movers": ""},
               "movers-two-spaces": {"movers": "a1  b2"}, "movers-65": {"movers": " ".join(["a"] * 65), "frames": "0 99"},
               "movers-more-than-frames": {"frames": "0 1"}, "emission-empty": {"emission": ""}})
    m.records({"path-not-below-emitted": ("path", "<Q", 9), "path-of-an-earlier-group": ("path", "<Q", 6),
               "path-twice": ("path", "<Q", 1), "intervals-none": ("intervals", "<Q", 0),
               "intervals-beyond-movers": ("intervals", "<Q", 8)}, {"path": 32, "intervals": 40})


def dataclass_with(record, **values):
    record = copy.deepcopy(record)
    for key, value in values.items():
        setattr(record, key, value)
    return record


make_points()
make_cache()
make_paths()

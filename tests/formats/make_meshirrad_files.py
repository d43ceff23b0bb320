#!/usr/bin/env python3
"""Make tests/formats/meshirrad/{accept,refuse}: small .meshirrad files, each named for what is right or wrong with it.

    make_meshirrad_files.py FOLDER          FOLDER is tests/formats/meshirrad

Checksums are right in every file whose name does not say otherwise.
"""
import os
import struct
import sys
import zlib

from containers import damages, encode_container
from read_meshirrad import END, KEYS, MAGIC, MARK, RECORD

folder = sys.argv[1]
HEADER = {"kinds": "indirect", "origin": "0 0 0", "cell": "0.5", "unit": "0.25", "filter": "none", "frames": "3 3", "static-geometry": "a1"}


def element(surface=2, triangle=5, cell=0, cuts=1, side=0, position=(1, 2, 3), normal=(32767, 65534), area=0.5, photons=3, sums=(4, 2, 1),
            irradiance=(2, 1, 0.5), number=7, before=0, after=0):
    return surface, triangle, cell, cuts, side, *position, *normal, area, photons, *sums, *irradiance, number, before, after


FRONT, BACK = element(), element(side=1, normal=(32767, 32767), photons=0, sums=(0, 0, 0), irradiance=(0, 0, 0))
FOUR = [element(surface=3, triangle=0, cell=c, cuts=2, area=0.125) for c in range(4)]


def encoded(elements=(FRONT, BACK), end=None, magic=MAGIC, mark=MARK, minor=0, **header):
    values = {k: v for k, v in (HEADER | {k.replace("_", "-"): v for k, v in header.items()}).items() if v is not None}
    blocks = [(len(elements), [b"".join(RECORD.pack(*e) for e in elements)])] if elements else []
    end = (len(elements), sum(e[11] for e in elements)) if end is None else end
    return encode_container(magic, mark, KEYS + [k for k in values if k not in KEYS and k not in ("frames", "static-geometry")], values, ["example"],
                            blocks, struct.pack(END, *end), minor)


def save(name, data):
    path = os.path.join(folder, name + ".meshirrad")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as stream:
        stream.write(data)


def with_text(change):
    """GOOD with another header text, checksums right."""
    size, = struct.unpack_from("<I", GOOD, 12)
    text = change(GOOD[16:16 + size])
    head = struct.pack("<8sHHI", MAGIC, 1, 0, len(text)) + text
    rest, crc = GOOD[20 + size:], struct.pack("<I", zlib.crc32(head))
    end = rest[-24:-4]
    return head + crc + rest[:-4] + struct.pack("<I", zlib.crc32(end, zlib.crc32(crc + rest[8:12])))


GOOD = encoded()
INF, NAN = float("inf"), float("nan")
save("accept/worked-example", GOOD)
save("accept/nothing", encoded(()))
save("accept/cells-of-a-triangle", encoded([FRONT, BACK, *FOUR]))
save("accept/bilateral", encoded(filter="bilateral 0.25", kinds="direct,caustic,indirect"))
COUNTED, WINDOW = element(irradiance=(7.5, 0, 0)), element(before=3, after=16)
save("accept/counts", encoded([COUNTED, BACK], minor=1, holds="counts"))
save("accept/counts-after-a-jump", encoded([COUNTED, BACK], minor=1, holds="counts", jump="yes"))
save("accept/windows", encoded([WINDOW, BACK], minor=1, holds="windows", filter="gaussian 0.25"))
save("refuse/counts-with-windows", encoded([WINDOW, BACK], minor=1, holds="counts"))
save("refuse/header-counts-with-filter", encoded([COUNTED, BACK], minor=1, holds="counts", filter="box 1"))
save("refuse/header-holds-unknown", encoded(minor=1, holds="photons"))
save("refuse/header-holds-in-version-1.0", encoded(holds="counts"))
save("refuse/header-jump-without-counts", encoded([WINDOW, BACK], minor=1, holds="windows", jump="yes"))
save("refuse/header-jump-no", encoded(minor=1, holds="counts", jump="no"))
save("accept/no-identity", encoded(frames=None, static_geometry=None))
save("accept/later-minor-version-with-new-key", encoded(minor=7, colour_of_ink="blue"))
for name, values in {"kinds-volume": {"kinds": "volume"}, "kinds-in-other-order": {"kinds": "indirect,direct"}, "cell-zero": {"cell": "0"},
                     "cell-infinite": {"cell": "inf"}, "unit-negative": {"unit": "-1"}, "unit-nan": {"unit": "nan"}, "filter-unknown": {"filter": "median 1"},
                     "filter-without-width": {"filter": "box"}, "filter-of-two-widths": {"filter": "box 1 2"}, "key-missing": {"unit": None},
                     "key-unknown": {"colour_of_ink": "blue"}, "hashes-without-frames": {"frames": None}, "frames-backwards": {"frames": "3 2"}}.items():
    save("refuse/header-" + name, encoded(**values))
save("refuse/header-line-without-colon", with_text(lambda t: t + b"elements\n"))
save("refuse/header-control-character", with_text(lambda t: t + b"history: \x1b[2J\n"))
save("refuse/header-key-twice", with_text(lambda t: t + b"cell: 0.5\n"))
save("refuse/header-checksum", GOOD.replace(b"cell: 0.5", b"cell: 0.6"))
for name, values in {"cuts-zero": {"cuts": 0}, "cuts-above-limit": {"cuts": 1025}, "side-2": {"side": 2}, "position-nan": {"position": (1, NAN, 3)},
                     "normal-above-65534": {"normal": (0, 65535)}, "area-negative": {"area": -1}, "area-infinite": {"area": INF},
                     "irradiance-negative": {"irradiance": (1, -1, 1)}, "irradiance-nan": {"irradiance": (1, 1, NAN)}, "sum-negative": {"sums": (1, -1, 1)},
                     "frames-before-in-light-of-a-frame": {"before": 1}, "first-cell-is-not-0": {"cell": 1, "cuts": 2}}.items():
    save("refuse/" + name, encoded([element(**values)]))
save("refuse/cells-missing", encoded(FOUR[:3]))
save("refuse/cell-left-out", encoded([FOUR[0], *FOUR[2:]]))
save("refuse/cuts-differ-in-a-triangle", encoded([*FOUR[:3], element(surface=3, triangle=0, cell=3, cuts=3)]))
save("refuse/next-triangle-too-early", encoded([FOUR[0], element(surface=4)]))
save("refuse/element-twice", encoded([FRONT, FRONT]))
save("refuse/back-before-front", encoded([BACK, FRONT]))
save("refuse/surfaces-descend", encoded([FOUR[0]] + FOUR[1:] + [FRONT]))
save("refuse/end-count", encoded(end=(3, 3)))
save("refuse/end-photons", encoded(end=(2, 4)))
save("refuse/magic", encoded(magic=b"\x89TMESX\r\n"))
save("refuse/block-mark-unknown", encoded(mark=b"MESX"))
save("refuse/block-checksum", GOOD.replace(struct.pack("<3q", 4, 2, 1), struct.pack("<3q", 4, 2, 2)))
for name, data in damages(GOOD, 24, 40):
    save("refuse/" + name, data)

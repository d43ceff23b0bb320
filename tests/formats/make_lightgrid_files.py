#!/usr/bin/env python3
"""Make tests/formats/lightgrid/{accept,refuse}: small .lightgrid files, each named for what is right or wrong with it.

    make_lightgrid_files.py FOLDER          FOLDER is tests/formats/lightgrid

Checksums are right in every file whose name does not say otherwise.
"""
import os
import struct
import sys

from containers import damages
from read_lightgrid import KEYS, encode

folder = sys.argv[1]
HEADER = {"origin": "0 0 0", "edge": "0.5", "parts": "2 1", "frames": "3 3", "static-geometry": "a1"}
FIRST, SECOND = (-1, 2, 3, 2, 0.5, 0.25, [0.25, 1]), (-1, 2, 3, 5, 0, 1, [1, 1])
NAN = float("nan")


def encoded(cells=(FIRST, SECOND), end=None, header={}, **how):
    values = {k: v for k, v in (HEADER | header).items() if v is not None}
    return encode(values, ["example"], list(cells), end, keys=KEYS + [k for k in values if k not in KEYS and k not in ("frames", "static-geometry")], **how)


def save(name, data):
    path = os.path.join(folder, name + ".lightgrid")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as stream:
        stream.write(data)


def changed(place=(-1, 2, 3), facing=2, sky=0.5, suns=0.25, end=(0.25, 1)):
    return encoded([(*place, facing, sky, suns, list(end))])


GOOD = encoded()
save("accept/worked-example", GOOD)
save("accept/nothing", encoded(()))
save("accept/one-part", encoded([(*FIRST[:6], [1])], header={"parts": "1 1"}))
save("accept/farthest-places", encoded([(-524286, 0, 524286, *FIRST[3:]), (524286, 0, 0, *FIRST[3:])]))
save("accept/no-identity", encoded(header={"frames": None, "static-geometry": None}))
save("accept/later-minor-version-with-new-key", encoded(minor=7, header={"colour-of-ink": "blue"}))
for name, header in {"edge-zero": {"edge": "0"}, "edge-infinite": {"edge": "inf"}, "parts-zero": {"parts": "2 0"}, "parts-above-limit": {"parts": "257 1"},
                     "parts-of-one-number": {"parts": "2"}, "key-missing": {"edge": None}, "key-unknown": {"colour-of-ink": "blue"},
                     "hashes-without-frames": {"frames": None}, "frames-backwards": {"frames": "3 2"}, "origin-nan": {"origin": "0 nan 0"}}.items():
    save("refuse/header-" + name, encoded(header=header))
save("refuse/header-checksum", GOOD.replace(b"edge: 0.5", b"edge: 0.6"))
save("refuse/place-too-far", changed(place=(-1, 524287, 3)))
save("refuse/facing-6", changed(facing=6))
save("refuse/sky-negative", changed(sky=-0.5))
save("refuse/suns-nan", changed(suns=NAN))
save("refuse/sky-and-suns-above-1", changed(sky=0.75, suns=0.5))
save("refuse/end-descends", changed(end=(0.5, 0.25)))
save("refuse/end-below-1", changed(end=(0.25, 0.75)))
save("refuse/end-nan", changed(end=(NAN, 1)))
save("refuse/end-negative", changed(end=(-0.25, 1)))
save("refuse/cell-twice", encoded([FIRST, FIRST]))
save("refuse/cells-descend", encoded([SECOND, FIRST]))
save("refuse/end-count", encoded(end=3))
save("refuse/magic", encoded(magic=b"\x89TLGRX\r\n"))
save("refuse/block-mark-unknown", encoded(mark=b"CELX"))
save("refuse/block-checksum", GOOD.replace(struct.pack("<2f", 0.25, 1), struct.pack("<2f", 0.5, 1), 1))
for name, data in damages(GOOD, 16, 30):
    save("refuse/" + name, data)

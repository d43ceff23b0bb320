#!/usr/bin/env python3
"""Make tests/formats/photons/{accept,refuse}: small .photons files, each named for what is right or wrong with it.

    make_photons_files.py FOLDER [BASE-DIGEST]

BASE-DIGEST is the digest of accept/overlay-base.photons, if that changes (tempolux-info --digest). Checksums are right in every
file whose name does not say otherwise, so that each is refused for its own reason.
"""
import copy
import os
import struct
import sys
import zlib

from read_photons import Block, MAGIC, PILOT, Photons, RECORD, encode_photons

folder = sys.argv[1]
base_digest = sys.argv[2] if len(sys.argv) > 2 else "890904d158e59969b934f4a66bf90810"


def record(kind=1, flux=(0.5, 0.25, 0.125), position=(1, 2, 3), normal=(32767, 65534), bounce=2):
    return RECORD.pack(*position, *flux, *normal, 7, kind, bounce)


def photons(blocks=None, ledger=(), **header):
    h = {"map": "global", "kinds": "direct,caustic,indirect", "columns": "none", "origin": "0 0 0", "groups": "1",
         "emitted": "4"}
    h |= {key.replace("_", "-"): value for key, value in header.items()}
    blocks = [Block(0, record())] if blocks is None else blocks
    return Photons(h, ["0.1.0 photon-trace scene.glb --frame 0"], blocks, list(ledger), (1.0, 1.0, 1.0),
                   (0.5, 0.5, 0.5), (0.5, 0.5, 0.5))


def save(name, data):
    data = data if isinstance(data, bytes) else encode_photons(data)
    with open(os.path.join(folder, name + ".photons"), "wb") as stream:
        stream.write(data)


def header_bytes(text, magic=MAGIC, major=1, minor=0, size=None):
    """A file of one photon under this header."""
    head = struct.pack("<8sHHI", magic, major, minor, len(text) if size is None else size) + text
    return rejoin([head + struct.pack("<I", zlib.crc32(head))] + pieces(GOOD)[1:])


MAJORANTS = b"majorants: " + b"0123456789abcdef" * 2 + b"\n"


def changed_text(p, change, minor=None):
    """The file with another header text (and version): every checksum right."""
    data = encode_photons(p)
    size, = struct.unpack_from("<I", data, 12)
    text = change(data[16:16 + size])
    head = struct.pack("<8sHHI", MAGIC, 1, struct.unpack_from("<H", data, 10)[0] if minor is None else minor, len(text)) + text
    rest = data[20 + size:]
    end = rest[-112:-4]
    at, crcs = 0, struct.pack("<I", zlib.crc32(head))
    while rest[at:at + 4] == b"PHOT":
        crcs += rest[at + 12:at + 16]
        at += 16 + 32 * struct.unpack_from("<I", rest, at + 8)[0]
    if rest[at:at + 3] == b"LED":
        crcs += rest[at + 8:at + 12]
    return head + crcs[:4] + rest[:-112] + end + struct.pack("<I", zlib.crc32(end, zlib.crc32(crcs)))


def pieces(data):
    """Header, blocks and end block of a file without ledger and columns."""
    at = 20 + struct.unpack_from("<I", data, 12)[0]
    out = [data[:at]]
    while data[at:at + 4] == b"PHOT":
        size = 16 + 32 * struct.unpack_from("<I", data, at + 8)[0]
        out.append(data[at:at + size])
        at += size
    return out + [data[at:]]


def rejoin(parts):
    """The file with its chain made right again."""
    crcs = parts[0][-4:] + b"".join(b[12:16] for b in parts[1:-1])
    end = parts[-1][:108]
    return b"".join(parts[:-1]) + end + struct.pack("<I", zlib.crc32(end, zlib.crc32(crcs)))


def with_end(data, offset, value):
    parts = pieces(data)
    parts[-1] = parts[-1][:offset] + value + parts[-1][offset + len(value):]
    return rejoin(parts)


def with_head(data, offset, value):
    """The first block's head changed and its crc made right."""
    parts = pieces(data)
    block = parts[1][:offset] + value + parts[1][offset + len(value):]
    crc = struct.pack("<I", zlib.crc32(block[:12] + block[16:]))
    return rejoin([parts[0], block[:12] + crc + block[16:]] + parts[2:])


GOOD = encode_photons(photons())
TEXT = pieces(GOOD)[0][16:-4]
IDENTITY = {"frames": "0 23", "static_geometry": "a1", "materials": "b2", "lights": "c3"}
GROUPS = [Block(0, record()), Block(1, record() + record(kind=2)), Block(1, record()), Block(3, record(kind=0, bounce=0))]
LEDGER = [(g, (0.25, 0.25, 0.25, 0.1, 0.1, 0.1, 0.15, 0.15, 0.15)) for g in range(4)]
BASE = photons(GROUPS, LEDGER, groups="4")
OVERLAY = photons([Block(1, record(flux=(2, 2, 2))), Block(2, record()), Block(3, b"")],
                  [(g, (0.25, 0.25, 0.25, 0.2, 0.2, 0.2, 0.05, 0.05, 0.05)) for g in (1, 2, 3)],
                  groups="4", base="overlay-base.photons", base_digest=base_digest)


def tentative(blocks, ledger=None, **header):
    """Photons in a medium: version 1.3."""
    ledger = [(0, (1.0,) * 3 + (0.5,) * 6, 12, 4, b"")] if ledger is None else ledger
    return photons(blocks, ledger, **{"kinds": "indirect,tentative", "majorants": "0123456789abcdef" * 2} | header)


def piloted(entries=((1, 2, 3, 0.5), (2**64 - 1, 0, 7, -0.25)), **header):
    """Its ledger has pilots: version 1.4."""
    more = b"".join(PILOT.pack(*p) for p in entries)
    return tentative([Block(0, record(kind=4))], [(0, (1.0,) * 3 + (0.5,) * 6, 12, 4, more)], **{"pilots": "2"} | header)


TENTATIVE = tentative([Block(0, record(kind=2) + record(kind=4, normal=(32767, 32767)))])


def accept():
    example = photons(**IDENTITY)
    example.history = ["example"]
    save("accept/worked-example", example)
    save("accept/identity-with-emission", photons(**IDENTITY, emission="d4"))
    save("accept/part-low", photons(part="low"))
    save("accept/part-high-with-emission", photons(part="high", **IDENTITY, emission="d4"))
    save("accept/no-identity", photons())
    no_history = photons()
    no_history.history = []
    save("accept/no-history", no_history)
    save("accept/no-photons", photons([]))
    save("accept/empty-block", photons([Block(0, b""), Block(0, record())]))
    save("accept/groups", photons(GROUPS, groups="4"))
    save("accept/groups-with-ledger", BASE)
    save("accept/columns", photons([Block(0, record() * 2, b"\0\1\2\3\4\5\6\7", b"abc\0def\0")],
                                   columns="direction,albedo"))
    save("accept/dynamic-with-negative-flux", photons([Block(0, record(flux=(-1, 2, -3)))], map="dynamic"))
    save("accept/origin-far-away", photons(origin="1e+06 -0.5 12345.678901"))
    save("accept/flux-from-tiny-to-huge", photons([Block(0, b"".join(
        record(flux=(2.0**e, 2.0**-e, 3.0)) for e in range(-127, 128, 2)) + record(flux=(2.0**-149, 0, -0.0)))]))
    save("accept/later-minor-version-with-new-key", header_bytes(TEXT + b"colour-of-ink: blue\n", minor=7))
    save("accept/overlay-base", BASE)
    save("accept/overlay", OVERLAY)
    save("accept/tentative", TENTATIVE)
    save("accept/tentative-with-directions", tentative([Block(0, record(kind=4), b"\1\2\3\4")], columns="direction"))
    save("accept/tentative-of-nothing", tentative([]))
    save("accept/pilots", piloted())


def refuse_headers():
    save("refuse/magic", header_bytes(TEXT, magic=b"\x89TPHOX\r\n"))
    save("refuse/copied-as-text", GOOD.replace(b"\r\n", b"\n", 1))
    save("refuse/major-version-2", header_bytes(TEXT, major=2))
    save("refuse/header-size-above-limit", header_bytes(TEXT, size=2**20 + 1))
    save("refuse/header-size-beyond-end", header_bytes(TEXT, size=2**19))
    save("refuse/header-checksum", GOOD.replace(b"emitted: 4", b"emitted: 5"))
    save("refuse/header-key-unknown", header_bytes(TEXT + b"colour-of-ink: blue\n"))
    save("refuse/header-key-of-a-later-version", header_bytes(TEXT + b"frames: 0 23\nemission: d4\n"))
    save("refuse/header-part-of-a-later-version", header_bytes(TEXT + b"part: low\n", minor=1))
    save("refuse/header-key-unknown-1.4", header_bytes(TEXT + b"colour-of-ink: blue\n", minor=4))
    save("refuse/header-key-unknown-1.3", header_bytes(TEXT + b"colour-of-ink: blue\n", minor=3))
    save("refuse/header-key-unknown-1.2", header_bytes(TEXT + b"colour-of-ink: blue\n", minor=2))
    save("refuse/header-key-unknown-1.1", header_bytes(TEXT + b"colour-of-ink: blue\n", minor=1))
    save("refuse/header-key-missing", header_bytes(TEXT.replace(b"groups: 1\n", b"")))
    save("refuse/header-key-twice", header_bytes(TEXT + b"groups: 1\n"))
    save("refuse/header-line-without-colon", header_bytes(TEXT + b"photons\n"))
    save("refuse/header-last-line-without-lf", header_bytes(TEXT + b"history: x"))
    save("refuse/header-control-character", header_bytes(TEXT + b"history: \x1b[2J\n"))
    for name, values in {
            "map-unknown": {"map": "local"}, "kinds-unknown": {"kinds": "direct,purple"}, "kinds-empty": {"kinds": ""},
            "kinds-twice": {"kinds": "caustic,caustic"}, "columns-unknown": {"columns": "albedo,direction"},
            "part-unknown": {"part": "middle"}, "part-empty": {"part": ""},
            "origin-of-two-numbers": {"origin": "0 0"}, "origin-nan": {"origin": "0 nan 0"},
            "origin-infinite": {"origin": "0 1e999 0"}, "groups-zero": {"groups": "0"},
            "groups-above-limit": {"groups": "16777217"}, "groups-negative": {"groups": "-1"},
            "emitted-above-64-bits": {"emitted": "18446744073709551616"}, "emitted-not-a-number": {"emitted": "4 "},
            "frames-backwards": {"frames": "3 2"}, "hashes-without-frames": {"lights": "c3"},
            "hash-empty": {"frames": "0 0", "lights": ""}, "hash-with-space": {"frames": "0 0", "lights": "c 3"},
            "base-without-digest": {"base": "overlay-base.photons"}, "digest-without-base": {"base_digest": base_digest},
            "base-in-other-folder": {"base": "../accept/overlay-base.photons", "base_digest": base_digest},
            "base-is-dots": {"base": "..", "base_digest": base_digest},
            "base-digest-short": {"base": "overlay-base.photons", "base_digest": "abc"}}.items():
        save("refuse/header-" + name, photons(**values))


def refuse_blocks():
    nan, inf = float("nan"), float("inf")
    save("refuse/position-nan", photons([Block(0, record(position=(1, nan, 3)))]))
    save("refuse/position-infinite", photons([Block(0, record() * 5 + record(position=(1, 2, -inf)))]))
    for name, value, data in (("infinite", inf, 3.0), ("nan", nan, 3.0)):
        parts = pieces(encode_photons(photons([Block(0, record(flux=(0, 3, 0), position=(1, 2, 4)))])))
        block = parts[1].replace(struct.pack("<f", data), struct.pack("<f", value))
        block = block[:12] + struct.pack("<I", zlib.crc32(block[:12] + block[16:])) + block[16:]
        save("refuse/flux-" + name, rejoin([parts[0], block, parts[2]]))
    save("refuse/flux-negative-in-global", photons([Block(0, record(flux=(1, 1, -1e-30)))]))
    save("refuse/flux-negative-and-denormal", photons([Block(0, record(flux=(-1e-45, 1, 1)))]))
    save("refuse/normal-above-65534", photons([Block(0, record(normal=(0, 65535)))]))
    save("refuse/direction-above-65534", photons([Block(0, record(), b"\xff\xff\0\0")], columns="direction"))
    save("refuse/kind-not-in-header", photons([Block(0, record(kind=3))]))
    save("refuse/kind-4", photons([Block(0, record(kind=4))]))
    save("refuse/tentative-without-majorants", changed_text(TENTATIVE, lambda t: t.replace(MAJORANTS, b"")))
    save("refuse/tentative-of-version-1.2", changed_text(TENTATIVE, lambda t: t.replace(MAJORANTS, b""), minor=2))
    save("refuse/tentative-without-ledger", tentative([Block(0, record(kind=4))], []))
    save("refuse/tentative-with-undated-ledger", encode_photons(TENTATIVE).replace(b"LEDU", b"LEDG"))
    save("refuse/pilots-of-version-1.3", changed_text(piloted(), lambda t: t, minor=3))
    save("refuse/pilots-zero", piloted((), pilots="0"))
    save("refuse/pilots-above-limit", piloted(((1, 2, 3, 0.5),) * 257, pilots="257"))
    save("refuse/pilots-without-tentative", header_bytes(TEXT + b"pilots: 1\n", minor=4))
    save("refuse/pilots-fewer-than-said", piloted(pilots="3"))
    save("refuse/pilots-without-their-mark", encode_photons(piloted()).replace(b"LEDP", b"LEDU"))
    save("refuse/pilots-sum-nan", piloted(((1, 2, 3, 0.5), (1, 2, 3, float("nan")))))
    save("refuse/majorants-without-tentative", photons(majorants="0123456789abcdef" * 2))
    save("refuse/majorants-short", tentative([], majorants="abc"))
    save("refuse/majorants-of-a-later-version", header_bytes(TEXT + MAJORANTS, minor=2))
    save("refuse/kind-65", photons([Block(0, record(kind=65))]))
    save("refuse/block-mark-unknown", with_head(GOOD, 0, b"PHOX"))
    save("refuse/block-group-out-of-range", with_head(GOOD, 4, struct.pack("<I", 1)))
    save("refuse/block-count-above-limit", with_head(GOOD, 8, struct.pack("<I", 65537)))
    save("refuse/block-count-beyond-end", with_head(GOOD, 8, struct.pack("<I", 65536)))
    save("refuse/block-checksum", GOOD.replace(struct.pack("<f", 0.125), struct.pack("<f", 0.126)))
    save("refuse/groups-descend", photons([Block(1, record()), Block(0, record())], groups="2"))
    two = pieces(encode_photons(photons([Block(0, record()), Block(0, record(kind=2))])))
    save("refuse/blocks-in-other-order", two[0] + two[2] + two[1] + two[3])
    save("refuse/block-lost", two[0] + two[1] + two[3])
    save("refuse/block-twice", two[0] + two[1] + two[1] + two[3])
    save("refuse/columns-missing", header_bytes(TEXT.replace(b"columns: none", b"columns: albedo")))


def refuse_ends():
    save("refuse/empty-file", b"")
    save("refuse/ends-inside-magic", GOOD[:5])
    save("refuse/ends-inside-header", GOOD[:40])
    save("refuse/ends-inside-block-head", b"".join(pieces(GOOD)[:1]) + b"PHOT\0\0")
    save("refuse/ends-inside-block", b"".join(pieces(GOOD)[:2])[:-1])
    save("refuse/no-end-block", b"".join(pieces(GOOD)[:2]))
    save("refuse/ends-inside-end-block", GOOD[:-1])
    save("refuse/bytes-after-end", GOOD + b"\0")
    save("refuse/two-files-in-one", GOOD + GOOD)
    save("refuse/end-photon-count", with_end(GOOD, 4, struct.pack("<Q", 2)))
    save("refuse/end-stored-flux", with_end(GOOD, 12, struct.pack("<d", 0.5000000000000001)))
    save("refuse/end-emitted-flux-nan", with_end(GOOD, 36, struct.pack("<d", float("nan"))))
    save("refuse/end-escaped-flux-negative", with_end(GOOD, 60, struct.pack("<d", -1)))
    save("refuse/end-checksum", GOOD[:-1] + bytes([GOOD[-1] ^ 1]))


def refuse_ledgers_and_overlays():
    def changed(p, **values):
        p = copy.deepcopy(p)
        for key, value in values.items():
            setattr(p, key, value)
        return p

    save("refuse/ledger-of-fewer-groups", changed(BASE, ledger=LEDGER[:3]))
    save("refuse/ledger-out-of-order", changed(BASE, ledger=[LEDGER[i] for i in (0, 2, 1, 3)]))
    save("refuse/ledger-negative", changed(BASE, ledger=LEDGER[:3] + [(3, (-1.0,) * 9)]))
    good = encode_photons(BASE)
    save("refuse/ledger-checksum", good.replace(struct.pack("<d", 0.15), struct.pack("<d", 0.16), 1))
    save("refuse/ledger-twice", good[:good.index(b"LEDG")] + 2 * good[good.index(b"LEDG"):good.index(b"END!")] +
         good[good.index(b"END!"):])
    wrong_sum = good[good.index(b"END!"):]
    wrong_sum = wrong_sum[:36] + struct.pack("<d", 1.25) + wrong_sum[44:108]
    crcs = pieces(good)[0][-4:] + b"".join(b[12:16] for b in pieces(good)[1:-1])
    crcs += good[good.index(b"LEDG") + 8:good.index(b"LEDG") + 12]
    save("refuse/ledger-adds-up-to-other-totals",
         good[:good.index(b"END!")] + wrong_sum + struct.pack("<I", zlib.crc32(wrong_sum, zlib.crc32(crcs))))

    def overlay(**header):
        return changed(OVERLAY, header=OVERLAY.header | {k.replace("_", "-"): v for k, v in header.items()})

    save("refuse/overlay-base", BASE)      # a good file: what the others here lie upon
    save("refuse/overlay-base-missing", overlay(base="nowhere.photons"))
    save("refuse/overlay-base-of-other-digest", overlay(base_digest="0" * 32))
    save("refuse/overlay-base-of-other-origin", overlay(origin="0 0 1"))
    save("refuse/overlay-base-of-other-kinds", overlay(kinds="caustic,direct"))
    save("refuse/overlay-base-of-other-map", overlay(map="static"))
    save("refuse/overlay-upon-overlay", overlay(base="overlay-base-missing.photons"))
    save("refuse/overlay-upon-itself", overlay(base="overlay-upon-itself.photons"))
    save("refuse/overlay-ledger-of-other-groups",
         changed(OVERLAY, ledger=[(g, e) for (_, e), g in zip(OVERLAY.ledger, (0, 2, 3))]))
    whole = encode_photons(OVERLAY)
    end = whole[whole.index(b"END!"):][:108]
    parts = pieces(whole)
    crcs = parts[0][-4:] + b"".join(b[12:16] for b in parts[1:-1])
    save("refuse/overlay-without-ledger", whole[:whole.index(b"LEDG")] + end +
         struct.pack("<I", zlib.crc32(end, zlib.crc32(crcs))))


accept()
refuse_headers()
refuse_blocks()
refuse_ends()
refuse_ledgers_and_overlays()

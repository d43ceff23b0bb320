#!/usr/bin/env python3
"""Reads Cryptomatte as formats/frames/frames.md and Cryptomatte's specification describe it, with the standard library
only, and checks it.

    read_mattes.py FRAME.exr            each layer's names with their mean coverage
    read_mattes.py FRAME.exr X Y        the names at one pixel, (0, 0) top left
    read_mattes.py FRAME.exr --alpha E  also: coverage adds up to A within E where a pixel has ranks left

Names are found as a compositor finds them: by the manifest, whose hashes are computed again here.
"""
import functools
import json
import os
import re
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "lib", "image"))
import read_frame
from read_frame import Frame

read_frame.unzip = functools.lru_cache(2)(read_frame.unzip)   # a chunk is read for each of its pixels

ALL = 0xFFFFFFFF


def murmur(data):
    """MurmurHash3, 32 bits, seed 0."""
    def rotate(x, by):
        return (x << by | x >> (32 - by)) & ALL

    def block(k):
        return rotate(k * 0xCC9E2D51 & ALL, 15) * 0x1B873593 & ALL
    h, whole = 0, len(data) & ~3
    for i in range(0, whole, 4):
        h = (rotate(h ^ block(int.from_bytes(data[i:i + 4], "little")), 13) * 5 + 0xE6546B64) & ALL
    h ^= block(int.from_bytes(data[whole:], "little")) ^ len(data)
    for factor, shift in ((0x85EBCA6B, 16), (0xC2B2AE35, 13)):
        h = (h ^ h >> shift) * factor & ALL
    return h ^ h >> 16


def bits_of_name(name):
    """The hash as the bits of a float: exponents 0 and 255 are clamped to 1 and 254."""
    h = murmur(name.encode())
    exponent = min(max(h >> 23 & 255, 1), 254)
    return h & 0x807FFFFF | exponent << 23


def bits_of_float(value):
    return struct.unpack("<I", struct.pack("<f", value))[0]


class Mattes:
    """A layer of mattes: names by bits, and its channels as pairs (hash, coverage) by rank."""

    def __init__(self, frame, name, attributes):
        assert attributes["hash"] == "MurmurHash3_32" and attributes["conversion"] == "uint32_to_float32", attributes
        self.name, self.names = name, {}
        for text, digits in json.loads(attributes["manifest"]).items():
            assert re.fullmatch("[0-9a-f]{8}", digits) and int(digits, 16) == bits_of_name(text), (text, digits)
            self.names[int(digits, 16)] = text
        kinds = dict(frame.channels)
        self.ranks = []
        while f"{name}{len(self.ranks) // 2:02d}.R" in kinds:
            layer = f"{name}{len(self.ranks) // 2:02d}."
            assert all(kinds[layer + c] == 2 for c in "RGBA"), "32-bit floats"
            self.ranks += [(layer + "R", layer + "G"), (layer + "B", layer + "A")]
        assert self.ranks

    def at(self, values):
        """[(name, coverage)] of a pixel, the most first."""
        shown, before = [], (2.0, "")
        for hash_channel, coverage_channel in self.ranks:
            bits, coverage = bits_of_float(values[hash_channel]), values[coverage_channel]
            assert (bits == 0) == (coverage == 0) and 0 <= coverage <= before[0], (bits, coverage)
            if coverage:
                shown.append((self.names[bits], coverage))
            before = (coverage, bits)
        assert len({name for name, _ in shown}) == len(shown) and sum(c for _, c in shown) <= 1, shown
        return shown


def mattes_in(frame):
    found = {}
    for attribute, value in frame.attributes.items():
        parts = attribute.split("/")
        if parts[0] == "cryptomatte":
            found.setdefault(parts[1], {})[parts[2]] = value
    layers = []
    for key, attributes in found.items():
        assert key == f"{bits_of_name(attributes['name']):08x}"[:7], key
        layers.append(Mattes(frame, attributes["name"], attributes))
    return layers


def main(path, *rest):
    frame = Frame(path)
    layers = mattes_in(frame)
    assert layers, "no mattes"
    if rest and rest[0] != "--alpha":
        values = frame.pixel(int(rest[0]), int(rest[1]))
        for layer in layers:
            for name, coverage in layer.at(values):
                print(f"{layer.name} {bits_of_name(name):08x} {coverage:.9g} {name}")
        return
    pixels, worst, soft = frame.width * frame.height, 0, 0
    for layer in layers:
        mean = {name: 0.0 for name in layer.names.values()}
        for y in range(frame.height):
            for x in range(frame.width):
                values = frame.pixel(x, y)
                shown = layer.at(values)
                soft += len(shown) > 1
                for name, coverage in shown:
                    mean[name] += coverage / pixels
                if rest and len(shown) < len(layer.ranks):
                    worst = max(worst, abs(sum(c for _, c in shown) - values["A"]))
        for name in sorted(mean):
            assert mean[name] > 0, f"{name} is in the manifest and not in the picture"
            print(f"{layer.name} {bits_of_name(name):08x} {mean[name]:.6f} {name}")
    if rest:
        print(f"alpha differs by at most {worst:.3g}; {soft} mixed pixels")
        assert worst <= float(rest[1]) and soft > 0


if __name__ == "__main__":
    main(*sys.argv[1:])

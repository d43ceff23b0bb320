#!/usr/bin/env python3
"""Reads a frame .exr as formats/frames/frames.md describes it, with the standard library only.

    read_frame.py FRAME.exr          attributes and channels
    read_frame.py FRAME.exr X Y      and every channel's value at one pixel, (0, 0) top left

Single part, scan lines, compression none or ZIP: what our tools write.
"""
import struct
import sys
import zlib

SIZE = {0: 4, 1: 2, 2: 4}                       # uint, half, float
FORMAT = {0: "I", 1: "e", 2: "f"}
NUMBER = {"float": "<f", "double": "<d", "int": "<i"}


def text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def value_of(kind, raw):
    if kind in NUMBER:
        return struct.unpack(NUMBER[kind], raw)[0]
    if kind == "string":
        return raw.decode()
    if kind == "rational":
        numerator, denominator = struct.unpack("<iI", raw)
        return numerator / denominator
    if kind == "box2i":
        return struct.unpack("<4i", raw)
    if kind == "m44f":
        return struct.unpack("<16f", raw)
    if kind == "m44d":
        return struct.unpack("<16d", raw)
    if kind == "compression":
        return raw[0]
    if kind == "chlist":
        channels, at = [], 0
        while raw[at]:
            name, at = text(raw, at)
            channels.append((name, struct.unpack_from("<i", raw, at)[0]))
            at += 16
        return channels
    return raw


def unzip(raw, size):
    """Undoes ZIP: deflate, then a running sum of bytes, then two interleaved halves."""
    if len(raw) == size:                         # a chunk that deflate would not make smaller is stored
        return raw
    data = bytearray(zlib.decompress(raw))
    for i in range(1, len(data)):
        data[i] = (data[i - 1] + data[i] - 128) & 255
    result, half = bytearray(size), (size + 1) // 2
    result[0::2], result[1::2] = data[:half], data[half:]
    return bytes(result)


class Frame:
    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        magic, version = struct.unpack_from("<II", self.data)
        if magic != 20000630 or version & ~0x400 != 2:
            raise ValueError(f"{path}: not a single-part scan-line OpenEXR file")
        self.attributes, at = {}, 8
        while self.data[at]:
            name, at = text(self.data, at)
            kind, at = text(self.data, at)
            (size,) = struct.unpack_from("<i", self.data, at)
            self.attributes[name] = value_of(kind, self.data[at + 4:at + 4 + size])
            at += 4 + size
        self.table = at + 1
        self.channels = self.attributes["channels"]
        x0, y0, x1, y1 = self.attributes["dataWindow"]
        self.width, self.height = x1 - x0 + 1, y1 - y0 + 1
        self.lines = {0: 1, 3: 16}[self.attributes["compression"]]

    def pixel(self, x, y):
        """Every channel's value at (x, y), by name."""
        if not (0 <= x < self.width and 0 <= y < self.height):
            raise ValueError(f"pixel ({x}, {y}) lies outside")
        chunk = y // self.lines
        (at,) = struct.unpack_from("<Q", self.data, self.table + 8 * chunk)
        size = struct.unpack_from("<ii", self.data, at)[1]
        line = self.width * sum(SIZE[kind] for _, kind in self.channels)
        count = min(self.lines, self.height - chunk * self.lines)
        samples = unzip(self.data[at + 8:at + 8 + size], line * count)
        offset, values = line * (y % self.lines), {}
        for name, kind in self.channels:         # a line holds one channel after the other
            values[name] = struct.unpack_from("<" + FORMAT[kind], samples, offset + SIZE[kind] * x)[0]
            offset += SIZE[kind] * self.width
        return values


def main(arguments):
    frame = Frame(arguments[0])
    if len(arguments) < 3:
        for name, value in sorted(frame.attributes.items()):
            print(name, value if not isinstance(value, bytes) else f"({len(value)} bytes)")
        return
    for name, value in frame.pixel(int(arguments[1]), int(arguments[2])).items():
        print(name, value if isinstance(value, int) else f"{value:.9g}")


if __name__ == "__main__":
    main(sys.argv[1:])

#!/usr/bin/env python3
"""make_exr.py OUT.exr WxH ITEM... -- a small EXR for tests, written from the format's description alone.

ITEM is CHANNEL=VALUE (float32), CHANNEL:id=VALUE (uint32) or @ATTRIBUTE=TEXT (string). VALUE is a number for all
pixels, or LEFT|RIGHT for the two halves of each row. Scan lines, no compression, one part.
"""
import struct
import sys


def attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(data)) + data


def main(out, size, *items):
    width, height = map(int, size.split("x"))
    channels, attributes = {}, []
    for item in items:
        name, value = item.split("=", 1)
        if name.startswith("@"):
            attributes.append(attribute(name[1:], "string", value.encode()))
            continue
        name, _, kind = name.partition(":")
        values = [float(v) for v in value.split("|")]
        row = [values[0] if 2 * x < width else values[-1] for x in range(width)]
        channels[name] = (0, struct.pack(f"<{width}I", *map(int, row))) if kind else (2, struct.pack(f"<{width}f", *row))
    names = sorted(channels)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<IB3xII", channels[n][0], 0, 1, 1) for n in names) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = b"\x76\x2f\x31\x01" + struct.pack("<I", 2 | (0x400 if any(len(n) > 31 for n in names) else 0))
    header += attribute("channels", "chlist", listed) + attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"".join(attributes) + b"\0"
    line = b"".join(channels[n][1] for n in names)
    first = len(header) + 8 * height
    with open(out, "wb") as file:
        file.write(header)
        for y in range(height):
            file.write(struct.pack("<Q", first + y * (8 + len(line))))
        for y in range(height):
            file.write(struct.pack("<iI", y, len(line)) + line)


main(*sys.argv[1:])

"""Writes small EXR files for tests of formats, from OpenEXR's description alone: scan lines, no compression, one part."""
import struct

FORMAT = {"uint": (0, "I"), "half": (1, "e"), "float": (2, "f")}


def attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(data)) + data


def exr(width, height, channels, attributes=()):
    """channels: {name: (type, values)}, lines from the top; attributes: (name, type, bytes), sorted by name among the rest."""
    names = sorted(channels)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<IB3xII", FORMAT[channels[n][0]][0], 0, 1, 1) for n in names)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    every = [("channels", "chlist", listed + b"\0"), ("compression", "compression", b"\0"), ("dataWindow", "box2i", window),
             ("displayWindow", "box2i", window), ("lineOrder", "lineOrder", b"\0"),
             ("pixelAspectRatio", "float", struct.pack("<f", 1)), ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
             ("screenWindowWidth", "float", struct.pack("<f", 1)), *attributes]
    header = b"\x76\x2f\x31\x01" + struct.pack("<I", 2)
    header += b"".join(attribute(*a) for a in sorted(every)) + b"\0"
    lines = []
    for y in range(height):
        line = b"".join(struct.pack(f"<{width}{FORMAT[channels[n][0]][1]}", *channels[n][1][y * width:(y + 1) * width])
                        for n in names)
        lines.append(struct.pack("<iI", y, len(line)) + line)
    at, table = len(header) + 8 * height, b""
    for line in lines:
        table += struct.pack("<Q", at)
        at += len(line)
    return header + table + b"".join(lines)

"""OpenEXR, uncompressed scan lines, in the standard library: what the cases write and what they read back.

formats/frames/frames.md describes the files; tests/lib/image/read_frame.py is a reader to learn from, this one is
for whole images: read(path) -> Image, write(path, width, height, channels).
"""
import array
import math
import struct

UINT, HALF, FLOAT = 0, 1, 2
CODES = {UINT: "I", HALF: "e", FLOAT: "f"}


class Image:
    def __init__(self, width, height, channels):
        self.width, self.height, self.channels = width, height, channels     # name: array, lines from the top

    def rgb(self, layer=""):
        """R, G, B one after the other."""
        prefix = layer + "." if layer else ""
        return [v for c in "RGB" for v in self.channels[prefix + c]]

    def mean(self, channel="G"):
        values = self.channels[channel]
        return math.fsum(values) / len(values)

    def sigma_of_mean(self, channel="G"):
        """Standard error of the mean if all pixels estimate one number; too large if they do not."""
        values, mean = self.channels[channel], self.mean(channel)
        return math.sqrt(math.fsum((v - mean) ** 2 for v in values) / max(1, len(values) - 1) / len(values))

    def not_finite(self):
        """Channels with NaN, or with infinity where frames.md allows none (Z alone may be +inf)."""
        def bad(name, v):
            return math.isnan(v) or (math.isinf(v) and not (name == "Z" and v > 0))
        return [n for n, a in self.channels.items() if any(not math.isfinite(v) and bad(n, v) for v in a)]


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    magic, version = struct.unpack_from("<II", data)
    if magic != 20000630 or version & ~0x400 != 2:                           # 0x400: long names
        raise ValueError(f"{path}: not a single-part scan-line OpenEXR file")
    at, attributes = 8, {}

    def text():
        nonlocal at
        end = data.index(b"\0", at)
        word, at = data[at:end].decode(), end + 1
        return word
    while data[at]:
        name, _ = text(), text()
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    if attributes["compression"] != b"\0":
        raise ValueError(f"{path}: compressed; render with --compression none")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names, raw, place = [], attributes["channels"], 0
    while raw[place]:
        end = raw.index(b"\0", place)
        names.append((raw[place:end].decode(), struct.unpack_from("<i", raw, end + 1)[0]))
        place = end + 17
    channels = {name: array.array("I" if kind == UINT else "f") for name, kind in names}
    for offset in struct.unpack_from(f"<{height}Q", data, at + 1):
        start = offset + 8
        for name, kind in names:
            size = width * (2 if kind == HALF else 4)
            line = data[start:start + size]
            if kind == HALF:
                channels[name].extend(struct.unpack(f"<{width}e", line))
            else:
                channels[name].frombytes(line)
            start += size
    return Image(width, height, channels)


def write(path, width, height, channels):
    """channels: name -> values, lines from the top; all float."""
    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    names = sorted(channels)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iiii", FLOAT, 0, 1, 1) for n in names) + b"\0"
    header = struct.pack("<II", 20000630, 2) + b"".join([
        attribute("channels", "chlist", listed), attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window), attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"), attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1))]) + b"\0"
    line = 8 + 4 * width * len(names)
    with open(path, "wb") as file:
        file.write(header)
        first = len(header) + 8 * height
        file.write(struct.pack(f"<{height}Q", *(first + y * line for y in range(height))))
        for y in range(height):
            file.write(struct.pack("<ii", y, line - 8))
            for name in names:
                file.write(array.array("f", channels[name][y * width:(y + 1) * width]).tobytes())

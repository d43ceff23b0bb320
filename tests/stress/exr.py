"""OpenEXR, scan lines, uncompressed or ZIP, in the standard library: what the cases write and what they read back.

formats/frames/frames.md describes the files; tests/lib/image/read_frame.py is a reader to learn from, this one is
for whole images: read(path) -> Image, write(path, width, height, channels).
"""
import array
import itertools
import math
import struct
import zlib

UINT, HALF, FLOAT = 0, 1, 2
CODES = {UINT: "I", HALF: "e", FLOAT: "f"}


class Image:
    def __init__(self, width, height, channels):
        self.width, self.height, self.channels = width, height, channels     # name: array, lines from the top
        self.attributes = {}                                                 # name: its bytes

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
    lines = {b"\0": 1, b"\3": 16}.get(attributes["compression"])           # of a block: no compression, ZIP
    if lines is None:
        raise ValueError(f"{path}: compressed neither by ZIP nor not at all")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names, raw, place = [], attributes["channels"], 0
    while raw[place]:
        end = raw.index(b"\0", place)
        names.append((raw[place:end].decode(), struct.unpack_from("<i", raw, end + 1)[0]))
        place = end + 17
    channels = {name: array.array("I" if kind == UINT else "f") for name, kind in names}
    line = sum(width * (2 if kind == HALF else 4) for _, kind in names)
    for block, offset in enumerate(struct.unpack_from(f"<{-(-height // lines)}Q", data, at + 1)):
        count = min(lines, height - block * lines)
        size, = struct.unpack_from("<i", data, offset + 4)
        raw, start = data[offset + 8:offset + 8 + size], 0
        if size < count * line:                                              # a block that ZIP would not make smaller is stored
            raw = unzipped(raw)
        for _ in range(count):
            for name, kind in names:
                size = width * (2 if kind == HALF else 4)
                values = raw[start:start + size]
                if kind == HALF:
                    channels[name].extend(struct.unpack(f"<{width}e", values))
                else:
                    channels[name].frombytes(values)
                start += size
    image = Image(width, height, channels)
    image.attributes = attributes
    return image


def unzipped(block):
    """Undoes OpenEXR's ZIP: deflate; differences of bytes, with 128 added; the even bytes first, then the odd ones.
    The byte at i is (sum of all up to it) - 128 i modulo 256: of odd i the top bit is turned."""
    sums = array.array("Q", itertools.accumulate(zlib.decompress(block)))
    data = bytearray(sums.tobytes()[::8])                                    # the low bytes, as the processor is little-endian
    data[1::2] = data[1::2].translate(bytes(b ^ 128 for b in range(256)))
    half, result = (len(data) + 1) // 2, bytearray(len(data))
    result[0::2], result[1::2] = data[:half], data[half:]
    return bytes(result)


def write(path, width, height, channels, matrices=None, numbers=None, place=None):
    """channels: name -> values, lines from the top; float, or uint where they are array.array("I"). matrices: name -> the bytes
    of a 4x4 float attribute, as read() gives them. numbers: name -> value of a double attribute. place: (x, y, display width, display height) of a data window that is not the display window."""
    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    def code(name):
        return getattr(channels[name], "typecode", "f")
    names = sorted(channels)
    left, top, shown_width, shown_height = place or (0, 0, width, height)
    window = struct.pack("<4i", left, top, left + width - 1, top + height - 1)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iiii", UINT if code(n) == "I" else FLOAT, 0, 1, 1) for n in names) + b"\0"
    header = struct.pack("<II", 20000630, 2) + b"".join([
        attribute("channels", "chlist", listed), attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window), attribute("displayWindow", "box2i", struct.pack("<4i", 0, 0, shown_width - 1, shown_height - 1)),
        attribute("lineOrder", "lineOrder", b"\0"), attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
        *(attribute(name, "m44f", value) for name, value in (matrices or {}).items()),
        *(attribute(name, "double", struct.pack("<d", value)) for name, value in (numbers or {}).items())]) + b"\0"
    line = 8 + 4 * width * len(names)
    with open(path, "wb") as file:
        file.write(header)
        first = len(header) + 8 * height
        file.write(struct.pack(f"<{height}Q", *(first + y * line for y in range(height))))
        for y in range(height):
            file.write(struct.pack("<ii", top + y, line - 8))
            for name in names:
                file.write(array.array("I" if code(name) == "I" else "f", channels[name][y * width:(y + 1) * width]).tobytes())

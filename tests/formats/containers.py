"""Header, blocks and end block of .irradpoints and .irradcache. Written from formats/conventions.md ("Containers") alone.

Used by read_irradpoints.py and read_irradcache.py. Checks everything but what a page says of its keys, records and totals.
"""
import json
import math
import os
import re
import struct
import sys
import zlib

HASHES = ["static-geometry", "moving-geometry", "materials", "lights", "media"]
IDENTITY = ["frames"] + HASHES
REAL = r"-?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?"


def refuse(offset, reason):
    raise ValueError(f"byte {offset}: {reason}")


def reals(text, count):
    """So many finite real numbers, or None."""
    good = re.fullmatch(" ".join([REAL] * count), text)
    values = [float(x) for x in text.split(" ")] if good else []
    return values if values and all(map(math.isfinite, values)) else None


def integers(text, count, low, high):
    good = re.fullmatch(" ".join([r"-?[0-9]+"] * count), text)
    values = [int(v) for v in text.split(" ")] if good else []
    return values if values and all(low <= v <= high for v in values) else None


def good_frames(text):
    frames = integers(text, 2, -2**31, 2**31 - 1)
    return bool(frames) and frames[0] <= frames[1]


def parse_text(text, later, required, rules):
    """(header, history). rules: of each key of the page, optional ones too, a function of its value: is it good?"""
    rules = rules | {"origin": lambda v: reals(v, 3), "frames": good_frames}
    rules |= {key: lambda v: re.fullmatch("[!-~]{1,128}", v) for key in HASHES}
    header, history = {}, []
    if text and not text.endswith(b"\n"):
        refuse(16, "header line without LF")
    for line in text.split(b"\n")[:-1]:
        key, colon, value = line.decode("utf-8", "replace").partition(": ")
        if not colon or any(b < 32 or b == 127 for b in line):
            refuse(16, "header line is not 'key: value'")
        if key == "history":
            history.append(value)
        elif key in header:
            refuse(16, f"key twice: {key}")
        elif key in rules:
            if not rules[key](value):
                refuse(16, f"bad value of {key}")
            header[key] = value
        elif not later:
            refuse(16, f"unknown key: {key}")
    for key in required + ["origin"]:
        if key not in header:
            refuse(16, f"key missing: {key}")
    if "frames" not in header and any(key in header for key in HASHES):
        refuse(16, "hashes without frames")
    return header, history


def read_container(path, magic, mark, required, rules, record_sizes, end_format, since={}):
    """(header, history, blocks, totals). since: the minor version of keys that came later than 1.0. record_sizes(header): bytes of a record, then of an entry of each column. Blocks:
    a list of (offset of the body, n, [bytes of all records, bytes of each column]); totals: end_format unpacked."""
    with open(path, "rb") as stream:
        return parse_container(stream, magic, mark, required, rules, record_sizes, end_format, since)


def parse_container(stream, magic, mark, required, rules, record_sizes, end_format, since):
    offset = 0

    def take(size):
        nonlocal offset
        data = stream.read(size)
        if len(data) != size:
            refuse(offset + len(data), "truncated")
        offset += size
        return data

    fixed = take(16)
    found, major, minor, text_size = struct.unpack("<8sHHI", fixed)
    if found != magic or major != 1 or text_size > 1 << 20:
        refuse(0, "not a file of this format, version 1")
    text = take(text_size)
    chain = take(4)
    if struct.unpack("<I", chain)[0] != zlib.crc32(fixed + text):
        refuse(offset - 4, "wrong checksum of the header")
    known = {key: rule for key, rule in rules.items() if since.get(key, 0) <= minor}
    header, history = parse_text(text, minor > max(since.values(), default=0), required, known)
    sizes = record_sizes(header)

    blocks = []
    while (found := take(4)) == mark:
        head = take(8)
        count, crc = struct.unpack("<II", head)
        if count > 65536:
            refuse(offset - 8, "count above its limit")
        start = offset
        parts = [take(size * count) for size in sizes]
        if crc != zlib.crc32(b"".join([mark, head[:4]] + parts)):
            refuse(start - 4, "wrong checksum of a block")
        chain += head[4:]
        blocks.append((start, count, parts))
    if found != b"END!":
        refuse(offset - 4, "unknown mark")
    end = found + take(struct.calcsize(end_format))
    if struct.unpack("<I", take(4))[0] != zlib.crc32(end, zlib.crc32(chain)):
        refuse(offset - 4, "wrong chain")
    if stream.read(1):
        refuse(offset, "bytes after the end block")
    return header, history, blocks, struct.unpack(end_format, end[4:])


def encode_container(magic, mark, keys, header, history, blocks, end, minor=0):
    """The bytes of a file. Of the header the keys named, in their order, then the identity. blocks: lists of (n, parts); end: bytes."""
    lines = [f"{key}: {header[key]}\n" for key in keys + IDENTITY if key in header]
    text = "".join(lines + [f"history: {line}\n" for line in history]).encode()
    head = struct.pack("<8sHHI", magic, 1, minor, len(text)) + text
    chain = struct.pack("<I", zlib.crc32(head))
    out = [head, chain]
    for count, parts in blocks:
        head, body = struct.pack("<4sI", mark, count), b"".join(parts)
        crc = struct.pack("<I", zlib.crc32(head + body))
        out += [head, crc, body]
        chain += crc
    end = b"END!" + end
    return b"".join(out + [end, struct.pack("<I", zlib.crc32(end, zlib.crc32(chain)))])


def cut(values, size=65536):
    """Pieces of at most `size`; none of an empty list."""
    return [values[i:i + size] for i in range(0, len(values), size)]


def exact_sums(triples):
    """Exact sums, rounded once, of three channels, of the values as a file holds them: float32."""
    triples = [struct.unpack("<3f", struct.pack("<3f", *t)) for t in triples]
    return tuple(math.fsum(t[c] for t in triples) for c in range(3))


def save(path, data):
    with open(path + ".tmp", "wb") as stream:
        stream.write(data)
    os.replace(path + ".tmp", path)


def damages(good, end, block):
    """(name, bytes) of a good file of one block that is damaged in ways any container may be. end: bytes of its end block; block: so many bytes off, the
    file ends inside of the block."""
    yield "copied-as-text", good.replace(b"\r\n", b"\n", 1)
    yield "major-version-2", good[:8] + b"\2" + good[9:]
    yield "end-checksum", good[:-1] + bytes([good[-1] ^ 1])
    yield "no-end-block", good[:-end]
    yield "ends-inside-block", good[:-block]
    yield "ends-inside-header", good[:30]
    yield "empty-file", b""
    yield "bytes-after-end", good + b"\0"
    yield "two-files-in-one", good + good


def second_reader(doc, read, numbers, write):
    """The main of a second reader: FILE [COPY]. Prints numbers of FILE as JSON, writes it again to COPY; of a bad file the reason, exit 2."""
    if len(sys.argv) not in (2, 3):
        sys.exit(doc)
    try:
        file = read(sys.argv[1])
    except (ValueError, OSError) as error:
        print(f"{sys.argv[1]}: {error}", file=sys.stderr)
        sys.exit(2)
    print(json.dumps(numbers(file), indent=1))
    if len(sys.argv) == 3:
        write(sys.argv[2], file)

#!/usr/bin/env python3
"""Pictures of files that have none, from what tempolux-info and scene-plan say of them, for README.md.

  draw.py points POINTS.csv FRAME.json OUT.png [WIDTH]   points where the frame's camera sees them, nearest on top,
                                                         as squares WIDTH metres wide
  draw.py dots POINTS.csv FRAME.json FRAME.png OUT.png   as dots over the darkened frame
  draw.py kept KEPT.radsamples FRAME.json FRAME.png OUT.png   likewise records with their samples, the redder the more of these
                                                         met what moves
  draw.py windows D.meshirrad FRAME.json OUT.png         elements of gather-temporal density by the frames in their windows: dark blue
                                                         a single frame, white 33; red where they lie after the frame, green before
  draw.py plan PLAN.json OUT.png                         a column for each frame, a row for each concern of the scene;
                                                         equal colours in a row: equal content

POINTS.csv: tempolux-info --export; FRAME.json: tempolux-info --json of the frame's EXR."""
import csv
import json
import math
import os
import struct
import sys
import zlib


def write_png(path, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + bytes(v for pixel in row for v in pixel) for row in rows)
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def read_png(path):
    """Rows of a PNG of 8 bits and three channels, as tempolux-info writes them."""
    data, at, packed = open(path, "rb").read(), 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            width, height = struct.unpack_from(">II", data, at + 8)
        elif kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += size + 12
    raw, stride, above, rows = zlib.decompress(packed), 3 * width, bytes(3 * width), []
    for y in range(height):
        code, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a, b, c = line[i - 3] if i >= 3 else 0, above[i], above[i - 3] if i >= 3 else 0
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[i] = (line[i] + (0, a, b, (a + b) // 2, paeth)[code]) & 255
        above = bytes(line)
        rows.append([tuple(line[i:i + 3]) for i in range(0, stride, 3)])
    return rows


def seen(rows, frame, width, height):
    """(depth, x, y, row) in pixels of the points before the camera whose lit side is turned to it, farthest first."""
    m, turn, found = frame["worldToNDC"], frame["worldToCamera"], []
    eye = [-sum(turn[12 + i] * turn[4 * c + i] for i in range(3)) for c in range(3)]
    for row in rows:
        p = (float(row["x_m"]), float(row["y_m"]), float(row["z_m"]), 1.0)
        x, y, w = (sum(p[i] * m[4 * i + c] for i in range(4)) for c in (0, 1, 3))
        facing = sum((eye[c] - p[c]) * float(row[n]) for c, n in enumerate(("nx", "ny", "nz"))) > 0
        if facing and w > 1e-3 and 0 <= x < w and 0 <= y < w:
            found.append((w, int(x / w * width), int(y / w * height), row))
    return sorted(found, key=lambda point: -point[0])


def light_of(row):
    """Flux of a photon, irradiance of a point or record: R, G, B."""
    kinds = ("flux_{}_W", "irradiance_{}_W_m2", "direct_{}_W_m2", "caustic_{}_W_m2", "indirect_{}_W_m2")
    return [sum(float(row.get(kind.format(c), 0)) for kind in kinds) for c in "rgb"]


def colour(light, white):
    return tuple(round(255 * min(1.0, max(0.0, x / white)) ** (1 / 2.2)) for x in light)


def splat(rows, x, y, size, value):
    for v in range(max(0, y), min(len(rows), y + size)):
        for u in range(max(0, x), min(len(rows[0]), x + size)):
            rows[v][u] = value


def points(table, frame, out, width_m=0.02):
    frame, rows = json.load(open(frame)), list(csv.DictReader(open(table)))
    width, height = frame["width"], frame["height"]
    brightness = sorted(max(light_of(row)) for row in rows)
    white = brightness[len(brightness) * 98 // 100]
    image = [[(0, 0, 0)] * width for _ in range(height)]
    scale = float(width_m) * width * math.hypot(*frame["worldToNDC"][0:12:4])
    for depth, x, y, row in seen(rows, frame, width, height):
        size = 1 + round(scale / depth)
        splat(image, x - size // 2, y - size // 2, size, colour(light_of(row), white))
    write_png(out, image)


def dots(table, frame, picture, out):
    frame, rows = json.load(open(frame)), list(csv.DictReader(open(table)))
    image = [[tuple(v * 2 // 5 for v in pixel) for pixel in row] for row in read_png(picture)]
    for _, x, y, row in seen(rows, frame, len(image[0]), len(image)):
        splat(image, x, y, 1, (255, 170, 60) if row.get("set") == "dynamic" else (255, 255, 255))
    write_png(out, image)


def kept(samples, frame, picture, out):
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "formats"))
    from read_radsamples import DYNAMIC, read_radsamples
    file, frame = read_radsamples(samples), json.load(open(frame))
    origin, rows = [float(x) for x in file.header["origin"].split()], []
    for r in file.records:
        met = sum(bool(s.flags & DYNAMIC) for s in r.samples) / len(r.samples)
        place = [a + b for a, b in zip(r.position, origin)]
        rows.append({**dict(zip(("x_m", "y_m", "z_m", "nx", "ny", "nz"), (*place, *r.normal))), "share": 1.0 if r.set else met})
    image = [[tuple(v * 2 // 5 for v in pixel) for pixel in row] for row in read_png(picture)]
    for _, x, y, row in seen(rows, frame, len(image[0]), len(image)):
        hot = min(1.0, 4 * row["share"])
        splat(image, x, y, 2, (255, round(255 - 195 * hot), round(255 - 235 * hot)))
    write_png(out, image)


def windows(texture, frame, out):
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "formats"))
    import read_meshirrad as mesh
    file, frame = mesh.read_meshirrad(texture), json.load(open(frame))
    origin, rows = [float(x) for x in file.header["origin"].split()], []
    for e in file.elements:
        u, v = (c / 65534 * 2 - 1 for c in e[mesh.NORMAL:mesh.NORMAL + 2])
        n = [u, v, 1 - abs(u) - abs(v)]
        if n[2] < 0:
            n[:2] = (1 - abs(v)) * math.copysign(1, u), (1 - abs(u)) * math.copysign(1, v)
        if e[mesh.PHOTONS]:
            place = [a + b for a, b in zip(e[mesh.POSITION:mesh.POSITION + 3], origin)]
            rows.append({**dict(zip(("x_m", "y_m", "z_m", "nx", "ny", "nz"), (*place, *n))), "area": e[mesh.AREA], "window": (e[mesh.BEFORE], e[mesh.AFTER])})
    width, height = frame["width"], frame["height"]
    image = [[(0, 0, 0)] * width for _ in range(height)]
    scale = width * math.hypot(*frame["worldToNDC"][0:12:4])
    for depth, x, y, row in seen(rows, frame, width, height):
        before, after = row["window"]
        size = 1 + round(0.8 * math.sqrt(row["area"]) * scale / depth)
        length = (before + after) / 32
        splat(image, x - size // 2, y - size // 2, size, tuple(round(255 * min(1, v)) for v in (0.1 + length * 0.7 + max(0, after - before) / 32, 0.1 + length * 0.7 + max(0, before - after) / 32, 0.4 + 0.6 * length)))
    write_png(out, image)


def plan(document, out):
    document = json.load(open(document))
    columns = []
    for segment in document["segments"]:
        for frame in segment["frames"]:
            if frame["frame"] in document["frames"]:
                hashes = {**segment["hashes"], **frame["hashes"]}
                columns.append([hashes[k] for k in ("static_geometry", "materials", "moving_geometry", "lights", "camera")])
    step, tall, image = max(2, 320 // len(columns)), 18, []
    for concern in range(5):
        line = []
        for column in columns:
            value = tuple(60 + int(column[concern][2 * i:2 * i + 2], 16) * 3 // 4 for i in range(3))
            line += [value] * (step - 1) + [(255, 255, 255)]
        image += [line] * (tall - 3) + [[(255, 255, 255)] * len(line)] * 3
    write_png(out, image)


if __name__ == "__main__":
    commands = {"points": points, "dots": dots, "kept": kept, "windows": windows, "plan": plan}
    if len(sys.argv) < 4 or sys.argv[1] not in commands:
        sys.exit(__doc__)
    commands[sys.argv[1]](*sys.argv[2:])

#!/usr/bin/env python3
"""Write the demo's room at evening: make_evening.py > evening.glb

A living room of 5.2 m x 4.8 m x 2.6 m in which a lamp with a shade is lit. A window looks out to the last light of the sky, a picture on a
wall 2 m outside. A red balloon drifts across the room, and the camera walks in: 48 frames of 24 a second. No Blender and no library is
needed. Lengths are in metres, y up; light is in W/m^2/sr.
"""
import json
import math
import random
import struct
import sys
import zlib

from make_walkthrough import FPS, FRAMES, add_accessor, animate


class Mesh:
    """Corners with normals, texture coordinates and colours, and triangles over them."""

    def __init__(self):
        self.positions, self.normals, self.uvs, self.colors, self.triangles = [], [], [], [], []

    def grid(self, columns, rows, point, flip=False, color=None):
        """(columns + 1) x (rows + 1) corners; point(i, j) gives position, normal and texture coordinates of one."""
        first = len(self.positions)
        for j in range(rows + 1):
            for i in range(columns + 1):
                position, normal, uv = point(i, j)
                self.positions.append(tuple(struct.unpack("<3f", struct.pack("<3f", *position))))
                self.normals.append(unit(normal))
                self.uvs.append(tuple(uv))
                self.colors.append(tuple(color or (1, 1, 1)))
        for j in range(rows):
            for i in range(columns):
                a = first + j * (columns + 1) + i
                b, c, d = a + 1, a + columns + 2, a + columns + 1
                for triangle in ([a, c, b], [a, d, c]) if flip else ([a, b, c], [a, c, d]):
                    if len({self.positions[k] for k in triangle}) == 3:   # two corners are one at the pole of a lathe
                        self.triangles += triangle
        return self


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def quad(mesh, origin, u, v, tiles=(1, 1), color=None):
    """A parallelogram with its front where u x v points. Texture coordinates have v down, as glTF has them."""
    normal = cross(u, v)
    corner = lambda i, j: ([o + i * a + j * b for o, a, b in zip(origin, u, v)], normal, (i * tiles[0], (1 - j) * tiles[1]))
    return mesh.grid(1, 1, corner, color=color)


def box(mesh, lower, upper, color=None):
    size = [b - a for a, b in zip(lower, upper)]
    for axis in range(3):
        u, v = [0, 0, 0], [0, 0, 0]
        u[(axis + 1) % 3], v[(axis + 2) % 3] = size[(axis + 1) % 3], size[(axis + 2) % 3]
        far = list(lower)
        far[axis] = upper[axis]
        quad(mesh, far, u, v, color=color)
        quad(mesh, lower, v, u, color=color)
    return mesh


def cushion(mesh, lower, upper, radius, steps=3, turn=None):
    """A box whose edges are rounded by `radius`; `turn` maps position and normal to where it stands."""
    radius = min([radius, *((b - a) / 2 for a, b in zip(lower, upper))])
    along = [(0, k / steps - 1) for k in range(steps + 1)] + [(1, k / steps) for k in range(steps + 1)]   # side, tangent of the angle
    last = len(along) - 1
    for axis in range(3):
        for side in (0, 1):
            def corner(i, j):
                at, towards = [side] * 3, [0.0] * 3
                towards[axis] = 2 * side - 1
                for k, which in (((axis + 1) % 3, along[i]), ((axis + 2) % 3, along[j])):
                    at[k], towards[k] = which[0], math.tan(which[1] * math.pi / 4)
                normal = unit(towards)
                position = [(b - radius if s else a + radius) + radius * n for a, b, s, n in zip(lower, upper, at, normal)]
                if turn:
                    position, normal = turn(position, normal)
                return position, normal, (0, 0)
            mesh.grid(last, last, corner, flip=side == 0)
    return mesh


def about_y(degrees, center):
    """Turns about an upright axis through `center` (x, z), for cushion."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    spin = lambda p: (c * p[0] + s * p[2], p[1], c * p[2] - s * p[0])
    def turn(position, normal):
        p = spin((position[0] - center[0], position[1], position[2] - center[1]))
        return (p[0] + center[0], p[1], p[2] + center[1]), spin(normal)
    return turn


def lathe(mesh, center, profile, segments=32):
    """A surface of revolution. `profile`: lines of points (radius, height), each smooth; edges lie between them. Fronts lie to the right
    of a line that is walked: outside, if it is walked downwards."""
    for line in profile:
        def corner(i, j):
            r, y = line[j]
            before, after = line[max(j - 1, 0)], line[min(j + 1, len(line) - 1)]
            dr, dy = after[0] - before[0], after[1] - before[1]
            c, s = math.cos(2 * math.pi * i / segments), -math.sin(2 * math.pi * i / segments)
            return (center[0] + r * c, center[1] + y, center[2] + r * s), (-dy * c, dr, -dy * s), (i / segments, j / (len(line) - 1))
        mesh.grid(segments, len(line) - 1, corner, flip=True)
    return mesh


def curve(points, steps=8):
    """A smooth line through points (Catmull-Rom)."""
    ends = [points[0], *points, points[-1]]
    line = []
    for a, b, c, d in zip(ends, ends[1:], ends[2:], ends[3:]):
        for k in range(steps):
            t = k / steps
            line.append(tuple(.5 * (2 * q + (r - p) * t + (2 * p - 5 * q + 4 * r - s) * t * t + (3 * q - p - 3 * r + s) * t ** 3)
                              for p, q, r, s in zip(a, b, c, d)))
    return [*line, points[-1]]


# ---- pictures: rows of palette entries, written as PNG

def png(rows, palette):
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 3, 0, 0, 0)
    entries = b"".join(bytes(round(255 * srgb(x)) for x in color) for color in palette)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"PLTE", entries)
            + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)) + chunk(b"IEND", b""))


def srgb(x):
    x = min(max(x, 0), 1)
    return 12.92 * x if x <= .0031308 else 1.055 * x ** (1 / 2.4) - .055


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def planks(size=256, boards=6):
    """A floor of boards: each has a tone and grain of its own."""
    rng = random.Random(1)
    palette = [mix((.07, .03, .012), (.34, .17, .075), k / 31) for k in range(32)]
    rows = []
    for y in range(size):
        board, inside = divmod(y * boards, size)
        if inside < boards:   # the gap
            tone = [rng.uniform(.45, .85) for _ in range(3)]
            joint, phase = rng.randrange(size), rng.uniform(0, 9)
            rows.append([2] * size)
            continue
        row, wobble = [], rng.uniform(-.06, .06)
        for x in range(size):
            t = tone[(x > joint) + (x > joint + size // 2)] + wobble
            t += .07 * math.sin(.9 * y + phase + 2.2 * math.sin(2 * math.pi * x / size + phase) + 1.5 * math.sin(4 * math.pi * x / size + board))
            row.append(2 if x in (joint, joint + size // 2) else max(0, min(31, int(32 * t))))
        rows.append(row)
    return png(rows, palette)


def carpet(width=120, height=168):
    """Diamonds within a border."""
    palette = [(.55, .44, .30), (.30, .035, .03), (.03, .07, .14), (.62, .30, .06)]
    def thread(x, y):
        edge = min(x, y, width - 1 - x, height - 1 - y)
        if edge < 12:
            return (1, 1, 0, 2, 2, 2, 2, 0, 1, 1, 1, 0)[edge] if edge != 4 or (x + y) % 6 else 3
        u, v = abs((x - 12) % 48 - 24), abs((y - 12) % 48 - 24)
        ring = u + v
        return 1 if ring < 5 else 3 if ring < 8 else 2 if 13 <= ring < 16 else 0 if ring < 22 else 1 if ring < 25 else 0
    return png([[thread(x, y) for x in range(width)] for y in range(height)], palette)


def painting(width=160, height=112):
    """A sun over the sea."""
    palette = [(.80, .50, .22), (.70, .30, .14), (.85, .70, .45), (.05, .16, .22), (.10, .28, .32), (.75, .16, .06), (.02, .07, .11)]
    def stroke(x, y):
        if math.hypot(x - 105, y - 46) < 19 and y < 62:
            return 5
        if y >= 62:
            glint = abs(x - 105) < 14 - (y - 62) * .1 and (y // 3) % 2
            return 1 if glint else 6 if y > 94 + 4 * math.sin(x / 9) else 4 if (y + int(2 * math.sin(x / 11))) % 9 < 3 else 3
        return 2 if y < 16 + 5 * math.sin(x / 24) else 0 if y < 42 + 4 * math.sin(x / 17 + 2) else 1
    return png([[stroke(x, y) for x in range(width)] for y in range(height)], palette)


def dusk(width=256, height=192):
    """The sky after sunset over hills and trees; the brightest is 1."""
    rng = random.Random(4)
    stops = [(0, (.10, .17, .42)), (.45, (.22, .30, .52)), (.7, (.62, .42, .40)), (.86, (1, .52, .20)), (1, (1, .62, .25))]
    def sky(t):
        (t0, a), (t1, b) = next((p, q) for p, q in zip(stops, stops[1:]) if t <= q[0])
        return mix(a, b, (t - t0) / (t1 - t0))
    palette = [sky(k / 239) for k in range(240)] + [(.05, .06, .10), (.022, .028, .04), (.008, .011, .012)]
    trees = [(rng.uniform(0, width), rng.uniform(7, 15), rng.uniform(16, 40)) for _ in range(13)]
    rows = []
    for y in range(height):
        row = []
        for x in range(width):
            cloud = .5 * math.sin(x / 31 + y / 9) + .5 * math.sin(x / 13 - y / 5 + 2)
            t = y / (.72 * height) + (.05 * cloud * math.exp(-((y - 80) / 22) ** 2))
            k = max(0, min(239, int(239 * t)))
            if y > 128 + 9 * math.sin(x / 41 + 1) + 4 * math.sin(x / 17):
                k = 240
            if y > 143 + 6 * math.sin(x / 29 + 4) + 2 * math.sin(x / 9):
                k = 241
            for at, wide, high in trees:
                if ((x - at) / wide) ** 2 + ((y - 160) / high) ** 2 < 1 + .12 * math.sin(x * 1.9) * math.sin(y * 1.3):
                    k = 242
            row.append(242 if y > 160 else k)
        rows.append(row)
    return png(rows, palette)


# ---- the room

MATERIALS = {   # base colour, further members of pbrMetallicRoughness; SHINY ones keep glTF's coat of index 1.5
    "Plaster": (.66, .60, .50), "Back wall": (.26, .33, .30), "Ceiling": (.72, .69, .64), "Wood": (.23, .105, .045), "Dark wood": (.075, .035, .018),
    "White paint": (.70, .68, .63), "Curtain": (.42, .10, .045), "Sofa": (.055, .14, .17), "Mustard": (.60, .31, .045), "Cream": (.68, .58, .43),
    "Leaf": (.055, .19, .045), "Terracotta": (.47, .17, .08), "Books": (1, 1, 1), "Black": (.02, .02, .02), "Thread": (.5, .5, .45),
    "Table top": (.12, .05, .022), "Porcelain": (.72, .70, .64), "Balloon": (.62, .018, .012), "Brass": (.84, .60, .28), "Glass": (.96, .985, .97),
    "Floor": (1, 1, 1), "Carpet": (1, 1, 1), "Painting": (1, 1, 1), "Shade": (.75, .62, .42), "Dusk": (1, 1, 1)}
SHINY = {"Porcelain": .12, "Balloon": .16}
TEXTURES = {"Floor": planks, "Carpet": carpet, "Painting": painting, "Dusk": dusk}
EMITTING = {"Shade": (15, 9.6, 5.2)}


def window(parts, x0, x1, y0, y1, z):
    """An opening in the back wall with its reveal, a cross of bars and a sill; `z` is the wall's plane."""
    wall, depth = parts["Back wall"], .16
    for a, b, c, d in ((-2.6, x0, 0, 2.6), (x1, 2.6, 0, 2.6), (x0, x1, 0, y0), (x0, x1, y1, 2.6)):
        quad(wall, (a, c, z), (b - a, 0, 0), (0, d - c, 0))
    frame = parts["White paint"]
    w, h = x1 - x0, y1 - y0
    for origin, u, v in (((x0, y0, z), (0, h, 0), (0, 0, -depth)), ((x1, y0, z), (0, 0, -depth), (0, h, 0)),
                         ((x0, y0, z), (0, 0, -depth), (w, 0, 0)), ((x0, y1, z), (w, 0, 0), (0, 0, -depth))):
        quad(frame, origin, u, v)
    box(frame, (x0 - .06, y0 - .04, z - .02), (x1 + .06, y0, z + .13))
    mid, half = (x0 + x1) / 2, .022
    for lower, upper in (((mid - half, y0, z - .12), (mid + half, y1, z - .08)), ((x0, y1 - .42, z - .12), (x1, y1 - .42 + 2 * half, z - .08)),
                         ((x0, y0, z - .13), (x0 + .05, y1, z - .07)), ((x1 - .05, y0, z - .13), (x1, y1, z - .07)),
                         ((x0, y0, z - .13), (x1, y0 + .05, z - .07)), ((x0, y1 - .05, z - .13), (x1, y1, z - .07))):
        box(frame, lower, upper)
    quad(parts["Dusk"], (x0 - .32, y0 - .2, z - .45), (w + .42, 0, 0), (0, h + .3, 0))


def curtain(mesh, x0, x1, y0, y1, z, folds):
    """A cloth that hangs in folds; seen from both sides."""
    def corner(i, j):
        t = i / (8 * folds)
        deep = .035 * (1 + .25 * (1 - j / 2))
        phase = 2 * math.pi * folds * t + .3 * j / 2
        slope = deep * 2 * math.pi * folds / (x1 - x0) * math.cos(phase)
        return (x0 + (x1 - x0) * t, y0 + (y1 - y0) * j / 2, z + deep * math.sin(phase)), (-slope, 0, 1), (0, 0)
    mesh.grid(8 * folds, 2, corner)


def plant(parts, center, height, rng, leaves=15):
    """A pot, and leaves that bend out of it."""
    x, y, z = center
    lathe(parts["Terracotta"], center, [[(.085, .17), (.105, .17)], [(.105, .17), (.105, .135)], [(.095, .135), (.07, 0)], [(.085, .17), (.08, .13)],
                                        [(.08, .13), (0, .13)]], 24)
    for k in range(leaves):
        turn, lean = 2.4 * k + rng.uniform(-.3, .3), rng.uniform(.2, .75)
        tall, wide = height * rng.uniform(.7, 1.05), rng.uniform(.035, .055)
        c, s = math.cos(turn), math.sin(turn)
        def corner(i, j):
            t = j / 8
            out, up = lean * height * t * t * 1.1 + .02, .12 + tall * (t - .32 * lean * t * t * t)
            across = (i - 1) * wide * math.sin(math.pi * min(1, .08 + .92 * t)) ** .8
            fold = abs(i - 1) * .25 * wide
            slope = (lean * height * 2.2 * t + .02) / (tall * (1 - lean * t * t))
            normal = (-c + .5 * (i - 1) * -s * -1, slope, -s + .5 * (i - 1) * c * -1)
            return (x + c * (out - fold) - s * across, y + up, z + s * (out - fold) + c * across), normal, (0, 0)
        parts["Leaf"].grid(2, 8, corner)


def seat(parts, fabric, center, size, turn_degrees, cushions):
    """A sofa or a chair that faces +z before it is turned; its middle on the floor at `center`."""
    x, z = center
    w, d = size[0] / 2, size[1] / 2
    turn = about_y(turn_degrees, center)
    part = lambda mesh, x0, x1, y0, y1, z0, z1, r: cushion(parts[mesh], (x + x0, y0, z + z0), (x + x1, y1, z + z1), r, turn=turn)
    part(fabric, -w, w, .12, .34, -d, d - .02, .05)
    part(fabric, -w + .02, w - .02, .25, .84, -d, -d + .24, .09)
    part(fabric, -w, -w + .18, .14, .60, -d + .02, d, .08)
    part(fabric, w - .18, w, .14, .60, -d + .02, d, .08)
    wide = (2 * w - .36) / cushions
    for k in range(cushions):
        left = -w + .18 + k * wide
        part(fabric, left + .008, left + wide - .008, .33, .47, -d + .2, d + .015, .06)
        part(fabric, left + .012, left + wide - .012, .45, .80, -d + .17, -d + .36, .085)
    for a in (-w + .1, w - .1):
        for b in (-d + .1, d - .1):
            part("Dark wood", a - .025, a + .025, 0, .14, b - .025, b + .025, .01)


def table(parts, x, z):
    """A low round table, and what stands on it: books, a cup, a glass bowl, a brass ball."""
    top = .42
    lathe(parts["Table top"], (x, 0, z), [[(0, top), (.46, top)], curve([(.46, top), (.475, top - .012), (.46, top - .03)], 4), [(.46, top - .03), (0, top - .03)]], 48)
    for k in range(3):
        a = 2 * math.pi * k / 3 + .5
        turn = about_y(math.degrees(-a), (x, z))
        cushion(parts["Dark wood"], (x + .30, 0, z - .025), (x + .36, top - .03, z + .025), .02, 2, turn)
    for k, (w, d, color) in enumerate(((.26, .19, (.06, .14, .22)), (.23, .17, (.62, .54, .40)), (.19, .14, (.42, .06, .04)))):
        lower, upper = (-w / 2, top + .026 * k, -d / 2), (w / 2, top + .026 * (k + 1) - .001, d / 2)
        turn, first = about_y(18 - 17 * k, (x - .20, z + .10)), len(parts["Books"].positions)
        box(parts["Books"], [lower[0] + x - .20, lower[1], lower[2] + z + .10], [upper[0] + x - .20, upper[1], upper[2] + z + .10], color)
        mesh = parts["Books"]
        for i in range(first, len(mesh.positions)):
            mesh.positions[i], mesh.normals[i] = turn(mesh.positions[i], mesh.normals[i])
    cup = [curve([(.041, .075), (.040, .04), (.030, .008), (.022, 0)], 5), [(.022, 0), (0, 0)], [(.038, .075), (.041, .075)],
           curve([(0, .012), (.026, .012), (.036, .04), (.038, .075)], 5)]
    lathe(parts["Porcelain"], (x + .04, top, z + .27), cup, 28)
    lathe(parts["Porcelain"], (x + .04, top - .0005, z + .27), [[(0, .006), (.05, .006), (.073, .013)], [(.073, .013), (.045, .0005), (0, .0005)]], 28)
    bowl = [curve([(.150, .105), (.140, .06), (.10, .02), (.06, .004)], 4), [(.06, .004), (0, .004)], curve([(0, .014), (.062, .014), (.10, .03), (.136, .065), (.146, .105)], 4),
            [(.146, .105), (.150, .105)]]
    lathe(parts["Porcelain"], (x + .19, top - .003, z - .03), bowl, 32)
    tumbler = [[(.038, .095), (.030, .0)], [(.030, .0), (0, .0)], [(0, .012), (.028, .012)], [(.028, .012), (.0345, .095)], [(.0345, .095), (.038, .095)]]
    lathe(parts["Glass"], (x - .10, top + .001, z + .30), tumbler, 24)
    sphere(parts["Mustard"], (x + .165, top + .013 + .052, z - .05), .050, 20)
    sphere(parts["Terracotta"], (x + .245, top + .013 + .050, z - .01), .043, 20)
    sphere(parts["Leaf"], (x + .19, top + .013 + .054, z + .045), .042, 20)


def sphere(mesh, center, radius, segments=32):
    half = segments // 2
    points = [(radius * math.sin(math.pi * k / half) if 0 < k < half else 0, radius * math.cos(math.pi * k / half)) for k in range(half + 1)]
    return lathe(mesh, center, [points], segments)


def lamp(parts, x, z):
    """A lamp that hangs over the table: a wide shade of paper that glows, closed above and below."""
    top, bottom = (.185, 2.08), (.235, 1.87)
    lathe(parts["Shade"], (x, 0, z), [[(0, top[1]), top], [top, bottom], [bottom, (0, bottom[1])]], 20)
    lathe(parts["Black"], (x, 0, z), [[(.008, 2.6), (.008, top[1])]], 8)
    lathe(parts["Black"], (x, 0, z), [[(.05, 2.6), (.05, 2.575)], [(.05, 2.575), (0, 2.575)]], 16)


def furnish(parts):
    rng = random.Random(7)
    quad(parts["Floor"], (-2.6, 0, 2.4), (5.2, 0, 0), (0, 0, -4.8), (2, 2))
    quad(parts["Ceiling"], (-2.6, 2.6, -2.4), (5.2, 0, 0), (0, 0, 4.8))
    quad(parts["Plaster"], (-2.6, 0, 2.4), (0, 0, -4.8), (0, 2.6, 0))
    quad(parts["Plaster"], (2.6, 0, -2.4), (0, 0, 4.8), (0, 2.6, 0))
    quad(parts["Plaster"], (2.6, 0, 2.4), (-5.2, 0, 0), (0, 2.6, 0))
    window(parts, -1.75, -.35, .92, 2.16, -2.4)
    for lower, upper in (((-2.6, 0, -2.4), (2.6, .09, -2.382)), ((-2.6, 0, -2.4), (-2.582, .09, 2.4)), ((2.582, 0, -2.4), (2.6, .09, 2.4))):
        box(parts["White paint"], lower, upper)
    curtain(parts["Curtain"], -2.18, -1.70, .08, 2.34, -2.27, 3)
    curtain(parts["Curtain"], -.40, .02, .08, 2.34, -2.27, 3)
    box(parts["Dark wood"], (-2.3, 2.34, -2.285), (.18, 2.365, -2.26))
    quad(parts["Carpet"], (-1.35, .008, 1.05), (2.7, 0, 0), (0, 0, -1.9))
    box(parts["Carpet"], (-1.35, 0, -.85), (1.35, .007, 1.05))
    seat(parts, "Sofa", (1.22, -1.78), (1.95, .88), 0, 2)
    cushion(parts["Mustard"], (-.21, -.21, -.075), (.21, .21, .075), .075, 3, stood((.68, .66, -1.72), -16, 12))
    cushion(parts["Cream"], (-.19, -.19, -.07), (.19, .19, .07), .07, 3, stood((1.80, .64, -1.70), -18, -14))
    seat(parts, "Mustard", (-1.62, -.55), (.86, .82), 62, 1)
    table(parts, .28, -.28)
    lamp(parts, .34, -.62)
    plant(parts, (-1.42, .92, -2.30), .34, rng, 9)
    box(parts["Dark wood"], (.78, 1.32, -2.4), (1.78, 2.04, -2.375))
    quad(parts["Painting"], (.82, 1.36, -2.374), (.92, 0, 0), (0, .64, 0))


def stood(center, lean, yaw):
    """Leans about x, then turns about y, then stands at `center`, for cushion."""
    c, s = math.cos(math.radians(lean)), math.sin(math.radians(lean))
    tip = lambda p: (p[0], c * p[1] - s * p[2], s * p[1] + c * p[2])
    spin = about_y(yaw, (0, 0))
    def turn(position, normal):
        p, n = spin(tip(position), tip(normal))
        return tuple(a + b for a, b in zip(p, center)), n
    return turn


def balloon(parts):
    """About its own origin, the middle of the balloon."""
    points = [(0, .125)] + [(.105 * math.sin(a) * (1 - .08 * math.cos(a)), .125 * math.cos(a) - .010 * (1 - math.cos(a))) for a in (math.pi * k / 20 for k in range(1, 20))]
    lathe(parts["Balloon"], (0, 0, 0), [points[:-1] + [(.010, -.143)], [(.010, -.143), (.018, -.158)], [(.018, -.158), (0, -.151)]], 32)
    knot = [(.003, -.155), (.003, -.75)]
    lathe(parts["Thread"], (0, 0, 0), [knot], 6)


# ---- glTF

def material(name):
    surface = {"baseColorFactor": [*MATERIALS[name], 1], "metallicFactor": 0, "roughnessFactor": 1}
    made = {"name": name, "pbrMetallicRoughness": surface, "doubleSided": name not in ("Glass", "Shade"), "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
    if name in SHINY:
        surface["roughnessFactor"] = SHINY[name]
        del made["extensions"]
    if name == "Brass":
        surface.update(metallicFactor=1, roughnessFactor=.3)
        del made["extensions"]
    if name == "Glass":
        surface["roughnessFactor"] = 0
        made["extensions"] = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5}, "KHR_materials_volume": {"thicknessFactor": .01}}
    if name == "Dusk":   # a picture of the sky: it is seen, and lights nothing
        made["extensions"] = {"KHR_materials_unlit": {}}
    if name in EMITTING:
        strength = max(EMITTING[name])
        made["emissiveFactor"] = [x / strength for x in EMITTING[name]]
        made["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
    return made


class Writer:
    def __init__(self):
        self.gltf = {"asset": {"version": "2.0", "generator": "make_evening.py"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                     "materials": [material(name) for name in MATERIALS], "images": [], "textures": [], "samplers": [{}], "accessors": [], "bufferViews": [],
                     "cameras": [], "buffers": [{}]}
        self.binary = bytearray()
        for name, paint in TEXTURES.items():
            self.texture(name, paint())
        self.gltf["extensionsUsed"] = sorted({e for m in self.gltf["materials"] for e in m.get("extensions", {})})

    def texture(self, name, data):
        self.binary += bytes(-len(self.binary) % 4)
        self.gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data
        self.gltf["images"].append({"name": name, "mimeType": "image/png", "bufferView": len(self.gltf["bufferViews"]) - 1})
        self.gltf["textures"].append({"source": len(self.gltf["images"]) - 1, "sampler": 0})
        material = self.gltf["materials"][list(MATERIALS).index(name)]
        material["pbrMetallicRoughness"]["baseColorTexture"] = {"index": len(self.gltf["textures"]) - 1}

    def primitive(self, name, mesh):
        attributes = {"POSITION": mesh.positions, "NORMAL": mesh.normals}
        if name in TEXTURES:
            attributes["TEXCOORD_0"] = mesh.uvs
        if name == "Books":
            attributes["COLOR_0"] = mesh.colors
        kinds = {"TEXCOORD_0": "VEC2"}
        return {"attributes": {key: add_accessor(self.gltf, self.binary, rows, kinds.get(key, "VEC3")) for key, rows in attributes.items()},
                "indices": add_accessor(self.gltf, self.binary, mesh.triangles, "SCALAR", "I"), "material": list(MATERIALS).index(name)}

    def node(self, name, **members):
        self.gltf["nodes"].append({"name": name, **members})
        self.gltf["scenes"][0]["nodes"].append(len(self.gltf["nodes"]) - 1)
        return len(self.gltf["nodes"]) - 1

    def object(self, name, parts):
        self.gltf["meshes"].append({"name": name, "primitives": [self.primitive(*part) for part in parts.items() if part[1].triangles]})
        return self.node(name, mesh=len(self.gltf["meshes"]) - 1)

    def animate(self, node, path, keys):
        animate(self.gltf, self.binary, node, path, keys)

    def write(self, file):
        self.binary += bytes(-len(self.binary) % 4)
        self.gltf["buffers"][0]["byteLength"] = len(self.binary)
        text = json.dumps(self.gltf, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.binary)) + struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary)


def looking(eye, target):
    """The quaternion of a camera at `eye`, upright, that looks at `target`."""
    back = unit([a - b for a, b in zip(eye, target)])
    yaw, pitch = math.atan2(back[0], back[2]), -math.asin(back[1])
    cy, sy, cp, sp = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(pitch / 2), math.sin(pitch / 2)
    return cy * sp, sy * cp, -sy * sp, cy * cp


def main():
    writer = Writer()
    parts = {name: Mesh() for name in MATERIALS}
    furnish(parts)
    for name, mesh in parts.items():
        if mesh.triangles:
            writer.object(name, {name: mesh})
    floating = {name: Mesh() for name in ("Balloon", "Thread")}
    balloon(floating)
    drift = writer.object("Balloon", floating)
    frames = [*range(0, FRAMES, 4), FRAMES - 1]
    ease = lambda f: f / (FRAMES - 1)
    writer.animate(drift, "translation", {f: (-.62 + .8 * ease(f), 1.52 + .12 * ease(f) + .02 * math.sin(5 * ease(f)), -.35 + .2 * ease(f)) for f in frames})
    writer.gltf["cameras"].append({"type": "perspective", "name": "Camera", "perspective": {"aspectRatio": 16 / 9, "yfov": 2 * math.atan(10.125 / 27), "znear": .05}})
    camera = writer.node("Camera", camera=0)
    eye = lambda f: (1.05 - .55 * ease(f), 1.42 - .05 * ease(f) + .012 * math.sin(4 * math.pi * ease(f)), 2.25 - .7 * ease(f))
    look = lambda f: (.05 - .1 * ease(f), .92, -2.0)
    writer.animate(camera, "translation", {f: eye(f) for f in frames})
    writer.animate(camera, "rotation", {f: looking(eye(f), look(f)) for f in frames})
    writer.write(sys.stdout.buffer)


if __name__ == "__main__":
    main()

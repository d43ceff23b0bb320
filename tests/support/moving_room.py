#!/usr/bin/env python3
"""A furnished room of 8 x 6 x 3 m, 200 000 triangles, a lamp under its ceiling, in which a ball of 0.5 m moves for 48 frames.

    python3 tests/support/moving_room.py room.glb [triangles] [lamp]

With `lamp` the ball stands and the lamp glides under the ceiling instead. What stands: floor, ceiling and four walls, three tables, two cupboards, six bumpy cushions. The ball glides over the floor past a table.
"""
import math
import sys

from wavy import Mesh, Room, unit

SIZE = (8.0, 3.0, 6.0)                       # m; x along, y up, z across
LAST_S = 47 / 24                             # the ball's last key
GREY, WOOD, CLOTH = (0.7, 0.68, 0.64), (0.5, 0.33, 0.2), (0.3, 0.4, 0.55)


def face(corner, u, v, cells, mesh):
    """A rectangle from `corner` along u and v, its front towards u x v."""
    n = unit((u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]))
    mesh.grid(cells, cells, lambda s, t: ([c + s * a + t * b for c, a, b in zip(corner, u, v)], n))


def box(low, high, cells, inwards=False):
    mesh = Mesh()
    (x, y, z), (a, b, c) = low, (high[i] - low[i] for i in range(3))
    for corner, u, v in (((x, y, z), (0, b, 0), (a, 0, 0)), ((x, y, z + c), (a, 0, 0), (0, b, 0)), ((x, y, z), (0, 0, c), (0, b, 0)),
                         ((x + a, y, z), (0, b, 0), (0, 0, c)), ((x, y, z), (a, 0, 0), (0, 0, c)), ((x, y + b, z), (0, 0, c), (a, 0, 0))):
        face(corner, *((v, u) if inwards else (u, v)), cells, mesh)
    return mesh


def ball(centre, radius, rows, bumps=0.0):
    """Longitude s, latitude t; rows begin a little off the poles, where triangles would have no area."""
    def point(s, t):
        a, b = 2 * math.pi * s, math.pi * (t * 0.998 + 0.001) - math.pi / 2
        r = radius * (1 + bumps * math.sin(8 * a) * math.cos(b) ** 2)
        direction = (math.cos(b) * math.cos(a), math.sin(b), -math.cos(b) * math.sin(a))
        return [c + r * d for c, d in zip(centre, direction)], direction
    mesh = Mesh()
    mesh.grid(2 * rows, rows, point)
    return mesh


def furniture(triangles):
    """(name, colour, mesh) of what stands: a quarter of the triangles flat, the rest in cushions."""
    cells = max(1, round(math.sqrt(triangles / 4 / (12 * 18))))
    yield "Room", GREY, box((0, 0, 0), SIZE, cells, inwards=True)
    for i, (x, z) in enumerate(((1.0, 1.0), (5.4, 0.8), (3.2, 4.2))):
        yield f"Table{i}", WOOD, box((x, 0.72, z), (x + 1.6, 0.76, z + 0.9), cells)
        for leg, (dx, dz) in enumerate(((0.02, 0.02), (1.52, 0.02), (0.02, 0.82), (1.52, 0.82))):
            yield f"Leg{i}{leg}", WOOD, box((x + dx, 0, z + dz), (x + dx + 0.06, 0.72, z + dz + 0.06), cells)
    for i, x in enumerate((0.02, 6.9)):
        yield f"Cupboard{i}", CLOTH, box((x, 0, 4.4), (x + 1.06, 2.0, 5.9), cells)
    rows = max(4, round(math.sqrt(triangles * 0.75 / 6 / 4)))
    for i, (x, y, z) in enumerate(((1.5, 0.97, 1.4), (2.2, 0.97, 1.5), (5.9, 0.97, 1.2), (3.8, 0.97, 4.6), (7.2, 0.21, 2.6), (0.6, 0.21, 3.0))):
        yield f"Cushion{i}", CLOTH, ball((x, y, z), 0.2, rows, 0.08)


def make(path, triangles=200_000, lamp_moves=False):
    """Writes the room as .glb; the number of triangles it has."""
    room = Room()
    for name, colour, mesh in [*furniture(triangles), ("Ball", (0.7, 0.5, 0.2), ball((0, 0, 0), 0.25, 24))]:
        mover = room.add_matte(name, colour, mesh)
    begin, end = [2.6, 0.26, 3.0], [5.4, 0.26, 3.6]
    room.gltf["nodes"][mover]["translation"] = begin
    if lamp_moves:                            # the lamp is the next node
        mover, begin, end = mover + 1, [-0.9, 0, 0], [0.9, 0, 0.4]
    room.move(mover, begin, end, LAST_S)
    lamp = Mesh()
    face((3.4, 2.95, 2.6), (1.2, 0, 0), (0, 0, 0.8), 1, lamp)
    room.add_lamp(lamp)
    room.write(path, 0.95, [0.3, 1.7, 3.9], [-0.084, -0.4826, -0.0466, 0.871])
    return room.triangles


if __name__ == "__main__":
    print(make(sys.argv[1], *(int(a) for a in sys.argv[2:] if a != "lamp"), lamp_moves="lamp" in sys.argv))

"""Rooms as people build them in Blender, which nothing here was tuned for: modifiers, instances, curves, Principled materials, constraints.

    blender -b --factory-startup -P tests/bench/blender_rooms.py -- kitchen kitchen.blend

kitchen: 2.2 m wide, two window openings, sun and sky, glossy floor, glass bottle and pane, thin chair legs, a cup that slides.
garage:  one lamp 8 cm below the ceiling, shelves full of boxes, a door ajar, a ball that rolls.
spheres: one small lamp, nine spheres: rough, glossy, metal, mirror, glass smooth and rough; one hops.

A word `matte` behind: surfaces that are neither metal, glass nor lamp get a Diffuse BSDF of their colour, which Cycles and glTF agree on.
Frames 1 to 24. Then docs/from-blender.md: export with pipelines/blender/tempolux_export.py, or by Blender's own glTF exporter.
"""
import math
import random
import sys

import bpy

scene = None


def material(name, colour, roughness=0.5, specular=0.5, metallic=0.0, transmission=0.0, ior=1.45):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    for key, value in (("Base Color", (*colour, 1)), ("Roughness", roughness), ("Specular", specular), ("Metallic", metallic),
                       ("Transmission", transmission), ("IOR", ior)):
        shader.inputs[key].default_value = value
    return made


def place(item, of=None, parent=None):
    scene.collection.objects.link(item)
    if of is not None and hasattr(item.data, "materials"):
        item.data.materials.append(of)
    item.parent = parent
    return item


def box(name, low, high, of, parent=None, bevel=0.0):
    """A box between two corners; its edges rounded by a modifier."""
    corners = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    item = place(bpy.data.objects.new(name, mesh), of, parent)
    if bevel:
        rounded = item.modifiers.new("Bevel", "BEVEL")
        rounded.width, rounded.segments = bevel, 2
    return item


def turned(name, outline, of, where, steps=32):
    """A solid of revolution about z by (radius, height) pairs, smooth."""
    mesh = bpy.data.meshes.new(name)
    corners = [(r * math.cos(a), r * math.sin(a), z) for r, z in outline for a in (2 * math.pi * k / steps for k in range(steps))]
    faces = [(i * steps + k, i * steps + (k + 1) % steps, (i + 1) * steps + (k + 1) % steps, (i + 1) * steps + k)
             for i in range(len(outline) - 1) for k in range(steps)]
    faces += [tuple(range(steps))[::-1], tuple((len(outline) - 1) * steps + k for k in range(steps))]
    mesh.from_pydata(corners, [], faces)
    for face in mesh.polygons:
        face.use_smooth = True
    item = place(bpy.data.objects.new(name, mesh), of)
    item.location = where
    return item


def sphere(name, radius, where, of):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=where, segments=48, ring_count=24)
    item = bpy.context.object
    item.name = name
    item.data.materials.append(of)
    bpy.ops.object.shade_smooth()
    return item


def wall_with_hole(name, low, high, hole, of):
    """A wall across x or y, with a rectangular hole in it: four boxes. `hole` is low and high along the wall, low and high in z."""
    along = 0 if high[0] - low[0] > high[1] - low[1] else 1
    def part(n, a, b, z0, z1):
        lo, hi = [*low], [*high]
        lo[along], hi[along], lo[2], hi[2] = a, b, z0, z1
        box(f"{name} {n}", lo, hi, of)
    part("left", low[along], hole[0], low[2], high[2])
    part("right", hole[1], high[along], low[2], high[2])
    part("below", hole[0], hole[1], low[2], hole[2])
    part("above", hole[0], hole[1], hole[3], high[2])


def camera(where, at, lens=24.0, dolly=(0, 0, 0)):
    eye = place(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
    eye.data.lens = lens
    aim = place(bpy.data.objects.new("Aim", None))
    aim.location = at
    follow = eye.constraints.new("TRACK_TO")
    follow.target, follow.track_axis, follow.up_axis = aim, "TRACK_NEGATIVE_Z", "UP_Y"
    move(eye, where, tuple(a + b for a, b in zip(where, dolly)))
    scene.camera = eye


def move(item, start, end):
    for frame, where in ((1, start), (24, end)):
        item.location = where
        item.keyframe_insert("location", frame=frame)


def lamp(name, kind, energy, where, turn=(0, 0, 0), **more):
    light = bpy.data.lights.new(name, kind)
    light.energy = energy
    for key, value in more.items():
        setattr(light, key, value)
    item = place(bpy.data.objects.new(name, light))
    item.location, item.rotation_euler = where, turn
    return item


def shell(size, wall, floor, ceiling=None):
    """Floor and ceiling of a room whose inner side begins at the origin; walls are left to the caller."""
    box("Floor", (-0.2, -0.2, -0.2), (size[0] + 0.2, size[1] + 0.2, 0), floor)
    box("Ceiling", (-0.2, -0.2, size[2]), (size[0] + 0.2, size[1] + 0.2, size[2] + 0.2), ceiling or wall)


def chair(name, wood):
    """A chair in a collection of its own, for instances."""
    group = bpy.data.collections.new(name)
    def part(n, low, high, bevel=0.004):
        item = box(f"{name} {n}", low, high, wood, bevel=bevel)
        scene.collection.objects.unlink(item)
        group.objects.link(item)
    for k, (x, y) in enumerate(((-.18, -.18), (.18, -.18), (-.18, .18), (.18, .18))):
        part(f"leg {k}", (x - .011, y - .011, 0), (x + .011, y + .011, .88 if y > 0 else .44), 0)
    part("seat", (-.2, -.2, .44), (.2, .2, .465))
    for k in range(3):
        part(f"slat {k}", (-.18, .172, .55 + .11 * k), (.18, .184, .6 + .11 * k))
    return group


def put(group, name, where, angle):
    item = place(bpy.data.objects.new(name, None))
    item.instance_type, item.instance_collection = "COLLECTION", group
    item.location, item.rotation_euler = where, (0, 0, math.radians(angle))


def kitchen():
    white, tiles = material("Wall paint", (.78, .76, .71), .6), material("Tiles", (.32, .3, .28), .12)
    front, steel = material("Cupboard fronts", (.12, .22, .2), .35), material("Steel", (.7, .7, .7), .25, metallic=1)
    wood, top = material("Oak", (.42, .25, .12), .4), material("Worktop", (.6, .58, .55), .2)
    glass = material("Bottle glass", (.55, .85, .6), 0, transmission=1, ior=1.5)
    pane = material("Window glass", (1, 1, 1), 0, transmission=1, ior=1.5)
    china = material("China", (.85, .83, .8), .08)
    w, d, h = 2.2, 3.4, 2.3
    shell((w, d, h), white, tiles)
    wall_with_hole("Back wall", (-.2, d, 0), (w + .2, d + .2, h), (.55, 1.65, 1.0, 2.0), white)
    wall_with_hole("Right wall", (w, 0, 0), (w + .2, d, h), (.6, 1.5, .9, 2.05), white)
    box("Left wall", (-.2, 0, 0), (0, d, h), white)
    box("Front wall", (-.2, -.2, 0), (w + .2, 0, h), white)
    box("Window sill", (.5, d - .06, .97), (1.7, d + .2, 1.0), white, bevel=.005)
    for n, (low, high) in enumerate((((.55, d + .09, 1), (.59, d + .13, 2)), ((1.61, d + .09, 1), (1.65, d + .13, 2)), ((1.08, d + .09, 1), (1.12, d + .13, 2)),
                                     ((.59, d + .09, 1), (1.61, d + .13, 1.04)), ((.59, d + .09, 1.96), (1.61, d + .13, 2)))):
        box(f"Window frame {n}", low, high, white, bevel=.003)
    sheet = bpy.data.meshes.new("Pane")
    sheet.from_pydata([(.55, d + .11, 1), (1.65, d + .11, 1), (1.65, d + .11, 2), (.55, d + .11, 2)], [], [(0, 1, 2, 3)])
    place(bpy.data.objects.new("Pane", sheet), pane)
    # Cupboards: doors and handles by an array of linked copies along the left wall, and below the window.
    box("Base units", (0, .9, .1), (.56, d, .86), front)
    box("Plinth", (0, .9, 0), (.5, d, .1), wood)
    box("Worktop", (0, .88, .86), (.6, d, .9), top, bevel=.006)
    door = box("Door", (.56, .905, .12), (.58, 1.495, .85), front, bevel=.003)
    rows = door.modifiers.new("Array", "ARRAY")
    rows.count, rows.use_relative_offset, rows.use_constant_offset, rows.constant_offset_displace = 4, False, True, (0, .6, 0)
    pipe = bpy.data.curves.new("Handle", "CURVE")
    pipe.dimensions, pipe.bevel_depth = "3D", .006
    line = pipe.splines.new("POLY")
    line.points.add(3)
    for point, at in zip(line.points, ((.58, 1.06, .78), (.61, 1.06, .78), (.61, 1.34, .78), (.58, 1.34, .78))):
        point.co = (*at, 1)
    handle = place(bpy.data.objects.new("Handle", pipe), steel)
    rows = handle.modifiers.new("Array", "ARRAY")
    rows.count, rows.use_relative_offset, rows.use_constant_offset, rows.constant_offset_displace = 4, False, True, (0, .6, 0)
    for k in range(3):
        box(f"Wall unit {k}", (0, 1.0 + .62 * k, 1.45), (.33, 1.6 + .62 * k, 2.15), front, bevel=.004)
    tap = bpy.data.curves.new("Tap", "CURVE")
    tap.dimensions, tap.bevel_depth = "3D", .011
    line = tap.splines.new("BEZIER")
    line.bezier_points.add(2)
    for point, at in zip(line.bezier_points, ((.12, 2.7, .9), (.16, 2.7, 1.16), (.3, 2.7, 1.08))):
        point.co, point.handle_left_type, point.handle_right_type = at, "AUTO", "AUTO"
    place(bpy.data.objects.new("Tap", tap), steel)
    turned("Bottle", [(.034, 0), (.038, .01), (.038, .17), (.014, .22), (.013, .29), (.009, .29), (.009, .22), (.033, .17), (.033, .012), (.001, .01)],
           glass, (.34, 1.35, .9))
    # Table, chairs, what stands on it.
    box("Table top", (1.2, 1.55, .72), (2.05, 2.75, .75), wood, bevel=.004)
    for k, (x, y) in enumerate(((1.25, 1.6), (2.0, 1.6), (1.25, 2.7), (2.0, 2.7))):
        box(f"Table leg {k}", (x - .02, y - .02, 0), (x + .02, y + .02, .72), wood)
    seat = chair("Chair", wood)
    put(seat, "Chair A", (1.05, 1.95, 0), 100)
    put(seat, "Chair B", (1.6, 3.0, 0), 5)
    put(seat, "Chair C", (1.5, 1.25, 0), 190)
    cup = turned("Cup", [(.025, 0), (.04, .01), (.042, .085), (.038, .085), (.036, .012), (.001, .01)], china, (1.6, 1.9, .75))
    move(cup, (1.45, 1.8, .75), (1.75, 2.35, .75))
    bowl = turned("Bowl", [(.05, 0), (.13, .06), (.14, .075), (.132, .075), (.12, .06), (.001, .008)], china, (1.72, 2.5, .75))
    fruit = material("Orange", (.8, .3, .05), .45)
    for k, (x, y, z) in enumerate(((-.04, 0, .06), (.05, .03, .06), (0, -.05, .07))):
        sphere(f"Orange {k}", .042, tuple(a + b for a, b in zip(bowl.location, (x, y, z))), fruit)
    lamp("Pendant", "POINT", 25, (1.6, 2.15, 1.75), shadow_soft_size=.05, color=(1, .82, .6))
    turned("Shade", [(.06, .14), (.15, 0), (.146, 0), (.057, .136)], steel, (1.6, 2.15, 1.72))
    lamp("Sun", "SUN", 3.5, (4, 3, 5), (math.radians(48), 0, math.radians(118)), angle=math.radians(.53), color=(1, .93, .8))
    sky(.25)
    camera((.75, .25, 1.5), (1.25, 2.6, .95), 20, dolly=(.15, .25, 0))


def sky(strength):
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    colour = tree.nodes.new("ShaderNodeTexSky")
    colour.sky_type, colour.sun_disc, colour.sun_elevation = "NISHITA", False, math.radians(42)
    tree.links.new(colour.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    tree.nodes["Background"].inputs["Strength"].default_value = strength


def garage():
    concrete, plaster = material("Concrete", (.4, .39, .37), .8), material("Plaster", (.62, .6, .56), .9, specular=.2)
    iron, card = material("Shelf iron", (.25, .28, .3), .45, metallic=.6), material("Cardboard", (.48, .33, .19), .85)
    red, tin = material("Red paint", (.6, .05, .04), .25), material("Tin", (.75, .74, .72), .3, metallic=1)
    w, d, h = 4.2, 6.0, 2.4
    shell((w, d, h), plaster, concrete)
    box("Left wall", (-.2, 0, 0), (0, d, h), plaster)
    box("Right wall", (w, 0, 0), (w + .2, d, h), plaster)
    box("Back wall", (-.2, d, 0), (w + .2, d + .2, h), plaster)
    box("Front wall", (-.2, -.2, 0), (w + .2, 0, h), plaster)
    box("Beam", (0, 3.4, h - .22), (w, 3.6, h), plaster)
    lamp("Bulb", "POINT", 60, (2.1, 2.6, h - .08), shadow_soft_size=.035, color=(1, .88, .7))
    random.seed(5)
    for side, x in (("left", .05), ("right", w - .5)):
        for k in range(4):
            for n, y in enumerate((2.2, 3.9, 5.6)):
                if k == 0:
                    for m, e in enumerate((0, .43)):
                        box(f"Post {side} {n}{m}", (x + e, y, 0), (x + e + .02, y + .03, 2.0), iron)
            z = .15 + .55 * k
            box(f"Shelf {side} {k}", (x, 2.2, z), (x + .45, 5.63, z + .02), iron)
            y = 2.28
            while y < 5.2 and k < 4:
                length, tall = random.uniform(.18, .5), random.uniform(.14, .38)
                kind = random.choice((card, card, card, red, tin))
                if random.random() < .8:
                    box(f"Box {side} {k} {y:.2f}", (x + .04, y, z + .021), (x + .04 + random.uniform(.25, .38), y + length, z + .021 + tall), kind, bevel=.004)
                else:
                    for n in range(2):
                        turned(f"Can {side} {k} {y:.2f} {n}", [(.07, 0), (.07, .16), (.062, .165)], tin, (x + .14 + .17 * n, y + .1, z + .021), 24)
                y += length + random.uniform(.03, .2)
    box("Bench", (1.4, 5.3, .85), (2.9, 5.95, .9), card, bevel=.004)
    for k, (x, y) in enumerate(((1.45, 5.35), (2.8, 5.35), (1.45, 5.85), (2.8, 5.85))):
        box(f"Bench leg {k}", (x, y, 0), (x + .05, y + .05, .85), iron)
    box("Tool box", (1.7, 5.5, .9), (2.2, 5.75, 1.12), red, bevel=.01)
    mirror = material("Old mirror", (.85, .86, .85), .04, metallic=1)
    box("Mirror", (2.3, 5.97, 1.2), (2.8, 5.999, 1.8), mirror)
    ladder = box("Ladder rail", (3.2, 5.0, 0), (3.24, 5.04, 2.3), tin)
    ladder.rotation_euler = (math.radians(-4), 0, 0)
    ball = sphere("Ball", .14, (1.2, 3.2, .14), red)
    move(ball, (1.2, 3.2, .14), (2.6, 3.9, .14))
    ball.rotation_euler = (0, 0, 0)
    ball.keyframe_insert("rotation_euler", frame=1)
    ball.rotation_euler = (0, 1.5 / .14, .3)
    ball.keyframe_insert("rotation_euler", frame=24)
    camera((2.3, .35, 1.55), (2.0, 5.0, 1.05), 22, dolly=(-.3, .3, .05))


def spheres():
    w, d, h = 4.0, 4.0, 2.6
    left, right = material("Ochre wall", (.7, .45, .2), .8), material("Blue wall", (.2, .35, .6), .8)
    white, floor = material("White wall", (.8, .8, .8), .7), material("Waxed floor", (.45, .38, .3), .22)
    shell((w, d, h), white, floor)
    box("Left wall", (-.2, 0, 0), (0, d, h), left)
    box("Right wall", (w, 0, 0), (w + .2, d, h), right)
    box("Back wall", (-.2, d, 0), (w + .2, d + .2, h), white)
    box("Front wall", (-.2, -.2, 0), (w + .2, 0, h), white)
    kinds = [material("Rough clay", (.6, .3, .2), 1, 0), material("Satin", (.2, .5, .3), .35), material("Lacquer", (.5, .05, .05), .05),
             material("Rough gold", (.9, .65, .25), .4, metallic=1), material("Brushed", (.8, .8, .82), .15, metallic=1),
             material("Mirror", (.95, .95, .95), 0, metallic=1), material("Clear glass", (1, 1, 1), 0, transmission=1, ior=1.5),
             material("Frosted glass", (.9, 1, .95), .3, transmission=1, ior=1.45), material("Green glass", (.5, .9, .6), 0, transmission=1, ior=1.52)]
    for k, kind in enumerate(kinds):
        row, column = divmod(k, 3)
        item = sphere(kind.name + " sphere", .32, (.9 + 1.1 * column + .15 * row, 1.5 + .9 * row, .32), kind)
        if k == 1:
            move(item, tuple(item.location), (item.location[0], item.location[1], .9))
    lamp("Lamp", "AREA", 45, (2.6, 2.3, 2.45), (0, 0, 0), shape="DISK", size=.3)
    camera((1.9, .3, 1.7), (2.05, 2.6, .45), 22, dolly=(.2, .1, 0))


def be_matte():
    for made in bpy.data.materials:
        tree = made.node_tree
        old = tree.nodes["Principled BSDF"]
        if old.inputs["Metallic"].default_value > 0 or old.inputs["Transmission"].default_value > 0:
            continue
        new = tree.nodes.new("ShaderNodeBsdfDiffuse")
        new.inputs["Color"].default_value = old.inputs["Base Color"].default_value
        tree.links.new(new.outputs["BSDF"], tree.nodes["Material Output"].inputs["Surface"])
        tree.nodes.remove(old)


def main():
    name, path, *matte = sys.argv[sys.argv.index("--") + 1:]
    global scene
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.fps = 1, 24, 24
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 320, 180, 100
    scene.render.engine = "CYCLES"
    {"kitchen": kitchen, "garage": garage, "spheres": spheres}[name]()
    if matte == ["matte"]:
        be_matte()
    bpy.ops.wm.save_as_mainfile(filepath=path)


main()

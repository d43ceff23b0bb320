"""The scene as Blender's importer has it, for renderers without one: triangles in world space (y up as in glTF), materials, lights, camera.

export() runs inside Blender; the file is a pickle of plain lists and arrays, so that no reader needs more than Python.
"""

import array
import math
import pickle

import bpy
import mathutils

UP = mathutils.Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))       # Blender's z is up


def number(node, *names):
    for name in names:
        socket = node.inputs.get(name)
        if socket is not None:
            value = socket.default_value
            return list(value)[:3] if hasattr(value, "__len__") else float(value)
    return 0.0


def picture(node, name):
    """The file of the picture that feeds a socket, at most through mixing by a constant; else None."""
    socket = node.inputs.get(name)
    seen = [link.from_node for link in socket.links] if socket else []
    while seen:
        found = seen.pop()
        if found.type == "TEX_IMAGE" and found.image:
            return found.image
        seen += [link.from_node for entry in found.inputs for link in entry.links]
    return None


def material_of(material, folder):
    look = {
        "base": [0.8, 0.8, 0.8],
        "metallic": 0.0,
        "roughness": 1.0,
        "specular": 0.5,
        "transmission": 0.0,
        "ior": 1.5,
        "emission": [0, 0, 0],
        "alpha": 1.0,
        "picture": None,
        "lacks": [],
    }
    nodes = material.node_tree.nodes if material and material.node_tree else ()
    for node in nodes:
        if node.type == "BSDF_PRINCIPLED":
            strength = number(node, "Emission Strength")
            look |= {
                "base": number(node, "Base Color"),
                "metallic": number(node, "Metallic"),
                "roughness": number(node, "Roughness"),
                "specular": number(node, "Specular IOR Level"),
                "transmission": number(node, "Transmission Weight"),
                "ior": number(node, "IOR"),
                "emission": [strength * c for c in number(node, "Emission Color")],
                "alpha": number(node, "Alpha"),
            }
            image = picture(node, "Base Color")
            if image:
                look["picture"] = f"{folder}/{image.name.replace('/', '_')}.png"
                image.save_render(look["picture"])
            look["lacks"] = [
                name
                for name in ("Roughness", "Metallic", "Normal", "Alpha", "Emission Color", "Transmission Weight")
                if node.inputs[name].links
            ]
        elif node.type == "EMISSION" and look["emission"] == [0, 0, 0]:
            look |= {
                "emission": [number(node, "Strength") * c for c in number(node, "Color")],
                "base": [0, 0, 0],
                "specular": 0.0,
            }
    return look


def export(job):
    scene = bpy.context.scene
    scene.frame_set(job["frame"])
    graph = bpy.context.evaluated_depsgraph_get()
    folder = job["export"].rpartition("/")[0]
    meshes, lights = [], []
    for instance in graph.object_instances:
        thing = instance.object
        world = UP @ instance.matrix_world
        if thing.type == "LIGHT":
            lamp = thing.data
            lights.append(
                {
                    "type": lamp.type,
                    "place": list(world.translation),
                    "towards": list((world.to_3x3() @ mathutils.Vector((0, 0, -1))).normalized()),
                    "power": [lamp.energy * c for c in lamp.color],
                    "cone": getattr(lamp, "spot_size", 0) / 2,
                    "blend": getattr(lamp, "spot_blend", 0),
                }
            )
        if thing.type != "MESH":
            continue
        mesh = thing.to_mesh()
        mesh.calc_loop_triangles()
        turn = world.to_3x3().inverted_safe().transposed()
        layer = mesh.uv_layers.active
        by_material = {}
        for triangle in mesh.loop_triangles:
            part = by_material.setdefault(triangle.material_index, ([], [], []))
            for loop in triangle.loops:
                part[0].extend(world @ mesh.vertices[mesh.loops[loop].vertex_index].co)
                part[1].extend((turn @ mathutils.Vector(mesh.corner_normals[loop].vector)).normalized())
                part[2].extend(layer.data[loop].uv if layer else (0, 0))
        for index, (places, normals, uvs) in by_material.items():
            slot = thing.material_slots[index].material if index < len(thing.material_slots) else None
            meshes.append(
                {
                    "material": slot.name if slot else "",
                    "places": array.array("f", places),
                    "normals": array.array("f", normals),
                    "uvs": array.array("f", uvs),
                }
            )
        thing.to_mesh_clear()
    materials = {m.name: material_of(m, folder) for m in bpy.data.materials} | {"": material_of(None, folder)}
    eye = UP @ scene.camera.matrix_world
    width, height = scene.render.resolution_x, scene.render.resolution_y
    lens = scene.camera.data
    found = {
        "meshes": meshes,
        "materials": materials,
        "lights": lights,
        "size": [width, height],
        "camera": {
            "eye": list(eye.translation),
            "towards": list(eye.to_3x3() @ mathutils.Vector((0, 0, -1))),
            "up": list(eye.to_3x3() @ mathutils.Vector((0, 1, 0))),
            "across": (
                2 * math.atan(math.tan(lens.angle_x / 2))
                if lens.sensor_fit != "VERTICAL"
                else 2 * math.atan(math.tan(lens.angle_y / 2) * width / height)
            ),
        },
    }
    with open(job["export"], "wb") as out:
        pickle.dump(found, out)

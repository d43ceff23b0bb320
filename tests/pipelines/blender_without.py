"""A .blend without some of what is in it: to find what a difference between two renderers comes from.

    build/peers/bpy/bin/python tests/pipelines/blender_without.py SHOT.blend OUT.blend WORD...

coat, sheen, film, anisotropy, subsurface: their weights 0.  smoke: domains with only a volume.  cards: holdouts and shadow catchers.
hair: hair systems.  sun, points, spots, areas: lamps of this kind.  world: its light.
specular: the reflection of Principled.  glass: panes of clear glass.  spread: area lamps shine to all sides.  sizes: radius of spots and
points, angle of suns 0.  metallic: Metallic below 1 becomes 0.  frost: transmission of rough Principled becomes 0.  bumps: no Bump node.
translucent: Translucent BSDF becomes Diffuse.  mixed: mixtures of a matte and a glossy shader become the matte one.
close:NAME: the first frame alone, by a lens that shows this object alone from where the camera stands.
"""

import math
import sys

import bpy
import mathutils

LAMPS = {"sun": "SUN", "points": "POINT", "spots": "SPOT", "areas": "AREA"}
WEIGHTS = {
    "coat": "Coat Weight",
    "sheen": "Sheen Weight",
    "film": "Thin Film Thickness",
    "anisotropy": "Anisotropic",
    "subsurface": "Subsurface Weight",
}


def shaders(kind):
    for material in bpy.data.materials:
        for node in list(material.node_tree.nodes) if material.node_tree else ():
            if node.type == kind:
                yield material, node


def remove(things):
    for thing in list(things):
        bpy.data.objects.remove(thing)


def only_volume(thing):
    for slot in thing.material_slots:
        output = slot.material and slot.material.node_tree and slot.material.node_tree.get_output_node("CYCLES")
        if output and output.inputs["Volume"].is_linked and not output.inputs["Surface"].is_linked:
            return True
    return False


def is_clear_glass(thing):
    nodes = [
        n
        for s in thing.material_slots
        if s.material and s.material.node_tree
        for n in s.material.node_tree.nodes
        if n.type == "BSDF_GLASS"
    ]
    return bool(nodes) and all(n.inputs["Roughness"].default_value == 0 for n in nodes)


def replace(material, node, other):
    links = material.node_tree.links
    for link in list(node.outputs[0].links):
        links.new(other.outputs[0], link.to_socket)


def look_closely(scene, name):
    scene.frame_end = scene.frame_start
    scene.frame_set(scene.frame_start)
    thing = scene.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get())
    corners = [thing.matrix_world @ mathutils.Vector(corner) for corner in thing.bound_box]
    middle = sum(corners, mathutils.Vector()) / 8
    radius = max((corner - middle).length for corner in corners)
    place = scene.camera.matrix_world.translation
    eye = bpy.data.objects.new("close", bpy.data.cameras.new("close"))
    eye.location = place
    eye.rotation_euler = (middle - place).to_track_quat("-Z", "Y").to_euler()
    eye.data.angle = 2 * math.asin(radius / (middle - place).length)
    eye.data.clip_start = .01
    scene.collection.objects.link(eye)
    scene.camera = eye
    scene.render.resolution_x = scene.render.resolution_y


def take_out(word):
    objects = bpy.context.scene.objects
    if word in WEIGHTS:
        for _, node in shaders("BSDF_PRINCIPLED"):
            node.inputs[WEIGHTS[word]].default_value = 0
    elif word == "smoke":
        remove(o for o in objects if only_volume(o))
    elif word == "cards":
        remove(o for o in objects if o.type == "MESH" and (o.is_holdout or o.is_shadow_catcher))
    elif word == "hair":
        for thing in objects:
            for modifier in [m for m in thing.modifiers if m.type == "PARTICLE_SYSTEM"]:
                thing.modifiers.remove(modifier)
    elif word in LAMPS:
        remove(o for o in bpy.data.objects if o.type == "LIGHT" and o.data.type == LAMPS[word])
    elif word == "world":
        bpy.context.scene.world = None
    elif word == "specular":
        for _, node in shaders("BSDF_PRINCIPLED"):
            node.inputs["Specular IOR Level"].default_value = 0
    elif word.startswith("close:"):
        look_closely(bpy.context.scene, word[6:])
    elif word == "glass":
        remove(o for o in objects if is_clear_glass(o))
    elif word == "spread":
        for lamp in [l for l in bpy.data.lights if l.type == "AREA"]:
            lamp.spread = math.pi
    elif word == "sizes":
        for lamp in bpy.data.lights:
            if lamp.type == "SUN":
                lamp.angle = 0
            elif lamp.type in ("POINT", "SPOT"):
                lamp.shadow_soft_size = 0
    elif word == "metallic":
        for _, node in shaders("BSDF_PRINCIPLED"):
            if 0 < node.inputs["Metallic"].default_value < 1:
                node.inputs["Metallic"].default_value = 0
    elif word == "frost":
        for _, node in shaders("BSDF_PRINCIPLED"):
            if node.inputs["Roughness"].default_value > 0:
                node.inputs["Transmission Weight"].default_value = 0
    elif word == "bumps":
        for material, node in shaders("BUMP"):
            material.node_tree.nodes.remove(node)
    elif word == "translucent":
        for material, node in shaders("BSDF_TRANSLUCENT"):
            other = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
            other.inputs[0].default_value = node.inputs[0].default_value
            replace(material, node, other)
    elif word == "mixed":
        for material, node in shaders("MIX_SHADER"):
            ends = [s.links[0].from_node for s in node.inputs if s.type == "SHADER" and s.is_linked]
            if sorted(e.type for e in ends) == ["BSDF_DIFFUSE", "BSDF_GLOSSY"] or sorted(e.type for e in ends) == [
                "BSDF_ANISOTROPIC",
                "BSDF_DIFFUSE",
            ]:
                replace(material, node, next(e for e in ends if e.type == "BSDF_DIFFUSE"))
    else:
        sys.exit(f"blender_without.py: no word {word}; see the head of the file")


def main():
    blend, out, *words = sys.argv[1:]
    bpy.ops.wm.open_mainfile(filepath=blend)
    for word in words:
        take_out(word)
    bpy.ops.wm.save_as_mainfile(filepath=out)


main()

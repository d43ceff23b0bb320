"""For from_blender.sh, run by `blender -b -P`: a shot with what a plain export loses, as a .blend of the name that follows `--`."""
import sys

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.frame_start, scene.frame_end, scene.render.fps = 3, 6, 30
bpy.ops.mesh.primitive_plane_add(size=4)
for name, kind, energy in (("Panel", "AREA", 60), ("Bulb", "POINT", 15), ("Spot", "SPOT", 10)):
    lamp = bpy.data.lights.new(name, kind)
    lamp.energy = energy
    if kind == "AREA":
        lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", 0.8, 0.4
    if kind == "POINT":
        lamp.shadow_soft_size = 0.05
    item = bpy.data.objects.new(name, lamp)
    item.location = (0, 0, 2)
    scene.collection.objects.link(item)
twin = bpy.data.objects.new("Panel.twin", bpy.data.lights["Panel"])   # two objects, one lamp
scene.collection.objects.link(twin)
eye = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
scene.collection.objects.link(eye)
scene.camera = eye
aim = bpy.data.objects.new("Aim", None)
scene.collection.objects.link(aim)
follow = eye.constraints.new("TRACK_TO")
follow.target, follow.track_axis, follow.up_axis = aim, "TRACK_NEGATIVE_Z", "UP_Y"
for frame, x in ((3, -1), (6, 1)):
    eye.location = (x, -3, 1)
    eye.keyframe_insert("location", frame=frame)



def material(name, kind, **values):
    made = bpy.data.materials.new(name)
    if made.node_tree is None:
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    shader = tree.nodes.new(kind)
    for key, value in values.items():
        shader.inputs[key].default_value = value
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return made, shader


# Shaders that the exporter would write as white metal; glass of a closed body and of an open sheet; a colour by nodes that glTF lacks.
matte, _ = material("Matte", "ShaderNodeBsdfDiffuse", Color=(.2, .4, .6, 1))
chrome, _ = material("Chrome", "ShaderNodeBsdfGlossy", Color=(.9, .8, .7, 1), Roughness=.1)
solid, _ = material("Solid", "ShaderNodeBsdfGlass", Color=(1, 1, 1, 1), Roughness=0, IOR=1.6)
sheet, shader = material("Sheet", "ShaderNodeBsdfPrincipled")
shader.inputs["Transmission Weight" if "Transmission Weight" in shader.inputs else "Transmission"].default_value = 1
noisy, shader = material("Noisy", "ShaderNodeBsdfPrincipled", **{"Base Color": (.3, .3, .3, 1)})
noisy.node_tree.links.new(noisy.node_tree.nodes.new("ShaderNodeTexNoise").outputs["Color"], shader.inputs["Base Color"])
for k, kind in enumerate((matte, chrome, solid, noisy)):
    bpy.ops.mesh.primitive_cube_add(size=.2, location=(.4 * k - .6, 1, .1))
    bpy.context.object.name = "Cube " + kind.name
    bpy.context.object.data.materials.append(kind)
bpy.ops.mesh.primitive_plane_add(size=.2, location=(0, 1.5, .5))
bpy.context.object.data.materials.append(sheet)
# Glass and a lamp in a collection that is instanced.
group = bpy.data.collections.new("Group")
for item in (bpy.data.objects["Cube Solid"], bpy.data.objects.new("Inner", bpy.data.lights["Panel"])):
    for collection in item.users_collection:
        collection.objects.unlink(item)
    group.objects.link(item)
holder = bpy.data.objects.new("Holder", None)
holder.instance_type, holder.instance_collection = "COLLECTION", group
scene.collection.objects.link(holder)
# A strip that plays, and one that is muted, which Blender does not show.
for name, mute in (("Cube Matte", False), ("Cube Chrome", True)):
    item = bpy.data.objects[name]
    for frame, x in ((3, 0), (6, 1)):
        item.location.x = x
        item.keyframe_insert("location", frame=frame)
    track = item.animation_data.nla_tracks.new()
    track.strips.new("Slide", 3, item.animation_data.action)
    track.mute, item.animation_data.action = mute, None
scene.world = bpy.data.worlds.new("World")
if scene.world.node_tree is None:
    scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.6, 0.8, 1)
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 2
# A shifted lens; an object that appears at frame 5; a wave, which only a modifier moves; a domain of smoke; a material whose group has no output;
# a lamp three stops brighter and one that changes, where this Blender has them; a level of subdivision for the render alone.
eye.data.shift_x, eye.data.shift_y = .2, .1
bpy.ops.mesh.primitive_cube_add(size=.1, location=(0, 2, 1))
late = bpy.context.object
late.name = "Late"
for frame, hide in ((3, True), (5, False)):
    late.hide_render = hide
    late.keyframe_insert("hide_render", frame=frame)
bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=1, location=(2, 0, 0))
bpy.context.object.name = "Wave"
bpy.context.object.modifiers.new("Wave", "WAVE")
bpy.ops.mesh.primitive_cube_add(size=.1, location=(1, 2, 1))
bpy.context.object.name = "Finer"
finer = bpy.context.object.modifiers.new("Subdivision", "SUBSURF")
finer.levels, finer.render_levels = 0, 2
smoke, shader = material("Smoke", "ShaderNodeVolumePrincipled")
smoke.node_tree.links.clear()
smoke.node_tree.links.new(shader.outputs[0], smoke.node_tree.nodes["Material Output"].inputs["Volume"])
odd, shader = material("Odd", "ShaderNodeBsdfPrincipled")
group = odd.node_tree.nodes.new("ShaderNodeGroup")
group.node_tree = bpy.data.node_groups.new("Empty", "ShaderNodeTree")
if hasattr(group.node_tree, "interface"):
    group.node_tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
else:
    group.node_tree.outputs.new("NodeSocketShader", "Shader")
odd.node_tree.links.new(group.outputs[0], odd.node_tree.nodes["Material Output"].inputs["Surface"])
for name, kind, x in (("Domain", smoke, 3), ("Odd", odd, 4)):
    bpy.ops.mesh.primitive_cube_add(size=.5, location=(x, 2, 1))
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(kind)
# A metal by half; a quarter of a mirror above matte; a solid of glass that is smooth across its sharp edges; a brushed metal.
half, _ = material("Half", "ShaderNodeBsdfPrincipled", **{"Metallic": .5, "Base Color": (.9, .3, .1, 1)})
glazed, mirror = material("Glazed", "ShaderNodeBsdfAnisotropic" if bpy.app.version >= (4, 0) else "ShaderNodeBsdfGlossy", Color=(.8, .8, .8, 1), Roughness=.1)
tree = glazed.node_tree
below, mixture = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeMixShader")
below.inputs["Color"].default_value, mixture.inputs[0].default_value = (.1, .4, .2, 1), .25
for k, node in ((1, below), (2, mirror)):
    tree.links.new(node.outputs[0], mixture.inputs[k])
tree.links.new(mixture.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
tumbler, _ = material("Tumbler", "ShaderNodeBsdfGlass", Color=(1, 1, 1, 1), Roughness=0)
brushed, _ = material("Brushed", "ShaderNodeBsdfPrincipled", Metallic=1, Roughness=.35, Anisotropic=.8)
for name, kind, x in (("Half", half, -1), ("Glazed", glazed, -1.4), ("Tumbler", tumbler, -1.8), ("Brushed", brushed, -2.6)):
    bpy.ops.mesh.primitive_cylinder_add(vertices=16, radius=.1, depth=.2, location=(x, 2, 1))
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(kind)
    for face in bpy.context.object.data.polygons:
        face.use_smooth = True
# A metal of .3 without a dielectric reflection; an area lamp without power, and one that has power in the last frame alone.
bare, shader = material("Bare", "ShaderNodeBsdfPrincipled", **{"Metallic": .3, "Base Color": (.6, .2, .1, 1)})
shader.inputs["Specular IOR Level" if "Specular IOR Level" in shader.inputs else "Specular"].default_value = 0
bpy.ops.mesh.primitive_cube_add(size=.1, location=(-2.2, 2, 1))
bpy.context.object.data.materials.append(bare)
for name in ("Dark", "Rises"):
    lamp = bpy.data.lights.new(name, "AREA")
    lamp.energy = 0
    scene.collection.objects.link(bpy.data.objects.new(name, lamp))
for frame, energy in ((5, 0), (6, 2)):
    lamp.energy = energy
    lamp.keyframe_insert("energy", frame=frame)
# An image that one mesh shows once and another three times.
shown, shader = material("Shown", "ShaderNodeBsdfPrincipled")
texture = shown.node_tree.nodes.new("ShaderNodeTexImage")
texture.image = bpy.data.images.new("Chequer", 8, 8)
texture.image.pixels[:] = [k % 4 == 3 or (k // 4 % 8 + k // 32) % 2 for k in range(256)]
texture.image.pack()
shown.node_tree.links.new(texture.outputs[0], shader.inputs["Base Color"])
for name, x, many in (("Once", 5, 1), ("Thrice", 6, 3)):
    bpy.ops.mesh.primitive_plane_add(size=.2, location=(x, 2, 1))
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(shown)
    for corner in bpy.context.object.data.uv_layers.active.data:
        corner.uv = [many * u for u in corner.uv]
scene.view_settings.exposure = -1.5
lamp = bpy.data.lights.new("Flicker", "POINT")
lamp.shadow_soft_size = 0
if hasattr(lamp, "exposure"):
    lamp.exposure = 3
for frame, energy in ((3, 1), (6, 4)):
    lamp.energy = energy
    lamp.keyframe_insert("energy", frame=frame)
scene.collection.objects.link(bpy.data.objects.new("Flicker", lamp))
scene.frame_set(3)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[sys.argv.index("--") + 1])

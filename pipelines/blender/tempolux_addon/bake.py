"""Values of nodes that glTF cannot say as pixels: Cycles bakes them from copies of the materials, in a scene that is thrown away."""

import bpy
import numpy

from .values import Blend, Source, Times, is_constant, as_tuple

LAYER = "tempolux bake"
MOST_FACES = 200_000     # a mesh with more is not unwrapped: it would take minutes
SAMPLES = 4


class Baker:
    """Bakes meshes of the record. Each mesh is unwrapped once."""

    def __init__(self, shot):
        self.shot, self.scene, self.unwrapped, self.made = shot, None, {}, []

    # ---- the scene ----

    def open(self):
        if self.scene:
            return
        self.window = bpy.context.window or next(iter(bpy.context.window_manager.windows), None)
        if self.window is None:
            raise RuntimeError("Blender has no window to bake in")
        self.before = self.window.scene
        self.scene = bpy.data.scenes.new("tempolux bake")
        self.scene.render.engine = "CYCLES"
        self.scene.cycles.device, self.scene.cycles.samples, self.scene.cycles.use_denoising = "CPU", SAMPLES, False
        if hasattr(self.scene.cycles, "use_adaptive_sampling"):
            self.scene.cycles.use_adaptive_sampling = False
        self.scene.frame_set(self.shot.first)
        self.window.scene = self.scene

    def close(self):
        if self.scene:
            self.window.scene = self.before
            bpy.data.scenes.remove(self.scene)
            self.scene = None

    # ---- texture coordinates of the bake ----

    def unwrap(self, topology):
        """(object, texture coordinates of each loop)."""
        if topology in self.unwrapped:
            return self.unwrapped[topology]
        self.open()
        mesh, place = self.shot.record.baking[topology]
        if len(mesh.polygons) > MOST_FACES:
            raise ValueError(f"{len(mesh.polygons)} faces are too many to unwrap")
        thing = bpy.data.objects.new("tempolux bake", mesh)
        self.scene.collection.objects.link(thing)
        from mathutils import Matrix
        thing.matrix_world = Matrix(place.tolist())
        render = next((layer.name for layer in mesh.uv_layers if layer.active_render), "")
        while len(mesh.uv_layers) > 7:
            mesh.uv_layers.remove(mesh.uv_layers[-1])
        layer = mesh.uv_layers.new(name=LAYER, do_init=False)
        mesh.uv_layers.active = layer
        layer.active_render = True
        self.alone(thing)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.smart_project(angle_limit=1.15, island_margin=.02)
        bpy.ops.object.mode_set(mode="OBJECT")
        layer = mesh.uv_layers[LAYER]
        coordinates = numpy.empty(2 * len(mesh.loops), "f4")
        layer.data.foreach_get("uv", coordinates)
        self.unwrapped[topology] = thing, coordinates.reshape(-1, 2), render
        return self.unwrapped[topology]

    def alone(self, thing):
        layer = self.scene.view_layers[0]
        for other in layer.objects:
            other.hide_render = other != thing
            other.select_set(other == thing)
        layer.objects.active = thing
        layer.update()

    # ---- one bake ----

    def bake(self, topology, values, size, normal=False):
        """Pixels (size, size, 4), first row on top, of {slot: value or three numbers' values}."""
        thing, _, render = self.unwrap(topology)
        self.alone(thing)
        image = bpy.data.images.new("tempolux bake", size, size, float_buffer=True, alpha=True)
        image.generated_color = (0, 0, 0, 0)
        image.colorspace_settings.name = "Non-Color"
        if not thing.data.materials:
            thing.data.materials.append(None)
        kept, copies = list(thing.data.materials), []
        try:
            for slot, material in enumerate(kept):
                copies.append(self.copy(material, values.get(slot), image, render, normal))
                thing.data.materials[slot] = copies[-1]
            self.fill(thing)
            options = dict(
                type="NORMAL" if normal else "EMIT",
                margin=max(2, size // 64),
                use_clear=True,
                use_selected_to_active=False,
                target="IMAGE_TEXTURES",
            )
            if normal:
                options.update(normal_space="TANGENT", normal_r="POS_X", normal_g="POS_Y", normal_b="POS_Z")
            bpy.ops.object.bake(**options)
            flat = numpy.empty(size * size * 4, "f4")
            image.pixels.foreach_get(flat)
            if not flat[3::4].any():
                raise RuntimeError("Cycles baked nothing")
        finally:
            for slot, material in enumerate(kept):
                thing.data.materials[slot] = material
            for copy in copies:
                bpy.data.materials.remove(copy)
            bpy.data.images.remove(image)
        return numpy.nan_to_num(flat.reshape(size, size, 4)[::-1], nan=0, posinf=1e30, neginf=0).copy()

    @staticmethod
    def fill(thing):
        """Faces whose slot has no material would stop the bake."""
        most = len(thing.data.materials) - 1
        for polygon in thing.data.polygons:
            if polygon.material_index > most:
                polygon.material_index = most

    def copy(self, material, value, image, render, normal):
        """A copy of a material that shines with a value, or reflects with a normal."""
        if material is not None and material.node_tree:
            made = material.copy()
            single_user_groups(made.node_tree)
            pin_coordinates(made.node_tree, render)
        else:
            made = bpy.data.materials.new("tempolux bake")
            if made.node_tree is None:
                made.use_nodes = True
        tree = made.node_tree
        output = (
            tree.get_output_node("CYCLES") or tree.get_output_node("ALL") or tree.nodes.new("ShaderNodeOutputMaterial")
        )
        for name in ("Surface", "Volume") + (() if normal else ("Displacement",)):
            for link in list(output.inputs[name].links):
                tree.links.remove(link)
        shader = tree.nodes.new("ShaderNodeBsdfDiffuse" if normal else "ShaderNodeEmission")
        target = shader.inputs["Normal" if normal else "Color"]
        if isinstance(value, list):                        # three numbers of their own
            joint = tree.nodes.new("ShaderNodeCombineXYZ")
            for part, socket in zip(value, joint.inputs):
                connect(tree, part, socket)
            tree.links.new(joint.outputs[0], target)
        elif value is not None:
            connect(tree, value, target)
        elif not normal:
            target.default_value = (0, 0, 0, 1)
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        for other in tree.nodes:
            other.select = other == node
        tree.nodes.active = node
        return made


# ---- expressions as nodes -----------------------------------------------------------------------------------

def single_user_groups(tree):
    for node in tree.nodes:
        if node.type == "GROUP" and node.node_tree:
            node.node_tree = node.node_tree.copy()
            single_user_groups(node.node_tree)


def pin_coordinates(tree, render):
    """The bake's own texture coordinates would take the place of those that are used without a name."""
    def source():
        node = tree.nodes.new("ShaderNodeUVMap")
        node.uv_map = render
        return node.outputs[0]
    for node in list(tree.nodes):
        if node.type == "TEX_IMAGE" and not node.inputs["Vector"].is_linked:
            tree.links.new(source(), node.inputs["Vector"])
        elif node.type == "TEX_COORD" and node.outputs["UV"].is_linked:
            for link in list(node.outputs["UV"].links):
                tree.links.new(source(), link.to_socket)
        elif node.type in ("NORMAL_MAP", "UVMAP", "TANGENT") and hasattr(node, "uv_map") and not node.uv_map:
            node.uv_map = render
        elif node.type == "GROUP" and node.node_tree:
            pin_coordinates(node.node_tree, render)


def new_output(tree, kind):
    if hasattr(tree, "interface"):
        return tree.interface.new_socket("tempolux", in_out="OUTPUT", socket_type=kind).identifier
    return tree.outputs.new(kind, "tempolux").identifier


def expose(tree, source):
    """The socket of a source in the copy `tree`, brought out of its groups."""
    trees, groups = [tree], []
    for group in source.stack:
        groups.append(trees[-1].nodes[group.name])
        trees.append(groups[-1].node_tree)
    node = trees[-1].nodes[source.node.name]
    socket = next(s for s in node.outputs if s.identifier == source.socket.identifier)
    kind = {"VALUE": "NodeSocketFloat", "VECTOR": "NodeSocketVector"}.get(socket.type, "NodeSocketColor")
    for inner, group in zip(reversed(trees[1:]), reversed(groups)):
        name = new_output(inner, kind)
        end = next(n for n in inner.nodes if n.type == "GROUP_OUTPUT")
        inner.links.new(socket, next(s for s in end.inputs if s.identifier == name))
        socket = next(s for s in group.outputs if s.identifier == name)
    return socket


def connect(tree, value, target):
    """Makes `target`, an input in the top tree, have a value."""
    if is_constant(value):
        if target.type == "RGBA":
            target.default_value = (*as_tuple(value), 1)
        elif target.type == "VECTOR":
            target.default_value = as_tuple(value)
        else:
            target.default_value = value if not isinstance(value, tuple) else sum(value) / 3
        return
    if isinstance(value, Source):
        tree.links.new(expose(tree, value), target)
        return
    node = tree.nodes.new("ShaderNodeMixRGB" if hasattr(bpy.types, "ShaderNodeMixRGB") else "ShaderNodeMix")
    if node.bl_idname == "ShaderNodeMix":
        node.data_type = "RGBA"
    factor, a, b = ends(node)
    if isinstance(value, Blend):
        connect(tree, value.factor, factor)
        connect(tree, value.a, a)
        connect(tree, value.b, b)
    elif isinstance(value, Times):
        node.blend_type = "MULTIPLY"
        factor.default_value = 1
        connect(tree, value.a, a)
        connect(tree, value.b, b)
    result = next(s for s in node.outputs if s.enabled and s.type == "RGBA")
    tree.links.new(result, target)


def ends(node):
    """Factor and the two colours of a Mix node."""
    usable = [s for s in node.inputs if s.enabled]
    factor = next(s for s in usable if s.type == "VALUE")
    colours = [s for s in usable if s.type == "RGBA"]
    return factor, colours[0], colours[1]

"""Smoke of an OpenVDB file for Cycles. Runs inside Blender, 3.4 and later."""
import bpy
import mathutils


def place_smoke(file, sigma_t, albedo):
    """Grid `density`, placed as the glTF is; extinction of density 1 in 1/m; scattered evenly."""
    bpy.ops.object.volume_import(filepath=file)
    volume = bpy.context.object
    # Blender's z is up, glTF's y.
    volume.matrix_world = mathutils.Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
    material = bpy.data.materials.new("Smoke")
    material.use_nodes = True
    nodes, link = material.node_tree.nodes, material.node_tree.links.new
    nodes.clear()
    density, scaled, both = (nodes.new(f"ShaderNode{kind}") for kind in ("Attribute", "Math", "AddShader"))
    density.attribute_name, scaled.operation = "density", "MULTIPLY"
    link(density.outputs["Fac"], scaled.inputs[0])
    scaled.inputs[1].default_value = sigma_t
    # colour x density scatters, (1 - colour) x density absorbs
    for i, kind in enumerate(("VolumeScatter", "VolumeAbsorption")):
        part = nodes.new(f"ShaderNode{kind}")
        part.inputs["Color"].default_value = [*albedo, 1]
        link(scaled.outputs[0], part.inputs["Density"])
        link(part.outputs[0], both.inputs[i])
    link(both.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
    volume.data.materials.append(material)

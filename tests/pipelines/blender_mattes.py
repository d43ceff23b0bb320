"""Blender's compositor finds our mattes, and the same shares in them as tests/formats/read_mattes.py.

    build/peers/bpy/bin/python tests/pipelines/blender_mattes.py BIN_DIR

Blender 5.0 or later. A frame with motion blur and depth of field; the matte of one object, pixel by pixel. Skipped (77)
without the module bpy.
"""

import pathlib
import subprocess
import sys
import tempfile

try:
    import bpy
except ImportError:
    print("there is no module bpy: sh tests/pipelines/get_bpy.sh")
    sys.exit(77)

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOP / "tests/formats")]
import read_mattes  # noqa: E402

NAME, WIDTH, HEIGHT = "MovingBox", 96, 54


def matte_by_blender(frame, folder):
    """The matte of NAME in the layer CryptoObject, rows from the top."""
    scene = bpy.context.scene
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(scene.camera)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    tree = scene.compositing_node_group = bpy.data.node_groups.new("mattes", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    node = tree.nodes.new("CompositorNodeCryptomatteV2")
    node.source, node.image = "IMAGE", bpy.data.images.load(str(frame))
    for layer in ("CryptoMaterial", "CryptoObject"):    # an error if Blender does not find the layer
        node.layer_name = layer
    node.matte_id = NAME
    tree.links.new(node.outputs["Matte"], tree.nodes.new("NodeGroupOutput").inputs[0])
    scene.view_settings.view_transform = "Raw"
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "NONE"
    scene.render.filepath = str(folder / "blender.exr")
    bpy.ops.render.render(write_still=True)
    image = read_mattes.Frame(scene.render.filepath)
    return [image.pixel(x, y)["R"] for y in range(HEIGHT) for x in range(WIDTH)]


def main(bin_dir):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        frame = folder / "frame.exr"
        subprocess.run([str(pathlib.Path(bin_dir).resolve() / "frame-render"), str(TOP / "pipelines/scenes/S2_cornell_moving.glb"), "-q",
                        "--frame", "10", "--size", f"{WIDTH}x{HEIGHT}", "--integrator", "path", "--spp", "16", "--shutter", "360",
                        "--f-stop", ".5", "--focus", "2", "--channels", "RGBA,Z,id,cryptomatte", "-o", str(frame)], check=True)
        ours = read_mattes.Frame(str(frame))
        layer = next(m for m in read_mattes.mattes_in(ours) if m.name == "CryptoObject")
        expected = [dict(layer.at(ours.pixel(x, y))).get(NAME, 0) for y in range(HEIGHT) for x in range(WIDTH)]
        found = matte_by_blender(frame, folder)
        soft = sum(0 < value < 1 for value in expected)
        worst = max(abs(a - b) for a, b in zip(found, expected))
        print(f"{NAME}: {soft} soft pixels, largest difference {worst:.3g}")
        assert soft > 50 and worst <= 1e-6


main(sys.argv[1])

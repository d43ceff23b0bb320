"""Small animated scenes and edits of them, for random_walk.py and two_makes.py.

A scene is a function of its edits: files(name, edits) gives the bytes of every file, so that equal edits are equal files. An edit is a small
whole number, 0 for the scene as it was: `lamp`, `object`, `camera` move a node, `colour` changes what the lamp emits, `texture`, `sky` and
`smoke` change the content of a file. Every scene has two cameras, the second is called Side.
"""
import copy
import math
import struct
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import edit_gltf                                                                     # noqa: E402
import textured_room                                                                 # noqa: E402

SCENES = HERE.parents[1] / "pipelines" / "scenes"
FRAMES = 8


# ---- edits that any scene takes ----------------------------------------------------------------------

def node_of(gltf, name):
    return next(i for i, node in enumerate(gltf["nodes"]) if node.get("name") == name)


def move(gltf, name, by):
    """The node NAME and what moves it stand BY further, in its parent's space: a new node above it."""
    index, new = node_of(gltf, name), len(gltf["nodes"])
    for children in [node.get("children", []) for node in gltf["nodes"]] + [scene["nodes"] for scene in gltf["scenes"]]:
        children[:] = [new if child == index else child for child in children]
    gltf["nodes"].append({"translation": list(by), "children": [index]})


def add_camera(gltf, name, place, yfov=1.2):
    gltf.setdefault("cameras", []).append({"type": "perspective", "perspective": {"yfov": yfov, "znear": 0.01}})
    gltf["nodes"].append({"name": name, "camera": len(gltf["cameras"]) - 1, "translation": place})
    gltf["scenes"][0]["nodes"].append(len(gltf["nodes"]) - 1)


def edited(gltf, edits, nodes):
    """nodes: {edit: (name of the node, distance of one step)}."""
    for edit, (name, step) in nodes.items():
        if edits.get(edit):
            move(gltf, name, [edits[edit] * x for x in step])
    if edits.get("colour"):
        for material in gltf["materials"]:
            if any(material.get("emissiveFactor", [0])):
                material["emissiveFactor"] = [1, 1 - 0.2 * edits["colour"], 1 - 0.3 * edits["colour"]]
        for lamp in gltf.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", []):
            lamp["color"] = [1, 1 - 0.2 * edits["colour"], 1 - 0.3 * edits["colour"]]


def glb(gltf, binary):
    path = Path(edit_gltf.__file__)                                                  # write_glb wants a file name
    import tempfile
    with tempfile.NamedTemporaryFile(suffix=".glb", prefix=path.stem) as file:
        edit_gltf.write_glb(file.name, gltf, bytearray(binary), separators=(",", ":"))
        return Path(file.name).read_bytes()


def sky(number):
    """A map of the sky as Radiance's .hdr, 16 x 8 pixels: light from above, and from one side a brighter window."""
    def rgbe(colour):
        largest = max(colour)
        exponent = math.frexp(largest)[1]
        return bytes(min(255, int(256 * math.ldexp(x, -exponent))) for x in colour) + bytes((exponent + 128,))
    rows = [rgbe((2, 2, 3) if 3 * number <= x < 3 * number + 4 else (0.5, 0.6, 0.9) if y < 4 else (0.1, 0.1, 0.1)) for y in range(8) for x in range(16)]
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + b"".join(rows)


# ---- the scenes --------------------------------------------------------------------------------------

def box_scene(edits):
    """A closed room with a lamp in its ceiling, in which a box slides."""
    gltf, binary = edit_gltf.read_glb(SCENES / "S2_cornell_moving.glb")
    add_camera(gltf, "Side", [0.5, 1.2, 1.9])
    edited(gltf, edits, {"lamp": ("Emitter", (0.1, -0.05, 0)), "object": ("TallBox", (0.1, 0, 0)), "camera": ("Camera", (0.03, 0.02, 0))})
    return {"scene.glb": glb(gltf, binary)}


def lamp_scene(edits):
    """Nothing moves but a point lamp, which stands still in the second segment; the camera walks."""
    gltf, binary = edit_gltf.read_glb(SCENES / "S1_cornell.glb")
    gltf.pop("animations", None)
    gltf["extensionsUsed"].append("KHR_lights_punctual")
    gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 1}]}}
    gltf["nodes"].append({"name": "Lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}})
    gltf["scenes"][0]["nodes"].append(len(gltf["nodes"]) - 1)
    edit_gltf.animate(gltf, binary, len(gltf["nodes"]) - 1, {f: [0.1 * min(f, 3), 1, 0.5] for f in range(FRAMES)})
    camera = node_of(gltf, "Camera")
    x, y, z = gltf["nodes"][camera]["translation"]
    edit_gltf.animate(gltf, binary, camera, {f: [x + 0.05 * f, y, z] for f in range(FRAMES)})
    add_camera(gltf, "Side", [0.5, 1.2, 1.9])
    edited(gltf, edits, {"lamp": ("Lamp", (0.1, 0.1, 0)), "object": ("TallBox", (0.1, 0, 0)), "camera": ("Camera", (0.02, 0.02, 0))})
    return {"scene.glb": glb(gltf, binary)}


def open_scene(edits):
    """A room without its front wall: textured floor and picture, a mirror that comes in at frame 5, a box that slides, a camera that walks."""
    m = textured_room.Maker()

    def image(name):
        m.gltf["images"].append({"uri": name})
        m.gltf["textures"].append({"source": len(m.gltf["images"]) - 1, "sampler": 0})
        return {"index": len(m.gltf["textures"]) - 1}
    walls = [quad for quad in textured_room.box((-2, 0, -2), (2, 2.5, 2), True) if quad[0] != (-2, 0, 2)]
    floor = next(quad for quad in walls if not quad[1][1] and not quad[2][1] and quad[0][1] == 0)
    walls.remove(floor)
    matte = {"metallicFactor": 0, "baseColorFactor": [0.7, 0.7, 0.7, 1]}
    dull = {"KHR_materials_specular": {"specularFactor": 0}}
    m.gltf["extensionsUsed"] = ["KHR_materials_specular", "KHR_lights_punctual"]
    m.quads({"pbrMetallicRoughness": matte, "doubleSided": True, "extensions": dull}, *walls)
    m.quads({"pbrMetallicRoughness": {"baseColorTexture": image("floor.png"), "metallicFactor": 0}, "doubleSided": True, "extensions": dull}, floor)
    names = ["Walls", "Floor"]
    m.quads({"pbrMetallicRoughness": matte, "extensions": dull}, *textured_room.box((-0.3, 0, -0.3), (0.3, 0.6, 0.3), False))
    m.quads({"pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0, "baseColorFactor": [0.9, 0.9, 0.9, 1]}, "doubleSided": True},
            ((-0.5, 0, 0), (1, 0, 0.3), (0, 1.2, 0)))
    names += ["Box", "Mirror"]
    for node, name in zip(m.gltf["nodes"], names):
        node["name"] = name
    m.gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 2}]}}
    m.node(name="Lamp", extensions={"KHR_lights_punctual": {"light": 0}}, translation=[-1, 2, 0.5])
    m.gltf["cameras"].append({"type": "perspective", "perspective": {"yfov": 1, "znear": 0.01}})
    m.node(name="Camera", camera=0, translation=[0, 1.2, 3.5])
    gltf, binary = m.gltf, bytearray(m.binary)
    gltf["buffers"] = [{"byteLength": len(binary), "uri": "scene.bin"}]
    away = [0, -50, 0]
    edit_gltf.animate(gltf, binary, node_of(gltf, "Box"), {f: [-1 + 0.2 * f, 0, -0.5] for f in range(FRAMES)})
    edit_gltf.animate(gltf, binary, node_of(gltf, "Mirror"), {f: away if f < 5 else [1, 0, -1.2] for f in range(FRAMES)}, interpolation="STEP")
    edit_gltf.animate(gltf, binary, node_of(gltf, "Camera"), {f: [0.05 * f, 1.2, 3.5] for f in range(FRAMES)})
    add_camera(gltf, "Side", [1, 1, 3])
    edited(gltf, edits, {"lamp": ("Lamp", (0.2, -0.1, 0)), "object": ("Box", (0.1, 0, 0.1)), "camera": ("Camera", (0.03, 0, 0.05))})
    gltf["buffers"][0]["byteLength"] = len(binary)
    import json
    shades = [(200, 180, 160, 255), (90, 160, 220, 255), (220, 90, 90, 255)]
    one = shades[edits.get("texture", 0)]
    files = {"scene.gltf": json.dumps(gltf).encode(), "scene.bin": bytes(binary),
             "floor.png": textured_room.png(8, lambda x, y: one if (x + y) % 2 else (60, 60, 60, 255))}
    return files | {"sky.hdr": sky(edits.get("sky", 0))}


def smoke_scene(edits):
    """A closed room with a ball of smoke that rises."""
    gltf, binary = edit_gltf.read_glb(SCENES / "S1_cornell.glb")
    add_camera(gltf, "Side", [0.5, 1.2, 1.9])
    edited(gltf, edits, {"lamp": ("Emitter", (0.1, -0.05, 0)), "object": ("TallBox", (0.1, 0, 0)), "camera": ("Camera", (0.03, 0.02, 0))})
    return {"scene.glb": glb(gltf, binary)} | {f"smoke_{f:04d}.vdb": ("vdb", f, edits.get("smoke", 0)) for f in range(FRAMES)}


def late_scene(edits):
    """A mirror comes in beside a point lamp, on open ground: no caustics before frame 5, some from there on."""
    files = open_scene(edits | {"sky": 0})
    import json
    gltf = json.loads(files["scene.gltf"])
    for name in ("Walls", "Box"):                                                    # the ground, the mirror and the lamp remain
        gltf["scenes"][0]["nodes"] = [n for n in gltf["scenes"][0]["nodes"] if gltf["nodes"][n].get("name") != name]
    files["scene.gltf"] = json.dumps(gltf).encode()
    del files["sky.hdr"]
    return files


SCENE = {"box": box_scene, "lamp": lamp_scene, "open": open_scene, "smoke": smoke_scene, "late": late_scene}
# What can be edited, and how many states each edit has.
EDITS = {"box": {"lamp": 3, "object": 3, "camera": 3, "colour": 2},
         "lamp": {"lamp": 3, "object": 2, "camera": 3, "colour": 2},
         "open": {"lamp": 3, "object": 2, "camera": 3, "colour": 2, "texture": 3, "sky": 3},
         "smoke": {"lamp": 2, "camera": 2, "smoke": 3, "colour": 2},
         "late": {"lamp": 2, "camera": 2, "texture": 3}}


def vdb(make_vdb, path, frame, number):
    """A ball of smoke of 16^3 voxels; `number` says how dense it is, at frame 2 alone."""
    largest = (1, 0.5, 2)[number] if frame == 2 else 1
    ball = [largest * max(0.0, 1 - math.dist((x, y, z), (7.5, 5 + 0.7 * frame, 7.5)) / 5) for x in range(16) for y in range(16) for z in range(16)]
    subprocess.run([make_vdb, path, "16", "16", "16", ".06", "-.45", ".5", "-.45"], input=struct.pack("<4096f", *ball), check=True)


def scene_file(name):
    return "scene.gltf" if name in ("open", "late") else "scene.glb"


def files(name, edits):
    """{file name: bytes, or ("vdb", frame, number) for one that make-vdb writes}."""
    return SCENE[name](copy.deepcopy(edits))

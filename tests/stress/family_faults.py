"""Small faults of scene files: five good files, in each variant one property with one wrong value. A variant is
rendered with a warning that names the property, or refused with its name. Silence is right only if the picture is the
good file's, bit by bit: the property then has no meaning there (a clipping plane, the name of a mesh), or the value
means what was there before. Never a crash.

The wrong values follow from the schema of glTF 2.0 below, by kind of the property and not by file. A seeded generator
chooses the variants."""
import array
import base64
import copy
import json
import random
import re
import struct
import zlib

import exr
from scenes import Scene
from session import case

INF = float("inf")
TRANSFORM = "materials.pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform."

# Property, by the objects in which it lies: kind, least and largest number, count of numbers. "index": of that array.
SCHEMA = {
    "scene": ("index", "scenes"),
    "scenes.nodes": ("indices", "nodes"),
    "nodes.children": ("indices", "nodes"), "nodes.mesh": ("index", "meshes"), "nodes.camera": ("index", "cameras"),
    "nodes.skin": ("index", "skins"), "nodes.translation": ("numbers", -INF, INF, 3),
    "nodes.rotation": ("numbers", -1, 1, 4), "nodes.scale": ("numbers", -INF, INF, 3),
    "nodes.weights": ("numbers", -INF, INF, 2), "nodes.name": ("string",),
    "nodes.extensions.KHR_lights_punctual.light": ("index", "extensions.KHR_lights_punctual.lights"),
    "nodes.extensions.KHR_node_visibility.visible": ("boolean",),
    "nodes.extensions.EXT_mesh_gpu_instancing.attributes.TRANSLATION": ("index", "accessors"),
    "meshes.primitives.attributes.POSITION": ("index", "accessors"),
    "meshes.primitives.attributes.NORMAL": ("index", "accessors"),
    "meshes.primitives.attributes.TEXCOORD_0": ("index", "accessors"),
    "meshes.primitives.attributes.COLOR_0": ("index", "accessors"),
    "meshes.primitives.attributes.JOINTS_0": ("index", "accessors"),
    "meshes.primitives.attributes.WEIGHTS_0": ("index", "accessors"),
    "meshes.primitives.indices": ("index", "accessors"), "meshes.primitives.material": ("index", "materials"),
    "meshes.primitives.mode": ("integer", 0, 6), "meshes.weights": ("numbers", -INF, INF, 2),
    "accessors.bufferView": ("index", "bufferViews"), "accessors.componentType": ("integer", 5120, 5126),
    "accessors.count": ("integer", 1, INF), "accessors.type": ("string",), "accessors.byteOffset": ("integer", 0, INF),
    "bufferViews.buffer": ("index", "buffers"), "bufferViews.byteOffset": ("integer", 0, INF),
    "bufferViews.byteLength": ("integer", 1, INF), "buffers.byteLength": ("integer", 1, INF),
    "buffers.uri": ("string",),
    "materials.pbrMetallicRoughness.baseColorFactor": ("numbers", 0, 1, 4),
    "materials.pbrMetallicRoughness.metallicFactor": ("number", 0, 1),
    "materials.pbrMetallicRoughness.roughnessFactor": ("number", 0, 1),
    "materials.pbrMetallicRoughness.baseColorTexture.index": ("index", "textures"),
    "materials.pbrMetallicRoughness.baseColorTexture.texCoord": ("integer", 0, INF),
    "materials.emissiveFactor": ("numbers", 0, 1, 3), "materials.alphaMode": ("string",),
    "materials.alphaCutoff": ("number", 0, INF), "materials.doubleSided": ("boolean",),
    "materials.extensions.KHR_materials_specular.specularFactor": ("number", 0, 1),
    "materials.extensions.KHR_materials_emissive_strength.emissiveStrength": ("number", 0, INF),
    "materials.extensions.KHR_materials_ior.ior": ("number", 1, INF),
    "materials.extensions.KHR_materials_transmission.transmissionFactor": ("number", 0, 1),
    "materials.extensions.KHR_materials_pbrSpecularGlossiness.diffuseFactor": ("numbers", 0, 1, 4),
    "materials.extensions.KHR_materials_pbrSpecularGlossiness.specularFactor": ("numbers", 0, 1, 3),
    "materials.extensions.KHR_materials_pbrSpecularGlossiness.glossinessFactor": ("number", 0, 1),
    "materials.extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.index": ("index", "textures"),
    "materials.extensions.KHR_materials_pbrSpecularGlossiness.specularGlossinessTexture.index": ("index", "textures"),
    "textures.source": ("index", "images"), "textures.sampler": ("index", "samplers"), "images.uri": ("string",),
    "samplers.wrapS": ("integer", 10497, 33648), "samplers.wrapT": ("integer", 10497, 33648),
    "samplers.magFilter": ("integer", 9728, 9729), "samplers.minFilter": ("integer", 9728, 9987),
    "asset.version": ("string",), "asset.minVersion": ("string",), "extensionsUsed": ("strings",),
    "extensionsRequired": ("strings",), "accessors.min": ("numbers", -INF, INF, 3),
    "accessors.normalized": ("boolean",),
    "accessors.max": ("numbers", -INF, INF, 3), "bufferViews.byteStride": ("integer", 4, 252),
    "bufferViews.target": ("integer", 34962, 34963), "accessors.sparse": ("object",),
    "accessors.sparse.count": ("integer", 1, INF), "accessors.sparse.indices.bufferView": ("index", "bufferViews"),
    "accessors.sparse.indices.componentType": ("integer", 5121, 5125),
    "accessors.sparse.values.bufferView": ("index", "bufferViews"),
    "meshes.primitives.targets": ("objects",), "meshes.primitives.targets.POSITION": ("index", "accessors"),
    "materials.normalTexture.index": ("index", "textures"), "materials.normalTexture.scale": ("number", -INF, INF),
    "materials.occlusionTexture.index": ("index", "textures"), "materials.occlusionTexture.strength": ("number", 0, 1),
    "materials.emissiveTexture.index": ("index", "textures"),
    "materials.pbrMetallicRoughness.metallicRoughnessTexture.index": ("index", "textures"),
    TRANSFORM + "offset": ("numbers", -INF, INF, 2), TRANSFORM + "scale": ("numbers", -INF, INF, 2),
    TRANSFORM + "rotation": ("number", -INF, INF),
    "materials.extensions.KHR_materials_specular.specularColorFactor": ("numbers", 0, INF, 3),
    "materials.extensions.KHR_materials_volume.thicknessFactor": ("number", 0, INF),
    "materials.extensions.KHR_materials_volume.attenuationColor": ("numbers", 0, 1, 3),
    "materials.extensions.KHR_materials_volume.attenuationDistance": ("number", 0, INF),
    "cameras.orthographic": ("object",), "cameras.orthographic.xmag": ("number", 0, INF),
    "cameras.orthographic.ymag": ("number", 0, INF), "cameras.orthographic.zfar": ("number", 0, INF),
    "extensions.KHR_lights_punctual.lights": ("objects",),
    "extensions.KHR_lights_punctual.lights.range": ("number", 0, INF),
    "skins.joints": ("indices", "nodes"), "skins.inverseBindMatrices": ("index", "accessors"),
    "cameras.type": ("string",), "cameras.perspective": ("object",), "cameras.perspective.yfov": ("number", 0, 3.14),
    "cameras.perspective.znear": ("number", 0, INF),
    "animations.channels": ("objects",), "animations.channels.sampler": ("index", "animations.samplers"),
    "animations.channels.target.node": ("index", "nodes"), "animations.channels.target.path": ("string",),
    "animations.samplers.input": ("index", "accessors"), "animations.samplers.output": ("index", "accessors"),
    "animations.samplers.interpolation": ("string",),
    "extensions.KHR_lights_punctual.lights.type": ("string",),
    "extensions.KHR_lights_punctual.lights.color": ("numbers", 0, 1, 3),
    "extensions.KHR_lights_punctual.lights.intensity": ("number", 0, INF),
    "extensions.KHR_lights_punctual.lights.spot": ("object",),
    "extensions.KHR_lights_punctual.lights.spot.innerConeAngle": ("number", 0, 1.57),
    "extensions.KHR_lights_punctual.lights.spot.outerConeAngle": ("number", 0, 1.58),
    "materials": ("objects",), "cameras": ("objects",), "textures": ("objects",), "samplers": ("objects",),
    "animations": ("objects",), "skins": ("objects",), "nodes": ("objects",), "meshes": ("objects",),
}


# ---- five good files ------------------------------------------------------------------------------------

def small_png():
    """Four texels: red, green, blue, white."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    rows = b"\0\xff\0\0\xff\0\xff\0\xff" + b"\0\0\0\xff\x80\xff\xff\xff\xff"
    data = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 2, 2, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    return "data:image/png;base64," + base64.b64encode(data).decode()


def stage():
    """A lit floor, and a camera above it."""
    scene = Scene()
    scene.quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2), scene.material(0.5), name="Floor")
    scene.point_light((1, 3, 1), 20)
    scene.camera((0, 1.5, 4), (0, 0.6, 0))
    return scene


def wall(scene, material, **node):
    """An upright square with normals and texture coordinates; its primitive."""
    scene.mesh([-1, 0, 0, 1, 0, 0, 1, 2, 0, -1, 2, 0], [0, 1, 2, 0, 2, 3], material, [0, 0, 1] * 4, **node)
    primitive = scene.document["meshes"][-1]["primitives"][0]
    uv = scene._accessor(array.array("f", [0, 1, 1, 1, 1, 0, 0, 0]), "SCALAR", 5126)
    scene.document["accessors"][uv].update({"type": "VEC2", "count": 4})
    primitive["attributes"]["TEXCOORD_0"] = uv
    primitive["mode"] = 4
    return primitive


def textured():
    scene = stage()
    d = scene.document
    d["images"] = [{"uri": small_png()}]
    d["samplers"] = [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9728}]
    d["textures"] = [{"source": 0, "sampler": 0}]
    material = scene.material(0.8)
    d["materials"][material].update(
        {"alphaMode": "MASK", "alphaCutoff": 0.25, "normalTexture": {"index": 0, "scale": 0.2},
         "occlusionTexture": {"index": 0, "strength": 0.5}, "emissiveFactor": [0.1, 0.1, 0.1],
         "emissiveTexture": {"index": 0}})
    d["materials"][material]["pbrMetallicRoughness"].update(
        {"metallicRoughnessTexture": {"index": 0},
         "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {
             "offset": [0.25, 0], "scale": [2, 2], "rotation": 0.3}}}})
    scene.extensions.add("KHR_texture_transform")
    wall(scene, material, name="Picture")
    return scene


def lamps():
    scene = Scene()
    scene.quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2), scene.material(0.5))
    scene.spot_light((0, 3, 1), (0, 0, 0), [30, 20, 10], 0.3, 0.6)
    scene.sun((0.2, -1, -0.3), 1)
    scene.quad((-1, 2, -1), (1, 2, -1), (1, 2.5, -1), (-1, 2.5, -1), scene.material(0.5, [3, 2, 1]))
    scene.quad((-1, 0, 0), (0, 0, 0), (0, 1, 0), (-1, 1, 0), scene.glass(attenuation=(0.5, 0.3)))
    scene.document["materials"][-1]["extensions"]["KHR_materials_specular"]["specularColorFactor"] = [1, 0.5, 1]
    scene.camera((0, 1.5, 4), (0, 0.6, 0), half_height=1.5)
    return scene


def animated():
    """At frame 6: a wall moves and turns, a skinned one bends, a third one is shown."""
    scene = stage()
    d = scene.document
    moving = len(d["nodes"])
    wall(scene, scene.material([0.8, 0.2, 0.2]), name="Mover")
    scene.animate(moving, "translation", [0, 0.5], [[-1, 0, 0], [1, 0, 0]])
    primitive = scene.document["meshes"][-1]["primitives"][0]
    primitive["targets"] = [{"POSITION": scene._accessor(array.array("f", [0, 0, 0.5] * 4), "VEC3", 5126)},
                            {"POSITION": scene._accessor(array.array("f", [0, 0.5, 0] * 4), "VEC3", 5126)}]
    d["meshes"][-1]["weights"] = [0.5, 0]
    d["nodes"][moving]["weights"] = [0.25, 0.5]
    scene.animate(moving, "rotation", [0, 0.5], [[0, 0, 0, 1], [0, 0.6, 0, 0.8]], "STEP")
    joint = scene.node(name="Joint", translation=[0.5, 0, 0.5], scale=[0.5, 0.5, 0.5])
    primitive = wall(scene, scene.material([0.2, 0.2, 0.8]), name="Skinned")
    primitive["attributes"]["JOINTS_0"] = scene._accessor(array.array("I", [0] * 4), "VEC4", 5126)
    d["accessors"][-1].update({"componentType": 5121, "count": 4})
    primitive["attributes"]["WEIGHTS_0"] = scene._accessor(array.array("f", [1, 0, 0, 0] * 4), "VEC4", 5126)
    identity = array.array("f", [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    matrices = scene._accessor(identity, "VEC4", 5126)
    d["accessors"][matrices].update({"type": "MAT4", "count": 1})
    d["skins"] = [{"joints": [joint], "inverseBindMatrices": matrices}]
    d["nodes"][-1]["skin"] = 0
    wall(scene, scene.material([0.2, 0.8, 0.2]), name="Hidden", translation=[0, 0.3, 1], scale=[0.3, 0.3, 0.3])
    d["nodes"][-1]["extensions"] = {"KHR_node_visibility": {"visible": False}}
    scene.extensions.add("KHR_node_visibility")
    return scene


def instances():
    scene = stage()
    d = scene.document
    primitive = wall(scene, scene.material(0.9), name="Copies", scale=[0.3, 0.3, 0.3])
    colours = array.array("f", [1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0])
    primitive["attributes"]["COLOR_0"] = scene._accessor(colours, "VEC3", 5126)
    for view in d["bufferViews"]:
        view["target"] = 34962
    d["bufferViews"][0]["byteStride"] = 12
    some = scene._accessor(array.array("I", [0]), "SCALAR", 5125)
    moved = scene._accessor(array.array("f", [-2, 0.5, 2]), "VEC3", 5126)
    d["accessors"][0]["sparse"] = {"count": 1, "indices": {"bufferView": d["accessors"][some]["bufferView"],
                                                           "componentType": 5125},
                                   "values": {"bufferView": d["accessors"][moved]["bufferView"]}}
    places = scene._accessor(array.array("f", [-3, 0, 0, 0, 1, 0, 3, 0, 1]), "VEC3", 5126)
    d["nodes"][-1]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}
    scene.extensions.add("EXT_mesh_gpu_instancing")
    scene.node(children=[len(d["nodes"]) - 1], translation=[0, 0.2, 0])
    d["scenes"][0]["nodes"].remove(len(d["nodes"]) - 2)
    return scene


def specular_glossiness():
    scene = stage()
    d = scene.document
    d["images"] = [{"uri": small_png()}]
    d["samplers"] = [{}]
    d["textures"] = [{"source": 0, "sampler": 0}]
    name = "KHR_materials_pbrSpecularGlossiness"
    plain, textures = scene.material(0.5), scene.material(0.5)
    factors = {"diffuseFactor": [0.5, 0.2, 0.1, 1], "specularFactor": [0.3, 0.2, 0.1], "glossinessFactor": 0.4}
    maps = {"diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 0}, "glossinessFactor": 0.4}
    d["materials"][plain]["extensions"], d["materials"][textures]["extensions"] = {name: factors}, {name: maps}
    wall(scene, plain, translation=[-1, 0, 0], scale=[0.8, 0.8, 0.8])
    wall(scene, textures, translation=[1, 0, 0], scale=[0.8, 0.8, 0.8])
    scene.extensions.add(name)
    return scene


GOOD = [textured, lamps, animated, instances, specular_glossiness]


# ---- one fault ------------------------------------------------------------------------------------------

def properties(value, path=()):
    """Paths of all properties of the schema in a document."""
    if isinstance(value, dict):
        for key, inside in value.items():
            yield from properties(inside, path + (key,))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for i, inside in enumerate(value):
            yield from properties(inside, path + (i,))
    name = ".".join(k for k in path if isinstance(k, str))
    if name in SCHEMA and isinstance(path[-1], str):
        yield path, name


def length_of(document, name):
    """Number of elements of an array that an index counts."""
    values = [document]
    for key in name.split("."):
        values = [v[key] for value in values for v in (value if isinstance(value, list) else [value]) if key in v]
    return max((len(v) for v in values), default=0)


def wrong_values(document, old, name):
    """Wrong values of a property: null, another type, out of range, another count."""
    kind, *limits = SCHEMA[name]
    yield "null", None
    yield "wrong type", {"string": 7, "strings": 3, "boolean": "yes", "object": "none", "objects": 3}.get(kind, "x")
    if kind in ("number", "integer"):
        if limits[0] > -INF:
            yield "too small", limits[0] - (1 if kind == "integer" else 0.5)  # an ior of 0 is glTF's, one of .5 is not
        if limits[1] < INF:
            yield "too large", limits[1] + 1000
        elif kind == "integer":
            yield "too large", 10**12
    if kind == "integer":
        yield "a fraction", 2.5
    if kind == "index":
        yield "no such index", length_of(document, limits[0]) + 3
        yield "a negative index", -1
    if kind == "indices":
        yield "no such index", old[:-1] + [length_of(document, limits[0]) + 3]
    if kind == "numbers":
        yield "one number less", old[:-1]
        yield "a number of another type", old[:-1] + ["x"]
        if limits[1] < INF:
            yield "too large", [limits[1] + 5] + old[1:]
        if limits[0] > -INF:
            yield "too small", [limits[0] - 5] + old[1:]
    if kind == "string":
        yield "an unknown word", "unheard-of"
    if kind == "boolean":
        yield "a number", 1


def variants(document):
    for path, name in properties(document):
        old = document
        for key in path:
            old = old[key]
        for fault, value in wrong_values(document, old, name):
            if value != old:
                yield path, fault, value


def changed(document, path, value):
    other = copy.deepcopy(document)
    place = other
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return other


def names_it(line, path):
    """The line names the property, or the object that holds it by its number."""
    if re.search(rf"\b{re.escape(str(path[-1]))}\b", line):
        return True
    for i, key in enumerate(path):
        if not isinstance(key, int):
            continue
        array_name = path[i - 1]
        if re.search(rf"\b{array_name}\[{key}\]|\b{array_name.removesuffix('s')} {key}\b", line):
            return True
    return False


def picture(s, file):
    out = s.path(".exr")
    run = s.run("frame-render", file, "--frame", 6, "--size", "24x16", "--spp", 1, "--integrator", "path",
                "--threads", 1, "--compression", "none", "-o", out, timeout=20)
    return run, (exr.read(out).rgb() if run.code == 0 else None)


def said(run, file):
    """What the run says, without the name of the scene."""
    return [line.replace(str(file), "") for line in run.err.splitlines() if line.strip()]


def judge(s, good, path, fault, value):
    document, seen_before, known = good
    file = s.path(".gltf")
    with open(file, "w", encoding="utf-8") as out:
        json.dump(changed(document, path, value), out)
    run, seen = picture(s, file)
    lines = [line for line in said(run, file) if line not in known]
    shown = ".".join(map(str, path)) + f" = {json.dumps(value)[:40]} ({fault})"
    if run.killed or run.code not in (0, 2):
        return f"{shown}: exit {run.code}"
    named = any(names_it(line, path) for line in lines)
    if run.code == 2:
        return "" if len(lines) >= 1 and named else f"{shown}: refused without its name: {run.err.strip()[:200]}"
    if lines:
        return "" if named else f"{shown}: the warning names something else: {lines[0][:200]}"
    return "" if seen == seen_before else f"{shown}: silence, and another picture"


def run_faults(s, count, seed):
    documents = []
    for make in GOOD:
        file = s.path(".gltf")
        make().save(file)
        with open(file, encoding="utf-8") as source:
            document = json.load(source)
        run, good = picture(s, file)
        s.done(run)
        documents.append((make.__name__, (document, good, said(run, file)), list(variants(document))))
    chooser = random.Random(seed)
    per_file = count // len(documents)
    for name, good, all_of_it in documents:
        chosen = chooser.sample(all_of_it, min(per_file, len(all_of_it)))
        wrong = [why for path, fault, value in chosen if (why := judge(s, good, path, fault, value))]
        for why in wrong:
            s.true(f"{name}: {why}", False)
        s.true(f"{name}: variants of {len(all_of_it)} that are mended or refused by name", not wrong,
               f"{len(chosen) - len(wrong)} of {len(chosen)}", f"{len(chosen)} of {len(chosen)}")


@case("faults", "one fault in one of five good files")
def faults(s):
    run_faults(s, s.pick(20, 200, 20000), 1)

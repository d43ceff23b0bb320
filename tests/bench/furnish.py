"""Copies of glTF files that lack a camera or a light, with what they lack."""
import base64
import json
import math
import shutil
import struct


class Asset:
    """A glTF file in parts."""

    def __init__(self, path):
        data = path.read_bytes()
        self.path, self.binary = path, b""
        if data[:4] == b"glTF":
            size, = struct.unpack_from("<I", data, 12)
            self.gltf, self.binary = json.loads(data[20:20 + size]), data[20 + size:]     # with the header of the chunk
        else:
            self.gltf = json.loads(data)

    @property
    def has_camera(self):
        return any("camera" in node for node in self.gltf["nodes"])

    @property
    def has_light(self):
        return (any("KHR_lights_punctual" in node.get("extensions", {}) for node in self.gltf["nodes"])
                or any(any(m.get("emissiveFactor", [])) for m in self.gltf.get("materials", [])))

    def copied(self, folder):
        """Another one in a new folder, beside copies of the files it names."""
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.path.parent, folder)
        for file in [folder, *folder.rglob("*")]:
            file.chmod(0o755)
        return Asset(folder / self.path.name)

    def save(self):
        text = json.dumps(self.gltf).encode()
        if self.path.suffix == ".glb":
            text += b" " * (-len(text) % 4)
            size = 20 + len(text) + len(self.binary)
            text = struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON") + text + self.binary
        self.path.write_bytes(text)
        return self.path

    # ---- what is added

    def use(self, extension):
        used = self.gltf.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def node(self, **node):
        nodes = self.gltf["nodes"]
        nodes.append(node)
        scene = self.gltf.get("scenes", [{}])[self.gltf.get("scene", 0)]
        scene.setdefault("nodes", []).append(len(nodes) - 1)

    def sun(self, direction):
        self.use("KHR_lights_punctual")
        lights = self.gltf.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {}).setdefault("lights", [])
        lights.append({"type": "directional", "intensity": 3})
        self.node(name="AddedSun", matrix=looking([0, 0, 0], direction), extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def quad(self, name, corners, material):
        """Corners counter-clockwise from the front."""
        data = struct.pack("<12f6H", *(x for corner in corners for x in corner), 0, 1, 2, 0, 2, 3)
        g = self.gltf
        buffers, views, accessors = (g.setdefault(key, []) for key in ("buffers", "bufferViews", "accessors"))
        buffers.append({"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()})
        views += [{"buffer": len(buffers) - 1, "byteOffset": start, "byteLength": size} for start, size in ((0, 48), (48, 12))]
        accessors += [{"bufferView": len(views) - 2, "componentType": 5126, "type": "VEC3", "count": 4,
                       "min": [min(c) for c in zip(*corners)], "max": [max(c) for c in zip(*corners)]},
                      {"bufferView": len(views) - 1, "componentType": 5123, "type": "SCALAR", "count": 6}]
        self.use("KHR_materials_specular")
        self.use("KHR_materials_emissive_strength")
        g.setdefault("materials", []).append(
            {"name": name, "doubleSided": False, **material, "extensions": {"KHR_materials_specular": {"specularFactor": 0},
                                                                            **material.get("extensions", {})}})
        g.setdefault("meshes", []).append({"primitives": [{"attributes": {"POSITION": len(accessors) - 2},
                                                           "indices": len(accessors) - 1, "material": len(g["materials"]) - 1}]})
        self.node(name=name, mesh=len(g["meshes"]) - 1)


def looking(eye, forward):
    """Matrix of a node at `eye` whose -z points `forward`, its y upwards."""
    def unit(v):
        length = math.sqrt(sum(x * x for x in v))
        return [x / length for x in v]

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    z = unit([-x for x in forward])
    x = unit(cross([0, 1, 0], z))
    return [*x, 0, *cross(z, x), 0, *z, 0, *eye, 1]


def bounds(gltf):
    """(lower, upper) corner of all meshes as the nodes place them, without skins, morphs and instances; +-1 without meshes."""
    lower, upper = [math.inf] * 3, [-math.inf] * 3

    def times(m, n):
        return [sum(m[4 * k + i] * n[4 * j + k] for k in range(4)) for j in range(4) for i in range(4)]

    def local(node):
        if "matrix" in node:
            return node["matrix"]
        x, y, z, w = node.get("rotation", [0, 0, 0, 1])
        turned = [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 2 * (x * y - z * w), 1 - 2 * (x * x + z * z),
                  2 * (y * z + x * w), 2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]
        return [v for j, s in enumerate(node.get("scale", [1, 1, 1])) for v in (*(s * turned[3 * j + i] for i in range(3)), 0)] + [
            *node.get("translation", [0, 0, 0]), 1]
    pending = [(i, [float(i % 5 == 0) for i in range(16)]) for i in gltf.get("scenes", [{}])[gltf.get("scene", 0)].get("nodes", [])]
    while pending:
        index, above = pending.pop()
        node = gltf["nodes"][index]
        place = times(above, local(node))
        pending += [(child, place) for child in node.get("children", [])]
        for primitive in gltf["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            corners = gltf["accessors"][primitive["attributes"]["POSITION"]]
            for corner in range(8):
                p = [corners["max" if corner >> c & 1 else "min"][c] for c in range(3)]
                for i in range(3):
                    v = sum(place[4 * k + i] * p[k] for k in range(3)) + place[12 + i]
                    lower[i], upper[i] = min(lower[i], v), max(upper[i], v)
    return (lower, upper) if lower[0] <= upper[0] else ([-1] * 3, [1] * 3)

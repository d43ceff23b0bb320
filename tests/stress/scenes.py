"""Small glTF scenes: matte or metal triangles, emitters, lights, cameras, keys. Metres, +Y up.

    scene = Scene()
    wall = scene.material(0.5)
    scene.room((-1, -1, -1), (1, 1, 1), wall)
    scene.point_light((0, 0, 0), 10)
    scene.camera((0, 0, 0.9), (0, 0, -1))
    scene.save("room.gltf")            # or .glb, for many triangles
"""
import array
import base64
import json
import math
import struct


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def add(a, b, t=1.0):
    return [x + t * y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def normalize(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a]


def irradiance_of_polygon(point, normal, corners, radiance):
    """Lambert's formula for a polygon wholly above the surface at `point`: E = L/2 |sum of angle_i (n . Gamma_i)|.
    Small angles by atan2, so that emitters of 1e-6 m keep their digits."""
    directions = [subtract(c, point) for c in corners]
    total = 0.0
    for a, b in zip(directions, directions[1:] + directions[:1]):
        gamma = cross(a, b)
        size = math.sqrt(dot(gamma, gamma))
        if size > 0:
            total += math.atan2(size, dot(a, b)) * dot(gamma, normal) / size
    return abs(total) / 2 * radiance


def area_of(positions, triangles):
    total = []
    for i in range(0, len(triangles), 3):
        a, b, c = (positions[3 * t:3 * t + 3] for t in triangles[i:i + 3])
        n = cross(subtract(b, a), subtract(c, a))
        total.append(math.sqrt(dot(n, n)) / 2)
    return math.fsum(total)


def room_mesh(lower, upper, cuts=1):
    """The six faces of a box, fronts inwards, each of cuts x cuts cells; the faces share no vertices. `cuts` may also
    be a list of places from 0 to 1."""
    places = cuts if isinstance(cuts, list) else [i / cuts for i in range(cuts + 1)]
    size = subtract(upper, lower)
    positions, triangles = array.array("f"), array.array("I")
    for axis in range(3):
        for side in (0, 1):
            u, v = ((axis + 1) % 3, (axis + 2) % 3) if side == 0 else ((axis + 2) % 3, (axis + 1) % 3)
            first = len(positions) // 3
            corner = list(lower)
            corner[axis] = upper[axis] if side else lower[axis]
            for s in places:
                corner[u] = upper[u] if s == 1 else lower[u] + s * size[u]
                for t in places:
                    corner[v] = upper[v] if t == 1 else lower[v] + t * size[v]
                    positions.extend(corner)
            add_cells(triangles, first, len(places) - 1, len(places) - 1)
    return positions, triangles


def box_mesh(lower, upper):
    """The same box, fronts outwards."""
    positions, triangles = room_mesh(lower, upper)
    for i in range(0, len(triangles), 3):
        triangles[i + 1], triangles[i + 2] = triangles[i + 2], triangles[i + 1]
    return positions, triangles


def add_cells(triangles, first, rows, columns):
    for i in range(rows):
        for j in range(columns):
            a = first + i * (columns + 1) + j
            b = a + columns + 1
            triangles.extend((a, b, b + 1, a, b + 1, a + 1))


def grid_mesh(corner, u, v, rows, columns):
    """A parallelogram; the front is on the side of u x v."""
    positions, triangles = array.array("f"), array.array("I")
    for i in range(rows + 1):
        for j in range(columns + 1):
            positions.extend(add(add(corner, u, i / rows), v, j / columns))
    add_cells(triangles, 0, rows, columns)
    return positions, triangles


def sphere_mesh(centre, radii, n, inwards=True):
    """Subdivided octahedron, stretched to `radii`: 8 n^2 triangles without shared vertices between its faces, and the
    normals of the ellipsoid."""
    positions, normals, triangles = array.array("f"), array.array("f"), array.array("I")
    for face in range(8):
        signs = [-1 if face >> axis & 1 else 1 for axis in range(3)]
        mirrored = (signs[0] * signs[1] * signs[2] < 0) != inwards
        index = {}
        for i in range(n + 1):
            for j in range(n + 1 - i):
                index[i, j] = len(positions) // 3
                unit = normalize([signs[0] * (n - i - j), signs[1] * i, signs[2] * j])
                positions.extend(c + r * x for c, r, x in zip(centre, radii, unit))
                normal = normalize([x / r for r, x in zip(radii, unit)])
                normals.extend(-x if inwards else x for x in normal)
        for i in range(n):
            for j in range(n - i):
                cell = [(i, j), (i + 1, j), (i, j + 1)]
                cells = [cell] + ([[(i + 1, j), (i + 1, j + 1), (i, j + 1)]] if j < n - i - 1 else [])
                for a, b, c in cells:
                    order = (a, c, b) if mirrored else (a, b, c)
                    triangles.extend(index[k] for k in order)
    return positions, triangles, normals


def leaves_mesh(rng, count, bushes, radius, half_length, half_width):
    """Diamonds turned at random, spread over balls of `radius` about the bushes' middles in turn."""
    positions, triangles = array.array("f"), array.array("I")
    for i in range(count):
        while True:
            offset = [rng.uniform(-1, 1) for _ in range(3)]
            if sum(x * x for x in offset) < 1:
                break
        n = normalize([rng.gauss(0, 1) for _ in range(3)])
        u = normalize(cross(n, [rng.gauss(0, 1) for _ in range(3)]))
        v, first = cross(n, u), len(positions) // 3
        centre = add(bushes[i % len(bushes)], offset, radius)
        for s, t in ((-half_length, 0), (0, -half_width), (half_length, 0), (0, half_width)):
            positions.extend(add(add(centre, u, s), v, t))
        triangles.extend(first + k for k in (0, 1, 2, 0, 2, 3))
    return positions, triangles


class Scene:
    def __init__(self):
        self.data = bytearray()
        self.document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}
        self.extensions = set()

    def _list(self, name):
        return self.document.setdefault(name, [])

    def _append(self, name, value):
        values = self._list(name)
        values.append(value)
        return len(values) - 1

    def _accessor(self, values, kind, component):
        while len(self.data) % 4:
            self.data.append(0)
        view = self._append("bufferViews", {"buffer": 0, "byteOffset": len(self.data), "byteLength": 4 * len(values)})
        self.data += values.tobytes()
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[kind]
        entry = {"bufferView": view, "componentType": component, "count": len(values) // width, "type": kind}
        if kind == "VEC3" and component == 5126:
            entry["min"], entry["max"] = ([f(values[c::3]) for c in range(3)] for f in (min, max))
        return self._append("accessors", entry)

    def node(self, **fields):
        index = self._append("nodes", fields)
        self.document["scenes"][0]["nodes"].append(index)
        return index

    def material(self, reflectance, emission=0.0, *, one_sided=False, metallic=0.0, roughness=1.0, specular=0.0):
        colour = list(reflectance) if isinstance(reflectance, (list, tuple)) else [reflectance] * 3
        radiance = list(emission) if isinstance(emission, (list, tuple)) else [emission] * 3
        strength = max(radiance)
        entry = {"doubleSided": not one_sided,
                 "pbrMetallicRoughness": {"baseColorFactor": colour + [1], "metallicFactor": metallic,
                                          "roughnessFactor": roughness},
                 "extensions": {"KHR_materials_specular": {"specularFactor": specular}}}
        self.extensions.add("KHR_materials_specular")
        if strength > 0:
            entry["emissiveFactor"] = [c / strength for c in radiance]
            entry["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
            self.extensions.add("KHR_materials_emissive_strength")
        return self._append("materials", entry)

    def glass(self, roughness=0.0, ior=1.5, attenuation=None):
        """A clear solid; attenuation: (colour, distance at which white light has that colour)."""
        index = self.material(1.0, roughness=roughness, specular=1.0, one_sided=True)
        volume = {"thicknessFactor": 1.0}
        if attenuation:
            volume |= {"attenuationColor": [attenuation[0]] * 3, "attenuationDistance": attenuation[1]}
        added = {"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_volume": volume,
                 "KHR_materials_ior": {"ior": ior}}
        self.document["materials"][index]["extensions"] |= added
        self.extensions |= set(added)
        return index

    def mesh(self, positions, triangles, material, normals=None, uvs=None, **node):
        """One object; `node`: translation, rotation, scale, name."""
        attributes = {"POSITION": self._accessor(array.array("f", positions), "VEC3", 5126)}
        if normals is not None:
            attributes["NORMAL"] = self._accessor(array.array("f", normals), "VEC3", 5126)
        if uvs is not None:
            attributes["TEXCOORD_0"] = self._accessor(array.array("f", uvs), "VEC2", 5126)
        indices = self._accessor(array.array("I", triangles), "SCALAR", 5125)
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        return self.node(mesh=self._append("meshes", {"primitives": [primitive]}), **node)

    def quad(self, a, b, c, d, material, **node):
        """Counter-clockwise seen from its front."""
        return self.mesh([*a, *b, *c, *d], [0, 1, 2, 0, 2, 3], material, **node)

    def room(self, lower, upper, material, cuts=1, **node):
        return self.mesh(*room_mesh(lower, upper, cuts), material, **node)

    def _light(self, entry, position, rotation=None):
        lights = self.document.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        self.extensions.add("KHR_lights_punctual")
        if isinstance(entry.get("intensity"), (list, tuple)):
            colour = entry["intensity"]
            entry["intensity"] = max(colour)
            entry["color"] = [c / max(colour) for c in colour]
        lights.append(entry)
        fields = {"extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}, "translation": list(position)}
        if rotation:
            fields["rotation"] = rotation
        return self.node(**fields)

    def point_light(self, position, intensity):
        return self._light({"type": "point", "intensity": intensity}, position)

    def spot_light(self, position, target, intensity, inner, outer):
        entry = {"type": "spot", "intensity": intensity, "spot": {"innerConeAngle": inner, "outerConeAngle": outer}}
        return self._light(entry, position, rotation_towards(position, target))

    def sun(self, direction, irradiance):
        return self._light({"type": "directional", "intensity": irradiance}, (0, 0, 0),
                           rotation_towards((0, 0, 0), direction))

    def camera(self, eye, target, *, fov=1.0, half_height=None, name="Camera"):
        """Perspective with `fov` radians of height, or orthographic with `half_height` metres."""
        if half_height is None:
            entry = {"type": "perspective", "perspective": {"yfov": fov, "znear": 1e-6}}
        else:
            entry = {"type": "orthographic",
                     "orthographic": {"xmag": half_height, "ymag": half_height, "znear": 0, "zfar": 1e9}}
        return self.node(name=name, camera=self._append("cameras", entry), translation=list(eye),
                         rotation=rotation_towards(eye, target))

    def animate(self, node, path, times, values, interpolation="LINEAR"):
        animations = self.document.setdefault("animations", [{"samplers": [], "channels": []}])
        flat = array.array("f", [x for value in values for x in value])
        keys = self._accessor(array.array("f", times), "SCALAR", 5126)
        self.document["accessors"][keys].update({"min": [min(times)], "max": [max(times)]})
        out = self._accessor(flat, "VEC4" if path == "rotation" else "VEC3", 5126)
        animations[0]["samplers"].append({"input": keys, "output": out, "interpolation": interpolation})
        animations[0]["channels"].append({"sampler": len(animations[0]["samplers"]) - 1,
                                          "target": {"node": node, "path": path}})

    def move_all(self, **transform):
        """Puts all nodes so far below one that has this translation, rotation or scale."""
        children = self.document["scenes"][0]["nodes"]
        self.document["scenes"][0]["nodes"] = []
        self.node(children=children, **transform)

    def save(self, path):
        path = str(path)
        while len(self.data) % 4:
            self.data.append(0)
        self.document["extensionsUsed"] = sorted(self.extensions)
        self.document["buffers"] = [{"byteLength": len(self.data)}]
        if path.endswith(".glb"):
            text = json.dumps(self.document).encode()
            text += b" " * (-len(text) % 4)
            with open(path, "wb") as file:
                file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.data)))
                file.write(struct.pack("<I4s", len(text), b"JSON") + text)
                file.write(struct.pack("<I4s", len(self.data), b"BIN\0") + self.data)
        else:
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
            self.document["buffers"][0]["uri"] = uri
            with open(path, "w", encoding="utf-8") as file:
                json.dump(self.document, file)
        return path


def rotation_towards(eye, target):
    """Quaternion that turns -Z towards the target; +Y stays as far up as it can."""
    z = normalize(subtract(eye, target))
    up = [0, 0, -1] if abs(z[1]) > 0.999999 else [0, 1, 0]
    x = normalize(cross(up, z))
    y = cross(z, x)
    m = [[x[i], y[i], z[i]] for i in range(3)]
    squares = [1 + m[0][0] + m[1][1] + m[2][2], 1 + m[0][0] - m[1][1] - m[2][2],
               1 - m[0][0] + m[1][1] - m[2][2], 1 - m[0][0] - m[1][1] + m[2][2]]
    largest = max(range(4), key=squares.__getitem__)
    s = 2 * math.sqrt(squares[largest])
    w, q = (m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]), [0.0] * 4
    if largest == 0:
        return [w[0] / s, w[1] / s, w[2] / s, s / 4]
    i = largest - 1
    j, k = (i + 1) % 3, (i + 2) % 3
    q[i], q[j], q[k], q[3] = s / 4, (m[i][j] + m[j][i]) / s, (m[i][k] + m[k][i]) / s, w[i] / s
    return q

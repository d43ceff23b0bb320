"""Writes .glb: accessors, images, nodes, channels of animations."""
import hashlib
import json
import math
import struct

import numpy

KINDS = {"f4": 5126, "u2": 5123, "u4": 5125}
WIDTHS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
TO_GLTF = numpy.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], "f8")   # Blender's +z is up, glTF's +y


def axes(points):
    """Points or directions (..., 3) of Blender in glTF's axes."""
    return numpy.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)


class Document:
    def __init__(self, generator):
        self.json = {
            "asset": {"version": "2.0", "generator": generator},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
        }
        self.binary, self.kept, self.channels, self.inputs = bytearray(), {}, [], {}

    # ---- arrays and images ----

    def view(self, data, target=None):
        while len(self.binary) % 4:
            self.binary.append(0)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.binary += data
        return self.append("bufferViews", view)

    def append(self, kind, value):
        self.json.setdefault(kind, []).append(value)
        return len(self.json[kind]) - 1

    def accessor(self, values, bounds=False, target=None):
        """Index of an accessor of (n) or (n, width) numbers; equal ones are stored once."""
        values = numpy.ascontiguousarray(values)
        flat = values.reshape(len(values), -1)
        mark = hashlib.blake2b(
            values.tobytes(), digest_size=16, key=f"{values.dtype}{flat.shape}{bounds}".encode()[:64]
        ).digest()
        if mark not in self.kept:
            kind = values.dtype.str[1:]
            accessor = {
                "bufferView": self.view(values.tobytes(), target),
                "componentType": KINDS[kind],
                "count": len(values),
                "type": WIDTHS[flat.shape[1]],
            }
            if bounds:
                accessor["min"], accessor["max"] = flat.min(axis=0).tolist(), flat.max(axis=0).tolist()
            self.kept[mark] = self.append("accessors", accessor)
        return self.kept[mark]

    def texture(self, data, wrap=10497, closest=False, name=""):
        mark = hashlib.blake2b(data, digest_size=16).digest()
        if mark not in self.kept:
            kind = "image/png" if data[:4] == b"\x89PNG" else "image/jpeg"
            self.kept[mark] = self.append("images", {"name": name, "bufferView": self.view(data), "mimeType": kind})
        sampler = {
            "magFilter": 9728 if closest else 9729,
            "minFilter": 9728 if closest else 9987,
            "wrapS": wrap,
            "wrapT": wrap,
        }
        return self.once("textures", {"sampler": self.once("samplers", sampler), "source": self.kept[mark]})

    def once(self, kind, value):
        """Index of an equal element, which is added if there is none."""
        mark = kind, json.dumps(value, sort_keys=True)
        if mark not in self.kept:
            self.kept[mark] = self.append(kind, value)
        return self.kept[mark]

    def use(self, extension):
        used = self.json.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    # ---- animation ----

    def channel(self, times, values, interpolation="LINEAR", node=None, path=None, pointer=None):
        """Keys of a property; values (n, width). Keys between equal ones are left out."""
        values = numpy.asarray(values, "f4").reshape(len(times), -1)
        keep = thinned(values)
        times = numpy.asarray(times, "f4")[keep]
        sampler = {"input": self.accessor(times, bounds=True), "output": None, "interpolation": interpolation}
        output = values[keep]
        if path == "weights" or output.shape[1] not in WIDTHS:
            output = output.reshape(-1)
        sampler["output"] = self.accessor(output)
        target = {"node": node, "path": path}
        if pointer:
            self.use("KHR_animation_pointer")
            target = {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}
        self.channels.append((sampler, target))

    def write(self, path):
        if self.channels:
            self.json["animations"] = [
                {
                    "name": "shot",
                    "samplers": [s for s, _ in self.channels],
                    "channels": [{"sampler": i, "target": t} for i, (_, t) in enumerate(self.channels)],
                }
            ]
        while len(self.binary) % 4:
            self.binary.append(0)
        if self.binary:
            self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(scrubbed(self.json), separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        size = 28 + len(text) + len(self.binary) if self.binary else 20 + len(text)
        with open(path, "wb") as out:
            out.write(struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON") + text)
            if self.binary:
                out.write(struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary)


def scrubbed(value):
    """The same without infinities and NaN, which JSON has not: a broken value of one material must not cost the file."""
    if isinstance(value, dict):
        return {key: scrubbed(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [scrubbed(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return 0.0
    return value


def thinned(values):
    """Indices of the keys that differ from the one before or after; the first and the last always."""
    same = (values[1:] == values[:-1]).all(axis=1)
    keep = numpy.ones(len(values), bool)
    keep[1:-1] = ~(same[:-1] & same[1:])
    return numpy.nonzero(keep)[0]


# ---- placement ----------------------------------------------------------------------------------------------

def decomposed(matrix):
    """(translation, quaternion x y z w, scale, exact): exact is False where the matrix shears."""
    part = matrix[:3, :3]
    scale = numpy.linalg.norm(part, axis=0)
    if numpy.linalg.det(part) < 0:
        scale = -scale
    safe = numpy.where(scale == 0, 1, scale)
    turn = part / safe
    if (scale == 0).any():
        turn = completed(turn, scale)
    size = max(abs(scale).max(), 1e-30)
    exact = abs(turn @ turn.T - numpy.eye(3)).max() < 1e-4
    if not exact:
        u, _, v = numpy.linalg.svd(turn)
        turn = u @ v
    return matrix[:3, 3], quaternion(turn), scale, exact or size < 1e-12


def completed(turn, scale):
    """A rotation for a matrix some of whose axes are zero."""
    q, _ = numpy.linalg.qr(numpy.where(scale == 0, 0, turn) + 1e-9 * numpy.eye(3))
    signs = numpy.sign(numpy.einsum("ij,ij->j", q, turn))
    q = q * numpy.where(signs == 0, 1, signs)
    if numpy.linalg.det(q) < 0:
        q[:, int(numpy.argmin(abs(scale)))] *= -1
    return q


def quaternion(m):
    """x y z w of a rotation; the largest part is found first."""
    squares = [
        1 + m[0, 0] - m[1, 1] - m[2, 2],
        1 - m[0, 0] + m[1, 1] - m[2, 2],
        1 - m[0, 0] - m[1, 1] + m[2, 2],
        1 + m.trace(),
    ]
    k = int(numpy.argmax(squares))
    q = numpy.empty(4)
    if k == 3:
        q[:] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        q[k], q[i], q[j], q[3] = squares[k], m[i, k] + m[k, i], m[j, k] + m[k, j], m[j, i] - m[i, j]
    return q / numpy.linalg.norm(q)


def steady(quaternions):
    """Signs such that neighbours are near each other."""
    for before, q in zip(quaternions, quaternions[1:]):
        if before @ q < 0:
            q *= -1
    return quaternions

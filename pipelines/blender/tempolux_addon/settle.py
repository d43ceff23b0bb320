"""Keeps the numbers of an earlier export that have not moved.

Blender's last bits and the order of its triangles differ from export to export, and each would be another scene, whose light is computed
anew.
"""

import json
import struct

STILL = 1e-6             # what differs by less from the export before, as a share of its size, has not moved


def read_glb(path):
    data = open(path, "rb").read()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), bytearray(data[28 + size:])


def column(document, binary, number):
    """An accessor as an array (elements, components) that lies in `binary`; None where it is sparse or interleaved."""
    import numpy
    accessor = document["accessors"][number]
    kinds = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
    parts = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
    if "bufferView" not in accessor or "sparse" in accessor or accessor["type"] not in parts:
        return None
    view = document["bufferViews"][accessor["bufferView"]]
    if "byteStride" in view:
        return None
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    shape = accessor["count"], parts[accessor["type"]]
    return numpy.frombuffer(binary, kinds[accessor["componentType"]], shape[0] * shape[1], start).reshape(shape)


def near(a, b):
    import numpy
    if a is None or b is None or a.shape != b.shape or a.dtype != b.dtype:
        return False
    if a.dtype.kind != "f":
        return bool((a == b).all())
    extent = float(max(numpy.ptp(a, axis=0).max(), abs(a).max())) if a.size else 0
    return bool((abs(a - b) <= STILL * extent).all())


def corners(document, binary, primitive):
    """All attributes at each corner of each triangle: (triangles, 3, numbers). None where a column cannot be read."""
    import numpy
    columns = [
        column(document, binary, i)
        for _, i in sorted(primitive["attributes"].items(), key=lambda item: (item[0] != "POSITION", item[0]))
    ]
    order = column(document, binary, primitive["indices"]) if "indices" in primitive else None
    if order is None or any(c is None or c.dtype.kind != "f" for c in columns) or len(order) % 3:
        return None
    rows = numpy.concatenate(columns, axis=1)
    return rows[order[:, 0].astype(int)].reshape(-1, 3, rows.shape[1])


def in_one_order(a, b):
    """Two lists of triangles, both in an order that neither the file's order nor the last bits change: by ranks of the numbers of both, where numbers that
    follow each other by less than what counts as still have one rank."""
    import numpy
    both = numpy.concatenate([a.reshape(-1, a.shape[2]), b.reshape(-1, b.shape[2])])
    ranks = numpy.empty(both.shape, int)
    for k in range(both.shape[1]):
        size = abs(both[:, :3] if k < 3 else both[:, 3:]).max()   # of positions; of all else
        order = numpy.argsort(both[:, k], kind="stable")
        steps = numpy.diff(both[order, k]) > STILL * float(size)
        ranks[order, k] = numpy.concatenate([[0], numpy.cumsum(steps)])
    def ordered(rows, ranks):
        ranks = ranks.reshape(rows.shape)
        first = numpy.lexsort(numpy.moveaxis(ranks, 2, 0)[::-1], axis=-1)[
            :, :1
        ]  # each triangle from its least corner on
        index = numpy.arange(len(rows))[:, None], (numpy.arange(3) + first) % 3
        return rows[index][numpy.lexsort(ranks[index].reshape(len(rows), -1).T[::-1])]
    return ordered(a, ranks[:a.shape[0] * 3]), ordered(b, ranks[a.shape[0] * 3:])


def same_triangles(new, old, a, b):
    before, after = corners(*old, b), corners(*new, a)
    if before is None or after is None or before.shape != after.shape:
        return False
    before, after = in_one_order(before, after)
    return near(after[..., :3].reshape(-1, 3), before[..., :3].reshape(-1, 3)) and near(
        after[..., 3:].reshape(len(after), -1), before[..., 3:].reshape(len(before), -1)
    )


def settle_primitive(new, old, a, b):
    """Puts the old numbers of a primitive in place of the new ones if they are the same triangles."""
    uses = [(a["attributes"][k], b["attributes"].get(k)) for k in a["attributes"]] + [
        (a.get("indices"), b.get("indices"))
    ]
    pairs = [(column(*new, i), column(*old, j)) for i, j in uses if i is not None and j is not None]
    if len(pairs) != len(uses) or any(
        x is None or y is None or x.shape != y.shape or x.dtype != y.dtype for x, y in pairs
    ):
        return
    if not all(near(x, y) for x, y in pairs) and not same_triangles(new, old, a, b):
        return
    for (i, j), (x, y) in zip(uses, pairs):
        x[:] = y
        for bound in ("min", "max"):
            if bound in old[0]["accessors"][j]:
                new[0]["accessors"][i][bound] = old[0]["accessors"][j][bound]


def settled(new, old):
    """JSON with the old numbers where they have not moved."""
    if isinstance(new, dict) and isinstance(old, dict):
        return {key: settled(value, old.get(key)) for key, value in new.items()}
    if isinstance(new, list) and isinstance(old, list) and len(new) == len(old):
        numbers = [abs(v) for v in new if isinstance(v, float)]
        if numbers and len(numbers) == len(new) and all(isinstance(v, (int, float)) for v in old):
            return old if all(abs(a - b) <= STILL * max(numbers) for a, b in zip(new, old)) else new
        return [settled(a, b) for a, b in zip(new, old)]
    if isinstance(new, float) and isinstance(old, (int, float)):
        return old if abs(new - old) <= STILL * abs(new) else new
    return new


def settle(path, before):
    """Rewrites the file with the numbers of the export before, (document, binary), where nothing has moved."""
    new, old = read_glb(path), before
    by_name = {mesh.get("name"): mesh for mesh in old[0].get("meshes", [])}
    for mesh in new[0].get("meshes", []):
        same = by_name.get(mesh.get("name"), {"primitives": []})
        for a, b in zip(mesh["primitives"], same["primitives"]):
            settle_primitive(new, old, a, b)
    curves = {animation.get("name"): animation for animation in old[0].get("animations", [])}
    for animation in new[0].get("animations", []):
        for a, b in zip(animation["samplers"], curves.get(animation.get("name"), {"samplers": []})["samplers"]):
            for end in ("input", "output"):
                x, y = column(*new, a[end]), column(*old, b[end])
                if near(x, y):
                    x[:] = y
    document, binary = settled(new[0], old[0]), new[1]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as out:
        out.write(
            struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary))
            + struct.pack("<I4s", len(text), b"JSON")
            + text
        )
        out.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)

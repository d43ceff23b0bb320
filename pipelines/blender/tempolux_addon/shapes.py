"""Evaluated meshes as arrays, and a deforming mesh as few morph targets."""
import copy
import hashlib

import numpy

EXACT = 1e-4             # a reduced deformation departs by less than this share of the object's size from the true one


class Shape:
    """Triangles of an evaluated mesh, in Blender's axes. corners: loops of each triangle; vertex: vertex of each loop."""

    def __init__(self):
        self.points = self.vertex = self.corners = self.slots = self.normals = self.same = None
        self.uvs, self.colours, self.materials, self.name, self.render_uv = {}, {}, [], "", ""

    def faces(self):
        """Equal for two shapes whose corners correspond."""
        digest = hashlib.blake2b(digest_size=16)
        for values in (self.vertex[self.corners], self.slots):
            digest.update(numpy.ascontiguousarray(values))
        digest.update(str((len(self.points), self.normals is None, [m.name_full if m else "" for m in self.materials], self.name)).encode())
        return digest.digest()

    def topology(self):
        """Equal for two shapes that differ in positions alone."""
        if self.same is None:
            digest = hashlib.blake2b(self.faces(), digest_size=16)
            for values in self.uvs.values():
                digest.update(values)
            self.same = digest.digest()
        return self.same

    def key(self):
        digest = hashlib.blake2b(self.topology(), digest_size=16)
        digest.update(self.points)
        if self.normals is not None:
            digest.update(self.normals)
        for values in self.colours.values():
            digest.update(values)
        return digest.digest()

    def volume_and_area(self):
        """(volume, area); volume None where the mesh is not closed: an edge without two triangles."""
        triangles = self.vertex[self.corners]
        edges = numpy.sort(numpy.concatenate([triangles[:, (0, 1)], triangles[:, (1, 2)], triangles[:, (2, 0)]]), axis=1)
        _, uses = numpy.unique(edges, axis=0, return_counts=True)
        a, b, c = (self.points[triangles[:, k]].astype("f8") for k in range(3))
        cross = numpy.cross(b - a, c - a)
        area = float(numpy.linalg.norm(cross, axis=1).sum() / 2)
        if not len(uses) or (uses != 2).any():
            return None, area
        return abs(float(numpy.einsum("ij,ij->", a, numpy.cross(b, c)))) / 6, area


def read(values, name, width, kind="f4"):
    array = numpy.empty(len(values) * width, kind)
    values.foreach_get(name, array)
    return array.reshape(-1, width) if width > 1 else array


def loop_normals(mesh):
    """Normal of each loop; None if all are those of their faces."""
    if hasattr(mesh, "corner_normals"):
        normals = read(mesh.corner_normals, "vector", 3)
    else:
        mesh.calc_normals_split()
        normals = read(mesh.loops, "normal", 3)
    faces = read(mesh.polygons, "normal", 3)
    starts, counts = read(mesh.polygons, "loop_start", 1, "i4"), read(mesh.polygons, "loop_total", 1, "i4")
    owner = numpy.empty(len(mesh.loops), "i4")
    owner[numpy.repeat(starts - numpy.concatenate([[0], numpy.cumsum(counts)[:-1]]), counts) + numpy.arange(counts.sum())] = \
        numpy.repeat(numpy.arange(len(counts)), counts)
    return normals if (numpy.abs(normals - faces[owner]) > 1e-3).any() else None


CREASE = .866            # cosine of 30 degrees


def split_creases(shape):
    """The shape, with other normals where they lean away from their triangle by more than 30 degrees: the mean of the triangles at the vertex
    that lean away by less. Light that is bent by normals far from the surface leaves a solid of glass at its wrong side, and is lost."""
    if shape.normals is None:
        return shape
    triangles = shape.vertex[shape.corners]
    a, b, c = (shape.points[triangles[:, k]].astype("f8") for k in range(3))
    areas = numpy.cross(b - a, c - a)
    flat = areas / numpy.maximum(numpy.linalg.norm(areas, axis=1, keepdims=True), 1e-30)
    loops, owner = shape.corners.reshape(-1), numpy.repeat(numpy.arange(len(triangles)), 3)
    leaning = numpy.flatnonzero(numpy.einsum("ij,ij->i", shape.normals[loops].astype("f8"), flat[owner]) < CREASE)
    if not len(leaning):
        return shape
    order = numpy.argsort(shape.vertex[loops], kind="stable")
    starts = numpy.searchsorted(shape.vertex[loops][order], numpy.arange(len(shape.points) + 1))
    result = copy.copy(shape)
    result.normals = shape.normals.copy()
    for k in leaning:
        vertex = shape.vertex[loops[k]]
        around = owner[order[starts[vertex]:starts[vertex + 1]]]
        near = areas[around][flat[around] @ flat[owner[k]] > CREASE].sum(axis=0)
        length = numpy.linalg.norm(near)
        if length > 0:
            result.normals[loops[k]] = near / length
    return result


def read_colours(mesh):
    found = {}
    for layer in getattr(mesh, "color_attributes", ()):
        values = read(layer.data, "color", 4)
        found[layer.name] = values if layer.domain == "CORNER" else values[read(mesh.loops, "vertex_index", 1, "i4")]
    return found


def read_shape(mesh, thing):
    shape = Shape()
    shape.name = mesh.name if thing.type == "MESH" else thing.name
    mesh.calc_loop_triangles()
    shape.points = read(mesh.vertices, "co", 3)
    shape.vertex = read(mesh.loops, "vertex_index", 1, "i4")
    shape.corners = read(mesh.loop_triangles, "loops", 3, "i4")
    polygon = read(mesh.loop_triangles, "polygon_index", 1, "i4")
    slots = read(mesh.polygons, "material_index", 1, "i4")
    shape.normals = loop_normals(mesh)
    for layer in mesh.uv_layers:
        shape.uvs[layer.name] = read(layer.data, "uv", 2)
        if layer.active_render:
            shape.render_uv = layer.name
    shape.colours = read_colours(mesh)
    shape.materials = [m.original if m else None for m in mesh.materials]
    for index, slot in enumerate(thing.material_slots):
        if slot.link == "OBJECT" or index >= len(shape.materials):
            shape.materials += [None] * (index + 1 - len(shape.materials))
            shape.materials[index] = slot.material.original if slot.material else None
    shape.materials = shape.materials or [None]
    shape.slots = numpy.minimum(slots[polygon], len(shape.materials) - 1)
    if not numpy.isfinite(shape.points).all():
        raise ValueError("a vertex has no place: not a number")
    return shape


# ---- deformation --------------------------------------------------------------------------------------------

class Morph:
    """Few targets whose weighted sums are all shapes: positions[f] = rest + weights[f] . targets."""

    def __init__(self, weights, targets):
        self.weights, self.targets = weights, targets


def reduce(frames):
    """Morph of a list of arrays (n, 3), the first of which is the rest."""
    rest = frames[0].astype("f8")
    moved = numpy.stack([f.reshape(-1) for f in frames]).astype("f8") - rest.reshape(-1)
    size = max(float(numpy.ptp(rest, axis=0).max()), float(abs(moved).max()), 1e-30)
    values, vectors = numpy.linalg.eigh(moved @ moved.T)
    order = numpy.argsort(values)[::-1]
    vectors = vectors[:, order]
    low, high = 0, len(frames)
    while low < high:                      # the least number of targets that is exact enough
        middle = (low + high) // 2
        kept = vectors[:, :middle]
        if abs(kept @ (kept.T @ moved) - moved).max() <= EXACT * size:
            high = middle
        else:
            low = middle + 1
    kept = vectors[:, :low]
    targets, weights = kept.T @ moved, kept.copy()
    for k in range(low):
        peak = weights[numpy.argmax(abs(weights[:, k])), k]
        weights[:, k] /= peak
        targets[k] *= peak
    weights -= weights[0]                  # the rest is the first frame
    return Morph(weights.astype("f4"), targets.reshape(low, -1, 3).astype("f4"))


def follow(weights, frames):
    """Targets for other values of the same frames (normals): least squares."""
    rest = frames[0].astype("f8").reshape(-1)
    moved = numpy.stack([f.reshape(-1) for f in frames]).astype("f8") - rest
    return (numpy.linalg.pinv(weights.astype("f8")) @ moved).reshape(weights.shape[1], -1, 3).astype("f4")

"""Tangents of brushed surfaces: glTF's TANGENT says along which direction a surface with anisotropy is rougher."""
import numpy

AXES = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}


def around(points, normals, corners, axis):
    """Tangents (corners, 4) in Blender's axes: they go round an axis through the middle of the mesh's box, as Cycles has them
    without a UV map. It measures places by the box: in a flat mesh circles become ellipses. points: of all vertices;
    corners: vertex of each normal."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = numpy.where(high > low, high - low, 1)
    off = (points[corners] - (low + high) / 2) / size
    first, second = AXES[axis]
    turn = numpy.zeros_like(off)
    turn[:, first], turn[:, second] = -off[:, second], off[:, first]
    turn -= normals * (turn * normals).sum(axis=1, keepdims=True)
    length = numpy.linalg.norm(turn, axis=1, keepdims=True)
    other = numpy.cross(normals, numpy.roll(normals, 1, axis=1) + (0.1, 0.2, 0.3))   # on the axis: any direction
    turn = numpy.where(length > 1e-6, turn / numpy.maximum(length, 1e-6), other / numpy.linalg.norm(other, axis=1, keepdims=True))
    return turn

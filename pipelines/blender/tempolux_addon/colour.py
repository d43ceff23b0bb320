"""Colours of Blender's working space as Rec.709, which glTF has. Matrices: ITU-R BT.2087, ACES S-2014-004."""
import bpy

TO_REC709 = {
    "Linear Rec.2020": ((1.6605, -0.5876, -0.0728), (-0.1246, 1.1329, -0.0083), (-0.0182, -0.1006, 1.1187)),
    "ACEScg": ((1.7051, -0.6218, -0.0833), (-0.1303, 1.1408, -0.0105), (-0.0240, -0.1290, 1.1530)),
}


def working_space():
    space = getattr(bpy.data, "colorspace", None)
    return getattr(space, "working_space", "Linear Rec.709")


def rec709(colour):
    """Three numbers of the working space as Rec.709; what lies outside of its gamut is brought to its edge."""
    matrix = TO_REC709.get(working_space())
    if matrix is None:
        return tuple(float(c) for c in colour[:3])
    return tuple(max(0.0, sum(a * float(c) for a, c in zip(row, colour))) for row in matrix)


def rec709_array(pixels):
    """The same for an array (..., 3)."""
    import numpy
    matrix = TO_REC709.get(working_space())
    return pixels if matrix is None else numpy.maximum(pixels @ numpy.array(matrix, "f4").T, 0)


def is_known():
    return working_space() in ("Linear Rec.709", *TO_REC709)

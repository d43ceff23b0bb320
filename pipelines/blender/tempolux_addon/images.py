"""Image nodes that glTF can say, pixels of images, PNG files."""
import math
import os
import struct
import zlib

import bpy
import numpy

from .values import Source, follow, is_constant, pick, resolve

CLAMP = 33071
WRAPS = {"REPEAT": 10497, "EXTEND": CLAMP, "CLIP": CLAMP, "MIRROR": 33648}
LINEAR_SPACES = ("Non-Color", "Linear", "Linear Rec.709", "Raw", "Generic Data")


class Picture:
    """An image read by texture coordinates. channel: None for colour, or 0 to 3."""

    def __init__(self, node, channel, uv, transform):
        self.image, self.channel, self.uv, self.transform = node.image, channel, uv, transform
        self.wrap, self.closest = WRAPS[node.extension], node.interpolation == "Closest"

    def place(self):
        return self.uv, self.wrap, self.closest, tuple(map(str, sorted((self.transform or {}).items())))


def picture_of(value):
    """The Picture behind a value; None where glTF cannot say it."""
    if not isinstance(value, Source):
        return None
    node, output, channel = value.node, value.socket, None
    stack = value.stack
    if node.type in ("SEPRGB", "SEPARATE_COLOR") and getattr(node, "mode", "RGB") == "RGB":
        channel = list(node.outputs).index(output)
        _, node, output, stack = follow(node.inputs[0], stack)
    if node is None or node.type != "TEX_IMAGE" or node.image is None or node.projection != "FLAT":
        return None
    if output.name == "Alpha":
        channel = 3
    image = node.image
    if image.source not in ("FILE", "GENERATED") or not image.has_data and not image.size[0]:
        return None
    if not image.is_float and image.colorspace_settings.name not in ("sRGB", *LINEAR_SPACES):
        return None
    found = coordinates(pick(node.inputs, "Vector"), stack)
    return Picture(node, channel, *found) if found else None


def coordinates(socket, stack):
    """(name of the UV layer, transform of glTF or None) of a Vector input; None for other coordinates. "": the render's layer."""
    _, node, output, stack = follow(socket, stack)
    if node is None:
        return "", None
    if node.type == "UVMAP":
        return (None if getattr(node, "from_instancer", False) else (node.uv_map, None))
    if node.type == "TEX_COORD" and output.name == "UV":
        return "", None
    if node.type != "MAPPING" or node.vector_type != "POINT":
        return None
    inner = coordinates(pick(node.inputs, "Vector"), stack)
    values = [resolve(pick(node.inputs, name), stack) for name in ("Location", "Rotation", "Scale")]
    if inner is None or inner[1] is not None or not all(is_constant(v) for v in values):
        return None
    if not pick(node.inputs, "Vector").is_linked:
        return None                                        # without a link it has no coordinates at all
    where, turned, scale = values
    if abs(turned[0]) > 1e-6 or abs(turned[1]) > 1e-6:
        return None
    angle = turned[2]
    return inner[0], {
        "offset": [where[0] - scale[1] * math.sin(angle), 1 - where[1] - scale[1] * math.cos(angle)],
        "rotation": angle,
        "scale": [scale[0], scale[1]],
    }


def pixels_of(image):
    """(height, width, 4), first row on top, linear light."""
    width, height = image.size
    flat = numpy.empty(width * height * 4, "f4")
    image.pixels.foreach_get(flat)
    pixels = flat.reshape(height, width, 4)[::-1].copy()
    if not image.is_float and image.colorspace_settings.name == "sRGB":
        pixels[..., :3] = to_linear(pixels[..., :3])
    return pixels


def to_linear(v):
    return numpy.where(v <= .04045, v / 12.92, ((v + .055) / 1.055) ** 2.4).astype("f4")


def to_srgb(v):
    v = numpy.clip(v, 0, 1)
    return numpy.where(v <= .0031308, v * 12.92, 1.055 * v ** (1 / 2.4) - .055)


def file_bytes(image, srgb):
    """The image's own PNG or JPEG file, if it can be used as it is; None if not."""
    space = image.colorspace_settings.name
    if image.is_float or image.is_dirty or image.source != "FILE" or image.file_format not in ("PNG", "JPEG"):
        return None
    if space != "sRGB" if srgb else space not in LINEAR_SPACES:
        return None
    if image.packed_file:
        data = bytes(image.packed_file.data)
    else:
        path = bpy.path.abspath(image.filepath_from_user(), library=image.library)
        if not os.path.isfile(path):
            return None
        data = open(path, "rb").read()
    return data if data[:8] == b"\x89PNG\r\n\x1a\n" or data[:2] == b"\xff\xd8" else None


def png(pixels):
    """A PNG of numbers from 0 to 1, (height, width, 3 or 4), with 8 bits."""
    values = (numpy.clip(pixels, 0, 1) * 255 + .5).astype("u1")
    height, width, parts = values.shape
    rows = numpy.concatenate([numpy.zeros((height, 1), "u1"), values.reshape(height, width * parts)], axis=1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 6 if parts == 4 else 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6))
        + chunk(b"IEND", b"")
    )


def resized(pixels, height, width):
    """The nearest pixels, for two images in one texture."""
    if pixels.shape[:2] == (height, width):
        return pixels
    rows = (numpy.arange(height) + .5) * pixels.shape[0] / height
    columns = (numpy.arange(width) + .5) * pixels.shape[1] / width
    return pixels[rows.astype(int)][:, columns.astype(int)]

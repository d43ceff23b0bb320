"""Looks as materials of glTF: factors, textures, baked textures."""
import numpy

from .colour import rec709, rec709_array
from .factors import (
    ANIMATED,
    DEFAULTS,
    STRENGTH,
    as_number_or,
    leaves,
    plain_material,
    set_emission,
    set_extensions,
    unit,
)
from .images import CLAMP, file_bytes, picture_of, pixels_of, png, resized, to_srgb
from .looks import fog_of
from .notes import Damage
from .values import Source, as_number, as_tuple, is_constant, pick, resolve, times

SINGLE = (
    "ior",
    "level",
    "tint",
    "coat",
    "coat_roughness",
    "sheen",
    "sheen_roughness",
    "sheen_tint",
    "film",
    "film_ior",
    "passing",
    "anisotropic",
    "anisotropic_rotation",
)  # no texture of these: a mean
FLAT = 0.004  # scatter of a normal's two parts, as a map has them: a step of 8 bits, half a degree


def in_unit(uv):
    """Do these coordinates stay within the image, apart from rounding?"""
    return bool(len(uv)) and uv.min() >= -1e-5 and uv.max() <= 1 + 1e-5


def linked(look):
    """Names of the values that are not constants."""
    return [
        key
        for key, value in look.items()
        if value is not None and not isinstance(value, bool) and not is_constant(value)
    ]


def colour_layer(value):
    """Name of the colour attribute that a value reads; None for others."""
    if isinstance(value, Source) and value.node.type == "VERTEX_COLOR":
        return value.node.layer_name
    if isinstance(value, Source) and value.node.type == "ATTRIBUTE" and value.socket.name == "Color" \
            and getattr(value.node, "attribute_type", "GEOMETRY") == "GEOMETRY":
        return value.node.attribute_name
    return None


def needs_bake(look):
    """Is there a value that glTF cannot say? Colour attributes count as such, as a mesh may lack them."""
    if look is None:
        return False
    return any(
        picture_of(look[key]) is None and (key != "normal" or normal_map(look[key]) is None) for key in linked(look)
    ) or bool(look["displacement"])


def normal_map(value):
    """(picture, strength) of a normal map of tangent space; None for other normals."""
    if not isinstance(value, Source) or value.node.type != "NORMAL_MAP" or value.node.space != "TANGENT":
        return None
    strength = resolve(pick(value.node.inputs, "Strength"), value.stack)
    picture = picture_of(resolve(pick(value.node.inputs, "Color"), value.stack))
    if picture is None or picture.channel is not None or not is_constant(strength):
        return None
    if value.node.uv_map and picture.uv != value.node.uv_map:
        return None
    return picture, strength


class Materials:
    """Makes the materials of the file. A material is shared by all meshes that need no bake of their own."""

    def __init__(self, shot, document, baker):
        self.shot, self.document, self.baker, self.made = shot, document, baker, {}

    def material(self, material, shape, topology, slot, solid):
        """(index, UV layers, colour attribute): the file's material for one slot of a mesh. Layers: names, or None for the bake's."""
        look, volume = self.shot.surface(material)
        own = topology if material is not None and needs_bake(look) else None
        key = (
            material.name_full if material else "",
            solid > 0,
            own,
            slot if own else 0,
            tuple((name, in_unit(uv)) for name, uv in shape.uvs.items()) if linked(look) else (),
        )
        if key not in self.made:
            self.made[key] = self.make(material, look, volume, shape, topology, slot, solid)
        return self.made[key]

    def make(self, material, look, volume, shape, topology, slot, solid):
        name = f"material {material.name}" if material else "no material"
        for text in look.losses:
            self.shot.notes.lost(Damage.MATERIAL, name, text)
        maker = Maker(self, name, material, look, shape, topology, slot)
        result = {"name": material.name if material else "none", "doubleSided": True}
        maker.fill(result)
        index = len(self.document.json.get("materials", []))
        self.animate(material, index, result)
        extensions = result.get("extensions", {})
        if solid > 0 and "KHR_materials_transmission" in extensions:
            body = extensions["KHR_materials_volume"] = {"thicknessFactor": solid}
            fog = fog_of(volume)
            if fog:
                body["attenuationColor"], body["attenuationDistance"] = fog
            elif volume is not None:
                self.shot.notes.lost(Damage.DETAIL, name, "the volume inside of it is left out")
        for extension in extensions:
            self.document.use(extension)
        if as_number_or(look["subsurface"], 1) > 0:
            self.shot.notes.lost(Damage.MATERIAL, name, "subsurface scattering is left out: it is matte")
        self.document.append("materials", result)
        return index, maker.layers, maker.colours

    def animate(self, material, index, result):
        """Channels for the factors that change."""
        frames = self.shot.record.looks.get(material.name_full if material else "", {})
        if len(frames) < 2:
            return
        name = f"material {material.name}"
        looks = [dict(leaves(plain_material(look))) if look is not None else {} for _, look in sorted(frames.items())]
        light_emission(looks)
        moved = False
        for path in dict.fromkeys(path for look in looks for path in look):
            values = [look.get(path, DEFAULTS.get(path)) for look in looks]
            if all(v == values[0] for v in values):
                continue
            moved = True
            if path not in ANIMATED or None in values or not has_room(result, path, values[0]):
                self.shot.notes.lost(Damage.MOTION, name, f"the change of {path.rsplit('/', 1)[-1]} is left out")
                continue
            rows = numpy.array([numpy.atleast_1d(v) for v in values], "f4")
            self.document.channel(self.shot.times(sorted(frames)), rows, pointer=f"/materials/{index}{path}")
        if moved:
            self.shot.notes.keep("materials that change")
        else:
            self.shot.notes.lost(
                Damage.MOTION, name, "changes in its nodes are left out: it looks as in the frame that is open"
            )


def light_emission(looks):
    """Frames without emission keep the colour of their neighbours, with strength 0."""
    lit = next((look for look in looks if STRENGTH in look), None)
    colour = lit["/emissiveFactor"] if lit else None
    for look in looks if lit else ():
        if STRENGTH in look:
            colour = look["/emissiveFactor"]
        else:
            look["/emissiveFactor"], look[STRENGTH] = colour, 0.0


def has_room(result, path, value):
    """Puts the first frame's value where it is not in the material; False where a texture stands for it."""
    *parents, last = path.strip("/").split("/")
    if {
        "baseColorFactor": "baseColorTexture",
        "emissiveFactor": "emissiveTexture",
        "emissiveStrength": "emissiveTexture",
    }.get(last) in {**result, **result["pbrMetallicRoughness"]}:
        return False
    inner = result
    for parent in parents:
        inner = inner.setdefault(parent, {})
    inner[last] = value
    return True


class Maker:
    """One material: decides for each of its values between a factor, an image as it is, and a bake."""

    def __init__(self, materials, name, material, look, shape, topology, slot):
        self.owner, self.shot, self.document = materials, materials.shot, materials.document
        self.name, self.material, self.look, self.shape, self.topology, self.slot = (
            name,
            material,
            look,
            shape,
            topology,
            slot,
        )
        self.layers, self.colours, self.means, self.baked = [], None, {}, []

    def fill(self, result):
        look = self.look
        for key in SINGLE:
            if not is_constant(look[key]):
                self.means[key] = self.mean(key, look[key])
        plain = plain_material(look)
        set_extensions(plain, look, self.means)
        result.update(plain)
        for step in (self.base, self.rough, self.normal, self.emission, self.transmission, self.passing):
            with self.shot.notes.guard(Damage.MATERIAL, self.name, f"{step.__name__} by nodes is left out"):
                step(result)
        if self.baked:
            self.shot.notes.baked(self.name, f"{', '.join(self.baked)} by nodes: baked")

    # ---- where a texture is read ----

    def info(self, texture, picture=None):
        """A texture info; picture None: by the bake's coordinates."""
        name = (picture.uv or self.shape.render_uv) if picture else None
        if name not in self.layers:
            self.layers.append(name)
        info = {"index": texture}
        if self.layers.index(name):
            info["texCoord"] = self.layers.index(name)
        if picture and picture.transform:
            self.document.use("KHR_texture_transform")
            info["extensions"] = {"KHR_texture_transform": picture.transform}
        return info

    def fits(self, picture):
        """Has the mesh these coordinates, and is there room for them? One of two sets is kept for the bake."""
        if picture is None:
            return False
        name = picture.uv or self.shape.render_uv
        if name not in self.shape.uvs:
            return False
        return name in self.layers or len([n for n in self.layers if n]) < 1

    def image(self, data, picture):
        """An image that the mesh shows once ends at its borders: coarse levels of a repeated one would mix in the other
        side."""
        once = not picture.transform and in_unit(self.shape.uvs[picture.uv or self.shape.render_uv])
        return self.document.texture(data, CLAMP if once else picture.wrap, picture.closest, picture.image.name)

    def bake(self, what, value, kind="colour"):
        """Pixels of a bake, or of its mean, 1 x 1, where baking is off."""
        self.shot.need_bake(self.topology, self.material)
        size = self.shot.bake_size(self.topology)
        mean = size is None
        pixels = self.owner.baker.bake(self.topology, {self.slot: value}, 32 if mean else size, normal=kind == "normal")
        if mean:
            self.shot.notes.lost(Damage.MATERIAL, self.name, f"{what} by nodes: its mean is exported")
            return covered(pixels).mean(axis=0)[None, None]
        self.baked.append(what)
        return pixels

    def mean(self, key, value):
        """The mean of a value that no texture may give."""
        result = self.shot.plain_values.get(key, 0.0)
        with self.shot.notes.guard(Damage.DETAIL, self.name, f"{key} by nodes is left out"):
            self.shot.need_bake(self.topology, self.material)
            colour = covered(self.owner.baker.bake(self.topology, {self.slot: value}, 32)).mean(axis=0)
            result = tuple(float(c) for c in colour[:3])
            self.shot.notes.lost(Damage.DETAIL, self.name, f"{key.replace('_', ' ')} by nodes: its mean is exported")
        return result

    # ---- the values ----

    def base(self, result):
        colour, alpha = self.look["base"], self.look["alpha"]
        pbr = result["pbrMetallicRoughness"]
        if not is_constant(alpha) or as_number(alpha) < 1:
            result["alphaMode"] = "BLEND"
        if is_constant(colour) and is_constant(alpha):
            return
        pbr["baseColorFactor"] = [1.0, 1.0, 1.0, as_number_or(alpha, 1.0)]
        layer = colour_layer(colour)
        if layer is not None and is_constant(alpha) and (layer or self.shape.colours):
            layer = layer or next(iter(self.shape.colours))
            if layer in self.shape.colours:
                self.colours = layer
                return
        picture, mask = picture_of(colour), picture_of(alpha)
        direct = is_constant(colour) or self.fits(picture) and picture.channel is None
        if direct and not is_constant(alpha):
            direct = self.fits(mask) and (is_constant(colour) or mask.place() == picture.place())
        if direct:
            pbr["baseColorTexture"] = self.info(
                self.image(self.base_image(picture, mask), picture or mask), picture or mask
            )
            if is_constant(colour):
                pbr["baseColorFactor"][:3] = [unit(c) for c in rec709(as_tuple(colour))]
            return
        pixels = rec709_pixels(self.bake("colour", colour))
        if not is_constant(alpha):
            pixels[..., 3] = self.bake("alpha", alpha)[..., 0]
        else:
            pixels[..., 3] = 1
        if pixels.shape[0] == 1:
            pbr["baseColorFactor"] = [unit(c) for c in pixels[0, 0, :3]] + [
                unit(pixels[0, 0, 3] if not is_constant(alpha) else as_number(alpha))
            ]
            return
        pixels[..., :3] = to_srgb(pixels[..., :3])
        data = png(pixels if not is_constant(alpha) else pixels[..., :3])
        pbr["baseColorTexture"] = self.info(self.document.texture(data, CLAMP, name=f"{self.name} colour"))

    def base_image(self, picture, mask):
        one = picture or mask
        if picture and (mask is None or mask.image == picture.image and mask.channel == 3):
            data = file_bytes(picture.image, srgb=True)
            if data and (mask or data[:2] == b"\xff\xd8" or picture.image.channels < 4):
                return data
        pixels = pixels_of(one.image)
        if picture is None:
            pixels[..., :3] = 1
        if mask:
            other = resized(pixels_of(mask.image), *pixels.shape[:2])
            pixels[..., 3] = (
                other[..., mask.channel] if mask.channel is not None else other[..., :3] @ (0.2126, 0.7152, 0.0722)
            )
        pixels[..., :3] = to_srgb(pixels[..., :3])
        return png(pixels if mask else pixels[..., :3])

    def rough(self, result):
        rough, metal = self.look["roughness"], self.look["metallic"]
        if is_constant(rough) and is_constant(metal):
            return
        pbr = result["pbrMetallicRoughness"]
        pictures = [picture_of(v) for v in (rough, metal)]
        linked_ones = [p for p in pictures if p]
        direct = (
            all(is_constant(v) or self.fits(p) for v, p in zip((rough, metal), pictures))
            and len({p.place() for p in linked_ones}) == 1
        )
        if direct:
            size = linked_ones[0].image.size
            pixels = numpy.ones((size[1], size[0], 3), "f4")
            for channel, picture in zip((1, 2), pictures):
                if picture:
                    source = resized(pixels_of(picture.image), *pixels.shape[:2])
                    pixels[..., channel] = (
                        source[..., :3] @ numpy.array((0.2126, 0.7152, 0.0722), "f4")
                        if picture.channel is None
                        else source[..., picture.channel]
                    )
            info = self.info(self.image(png(pixels), linked_ones[0]), linked_ones[0])
        else:
            pixels = self.bake("roughness" if is_constant(metal) else "roughness and metallic", [0.0, rough, metal])[
                ..., :3
            ]
            if pixels.shape[0] == 1:
                pbr.update(roughnessFactor=unit(pixels[0, 0, 1]), metallicFactor=unit(pixels[0, 0, 2]))
                return
            info = self.info(self.document.texture(png(pixels), CLAMP, name=f"{self.name} roughness"))
            pbr.update(roughnessFactor=1.0, metallicFactor=1.0)
            pbr["metallicRoughnessTexture"] = info
            return
        pbr["roughnessFactor"] = as_number_or(rough, 1.0)
        pbr["metallicFactor"] = as_number_or(metal, 1.0)
        pbr["metallicRoughnessTexture"] = info

    def normal(self, result):
        value = self.look["normal"]
        if value is None and not self.look["displacement"]:
            return
        found = normal_map(value) if not self.look["displacement"] else None
        if found and self.fits(found[0]):
            picture, strength = found
            data = file_bytes(picture.image, srgb=False) or png(pixels_of(picture.image)[..., :3])
            result["normalTexture"] = {**self.info(self.image(data, picture), picture), "scale": strength}
            return
        if self.shot.bake_size(self.topology) is None:
            self.shot.notes.lost(Damage.DETAIL, self.name, "its bumps are left out")
            return
        pixels = self.bake("bumps", value, kind="normal")
        if float(covered(pixels)[:, :2].std()) < FLAT:
            self.baked[-1] = "bumps (flat to half a degree, left out)"
            return
        result["normalTexture"] = self.info(
            self.document.texture(png(pixels[..., :3]), CLAMP, name=f"{self.name} bumps")
        )

    def emission(self, result):
        value = times(self.look["emission"], self.look["strength"])
        if is_constant(value):
            return
        picture, strength = picture_of(self.look["emission"]), self.look["strength"]
        extensions = result.setdefault("extensions", {})
        if self.fits(picture) and picture.channel is None and is_constant(strength):
            pixels, top = pixels_of(picture.image), 1.0
            data = file_bytes(picture.image, srgb=True)
            if data is None:
                top = max(float(pixels[..., :3].max()), 1e-9) if picture.image.is_float else 1.0
                data = png(to_srgb(pixels[..., :3] / top))
            texture, strength = self.info(self.image(data, picture), picture), as_number(strength) * top
        else:
            pixels = rec709_pixels(self.bake("emission", value))
            strength = max(float(pixels[..., :3].max()), 1e-9)
            if pixels.shape[0] == 1:
                set_emission(result, tuple(float(c) for c in pixels[0, 0, :3]))
                return
            texture = self.info(
                self.document.texture(png(to_srgb(pixels[..., :3] / strength)), CLAMP, name=f"{self.name} emission")
            )
        result["emissiveFactor"], result["emissiveTexture"] = [1.0, 1.0, 1.0], texture
        extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": max(0.0, strength)}

    def transmission(self, result):
        value = self.look["transmission"]
        if is_constant(value):
            return
        pixels = self.bake("transmission", value)[..., :3]
        extension = result.setdefault("extensions", {}).setdefault("KHR_materials_transmission", {})
        extension["transmissionFactor"] = 1.0
        if pixels.shape[0] == 1:
            extension["transmissionFactor"] = unit(pixels[0, 0, 0])
        else:
            extension["transmissionTexture"] = self.info(
                self.document.texture(png(pixels), CLAMP, name=f"{self.name} transmission")
            )

    def passing(self, result):
        """The colour of the light that a translucent surface lets through, where it is not one colour."""
        value = self.look["passing_colour"]
        extension = result.get("extensions", {}).get("KHR_materials_diffuse_transmission")
        if extension is None or is_constant(value):
            return
        picture = picture_of(value)
        extension["diffuseTransmissionColorFactor"] = [1.0, 1.0, 1.0]
        if self.fits(picture) and picture.channel is None:
            info = self.info(self.image(self.base_image(picture, None), picture), picture)
        else:
            pixels = rec709_pixels(self.bake("translucent colour", value))[..., :3]
            if pixels.shape[0] == 1:
                extension["diffuseTransmissionColorFactor"] = [unit(c) for c in pixels[0, 0]]
                return
            data = png(to_srgb(pixels))
            info = self.info(self.document.texture(data, CLAMP, name=f"{self.name} translucent colour"))
        extension["diffuseTransmissionColorTexture"] = info


def covered(pixels):
    """Pixels (n, 4) that a bake wrote."""
    flat = pixels.reshape(-1, 4)
    inside = flat[flat[:, 3] > 0]
    return inside if len(inside) else flat


def rec709_pixels(pixels):
    pixels = pixels.copy()
    pixels[..., :3] = rec709_array(pixels[..., :3])
    return pixels

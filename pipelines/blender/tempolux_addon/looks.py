"""Shaders of Cycles as one Principled surface, or the one that is most like them."""
from .colour import rec709
from .values import (Blend, Source, as_number, as_tuple, blend, follow, is_constant, pick, plain, resolve, times)

WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
# Values of a look that blended() does not mix, and those of the light that a look reflects.
NOT_BLENDED = ("normal", "displacement", "emission", "strength", "through", "old_specular", "reflects", "one_for_all_angles", "grain_axis")
REFLECTED = ("base", "roughness", "ior", "tint")


class Look(dict):
    """Values of a Principled surface; names of losses in `losses`: (how bad, text)."""

    def __init__(self, **values):
        super().__init__(
            base=(0.8, 0.8, 0.8),
            alpha=1.0,
            metallic=0.0,
            roughness=0.5,
            normal=None,
            emission=BLACK,
            strength=0.0,
            transmission=0.0,
            ior=1.5,
            level=0.5,
            tint=WHITE,
            coat=0.0,
            coat_roughness=0.03,
            sheen=0.0,
            sheen_roughness=0.5,
            sheen_tint=WHITE,
            film=0.0,
            film_ior=1.33,
            anisotropic=0.0,
            anisotropic_rotation=0.0,
            subsurface=0.0,
            passing=0.0,                         # share of the matte part that sends light to the other side
            passing_colour=WHITE,
            displacement=None,
        )
        self.update(values)
        self.losses = []

    def lose(self, text):
        if text not in self.losses:
            self.losses.append(text)


def matte(colour, **values):
    return Look(base=colour, roughness=1.0, level=0.0, **values)


def inputs(node, stack, **names):
    """{key: value of the input of one of these names}; those that the node lacks are left out."""
    found = {key: pick(node.inputs, *([name] if isinstance(name, str) else name)) for key, name in names.items()}
    return {key: resolve(socket, stack) for key, socket in found.items() if socket is not None}


def bent_normal(node, stack):
    """The Normal input; None if nothing is linked to it."""
    socket = pick(node.inputs, "Normal")
    value = resolve(socket, stack) if socket is not None and socket.is_linked else None
    return value if isinstance(value, Source) else None


def principled(node, stack):
    look = Look(
        normal=bent_normal(node, stack),
        **inputs(
            node,
            stack,
            base="Base Color",
            alpha="Alpha",
            metallic="Metallic",
            roughness="Roughness",
            ior="IOR",
            emission=("Emission Color", "Emission"),
            strength="Emission Strength",
            transmission=("Transmission Weight", "Transmission"),
            level=("Specular IOR Level", "Specular"),
            coat=("Coat Weight", "Clearcoat"),
            coat_roughness=("Coat Roughness", "Clearcoat Roughness"),
            sheen=("Sheen Weight", "Sheen"),
            sheen_roughness="Sheen Roughness",
            film="Thin Film Thickness",
            film_ior="Thin Film IOR",
            anisotropic="Anisotropic",
            anisotropic_rotation="Anisotropic Rotation",
            subsurface=("Subsurface Weight", "Subsurface"),
        ),
    )
    tint = pick(node.inputs, "Specular Tint")
    if tint is not None:
        value = resolve(tint, stack)
        if tint.type == "RGBA":
            look["tint"] = value
        else:                                    # before 4.0: how much of the base colour
            look["tint"] = blend(value, WHITE, look["base"])
    sheen = pick(node.inputs, "Sheen Tint")
    if sheen is not None:
        value = resolve(sheen, stack)
        look["sheen_tint"] = value if sheen.type == "RGBA" else blend(value, WHITE, look["base"])
    if pick(node.inputs, "Specular IOR Level") is None:    # before 4.0 the reflection does not follow the IOR
        look["old_specular"] = True
        colour = pick(node.inputs, "Subsurface Color")
        if colour is not None and look["subsurface"] != 0:
            look["base"] = blend(look["subsurface"], look["base"], resolve(colour, stack))
        rough = pick(node.inputs, "Transmission Roughness")
        if (
            rough is not None
            and is_constant(look["transmission"])
            and as_number(look["transmission"]) > 0
            and resolve(rough, stack) != 0
        ):
            look.lose("Transmission Roughness is left out")
    elif is_constant(look["base"]) and is_constant(look["transmission"]):
        # Since 4.0 glass takes the root of the colour at each of its two surfaces.
        look["base"] = tuple(max(c, 0.0) ** (1 - as_number(look["transmission"]) / 2) for c in as_tuple(look["base"]))
    if (
        pick(node.inputs, "Coat Tint") is not None
        and look["coat"] != 0
        and resolve(pick(node.inputs, "Coat Tint"), stack) != WHITE
    ):
        look.lose("the tint of its coat is left out")
    grain_of(look, pick(node.inputs, "Tangent"))
    rough = pick(node.inputs, "Diffuse Roughness")
    if rough is not None and resolve(rough, stack) != 0:
        look.lose("Diffuse Roughness is left out")
    return look


def grain_of(look, tangent):
    """Sets the axis that a brushed surface's tangents go round, if a Tangent node says one."""
    if look["anisotropic"] == 0 or tangent is None or not tangent.is_linked:
        return
    node = tangent.links[0].from_node
    if node.type == "TANGENT" and node.direction_type == "RADIAL":
        look["grain_axis"] = node.axis
    else:
        look.lose("its tangents go round Z")


def conductor(node, stack):
    """Metallic BSDF (4.3): its colour, or what its index of refraction and extinction reflect from in front."""
    look = Look(
        metallic=1.0,
        normal=bent_normal(node, stack),
        **inputs(
            node,
            stack,
            base="Base Color",
            roughness="Roughness",
            anisotropic="Anisotropy",
            anisotropic_rotation="Rotation",
        ),
    )
    if getattr(node, "fresnel_type", "F82") == "PHYSICAL_CONDUCTOR":
        n, k = (as_tuple(resolve(pick(node.inputs, name), stack)) for name in ("IOR", "Extinction"))
        look["base"] = tuple(((a - 1) ** 2 + b * b) / ((a + 1) ** 2 + b * b) for a, b in zip(n, k))
    return look


def glass(node, stack):
    look = Look(
        transmission=1.0,
        normal=bent_normal(node, stack),
        **inputs(node, stack, base="Color", roughness="Roughness", ior="IOR"),
    )
    if node.type == "BSDF_REFRACTION":
        look.lose("its Refraction BSDF reflects here, too")
    elif look["base"] != WHITE:
        look.lose("the colour of its Glass BSDF tints what goes through, not what is reflected")
    return look


def simple(**fixed):
    def read(node, stack):
        return Look(**{**fixed, "normal": bent_normal(node, stack), **inputs(node, stack, base="Color")})
    return read


def diffuse(node, stack):
    look = matte(**inputs(node, stack, colour="Color"), normal=bent_normal(node, stack))
    if inputs(node, stack, rough="Roughness").get("rough", 0) != 0:
        look.lose("the roughness of its Diffuse BSDF is left out")
    return look


def glossy(node, stack):
    return Look(metallic=1.0, normal=bent_normal(node, stack), one_for_all_angles=True, **inputs(
        node, stack, base="Color", roughness="Roughness", anisotropic=("Anisotropy",), anisotropic_rotation="Rotation"))


def translucent(node, stack):
    colour = inputs(node, stack, colour="Color")["colour"]
    return matte(colour, passing=1.0, passing_colour=colour, normal=bent_normal(node, stack))


def subsurface(node, stack):
    return matte(**inputs(node, stack, colour="Color"), subsurface=1.0, normal=bent_normal(node, stack))


def sheen(node, stack):
    found = inputs(node, stack, colour="Color", roughness=("Roughness", "Sigma"))
    look = matte(BLACK, sheen=1.0, sheen_tint=found.get("colour", WHITE), normal=bent_normal(node, stack))
    look["sheen_roughness"] = found.get("roughness", .5)
    return look


def emission(node, stack):
    found = inputs(node, stack, colour="Color", strength="Strength")
    return matte(BLACK, emission=found["colour"], strength=found["strength"])


def transparent(node, stack):
    look = matte(BLACK, alpha=0.0)
    colour = inputs(node, stack, colour="Color")["colour"]
    if colour != WHITE:
        look["through"] = colour
    return look


def hair(node, stack):
    look = matte(**inputs(node, stack, colour="Color"))
    look.lose(f"{node.bl_label} becomes matte")
    return look


SHADERS = {
    "BSDF_PRINCIPLED": principled,
    "BSDF_DIFFUSE": diffuse,
    "BSDF_GLOSSY": glossy,
    "BSDF_ANISOTROPIC": glossy,
    "BSDF_METALLIC": conductor,
    "BSDF_GLASS": glass,
    "BSDF_REFRACTION": glass,
    "BSDF_TRANSLUCENT": translucent,
    "SUBSURFACE_SCATTERING": subsurface,
    "BSDF_SHEEN": sheen,
    "BSDF_VELVET": sheen,
    "EMISSION": emission,
    "BACKGROUND": emission,
    "BSDF_TRANSPARENT": transparent,
    "BSDF_HAIR": hair,
    "BSDF_HAIR_PRINCIPLED": hair,
    "BSDF_TOON": hair,
    "EEVEE_SPECULAR": hair,
}


def path_switch(value):
    """What a factor of the Light Path node is for the rays of the picture: 1 for camera rays, 0 for shadows and bounces."""
    if isinstance(value, Source) and value.node.type == "LIGHT_PATH":
        return 1.0 if value.socket.name == "Is Camera Ray" else 0.0
    return None


def angle_switch(value, stack):
    """A factor that depends on the angle of view, as the index of refraction of a Fresnel; None for others."""
    if isinstance(value, Source) and value.node.type == "FRESNEL":
        ior = resolve(pick(value.node.inputs, "IOR"), value.stack)
        return ior if is_constant(ior) else 1.45
    if isinstance(value, Source) and value.node.type == "LAYER_WEIGHT":
        weight = resolve(pick(value.node.inputs, "Blend"), value.stack)
        return 1 / max(1 - as_number(weight), 1e-5) if is_constant(weight) and value.socket.name == "Fresnel" else 1.5
    return None


def is_mirror(look):
    return is_constant(look["metallic"]) and look["metallic"] == 1 and is_constant(look["base"])


def is_matte(look):
    return look["level"] == 0 and look["metallic"] == 0 and look["transmission"] == 0


def is_clear(look):
    return is_constant(look["alpha"]) and look["alpha"] == 0


def coated(matte_look, mirror, reflectance):
    """Matte below a reflection of this share, seen from in front."""
    look = Look(**matte_look)
    top = min(max(max(as_tuple(reflectance)), 1e-6), .9999)
    root = top ** .5
    look.update(
        ior=(1 + root) / (1 - root),
        level=0.5,
        tint=tuple(c / top for c in as_tuple(reflectance)),
        roughness=mirror["roughness"],
        old_specular=False,
    )
    return look


def glazed(matte_look, mirror, share):
    """Matte below a mirror that takes the same share at all angles, or rises to it along the surface. In Blender the
    matte part loses all of the mirror's share, here what the mirror reflects: its colour is darker by the quotient."""
    look = coated(matte_look, mirror, times(mirror["base"], share))
    front = as_tuple(times(mirror["base"], share))
    along = max(front) if mirror.get("one_for_all_angles") else share
    look["reflects"] = front, along
    kept = (1 - share) / max(1 - (20 * max(front) + along) / 21, 1e-6)
    look["base"], look["passing_colour"] = times(look["base"], kept), times(look["passing_colour"], kept)
    return look


def mix(factor, a, b):
    """One look for a mixture of two."""
    switch, ior = path_switch(factor), angle_switch(factor, ())
    if switch is not None:
        look = b if switch else a
        look.lose("what it is for other rays than the camera's (Light Path) is left out")
        return look
    if ior is not None and is_matte(a) and is_mirror(b):
        f0 = ((ior - 1) / (ior + 1)) ** 2
        return coated(a, b, times(b["base"], f0))
    if ior is not None:
        factor = ((ior - 1) / (ior + 1)) ** 2
        a.lose("a mixture by the angle of view has the factor of the view from in front")
    for clear, other, share in ((a, b, factor), (b, a, flip(factor))):
        if is_clear(clear) and not is_clear(other):
            look = Look(**other)
            look.losses = clear.losses + other.losses
            look["alpha"] = times(other["alpha"], share)
            look["strength"] = other["strength"]
            if "through" in clear:
                look.lose("the colour of its Transparent is left out")
            return look
    if is_constant(factor):
        for low, mirror, share in ((a, b, as_number(factor)), (b, a, 1 - as_number(factor))):
            if is_matte(low) and is_mirror(mirror) and low["base"] != mirror["base"] and share < 1:
                look = glazed(low, mirror, share)
                look.losses = low.losses + mirror.losses
                return look
    return blended(factor, a, b)


def flip(factor):
    return 1 - as_number(factor) if is_constant(factor) else Blend(factor, 1.0, 0.0)


def passing_of(factor, a, b):
    """The share of the matte part of a mixture that sends light to the other side. Glass and metal have no matte part."""
    def matte_share(look):
        return (1 - as_number(look["transmission"])) * (1 - as_number(look["metallic"]))
    values = [look[key] for look in (a, b) for key in ("transmission", "metallic", "passing")]
    if not all(is_constant(value) for value in (factor, *values)):
        return blend(factor, a["passing"], b["passing"])
    share = as_number(factor)
    matte_a, matte_b = (1 - share) * matte_share(a), share * matte_share(b)
    whole = matte_a + matte_b
    return (matte_a * as_number(a["passing"]) + matte_b * as_number(b["passing"])) / whole if whole > 0 else 0.0


def blended(factor, a, b):
    look = Look(normal=a["normal"] or b["normal"])
    look.losses = a.losses + b.losses
    weight_a, weight_b = weight_of(a), weight_of(b)
    surface = b if weight_a == 0 else a if weight_b == 0 else None
    reflecting = b if (a["passing"], b["passing"]) == (1, 0) else a if (a["passing"], b["passing"]) == (0, 1) else None
    for key in set(a) | set(b):
        if key in NOT_BLENDED:
            continue
        if surface is not None and key in (*REFLECTED, "level", "passing", "passing_colour"):
            look[key] = surface[key]
        elif reflecting is not None and key in REFLECTED:
            look[key] = reflecting[key]
        elif key == "passing":
            look[key] = passing_of(factor, a, b)
        elif key == "passing_colour" and 0 in (a["passing"], b["passing"]):
            look[key] = (b if a["passing"] == 0 else a)[key]
        else:
            look[key] = blend(factor, a.get(key, 0.0), b.get(key, 0.0))
    if weight_a == 0 or weight_b == 0:       # emission beside a surface takes its share of it
        shine = factor if weight_b == 0 else flip(factor)
        look["base"] = times(look["base"], flip(shine))
        look["passing_colour"] = times(look["passing_colour"], flip(shine))
    look["old_specular"] = bool(a.get("old_specular") and b.get("old_specular"))
    if a["strength"] == 0 and b["strength"] == 0:
        look.update(emission=BLACK, strength=0.0)
    else:
        look["emission"] = blend(factor, times(a["emission"], a["strength"]), times(b["emission"], b["strength"]))
        look["strength"] = 1.0
    return look


def weight_of(look):
    """0 for a look that only emits."""
    return (
        0 if look["base"] == BLACK and look["level"] == 0 and look["transmission"] == 0 and look["strength"] != 0 else 1
    )


def add(a, b):
    for shine, other in ((a, b), (b, a)):
        if weight_of(shine) == 0 or is_clear(shine):
            look = Look(**other)
            look.losses = a.losses + b.losses
            if shine["strength"] != 0:
                look["emission"] = (
                    times(shine["emission"], shine["strength"]) if other["strength"] == 0 else other["emission"]
                )
                look["strength"] = 1.0 if other["strength"] == 0 else other["strength"]
            return look
    look = mix(.5, a, b)
    look.lose("a sum of two shaders becomes their mean")
    return look


def read_shader(socket, stack):
    """The look of a shader input; None if nothing is linked to it."""
    socket, node, output, stack = follow(socket, stack)
    if node is None:
        return None
    if node.type in ("MIX_SHADER", "ADD_SHADER"):
        ends = [s for s in node.inputs if s.type == "SHADER"]
        looks = [read_shader(end, stack) or matte(BLACK) for end in ends]
        return mix(resolve(node.inputs[0], stack), *looks) if node.type == "MIX_SHADER" else add(*looks)
    if node.type == "HOLDOUT":
        look = matte(BLACK)
        look.lose("a holdout becomes black")
        return look
    if output.type != "SHADER":                # Cycles takes a colour for light
        return matte(BLACK, emission=Source(node, output, stack), strength=1.0)
    if node.type not in SHADERS:
        look = Look(roughness=1.0)
        look.lose(f"{node.bl_label} is not exported: it becomes grey; use Principled BSDF")
        return look
    return SHADERS[node.type](node, stack)


def output_of(tree):
    """The output that Cycles uses."""
    return tree.get_output_node("CYCLES") or tree.get_output_node("ALL")


def look_of(material):
    """(look, volume): the surface of a material, None where it has none; the node of its volume, or None."""
    tree = material.node_tree
    if tree is None or not getattr(material, "use_nodes", True):
        return (
            Look(base=plain_colour(material.diffuse_color), metallic=material.metallic, roughness=material.roughness),
            None,
        )
    output = output_of(tree)
    if output is None:
        return matte(BLACK), None
    look = read_shader(output.inputs["Surface"], ())
    volume = follow(output.inputs["Volume"], ())[1]
    bumps = output.inputs["Displacement"]
    if look is not None and bumps.is_linked:
        look["displacement"] = True
    if look is None and volume is None:
        look = matte(BLACK)
    return look, volume


def plain_colour(colour):
    return tuple(float(c) for c in colour[:3])


def fog_of(volume):
    """(colour, distance) of KHR_materials_volume for what absorbs inside of glass; None for other volumes."""
    if volume is None or volume.type not in ("VOLUME_ABSORPTION", "PRINCIPLED_VOLUME"):
        return None
    density, colour = (plain(pick(volume.inputs, name)) for name in ("Density", "Color"))
    if volume.type == "PRINCIPLED_VOLUME" or any(s.is_linked for s in volume.inputs) or density <= 0:
        return None
    rate = [density * (1 - c) for c in rec709(colour)]
    return [2.718281828 ** -(r / density) for r in rate], 1 / density

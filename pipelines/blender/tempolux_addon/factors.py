"""Looks as factors and extensions of a material of glTF."""
from .colour import rec709
from .values import as_number, as_tuple, is_constant, times

STRENGTH = "/extensions/KHR_materials_emissive_strength/emissiveStrength"
DEFAULTS = {
    "/extensions/KHR_materials_specular/specularFactor": 1.0,
    "/extensions/KHR_materials_specular/specularColorFactor": [1.0, 1.0, 1.0],
    "/extensions/KHR_materials_ior/ior": 1.5,
    "/extensions/KHR_materials_transmission/transmissionFactor": 0.0,
}
ANIMATED = {
    "/pbrMetallicRoughness/baseColorFactor",
    "/pbrMetallicRoughness/metallicFactor",
    "/pbrMetallicRoughness/roughnessFactor",
    "/emissiveFactor",
    "/extensions/KHR_materials_emissive_strength/emissiveStrength",
    "/extensions/KHR_materials_specular/specularFactor",
    "/extensions/KHR_materials_specular/specularColorFactor",
    "/extensions/KHR_materials_ior/ior",
    "/extensions/KHR_materials_transmission/transmissionFactor",
}


def as_number_or(value, other):
    return as_number(value) if is_constant(value) else other


def leaves(value, path=""):
    """(pointer, number or list) of all numbers in a material."""
    for key, inner in value.items():
        if isinstance(inner, dict):
            yield from leaves(inner, f"{path}/{key}")
        elif isinstance(inner, (int, float, list)) and not isinstance(inner, bool):
            yield f"{path}/{key}", inner


def plain_material(look):
    """A material of the constants of a look."""
    result = {}
    set_base(result, look["base"] if is_constant(look["base"]) else (1.0, 1.0, 1.0), as_number_or(look["alpha"], 1.0))
    result["pbrMetallicRoughness"].update(metallicFactor=unit(as_number_or(look["metallic"], 1.0)),
                                          roughnessFactor=unit(as_number_or(look["roughness"], 1.0)))
    set_emission(result, times(look["emission"], look["strength"]))
    set_extensions(result, look, {})
    return result


def unit(value):
    return min(1.0, max(0.0, float(value)))


def set_base(result, base, alpha):
    result.setdefault("pbrMetallicRoughness", {})["baseColorFactor"] = [unit(c) for c in rec709(as_tuple(base))] + [
        unit(alpha)
    ]


def set_emission(result, emission):
    if not is_constant(emission):
        return
    colour = [max(0.0, c) for c in rec709(as_tuple(emission))]
    top = max(colour)
    if top > 0:
        result["emissiveFactor"] = [c / top for c in colour]
        result.setdefault("extensions", {})["KHR_materials_emissive_strength"] = {"emissiveStrength": top}
    else:
        result["emissiveFactor"] = [0.0, 0.0, 0.0]


def reflection(look, mean):
    """(ior, specularFactor, specularColorFactor): what a dielectric reflects from in front is F0 of the IOR times twice the level."""
    if "reflects" in look:
        front, along = look["reflects"]
        return 1.5, min(1.0, along), [25 * c / along for c in rec709(front)] if along > 0 else [1.0, 1.0, 1.0]
    ior, level, tint = max(1.0, mean("ior")), max(0.0, mean("level")), rec709(as_tuple(mean("tint", colour=True)))
    f0 = (
        0.04
        if look.get("old_specular") and as_number_or(look["transmission"], 1) == 0
        else ((ior - 1) / (ior + 1)) ** 2
    )
    f0 *= 2 * level
    if level == 0 and as_number_or(look["transmission"], 1) == 0:
        return 1.5, 0.0, [1.0, 1.0, 1.0]
    if as_number_or(look["transmission"], 1) > 0:
        return ior, 1.0 if level == .5 else min(1.0, 2 * level), list(tint)
    root = min(f0, .998) ** .5
    return (1 + root) / (1 - root), 1.0, list(tint)


def brushed(roughness, anisotropic):
    """(roughness, strength) of glTF with Blender's widths: r^2 / a and r^2 a, a^2 = 1 - .9 anisotropic. In glTF the widths are
    r^2 + (1 - r^2) s^2 and r^2."""
    wide, a = max(roughness, 1e-3) ** 2, (1 - 0.9 * anisotropic) ** 0.5
    along, across = min(1.0, wide / a), wide * a
    return across**0.5, ((along - across) / (1 - across)) ** 0.5 if across < 1 else 0.0


def set_extensions(result, look, means):
    """Extensions of the constants; `means` of what is linked."""
    extensions = result.setdefault("extensions", {})

    def mean(key, colour=False):
        value = look[key] if is_constant(look[key]) else means.get(key, (1.0, 1.0, 1.0) if colour else 0.0)
        return as_tuple(value) if colour else as_number(value)
    ior, specular, tint = reflection(look, mean)
    if abs(ior - 1.5) > 1e-6:
        extensions["KHR_materials_ior"] = {"ior": ior}
    if specular != 1 or any(abs(c - 1) > 1e-6 for c in tint):
        extensions["KHR_materials_specular"] = {"specularFactor": specular, "specularColorFactor": tint}
    if not is_constant(look["transmission"]) or as_number(look["transmission"]) > 0:
        extensions["KHR_materials_transmission"] = {"transmissionFactor": unit(as_number_or(look["transmission"], 1.0))}
    if mean("coat") > 0:
        extensions["KHR_materials_clearcoat"] = {
            "clearcoatFactor": unit(mean("coat")),
            "clearcoatRoughnessFactor": unit(mean("coat_roughness")),
        }
    if mean("sheen") > 0:
        extensions["KHR_materials_sheen"] = {
            "sheenColorFactor": [unit(mean("sheen") * c) for c in rec709(mean("sheen_tint", colour=True))],
            "sheenRoughnessFactor": unit(mean("sheen_roughness")),
        }
    if mean("passing") > 0:
        extensions["KHR_materials_diffuse_transmission"] = {
            "diffuseTransmissionFactor": unit(mean("passing")),
            "diffuseTransmissionColorFactor": [unit(c) for c in rec709(mean("passing_colour", colour=True))],
        }
    if mean("film") > 0:
        extensions["KHR_materials_iridescence"] = {
            "iridescenceFactor": 1.0,
            "iridescenceIor": mean("film_ior"),
            "iridescenceThicknessMinimum": mean("film"),
            "iridescenceThicknessMaximum": mean("film"),
        }
    if mean("anisotropic") > 0:
        strength = unit(mean("anisotropic"))
        if is_constant(look["roughness"]):
            roughness, strength = brushed(as_number(look["roughness"]), strength)
            result["pbrMetallicRoughness"]["roughnessFactor"] = roughness
        extensions["KHR_materials_anisotropy"] = {
            "anisotropyStrength": strength,
            "anisotropyRotation": 6.283185307179586 * mean("anisotropic_rotation"),
        }
    if not extensions:
        del result["extensions"]

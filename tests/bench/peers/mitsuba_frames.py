"""Frames of a scene of scene_of_blender.py by Mitsuba 3, in the Python of build/peers/mitsuba: reads jobs from standard input, one JSON a line.

    {"scene": FILE.scene, "world": FILE or null, "sky": [R, G, B] or null}    once, first
    {"samples": 16, "seed": 1, "output": STEM}                              writes STEM.pfm, STEM.albedo.pfm, STEM.normal.pfm
"""
import array
import math
import pickle
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import serve  # before others: it takes standard output
import mitsuba as mi

mi.set_variant("llvm_ad_rgb" if "llvm_ad_rgb" in mi.variants() and "--llvm" in sys.argv else "scalar_rgb")
state = {}


def rgb(values):
    return {"type": "rgb", "value": list(values)}


def bsdf(look):
    base = {"type": "bitmap", "filename": look["picture"]} if look["picture"] else rgb(look["base"])
    if look["transmission"] > 0.5:
        return {"type": "dielectric", "int_ior": look["ior"]} if look["roughness"] < 0.05 else {"type": "roughdielectric", "int_ior": look["ior"], "alpha": look["roughness"] ** 2}
    if look["specular"] == 0 and look["metallic"] == 0:
        found = {"type": "diffuse", "reflectance": base}
    elif look["metallic"] > 0.5 and look["roughness"] < 0.05:
        found = {"type": "conductor", "material": "none", "specular_reflectance": base}
    else:
        found = {"type": "principled", "base_color": base, "metallic": look["metallic"], "roughness": max(0.02, look["roughness"]), "specular": min(1.0, max(0.01, look["specular"]))}
    found = {"type": "twosided", "inner": found}
    return {"type": "mask", "opacity": look["alpha"], "inner": found} if look["alpha"] < 1 else found


def light(lamp):
    if lamp["type"] == "SUN":
        return {"type": "directional", "direction": lamp["towards"], "irradiance": rgb(lamp["power"])}
    intensity = rgb([p / (4 * math.pi) for p in lamp["power"]])
    if lamp["type"] == "SPOT":
        cone, at = math.degrees(lamp["cone"]), lamp["place"]
        return {"type": "spot", "to_world": mi.ScalarTransform4f().look_at(at, [a + b for a, b in zip(at, lamp["towards"])], [0.01, 1, 0.02]), "intensity": intensity,
                "cutoff_angle": cone, "beam_width": cone * (1 - lamp["blend"])}
    return {"type": "point", "position": lamp["place"], "intensity": intensity}


def shape(i, mesh, look):
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf(look))
    if max(look["emission"]) > 0:
        props["emitter"] = mi.load_dict({"type": "area", "radiance": rgb(look["emission"])})
    count = len(mesh["places"]) // 9
    made = mi.Mesh(f"s{i}", 3 * count, count, has_vertex_normals=True, has_vertex_texcoords=True, props=props)
    values = mi.traverse(made)
    for name, key in (("vertex_positions", "places"), ("vertex_normals", "normals"), ("vertex_texcoords", "uvs")):
        values[name] = type(values[name])(list(mesh[key]))
    values["faces"] = type(values["faces"])(list(range(3 * count)))
    values.update()
    return made


def load(job):
    with open(job["scene"], "rb") as file:
        found = pickle.load(file)
    camera, (width, height) = found["camera"], found["size"]
    scene = {"type": "scene",
             "integrator": {"type": "aov", "aovs": "albedo:albedo,normal:sh_normal", "inner": {"type": "path", "max_depth": 64}},
             "sensor": {"type": "perspective", "fov": math.degrees(camera["across"]), "fov_axis": "x",
                        "to_world": mi.ScalarTransform4f().look_at(camera["eye"], [a + b for a, b in zip(camera["eye"], camera["towards"])], camera["up"]),
                        "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"},
                        "sampler": {"type": "independent"}}}
    for i, mesh in enumerate(found["meshes"]):
        scene[f"s{i}"] = shape(i, mesh, found["materials"][mesh["material"]])
    for i, lamp in enumerate(found["lights"]):
        scene[f"l{i}"] = light(lamp)
    if job.get("world"):
        scene["w"] = {"type": "envmap", "filename": job["world"]}
    elif job.get("sky") and max(job["sky"]) > 0:
        scene["w"] = {"type": "constant", "radiance": rgb(job["sky"])}
    state.update(scene=mi.load_dict(scene), width=width, height=height)


def render(job):
    image = mi.render(state["scene"], spp=job["samples"], seed=job["seed"])
    values, channels = array.array("f", image.array), image.shape[2]
    for end, first in (("", 0), (".albedo", channels - 6), (".normal", channels - 3)):
        part = array.array("f", (values[p * channels + first + c] for p in range(state["width"] * state["height"]) for c in range(3)))
        serve.write_pfm(f"{job['output']}{end}.pfm", state["width"], state["height"], part, from_top=True)


serve.jobs(load, render)

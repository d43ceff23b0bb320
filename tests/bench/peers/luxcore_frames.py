"""Frames of a scene of scene_of_blender.py by LuxCore, in the Python of build/peers/luxcore: reads jobs from standard input, one JSON a line.

    {"scene": FILE.scene, "world": FILE or null, "sky": [R, G, B] or null}    once, first
    {"samples": 16, "seed": 1, "photongi": false, "output": STEM}            writes STEM.pfm, STEM.albedo.pfm, STEM.normal.pfm
"""
import array
import math
import pickle
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import serve  # before others: it takes standard output
import pyluxcore

pyluxcore.Init()
state = {}

# From the axes of its maps, z up, to ours: columns. The left edge of a map is at -Z, a quarter further is +X (formats/conventions.md).
OF_MAP = [0, 0, -1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1]


def properties(values):
    props = pyluxcore.Properties()
    for name, value in values.items():
        props.Set(pyluxcore.Property(name, value))
    return props


def material(name, look):
    key = f"scene.materials.{name}."
    base = look["base"]
    values = {}
    if look["picture"]:
        values |= {f"scene.textures.{name}.type": "imagemap", f"scene.textures.{name}.file": look["picture"], f"scene.textures.{name}.gamma": 2.2}
        base = name
    if look["transmission"] > 0.5:
        values |= {key + "type": "glass" if look["roughness"] < 0.05 else "roughglass", key + "kt": base, key + "kr": [1.0, 1.0, 1.0], key + "interiorior": look["ior"]}
        if look["roughness"] >= 0.05:
            values |= {key + "uroughness": look["roughness"] ** 2, key + "vroughness": look["roughness"] ** 2}
    elif look["specular"] == 0 and look["metallic"] == 0:
        values |= {key + "type": "matte", key + "kd": base}
    elif look["metallic"] > 0.5 and look["roughness"] < 0.05:
        values |= {key + "type": "mirror", key + "kr": base}
    else:
        values |= {key + "type": "disney", key + "basecolor": base, key + "metallic": look["metallic"], key + "roughness": look["roughness"], key + "specular": look["specular"]}
    if max(look["emission"]) > 0:
        values |= {key + "emission": look["emission"]}
    if look["alpha"] < 1:
        values |= {key + "transparency": look["alpha"]}
    return values


def light(i, lamp):
    key = f"scene.lights.l{i}."
    values = {key + "color": lamp["power"], key + "samples": 1}
    if lamp["type"] == "SUN":
        return values | {key + "type": "sharpdistant", key + "direction": lamp["towards"]}
    values |= {key + "position": lamp["place"], key + "gain": [1 / (4 * math.pi)] * 3}
    if lamp["type"] == "SPOT":
        cone = math.degrees(lamp["cone"])
        return values | {key + "type": "spot", key + "target": [a + b for a, b in zip(lamp["place"], lamp["towards"])], key + "coneangle": cone, key + "conedeltaangle": max(0.01, lamp["blend"] * cone)}
    return values | {key + "type": "point"}


def load(job):
    with open(job["scene"], "rb") as file:
        found = pickle.load(file)
    scene = pyluxcore.Scene()
    names = {name: f"m{i}" for i, name in enumerate(found["materials"])}
    for name, look in found["materials"].items():
        scene.Parse(properties(material(names[name], look)))
    for i, mesh in enumerate(found["meshes"]):
        def triples(values, n):
            return [tuple(values[k:k + n]) for k in range(0, len(values), n)]
        count = len(mesh["places"]) // 9
        scene.DefineMesh(f"s{i}", triples(mesh["places"], 3), [(3 * t, 3 * t + 1, 3 * t + 2) for t in range(count)], triples(mesh["normals"], 3), triples(mesh["uvs"], 2), None, None)
        scene.Parse(properties({f"scene.objects.o{i}.shape": f"s{i}", f"scene.objects.o{i}.material": names[mesh["material"]]}))
    for i, lamp in enumerate(found["lights"]):
        scene.Parse(properties(light(i, lamp)))
    if job.get("world"):
        scene.Parse(properties({"scene.lights.w.type": "infinite", "scene.lights.w.file": job["world"], "scene.lights.w.gamma": 1.0,
                                "scene.lights.w.transformation": OF_MAP}))
    elif job.get("sky") and max(job["sky"]) > 0:
        scene.Parse(properties({"scene.lights.w.type": "constantinfinite", "scene.lights.w.color": job["sky"]}))
    camera, (width, height) = found["camera"], found["size"]
    scene.Parse(properties({"scene.camera.type": "perspective", "scene.camera.lookat.orig": camera["eye"], "scene.camera.up": camera["up"],
                            "scene.camera.lookat.target": [a + b for a, b in zip(camera["eye"], camera["towards"])],
                            "scene.camera.fieldofview": math.degrees(camera["across"]), "scene.camera.autovolume.enable": False}))
    state.update(scene=scene, width=width, height=height)


def render(job):
    values = {"renderengine.type": "PATHCPU", "sampler.type": "SOBOL", "renderengine.seed": job["seed"] + 1, "film.width": state["width"], "film.height": state["height"],
              "film.haltspp": [job["samples"], 0], "path.pathdepth.total": 64, "path.pathdepth.diffuse": 64, "path.pathdepth.glossy": 64, "path.pathdepth.specular": 64,
              "path.clamping.variance.maxvalue": 0.0, "film.filter.type": "BOX", "film.filter.width": 0.5, "film.noiseestimation.warmup": 1 << 20, "native.threads.count": 2}
    if job.get("photongi"):
        values |= {"path.photongi.sampler.type": "METROPOLIS", "path.photongi.photon.maxcount": 200000, "path.photongi.photon.maxdepth": 8, "path.photongi.indirect.enabled": True,
                   "path.photongi.indirect.maxsize": 0, "path.photongi.indirect.haltthreshold": 0.05, "path.photongi.indirect.lookup.radius": 0.15,
                   "path.photongi.indirect.glossinessusagethreshold": 0.05, "path.photongi.caustic.enabled": True, "path.photongi.caustic.maxsize": 100000}
    outputs = {"": "RGB", ".albedo": "ALBEDO", ".normal": "AVG_SHADING_NORMAL"}
    for i, kind in enumerate(outputs.values()):
        values |= {f"film.outputs.{i}.type": kind, f"film.outputs.{i}.filename": f"o{i}.exr"}
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties(values), state["scene"]))
    session.Start()
    while session.GetStats().Get("stats.renderengine.pass").GetInt() < job["samples"]:
        time.sleep(0.005)
        session.UpdateStats()
    session.Stop()
    for end, kind in outputs.items():
        pixels = array.array("f", bytes(12 * state["width"] * state["height"]))
        session.GetFilm().GetOutputFloat(getattr(pyluxcore.FilmOutputType, kind), pixels)
        serve.write_pfm(f"{job['output']}{end}.pfm", state["width"], state["height"], pixels)


serve.jobs(load, render)

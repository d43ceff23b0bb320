#!/usr/bin/env python3
"""Ten materials on balls, ours beside Cycles: python3 -B tests/bench/ten_materials.py BIN OUT [--map MAP.hdr] [--light lamp] [--picture OUT.png]

Balls on a matte ground under one area lamp, and under one map of light; then balls alone in uniform light, which tell causes apart:
Cycles reads a second file there, in which definitions are made alike. peer_objects.py renders both sides with two seeds and
prints the means by object. --picture: for the first two ours, Cycles, and eight times the difference.
"""
import argparse
import math
import subprocess
import sys
from pathlib import Path

from layered_materials import Scene, ball, read  # adds tests/support and tests/stress to the path
import exr

HERE = Path(__file__).resolve().parent
GOLD, STEEL, WHITE, BLACK = (1, 0.77, 0.34), (0.56, 0.57, 0.58), (1, 1, 1), (0, 0, 0)
SHEEN = {"sheenColorFactor": [0.6, 0.5, 0.7], "sheenRoughnessFactor": 0.5}


def brushed(strength):
    return {"anisotropy": {"anisotropyStrength": strength}}


# {name: (base colour, metallic, roughness, extensions without their prefix)}
TEN = {
    "matte": ((0.6, 0.3, 0.2), 0, 1, {"specular": {"specularFactor": 0}}),
    "plastic .1": ((0.1, 0.25, 0.6), 0, 0.1, {}),
    "plastic .4": ((0.15, 0.45, 0.2), 0, 0.4, {}),
    "gold .35": (GOLD, 1, 0.35, {}),
    "steel .1": (STEEL, 1, 0.1, {}),
    "coat on red": ((0.6, 0.04, 0.03), 0, 0.5, {"clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.03}}),
    "cloth": ((0.2, 0.1, 0.3), 0, 0.9, {"sheen": SHEEN}),
    "brushed steel": (STEEL, 1, 0.3, brushed(0.6)),
    "rough glass": (WHITE, 0, 0.2, {"transmission": {"transmissionFactor": 1}, "volume": {"thicknessFactor": 1}, "ior": {"ior": 1.5}}),
    "half metal": ((0.7, 0.3, 0.15), 0.5, 0.3, {}),
}


def causes():
    """{name: (ours, the same for Cycles)}. Cycles' metals have Schlick's Fresnel term, its dielectrics the exact one. A strength s makes
    Cycles' widths roughness^2 / aspect and roughness^2 aspect, aspect^2 = 1 - .9 s."""
    narrow, share = TEN["brushed steel"][2]**2, TEN["brushed steel"][3]["anisotropy"]["anisotropyStrength"]**2
    wide = narrow + (1 - narrow) * share
    widths = (math.pow(narrow * wide, 0.25), brushed((1 - narrow / wide) / 0.9))
    black, cloth = (BLACK, 0, 0.1, {}), (*TEN["cloth"][:3], {})
    return {
        "black plastic": (black, black),
        "by Schlick both": (black, ((0.04, 0.04, 0.04), 1, 0.1, {})),
        "white metal .35": ((WHITE, *TEN["gold .35"][1:]),) * 2,
        "white brushed": ((WHITE, *TEN["brushed steel"][1:]),) * 2,
        "same widths": ((WHITE, *TEN["brushed steel"][1:]), (WHITE, 1, *widths)),
        "cloth": (TEN["cloth"],) * 2,
        "without sheen": (cloth, cloth),
    }


def material(scene, colour, metallic, roughness, extensions):
    extensions = {f"KHR_materials_{key}": value for key, value in extensions.items()}
    scene.extensions |= set(extensions)
    return scene._append("materials", {"extensions": extensions, "pbrMetallicRoughness": {
        "baseColorFactor": [*colour, 1], "metallicFactor": metallic, "roughnessFactor": roughness}})


def balls(scene, materials, places):
    for (name, values), place in zip(materials.items(), places):
        ball(scene, name, place, 0.45, material(scene, *values), rings=64, sectors=128)


def lit_balls(light):
    scene = Scene()
    scene.quad((-12, 0, 12), (12, 0, 12), (12, 0, -12), (-12, 0, -12), scene.material(0.4), name="ground")
    if light == "lamp":
        scene.quad((-2.2, 3.2, 1.6), (-2.2, 3.2, -0.4), (-0.6, 3.8, -0.4), (-0.6, 3.8, 1.6), scene.material(0, 20), name="lamp")
    balls(scene, TEN, [(1.05 * (i % 5 - 2), 0.45, 1.4 * (i // 5) - 0.9) for i in range(10)])
    scene.camera((0, 3.3, 5), (0, 0.35, 0), fov=0.5)
    return scene


def lone_balls(side):
    """So far from each other that each sees uniform light."""
    scene = Scene()
    balls(scene, {name: sides[side] for name, sides in causes().items()}, [(4 * (i % 4) - 6, 2 - 4 * (i // 4), 0) for i in range(7)])
    scene.camera((0, 0, 30), (0, 0, 0), fov=0.25)
    return scene


def picture(out, light):
    """Writes the means of both seeds and eight times their difference; returns the three files."""
    means = []
    for side in ("ours", "cycles"):
        seeds = [read(out / f"{side}{seed}.exr") for seed in (1, 2)]
        means.append({c: [(a + b) / 2 for a, b in zip(*(s.channels[c] for s in seeds))] for c in "RGB"})
    means.append({c: [8 * abs(a - b) for a, b in zip(means[0][c], means[1][c])] for c in "RGB"})
    files = [out / f"{light} {i}.exr" for i in range(3)]
    for file, channels in zip(files, means):
        exr.write(file, seeds[0].width, seeds[0].height, channels)
    return files


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--map", type=lambda p: Path(p).resolve())
    parser.add_argument("--light", choices=("lamp", "map", "uniform"))
    parser.add_argument("--size", default="240x120")
    parser.add_argument("--spp", default="192")
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    pictures = []
    for light in [options.light] if options.light else ["lamp", *(["map"] if options.map else []), "uniform"]:
        out = options.out / light
        out.mkdir(parents=True, exist_ok=True)
        words = {"lamp": [], "map": ["--world", options.map], "uniform": ["--sky", "1,1,1", "--theirs", out / "theirs.glb"]}[light]
        if light == "uniform":
            lone_balls(0).save(out / "scene.glb")
            lone_balls(1).save(out / "theirs.glb")
        else:
            lit_balls(light).save(out / "scene.glb")
        print(light, flush=True)
        subprocess.run([sys.executable, "-B", HERE / "peer_objects.py", options.bin, out, out / "scene.glb", "--size", options.size,
                        "--spp", options.spp, *words], check=True)
        if light != "uniform":
            pictures += picture(out, light)
    if options.picture and pictures:
        subprocess.run([options.bin / "tempolux-info", "--sheet", options.picture, "--columns", "3", "--tile", "216",
                        "--exposure", "-0.5", *pictures], check=True)


if __name__ == "__main__":
    main()

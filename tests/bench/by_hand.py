#!/usr/bin/env python3
"""The README's commands typed by hand against make: does a frame have the same light? by_hand.py BIN [--only WORD] [--size 160x90]

By hand: photon-trace, irradcache-build, frame-render as the README has them. By make: the frame in an OUT of its own, METHOD=frames. The
means of each layer over the frame are compared, all scenes of ../shared/scenes with what light they lack. Each way runs with several seeds
of its photons, gathering and pixels; make takes the seed through the tools' own names: BIN is copied, and each tool gets --seed.
A layer agrees if the means differ by at most 1 % of the frame's mean plus 3 standard errors of the difference. A way that is refused or a
layer that is not in the other is listed as it is. Scenes with smoke are left out: the README's three commands render none.
"""
import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

LAYERS = ("emission", "specular", "direct", "caustic", "indirect")
SHARED = Path("../shared/scenes")
SKY = {"SKY": "1,1.2,1.5"}
SPEC = {"LIGHT_UNITS": "spec"}
# Scene, frame, light that the file lacks.
SCENES = {
    "made/S1_cornell.glb": (0, {}), "made/S2_cornell_moving.glb": (10, {}), "made/S3_indirect_room.glb": (1, {}), "made/S4_atrium.glb": (10, {}),
    "made/S5_moving_light.glb": (10, {}), "made/S8_window_room.glb": (10, SPEC | {"SKY": "1.1,1.5,2"}),
    "made/cases/blink.glb": (2, {}), "made/cases/late.glb": (40, {}), "made/cases/passer.glb": (8, {}), "made/cases/stars.glb": (0, {}),
    "found/gltf/interiors/level_two_lamps.glb": (0, {}), "found/gltf/interiors/home_theater/cam.gltf": (0, {}),
    "found/gltf/interiors/house_cut_open.glb": (0, SKY), "found/gltf/interiors/evening_shot.glb": (10, SPEC | {"ENVIRONMENT": "hdri/evening_sky.exr"}),
    "found/gltf/bevy/CornellBox.glb": (0, {}), "found/gltf/bevy/DepthOfFieldExample.glb": (0, SKY), "found/gltf/playcanvas/house.glb": (0, SKY),
    "found/gltf/playcanvas/chess-board.glb": (0, SKY), "found/gltf/playcanvas/Lights.glb": (0, SKY), "found/gltf/godot/living_room.glb": (0, SKY),
    "found/gltf/threlte/issum_the_town_on_capital_isle-transformed.glb": (0, SKY), "found/gltf/sharpgltf/GrassFieldInstanced.glb": (0, SKY),
    "found/gltf/gkjohnson/low-poly-jungle/scene.gltf": (0, SKY), "found/gltf/gkjohnson/lamborghini/scene.glb": (0, SKY),
    "found/gltf/renderling/four_spotlights.glb": (0, {}), "found/gltf/renderling/shadow_mapping_points.glb": (0, {}),
    "found/gltf/blender-io/04_lights/04_lights.gltf": (0, {}), "found/gltf/blender-io/17_ior/17_ior.gltf": (0, SKY),
    "found/gltf/blender-io/24_gpu_instancing/24_gpu_instancing.gltf": (0, SKY), "found/gltf/bevy/MixedLightingExample/MixedLightingExample.gltf": (0, {}),
}


class Failed(Exception):
    pass


def run(command, limit, **how):
    try:
        done = subprocess.run([str(x) for x in ("nice", *command)], capture_output=True, text=True, timeout=limit, **how)
    except subprocess.TimeoutExpired:
        raise Failed(f"no end after {limit} s: {Path(str(command[0])).name}") from None
    if done.returncode:
        said = [x for x in (done.stderr or done.stdout).splitlines() if x.strip() and not x.startswith("make")]
        raise Failed(f"{Path(str(command[0])).name} ends with {done.returncode}: {said[-1] if said else ''}")


def options(light):
    names = {"SKY": "--environment", "ENVIRONMENT": "--environment", "LIGHT_UNITS": "--light-units"}
    return [word for name, value in light.items() for word in (names[name], value)]


class Comparison:
    def __init__(self, arguments, folder):
        self.bin, self.size, self.folder, self.limit = arguments.bin.resolve(), arguments.size, folder, arguments.limit
        self.photons, self.quality, self.old = arguments.photons, arguments.quality, arguments.old

    def seeded_tools(self, seed):
        tools = self.folder / f"bin{seed}"
        if not tools.exists():
            tools.mkdir()
            for tool in self.bin.iterdir():
                option = f"--seed {seed}" if tool.name in ("photon-trace", "irradcache-build", "frame-render", "gather-temporal") else ""
                # A dynamic map takes its seed from the static one.
                (tools / tool.name).write_text(f'#!/bin/sh\ncase "$*" in *"--map dynamic"*) exec "{tool}" "$@";; *) exec "{tool}" "$@" {option};; esac\n')
                (tools / tool.name).chmod(0o755)
        return tools

    def by_hand(self, scene, frame, light, seed):
        at = [scene, "--frame", frame, *options(light), "--seed", seed, "--threads", 1, "-q"]
        photons, cache, image = (self.folder / f"hand.{end}" for end in ("photons", "irradcache", "exr"))
        run([self.bin / "photon-trace", *at, "--photons", self.photons, "--kinds", "caustic,indirect", "-o", photons], self.limit)
        run([self.bin / "irradcache-build", *at, "--photons", photons, "--size", self.size, "-o", cache], self.limit)
        run([self.bin / "frame-render", *at, "--size", self.size, "--photons", photons, "--irradcache", cache, "--channels", "RGBA,layers", "-o", image], self.limit)
        return self.means_of(image)

    def by_make(self, scene, frame, light, seed):
        out = self.folder / f"out{seed}"
        light = dict(light)
        if self.old:                                                                 # makefiles before SKY and LIGHT_UNITS
            words = [f"{o} {light.pop(n)}" for n, o in (("SKY", "--environment"), ("LIGHT_UNITS", "--light-units")) if n in light]
            light |= {"TIME": " ".join(words)} if words else {}
        run(["make", "-f", "Makefile.example", "--no-print-directory", f"{out}/frames/{frame:04d}.exr", f"BIN={self.seeded_tools(seed)}", f"OUT={out}", f"SCENE={scene}",
             f"FRAMES={frame}", f"SIZE={self.size}", f"QUALITY={self.quality}", "CHANNELS=RGBA,layers", *(f"{k}={v}" for k, v in light.items())],
            self.limit, env=os.environ | {"TEMPOLUX_THREADS": "1"})
        return self.means_of(out / "frames" / f"{frame:04d}.exr")

    def make_refuses(self, scene, frame, light):
        """A scene without light or without a surface is refused, not rendered wrong."""
        try:
            self.by_make(scene.resolve(), frame, light, 1)
        except Failed as error:
            return " ends with 2: " in str(error)
        return False

    def means_of(self, image):
        """Mean of each layer over the frame and its channels."""
        done = subprocess.run([self.bin / "tempolux-info", "--json", image], capture_output=True, text=True, check=True)
        facts = json.loads(done.stdout)
        channels = {c["channel"]: c["mean"] for c in (facts[0] if isinstance(facts, list) else facts)["channels"]}
        return {layer: sum(channels.get(f"{layer}.{c}", 0) for c in "RGB") / 3 for layer in LAYERS}

    def scene(self, name, frame, light, seeds):
        """A line for each layer that differs, or one that says that all agree."""
        scene = SHARED / name
        light = {k: str(SHARED / "found" / v) if k == "ENVIRONMENT" else v for k, v in light.items()}
        try:
            hand = [self.by_hand(scene, frame, light, s) for s in range(1, seeds + 1)]
        except Failed as error:
            return [f"left out: {name}: both ways refuse: {error}" if self.make_refuses(scene, frame, light) else f"FAILED: {name}: {error}"]
        try:
            make = [self.by_make(scene.resolve(), frame, light, s) for s in range(1, seeds + 1)]
        except Failed as error:
            return [f"FAILED: {name}: {error}"]
        finally:
            subprocess.run(["rm", "-rf", *(str(self.folder / f"out{s}") for s in range(1, seeds + 1))], check=False)
        whole = statistics.mean(sum(m.values()) for m in make)
        if whole == 0:
            return [f"left out: {name}: make renders black"]
        lines = []
        for layer in ("all", *LAYERS):
            a, b = ([sum(m.values()) if layer == "all" else m[layer] for m in means] for means in (hand, make))
            difference = statistics.mean(a) - statistics.mean(b)
            error = math.sqrt((statistics.variance(a) + statistics.variance(b)) / seeds)
            if abs(difference) > 0.01 * whole + 3 * error:
                of = f"{100 * difference / statistics.mean(b):+.1f} % of the layer" if statistics.mean(b) > 0 else "make has none"
                lines.append(f"FAILED: {name}: {layer}: by hand - by make = {100 * difference / whole:+.2f} % of the frame, {of}; standard error {100 * error / whole:.2f} %")
        return lines or [f"ok: {name}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--size", default="160x90")
    parser.add_argument("--photons", default="200k")
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--limit", type=int, default=120, help="seconds of one command")
    parser.add_argument("--old", action="store_true", help="the makefile has no SKY and no LIGHT_UNITS")
    arguments = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory(prefix="hand") as folder:
        comparison = Comparison(arguments, Path(folder))
        for name, (frame, light) in SCENES.items():
            if arguments.only in name and (SHARED / name).exists():
                for line in comparison.scene(name, frame, light, arguments.seeds):
                    failed += line.startswith("FAILED")
                    print(line, flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Bias of the layer indirect: a lit house on a ground that takes most of the light, a dark room beside a bright one.

    ground.py --bin BIN --out DIR [--houses closed,window] [--radii 10,200] [--seeds 2] [--qualities draft,final]
              [--ways auto,gather] [--lamps 1]
    ground.py --bin BIN --out DIR --houses rooms --radii 0 --lamps 10,1000,100000

Prints the bias in percent of the layer, with its standard error over pixels, beside path tracing, and the CPU seconds of
the chain. --radii: half of the ground's width in metres, nothing in rooms; --lamps: candela, in rooms those of the bright
one over those of the dark one. closed and window need the scene generator ../shared/scenes/gen/ground_house.py and are
skipped where it is not.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys

import pipeline

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "tests" / "support"))
from open_scenes import Scene, boxes  # noqa: E402

HOUSE = TOP.parent / "shared/scenes/gen/ground_house.py"
SIZE = "96x54"


def two_rooms(path, ratio):
    """A dark room, lit by a lamp of 1 cd, beside one lit by a lamp of `ratio` cd; a wall of .1 m between them."""
    scene = Scene()
    white, red = (scene.material(colour, one_sided=True, specular=1.0) for colour in (0.8, (0.7, 0.3, 0.2)))
    boxes(scene, white, [((x - .05, -.2, -1.6), (x + .05, 2.7, 1.6)) for x in (-2.05, 0, 2.05)] +
          [((-2.1, -.2, z - .05), (2.1, 2.7, z + .05)) for z in (-1.55, 1.55)] +
          [((-2.1, y - .1, -1.6), (2.1, y + .1, 1.6)) for y in (-.1, 2.6)])
    boxes(scene, red, [((-1.5, 0, -.9), (-.9, .6, -.3))])
    scene.point_light((-1, 2.1, .2), 1)
    scene.point_light((1, 2.1, .2), ratio)
    scene.camera((-.2, 1.4, 1.3), (-1.4, .9, -.8), fov=1.1)
    scene.save(path)


def run(*words, **more):
    return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True, **more)


def reference(binaries, scene, out, spp):
    """Path tracing; made once."""
    file = out / (scene.stem + ".exr")
    if not file.exists():
        run(binaries / "frame-render", scene, "--size", SIZE, "--spp", spp, "--channels", "RGBA,indirect", "--seed", 77,
            "-o", file)
    return file


def chain(binaries, scene, out, seed, quality, way):
    """(frame, what was said, CPU seconds)"""
    folder = out / f"{scene.stem}-{quality}-{way}-{seed}"
    shutil.rmtree(folder, ignore_errors=True)
    how = {"auto": {}, "preview": {"METHOD": "preview"}}.get(way, {"INDIRECT": way})
    words = pipeline.command(TOP, binaries, folder, SIZE=SIZE, FRAMES=0, SCENE=scene, QUALITY=quality, FILTER="none",
                             CHANNELS="RGBA,layers", **how)
    said = run(*words, env=pipeline.environment() | {"MEASURE_SEED": str(seed)}).stderr
    return pipeline.frame_of(folder, 0), said, sum(pipeline.cpu_of(folder).values())


def bias(binaries, frame, right):
    """Of layer indirect: (frame - right) / right in percent, and its standard error over pixels."""
    text = run(binaries / "aqm-compare", frame, right, "--layer", "indirect", "--allow-stale", "--json", "-").stdout
    total = json.loads(text)["total"]
    return 100 * total["bias"], 100 * total["bias_standard_error"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", required=True, type=pathlib.Path)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--radii", default="10,50,200,1000")
    parser.add_argument("--houses", default="closed,window")
    parser.add_argument("--lamps", default="1")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--qualities", default="draft,final")
    parser.add_argument("--ways", default="auto")
    options = parser.parse_args()
    options.bin, options.out = options.bin.resolve(), options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    for house in options.houses.split(","):
        if house != "rooms" and not HOUSE.exists():
            print(f"ground.py: {house} skipped, no {HOUSE}")
            continue
        for radius in options.radii.split(","):
            for lamp in options.lamps.split(","):
                scene = options.out / f"{house}-{radius}-{lamp}.glb"
                if house == "rooms":
                    two_rooms(scene, float(lamp))
                else:
                    run(sys.executable, HOUSE, scene, radius, 3, lamp, house)
                right = reference(options.bin, scene, options.out, options.spp)
                for quality in options.qualities.split(","):
                    for way in options.ways.split(","):
                        for seed in range(1, options.seeds + 1):
                            frame, said, seconds = chain(options.bin, scene, options.out, seed, quality, way)
                            off, error = bias(options.bin, frame, right)
                            warned = "warned" if "off by" in said else ""
                            print(f"{scene.stem:16} {quality:6} {way:8} seed {seed}: {off:6.1f} +- {error:.1f} %",
                                  f"{seconds:5.1f} CPU s {warned}", flush=True)


if __name__ == "__main__":
    main()

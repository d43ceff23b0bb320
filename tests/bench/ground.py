#!/usr/bin/env python3
"""Light where most of it lands out of sight: a lit house on a wide ground, and a dark room beside a bright one.

    ground.py --bin BIN --out DIR [--houses closed,window] [--radii 10,200] [--seeds 2] [--qualities draft,final]
              [--ways auto,gather] [--lamps 1]
    ground.py --bin BIN --out DIR --houses rooms --radii 0 --lamps 10,1000,100000     (lamp of the bright room over that of the dark one)

Prints the bias of layer indirect in percent of the layer, with its standard error over pixels, beside path tracing, and
the CPU seconds of the chain. Needs the scene generator ../shared/scenes/gen/ground_house.py, else says so.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
HOUSE = TOP.parent / "shared/scenes/gen/ground_house.py"
SIZE = "96x54"


def two_rooms(path, ratio):
    """A dark room, lit by a lamp of 1 cd, beside one lit by a lamp of `ratio` cd; a wall of .1 m between them."""
    sys.path.insert(0, str(HOUSE.parent))
    import g as scenes
    file = scenes.G()
    white = file.mat((.8, .8, .8))
    slab = lambda centre, half: file.prim(**scenes.box(centre, half), mat=white)
    parts = [slab((x, 1.25, z), (hx, 1.45, hz)) for x, z, hx, hz in
             ((-2.05, 0, .05, 1.6), (0, 0, .05, 1.6), (2.05, 0, .05, 1.6), (0, -1.55, 2.1, .05), (0, 1.55, 2.1, .05))]
    parts += [slab((0, y, 0), (2.1, .1, 1.6)) for y in (-.1, 2.6)]
    file.node(mesh=file.mesh(*parts))
    file.node(mesh=file.mesh(file.prim(**scenes.box((-1.2, .3, -.6), (.3, .3, .3)), mat=file.mat((.7, .3, .2)))))
    file.lnode(file.light(type="point", intensity=1.0), translation=[-1, 2.1, .2])
    file.lnode(file.light(type="point", intensity=ratio), translation=[1, 2.1, .2])
    file.cam((-.2, 1.4, 1.3), (-1.4, .9, -.8), 1.1)
    file.save(str(path))


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
    folder = out / f"{scene.stem}-{quality}-{way}-{seed}"
    run("rm", "-rf", folder)
    environment = dict(os.environ, MEASURE_SEED=str(seed))
    words = ["make", "-s", "-f", TOP / "Makefile.example", f"BIN={binaries}", f"OUT={folder}", f"SIZE={SIZE}", "FRAMES=0",
             f"SCENE={scene}", f"QUALITY={quality}", "FILTER=none", "CHANNELS=RGBA,layers"]
    if way == "preview":
        words += ["METHOD=preview"]
    elif way != "auto":
        words += [f"INDIRECT={way}"]
    said = run(*words, env=environment).stderr
    seconds = sum(json.loads(f.read_text()).get("cpu_s", 0) for f in folder.rglob("*.json")
                  if f.name != "plan.json" and f.read_text().startswith("{") and "cpu_s" in f.read_text())
    return folder / "frames/0000.exr", said, seconds


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
    if not HOUSE.exists():
        print("ground.py: skipped, no", HOUSE)
        return
    options.out.mkdir(parents=True, exist_ok=True)
    for house in options.houses.split(","):
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
                            print(f"{scene.stem:16} {quality:6} {way:8} seed {seed}: {off:6.1f} +- {error:.1f} % {seconds:5.1f} CPU s {warned}",
                                  flush=True)


if __name__ == "__main__":
    main()

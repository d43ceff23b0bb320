#!/usr/bin/env python3
"""Light of each object by Cycles' path tracer over that by ours, neither denoised: python3 -B tests/bench/peer_objects.py BIN OUT SCENE [...]

BIN is the folder with the tools, OUT a folder for pictures. Needs Cycles (make -f Makefile.example peers). Objects are compared by the
mean of the pixels whose four neighbours show the same object, in frames of two seeds a side; the error is the difference of these two.
Both trace paths: what mirrors and glass send from lamps without size is in neither picture.

--only world, area or spot keeps one kind of light (area: emitting surfaces) and takes out what the two define differently: sheen, panes
(smooth glass with a volume), the faces behind one-sided lamps, which Cycles' lamps light, and the fall-off between a spot's two cones.
"""
import argparse
import json
import statistics
import struct
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr  # noqa: E402
from cycles import inner_pixels, object_names  # noqa: E402
from peer_renderers import Peer  # noqa: E402


def means(ids, width, planes):
    """{object: (pixels, mean of each plane)}"""
    return {
        number: (len(places), [statistics.fmean(plane[n] for n in places) for plane in planes])
        for number, places in inner_pixels(ids, width).items()
    }


def alike(scene, only, out):
    """Writes the file --only names; scene is a .glb."""
    data = scene.read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    document, rest = json.loads(data[20:20 + size]), data[20 + size:]
    panes = set()
    for number, material in enumerate(document["materials"]):
        extensions = material.get("extensions", {})
        material["doubleSided"] = True
        extensions.pop("KHR_materials_sheen", None)
        if "KHR_materials_volume" in extensions and not material.get("pbrMetallicRoughness", {}).get("roughnessFactor", 1):
            panes.add(number)
        if only != "area":
            material.pop("emissiveFactor", None)
    for node in document["nodes"]:
        if "mesh" in node and any(part.get("material") in panes for part in document["meshes"][node["mesh"]]["primitives"]):
            del node["mesh"]
    for light in document.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", []):
        if only != light["type"]:
            light["intensity"] = 0
        if "spot" in light:
            light["spot"]["innerConeAngle"] = light["spot"]["outerConeAngle"] - 1e-6
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    out.write_bytes(struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)) + struct.pack("<I4s", len(text), b"JSON") + text + rest)
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("scene", type=lambda p: Path(p).resolve())
    parser.add_argument("--frame", type=int, default=0)
    parser.add_argument("--size", default="160x90")
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--camera", default=None)
    parser.add_argument("--light-units", default="spec")
    parser.add_argument("--world", type=lambda p: Path(p).resolve())
    parser.add_argument("--sky", help="R,G,B")
    parser.add_argument("--least", type=int, default=20, help="pixels of an object that is shown")
    parser.add_argument("--only", choices=("world", "area", "spot"))
    parser.add_argument("--theirs", type=lambda p: Path(p).resolve(), help="another file for Cycles, with the same objects: to try a cause")
    wish = parser.parse_args()
    wish.out.mkdir(parents=True, exist_ok=True)
    if wish.only:
        wish.scene = alike(wish.scene, wish.only, wish.out.resolve() / f"{wish.only}.glb")
    (wish.out / "tmp").mkdir(exist_ok=True)
    bench = SimpleNamespace(project=Path(__file__).resolve().parents[2], out=wish.out.resolve())
    cycles = Peer(bench, "cycles", {"scene": str(wish.theirs or wish.scene), "size": wish.size, "light_units": wish.light_units, "camera": wish.camera,
                                    "world": str(wish.world) if wish.world else None,
                                    "sky": [float(v) for v in wish.sky.split(",")] if wish.sky else None})
    sky = ["--environment", wish.world or wish.sky] if wish.world or wish.sky else []
    camera = ["--camera", wish.camera] if wish.camera else []
    runs, names = {"ours": [], "Cycles": []}, {}
    for seed in (1, 2):
        ours, theirs = bench.out / f"ours{seed}.exr", bench.out / f"cycles{seed}.exr"
        subprocess.run([wish.bin / "frame-render", wish.scene, "--frame", str(wish.frame), "--size", wish.size, "--integrator", "path", "--spp", str(wish.spp),
                        "--pixel-error", "0", "--channels", "RGBA,id", "--light-units", wish.light_units, *camera, *sky, "--seed", str(seed), "-q", "-o", ours], check=True)
        cycles.ask({"frame": wish.frame, "samples": wish.spp, "seed": seed, "denoise": False, "output": str(theirs)})
        picture = exr.read(ours)
        ids = picture.channels["id.object"]
        names = object_names(picture)
        for side, file in (("ours", ours), ("Cycles", theirs)):
            channels = exr.read(file).channels
            runs[side].append(means(ids, picture.width, [channels[c] for c in "RGB"]))
    cycles.close()
    print(f"{'object':32} pixels   Cycles / ours - 1, percent: R G B   error")
    for number, (pixels, _) in sorted(runs["ours"][0].items(), key=lambda item: -item[1][0]):
        if pixels < wish.least:
            continue
        sums = {side: [[run[number][1][c] for c in range(3)] for run in both] for side, both in runs.items()}
        ratios = [100 * (sum(run[c] for run in sums["Cycles"]) / max(sum(run[c] for run in sums["ours"]), 1e-30) - 1) for c in range(3)]
        errors = [100 * sum(abs(both[0][c] - both[1][c]) / max(both[0][c] + both[1][c], 1e-30) for both in sums.values()) for c in range(3)]
        print(f"{names.get(str(number), number):32} {pixels:6}   {' '.join(f'{v:+6.1f}' for v in ratios)}   {max(errors):.1f}")


if __name__ == "__main__":
    main()

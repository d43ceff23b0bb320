#!/usr/bin/env python3
"""How near is scene-plan --estimate? Runs the pipeline on a few frames and compares processor seconds and bytes.

    python3 tests/bench/estimate.py --bin build/release/bin [--sizes 320x180,640x360] SCENE:FRAMES...

Prints one line for each scene and size: predicted, measured, and their ratio.
"""
import argparse
import glob
import json
import os
import shutil
import subprocess
import tempfile

parser = argparse.ArgumentParser()
parser.add_argument("--bin", required=True)
parser.add_argument("--sizes", default="320x180,640x360")
parser.add_argument("cases", nargs="+")
args = parser.parse_args()
tools = os.path.abspath(args.bin)

print("| scene | frames | size | CPU s predicted | measured | ratio | MB predicted | measured | ratio |\n|" + "---|" * 9, flush=True)
for case in args.cases:
    scene, _, frames = case.partition(":")
    for size in args.sizes.split(","):
        estimate = json.loads(subprocess.run(
            [f"{tools}/scene-plan", scene, "--frames", frames, "--estimate", "--json", "--quiet", "--photon-options",
             "--photons 200k", "--frame-options", f"--size {size} --channels RGBA,Z,N,id"],
            check=True, stdout=subprocess.PIPE).stdout)
        out = tempfile.mkdtemp()
        before = os.times()
        subprocess.run(["make", "-s", "-f", "Makefile.example", "demo", f"BIN={tools}", f"OUT={out}", f"SCENE={scene}",
                        f"FRAMES={frames}", f"SIZE={size}"], check=True, stdout=subprocess.DEVNULL)
        after = os.times()
        cpu = (after.children_user - before.children_user) + (after.children_system - before.children_system)
        files = [f for kind in ("photons/*.photons", "points/*.irradpoints", "cache/*.irradcache", "frames/*")
                 for f in glob.glob(f"{out}/{kind}") if not f.endswith(".json")]
        size_mb = sum(os.path.getsize(f) for f in files) / 1e6
        shutil.rmtree(out)
        print(f"| {os.path.basename(scene)} | {frames} | {size} | {estimate['cpu_s']:.1f} | {cpu:.1f} | "
              f"{estimate['cpu_s'] / cpu:.2f} | {estimate['bytes'] / 1e6:.1f} | {size_mb:.1f} | "
              f"{estimate['bytes'] / 1e6 / size_mb:.2f} |", flush=True)

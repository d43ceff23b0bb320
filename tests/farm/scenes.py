#!/usr/bin/env python3
"""48 frames of four scenes by a real Slurm and by one machine: scenes.py BIN --shared FOLDER [--only S2,S4,S5,S6] [--frames 48]

Run at the top of the tree; FOLDER has made/S5_moving_light.glb, S6_smoke.glb and S6_smoke_vdb. For each scene at 64x36, draft: equal digests,
jobs, seconds of `make` alone and of `make slurm` on two nodes of one processor (cluster.sh), and their ratio, at most 4. S2 takes 60 jobs at most.
"""
import argparse
import os
import re
import sys
import tempfile
import time
from pathlib import Path

import slurm

FEW = {"SIZE": "64x36", "QUALITY": "draft", "WAIT": "5"}
RECORDS = FEW | {"INDIRECT": "records"}


def scenes(shared):
    made = shared / "made"
    return {"S2": RECORDS | {"SCENE": "pipelines/scenes/S2_cornell_moving.glb"},
            "S5": RECORDS | {"SCENE": str(made / "S5_moving_light.glb"), "MOVING": "time"},
            "S4": RECORDS | {"SCENE": "pipelines/scenes/S4_atrium.glb", "METHOD": "walkthrough"},
            "S6": FEW | {"SCENE": str(made / "S6_smoke.glb"), "VOLUME": str(made / "S6_smoke_vdb" / "smoke_####.vdb"), "UPDATE": "20%",
                   "VOLUME_OPTIONS": "--volume-frames 0-23"}}


class Whole(slurm.Shot):
    def __init__(self, folder, tools, name, values):
        self.tools, self.name, self.out, self.values = tools, name, folder / name, values | {"BIN": str(tools)}

    def timed(self, out, way=None):
        began = time.monotonic()
        code, text = self.make(out, way)
        if code:
            sys.exit(f"FAILED: {self.name}: {text[-800:]}")
        return time.monotonic() - began, text


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=lambda p: Path(p).resolve())
    parser.add_argument("--shared", type=lambda p: Path(p).resolve(), required=True)
    parser.add_argument("--only", default="")
    parser.add_argument("--frames", type=int, default=48)
    arguments = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory(prefix="farm") as name:
        folder = Path(name)
        os.chmod(folder, 0o755)
        cluster = slurm.Cluster(folder / "cluster")
        try:
            for title, values in scenes(arguments.shared).items():
                if arguments.only and title not in arguments.only.split(","):
                    continue
                shot = Whole(folder, arguments.bin, title, values | {"FRAMES": f"0-{arguments.frames - 1}"})
                alone, said = shot.timed(folder / "alone")
                shot.right = shot.digests(folder / "alone")
                farmed, text = shot.timed(shot.out, "slurm")
                jobs = int(re.search(r"(\d+) jobs to run", text)[1])
                wrong = shot.wrong() + (["more than 60 jobs"] if title == "S2" and jobs > 60 else []) + \
                    (["takes more than 4 times as long"] if farmed > 4 * alone else [])
                cpu = re.search(r"([\d.]+) CPU s in all", said)[1]
                print(f"{'FAILED' if wrong else 'ok'}: {title}: {len(shot.right) - 2} frames, {cpu} CPU s, {jobs} jobs, alone {alone:.0f} s, by Slurm "
                      f"{farmed:.0f} s, ratio {farmed / alone:.2f} {'; '.join(wrong)}", flush=True)
                failed += bool(wrong)
                for out in (folder / "alone", shot.out):
                    slurm.shutil.rmtree(out)
        finally:
            cluster.stop()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

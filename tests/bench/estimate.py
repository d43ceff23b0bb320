#!/usr/bin/env python3
"""How near is `make estimate`? Runs the pipeline on a few frames and compares processor seconds and bytes.

    python3 tests/bench/estimate.py --build build/release SCENE.glb:0-47x8:640x360 ...
"""
import argparse
import shutil
import tempfile
from pathlib import Path

import pipeline
from measure import Bench

def spent(bench, out, **variables):
    """(CPU seconds, bytes) of `make demo`, plan, preview and all."""
    cpu = pipeline.run_make(bench.project, bench.bin, out, **variables)
    return cpu, pipeline.bytes_of(out)


def compared(bench, scene, frames, size):
    """A row, and the two ratios predicted / measured."""
    said = pipeline.estimate(bench.project, bench.bin, SCENE=scene, FRAMES=frames, SIZE=size)
    out = tempfile.mkdtemp()
    try:
        cpu, size_of = spent(bench, out, SCENE=scene, FRAMES=frames, SIZE=size)
    finally:
        shutil.rmtree(out)
    ratios = said["cpu_s"] / cpu, said["bytes"] / size_of
    return [scene.stem, frames, size, f"{said['cpu_s']:.1f}", f"{cpu:.1f}", f"{ratios[0]:.2f}", f"{said['bytes'] / 1e6:.1f}",
            f"{size_of / 1e6:.1f}", f"{ratios[1]:.2f}"], ratios


def main():
    project = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=project / "build" / "release", help="build folder [build/release]")
    parser.add_argument("cases", nargs="+", metavar="SCENE:FRAMES:SIZE")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as out:
        bench = Bench(args.build.resolve(), Path(out), project, False, 0)
        for case in args.cases:
            scene, frames, size = case.rsplit(":", 2)
            print(*compared(bench, Path(scene).resolve(), frames, size)[0], sep="\t", flush=True)


if __name__ == "__main__":
    main()

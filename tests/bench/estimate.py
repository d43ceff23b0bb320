#!/usr/bin/env python3
"""How near is `make estimate`? Runs the pipeline on a few frames and compares processor seconds, bytes on the disk and memory.

    python3 tests/bench/estimate.py --build build/release SCENE.glb:0-47x8:640x360[:VARIABLE=VALUE...] ...

A line for each case: scene, frames, size, then estimated, measured and their ratio of: CPU seconds; MB of the plan's files; MB that OUT held
at most while make ran; MB of memory of the largest command.
"""
import argparse
import shutil
import tempfile
import threading
from pathlib import Path

import pipeline
from measure import Bench


def size_of(folder):
    """Bytes of all files in it now."""
    sizes = 0
    for file in Path(folder).rglob("*"):
        try:
            sizes += file.stat().st_size if file.is_file() else 0
        except OSError:   # removed meanwhile
            pass
    return sizes


class Watch:
    """The most bytes that a folder holds while the block runs, looked at ten times a second."""

    def __init__(self, folder):
        self.folder, self.most, self.ended = folder, 0, threading.Event()

    def look(self):
        while not self.ended.wait(.1):
            self.most = max(self.most, size_of(self.folder))

    def __enter__(self):
        self.thread = threading.Thread(target=self.look)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.thread.join()


def spent(bench, out, **variables):
    """(CPU seconds, bytes of the plan's files, most bytes in OUT, memory) of `make demo`, plan, preview and all."""
    with Watch(out) as disk:
        cpu = pipeline.run_make(bench.project, bench.bin, out, **variables)
    stats = pipeline.stats_in(out, *pipeline.folders_of(out))
    return cpu, pipeline.bytes_of(out), disk.most, max(s["peak_memory_bytes"] for s in stats)


def compared(bench, scene, frames, size, **more):
    """A row, and the ratios estimated / measured."""
    said = pipeline.estimate(bench.project, bench.bin, SCENE=scene, FRAMES=frames, SIZE=size, **more)
    out = tempfile.mkdtemp()
    try:
        cpu, files, disk, memory = spent(bench, out, SCENE=scene, FRAMES=frames, SIZE=size, **more)
    finally:
        shutil.rmtree(out)
    pairs = ((said["cpu_s"], cpu), (said["bytes"] / 1e6, files / 1e6), (said["disk"] / 1e6, disk / 1e6), (said["memory"] / 1e6, memory / 1e6))
    return [scene.stem, frames, size, *(f"{a:.1f} {b:.1f} {a / b:.2f}" for a, b in pairs)], [a / b for a, b in pairs]


def main():
    project = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=project / "build" / "release", help="build folder [build/release]")
    parser.add_argument("cases", nargs="+", metavar="SCENE:FRAMES:SIZE[:VARIABLE=VALUE...]")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as out:
        bench = Bench(args.build.resolve(), Path(out), project, False, 0)
        for case in args.cases:
            scene, frames, size, *more = case.split(":")
            print(*compared(bench, Path(scene).resolve(), frames, size, **dict(word.split("=", 1) for word in more))[0], sep="\t", flush=True)


if __name__ == "__main__":
    main()

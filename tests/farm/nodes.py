#!/usr/bin/env python3
"""Is the forecast right? One node and two by a real Slurm: nodes.py BIN [--frames 24] [--size 160x90] [--times 3] [--only S2,S4]

Run at the top of the tree; BIN is the folder with the tools. `make estimate NODES=1,2 CORES=1 THREADS=1`, then `make slurm` on nodes of one
processor (cluster.sh), the second one drained for one node. Prints seconds: forecast, the median and the range of several; measured; measured
divided by how much longer than their CPU seconds the commands took, because others worked on the machine. A forecast adds nothing for Slurm.
"""
import argparse
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import slurm
from scenes import Whole, scenes

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bench"))
import pipeline                                                                      # noqa: E402

NODES = 1, 2


def forecasts(shot):
    """Seconds and jobs by number of nodes."""
    command = shot.command(shot.out, NODES=",".join(map(str, NODES)), CORES=1, THREADS=1)
    command[command.index("demo")] = "estimate"
    said = subprocess.run(command, capture_output=True, text=True, check=True, env=pipeline.environment()).stdout
    return {int(n): (float(seconds), int(jobs)) for jobs, n, seconds in re.findall(r"^(\d+) jobs on (\d+) x 1 .*: (\S+) s,", said, re.M)}


def measured(shot, cluster, nodes):
    """Seconds of make slurm, CPU seconds of its commands, and how much longer the commands took."""
    cluster.mend()
    if nodes == 1:
        slurm.slurm("scontrol", "update", "nodename=n2", "state=drain", "reason=one")
    shutil.rmtree(shot.out, ignore_errors=True)
    began = time.monotonic()
    code, text = shot.make(shot.out, "slurm")
    seconds = time.monotonic() - began
    if code:
        sys.exit(f"FAILED: {shot.name} on {nodes}: {text[-800:]}")
    stats = pipeline.stats_of(shot.out)
    cpu = sum(of["cpu_s"] for of in stats)
    return seconds, cpu, sum(of["wall_s"] for of in stats) / cpu


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=lambda p: Path(p).resolve())
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--size", default="160x90")
    parser.add_argument("--times", type=int, default=3)
    parser.add_argument("--only", default="S2,S4")
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))   # the daemons end, too
    with tempfile.TemporaryDirectory(prefix="farm") as name:
        folder = Path(name)
        os.chmod(folder, 0o755)
        cluster = slurm.Cluster(folder / "cluster")
        try:
            for title, values in scenes(Path("none")).items():
                if title not in arguments.only.split(","):
                    continue
                shot = Whole(folder, arguments.bin, title, values | {"FRAMES": f"0-{arguments.frames - 1}", "SIZE": arguments.size})
                said = [forecasts(shot) for _ in range(arguments.times)]
                for nodes in NODES * arguments.times:
                    seconds, cpu, longer = measured(shot, cluster, nodes)
                    forecast = sorted(of[nodes][0] for of in said)
                    middle = statistics.median(forecast)
                    print(f"{title}, {nodes} x 1: {said[0][nodes][1]} jobs, forecast {middle:.1f} ({forecast[0]:.1f} to {forecast[-1]:.1f}) s, measured "
                          f"{seconds:.1f} s, commands took {longer:.2f} times their {cpu:.1f} CPU s: {seconds / longer:.1f} s, ratio to the forecast "
                          f"{seconds / longer / middle:.2f}", flush=True)
        finally:
            cluster.stop()
    return 0


if __name__ == "__main__":
    sys.exit(main())

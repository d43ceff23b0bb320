"""Two threads against one: elapsed time of the parallel phases, and what one thread does alone. Functions as in required.py."""
import os
from pathlib import Path

from measure import figure, median, percent, quantity, wait_for_quiet


def compared(bench, tools, rounds):
    """Rows, and whether every ratio is enough."""
    rows, met = [], True
    for title, command in tools:
        speed, work, seconds, alone = [], [], {1: [], 2: []}, []
        for _ in range(rounds):
            wall, cpu = {}, {}
            for count in (1, 2):
                stats = bench.tool(*command, "--threads", count)
                phases = [p for p in stats["phases"] if p["parallel"]]
                wall[count], cpu[count] = (sum(p[kind] for p in phases) for kind in ("wall_s", "cpu_s"))
                seconds[count].append(wall[count])
            speed.append(wall[1] / wall[2])
            work.append(cpu[2] / cpu[1])
            alone.append(1 - wall[2] / stats["wall_s"])
        met = met and median(speed) >= 1.8
        rows.append([title, quantity(median(seconds[1])), quantity(median(seconds[2])), quantity(median(speed)),
                     f"{median(work):.3f}", percent(median(alone), 1)])
    return rows, met


def threads(bench):
    """Wall time of the parallel phases with one thread and with two."""
    scene, frame = bench.scene("S2")
    base = f"{bench.memory}/tempolux-bench-{os.getpid()}"
    photon_map, points, cache, image = (f"{base}.{end}" for end in ("photons", "irradpoints", "irradcache", "exr"))
    photons = 20000 if bench.tiny else 2 * 10**6
    render = ["frame-render", scene, "--frame", frame, "--size", bench.size, "-o", image]
    tools = [("photon-trace", ["photon-trace", scene, "--frame", frame, "--photons", photons, "-o", photon_map]),
             ("irradcache-build points", ["irradcache-build", "points", scene, "--frame", frame, "--photons", photon_map,
                                          *(["--point-count", "2k"] if bench.tiny else []), "-o", points]),
             ("irradcache-build records", ["irradcache-build", "records", scene, "--frame", frame, "--points", points, "--size",
                                           bench.size, "-o", cache]),
             ("frame-render, cache", [*render, "--irradcache", cache, "--points", points]),
             ("frame-render, photons", [*render, "--photons", photon_map, "--spp", 16]),
             ("frame-render, path", [*render, "--integrator", "path", "--spp", 16])]
    quiet = bench.tiny or wait_for_quiet(120)
    load = os.getloadavg()[0]
    try:
        rows, met = compared(bench, tools, bench.rounds)
    finally:
        for file in Path(base).parent.glob(Path(base).name + ".*"):
            file.unlink()
    notes = [f"Load average before: {load:.1f}. Other phases: opening the scene, reading and writing files; the tree and the "
             "compression of frames use all threads too."]
    if not quiet:
        notes.append("Others were using the processors: wall times say little here, run it again on a quiet machine.")
    return figure("Two threads against one, parallel phases", "1.8x in wall time",
                  ["", "1 thread, wall s", "2 threads, wall s", "ratio", "CPU s of 2 threads / 1",
                   "other phases, share of elapsed time with 2 threads"], rows,
                  met if quiet and not bench.tiny else None, notes)

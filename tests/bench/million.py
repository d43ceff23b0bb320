"""What opening a large scene costs: the tools on a hall of a million triangles (wavy.py), and the share of opening scenes
and of writing files in the pipeline.

Functions as in required.py.
"""
import json
import os
import shutil
import tempfile
from pathlib import Path

import pipeline
import wavy
from measure import Missing, figure, median, percent, quantity

LOADING = ("load", "evaluate", "build", "plan")     # formats/stats/stats.md
WRITING = ("write", "commit")
DRAFT = {"points": ("--point-count", "10k", "--light-samples", 2), "records": ("--rays", 150, "--error-bound", 0.3)}


def scene(bench):
    """(file, triangles), made once."""
    triangles = 5000 if bench.tiny else 10**6
    file, count = bench.out / "tmp" / f"wavy-{triangles}.glb", bench.out / "tmp" / f"wavy-{triangles}.json"
    maker = Path(wavy.__file__)
    if not count.exists() or count.stat().st_mtime < maker.stat().st_mtime:
        count.write_text(json.dumps(wavy.make(file, triangles)))
    return file, json.loads(count.read_text())


def cpu(stats, names):
    return sum(p["cpu_s"] for p in stats["phases"] if p["name"] in names)


def wall(stats, names):
    return sum(p["wall_s"] for p in stats["phases"] if p["name"] in names)


def processes(bench, file, size, base):
    """(title, command) of all that open a scene; each reads what those before it wrote."""
    common, photons = [file, "--frame", 10], 20000 if bench.tiny else 200000
    photon_map, points, cache, image = (f"{base}.{end}" for end in ("photons", "irradpoints", "irradcache", "exr"))
    render = ["frame-render", *common, "--size", size, "-o", image]
    return [("scene-plan", ["scene-plan", file, "--frames", "0-47", "-o", f"{base}.plan"]),
            ("photon-trace", ["photon-trace", *common, "--photons", photons, "-o", photon_map]),
            ("irradcache-build points", ["irradcache-build", "points", *common, "--photons", photon_map, *DRAFT["points"],
                                         "-o", points]),
            ("irradcache-build records", ["irradcache-build", "records", *common, "--points", points, "--size", size,
                                          *DRAFT["records"], "-o", cache]),
            ("frame-render, cache", [*render, "--irradcache", cache, "--points", points, "--spp", 2, "--pixel-error", 0.05]),
            ("frame-render, photons", [*render, "--photons", photon_map, "--spp", 2, "--pixel-error", 0]),
            ("frame-render, path", [*render, "--integrator", "path", "--spp", 2])]


def remove(base):
    for file in Path(base).parent.glob(Path(base).name + ".*"):
        shutil.rmtree(file) if file.is_dir() else file.unlink()


def million(bench, _):
    """A million triangles at 960x540: CPU seconds of each process until it can trace rays."""
    file, triangles = scene(bench)
    size = "96x54" if bench.tiny else "960x540"
    base = bench.memory / f"tempolux-bench-{os.getpid()}"
    rows, worst = [], 0

    def row(title, command, frames=1):
        runs = [bench.tool(*command) for _ in range(1 if bench.tiny else 3)]
        loading = median([cpu(run, LOADING) for run in runs]) / frames
        rows.append([title, quantity(median([run["cpu_s"] for run in runs]) / frames),
                     *(quantity(median([cpu(run, [name]) for run in runs]) / frames) for name in ("load", "evaluate", "build")),
                     quantity(loading), str(max(run["peak_memory_bytes"] for run in runs) >> 20)])
        return loading

    try:
        made = processes(bench, file, size, base)
        for title, command in made:
            worst = max(worst, row(title, command))
        photons = made[1][1]
        row("photon-trace --frames 4-11, per frame",
            [photons[0], file, "--frames", "4-11", *photons[4:-1], f"{base}.####.photons"], frames=8)
    finally:
        remove(base)
    return figure(f"A hall of {triangles} triangles, {size}", "loading and building the tree below 1.5 normalised CPU s per process",
                  ["process", "CPU s", "load", "evaluate", "build", "loading in all (with scene-plan's plan)", "peak memory, MiB"],
                  rows, None if bench.tiny else bench.normalised(worst) < 1.5,
                  [f"Draft settings, medians of 3, two threads; the file has {file.stat().st_size / 1e6:.0f} MB. A quarter of "
                   "the triangles moves: the ball."])


def by_stage(bench, file, frames, size, out):
    """Statistics by part of the work of `make demo` on some frames."""
    small = {"QUALITY": "draft", "PHOTONS": "5k"} if bench.tiny else {}
    pipeline.run_make(bench.project, bench.bin, out, SCENE=file, FRAMES=frames, SIZE=size, **small)
    return {stage: pipeline.stats_of(out, (stage,)) for stage in pipeline.STAGES}


def loading(bench, _):
    """Opening the scene, and writing files, as shares of the pipeline over the demo's 48 frames."""
    size, last, step = ("48x28", 1, 1) if bench.tiny else ("960x540", 47, 23)
    cases, rows, notes, met = [("hall", scene(bench)[0], size)], [], [], True
    try:
        cases.append(("S4", bench.scene("S4")[0], "48x28" if bench.tiny else "640x360"))
    except Missing as reason:
        notes.append(f"S4 left out: {reason}")
    for name, file, size in cases:
        out = tempfile.mkdtemp(dir=bench.memory)
        try:
            all_frames = bench.tool("scene-plan", file, "--frames", f"0-{last}", "--size", size, "-o", f"{out}/whole")
            many = pipeline.count_of(f"{out}/whole")
            runs = by_stage(bench, file, f"0-{last}x{step}", size, out)
        finally:
            shutil.rmtree(out)
        opened, spent = cpu(all_frames, LOADING), all_frames["cpu_s"]
        for stage, stats in runs.items():
            if not stats:       # a scene without light that scatters
                continue
            mean = [sum(f(s) for s in stats) / len(stats) for f in (lambda s: cpu(s, LOADING), lambda s: s["cpu_s"])]
            opened, spent = opened + many[stage] * mean[0], spent + many[stage] * mean[1]
            writing = median([wall(s, WRITING) / s["wall_s"] for s in stats])
            rows.append([name, stage, many[stage], quantity(mean[1]), quantity(mean[0]), percent(mean[0] / mean[1], 1),
                         percent(writing, 1)])
        rows.append([name, "all, scene-plan too", "", quantity(spent), quantity(opened), percent(opened / spent, 1), ""])
        met = met and opened / spent < 0.1
    return figure("Opening the scene, over the demo's 48 frames", "below 10 % of the pipeline's CPU seconds",
                  ["scene", "stage", "processes", "CPU s of one", "opening the scene", "share",
                   "writing its file, share of elapsed time"],
                  rows, None if bench.tiny else met,
                  [*notes, f"Makefile.example as it stands, the hall at 960x540, S4 at 640x360; measured on frames 0-{last}x{step}, "
                   f"as many processes as the plan of 0-{last} has. A stage started once with `--frames 0-{last}` opens the scene "
                   "once.", "photon-trace writes while it traces: what is left at the end is fsync and rename. Frames are "
                   "compressed by all threads, the bytes the same for any number of them."])


FIGURES = {"million": million, "loading": loading}

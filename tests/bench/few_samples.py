"""Curves of what takes the place of samples: st-filter on few of them, and key frames with warped frames between.

Entries of error-report's manifest, as sweep.py makes them.
"""
import os

import chain
import pipeline
from measure import big

WINDOW = 5
READ = "RGBA,layers,Z,N,id,albedo,motion,coverage,samples"


def run_of(title, curve, x, label, stats, comparison):
    return {"scene": title, "curve": curve, "label": label, "x": x, "parameters": {}, "stats": [str(s) for s in stats],
            "comparison": str(comparison)}


# ---- st-filter: 1 to 16 samples, five frames, beside up to four times as many unfiltered ones

def frames_of_window(bench, name, samples, filtered):
    """Frames around the scene's, each lit by itself, so many samples everywhere; the frame filtered by them or as it is; statistics of one
    frame of a sequence: its light, its samples, its filtering."""
    scene, frame = bench.scene(name)
    settings = chain.Settings(20000 if bench.tiny else 200000, points=("--point-count", "1k") if bench.tiny else ())
    wanted = range(frame - WINDOW // 2, frame + WINDOW // 2 + 1) if filtered else [frame]

    def make(stem):
        files = bench.out / "frames" / stem
        for f in wanted:
            light = {end: bench.out / "frames" / f"{name}-lit-{f}.{end}" for end in ("photons", "irradpoints", "irradcache")}
            if not light["irradcache"].exists():
                bench.run([bench.bin / "photon-trace", scene, f"--frame={f}", "--photons", settings.photons, "--kinds", "caustic,indirect", "-q",
                           "-o", light["photons"], "--stats", light["photons"].with_suffix(".json")])
                bench.run([bench.bin / "irradcache-build", scene, f"--frame={f}", "--photons", light["photons"], *settings.points, "--size", bench.size,
                           "-q", "--keep-points", light["irradpoints"], "-o", light["irradcache"], "--stats", f"{light['irradcache']}.json"])
            bench.run([bench.bin / "frame-render", scene, f"--frame={f}", "--size", bench.size, "--spp", samples, "--pixel-error", 0,
                       "--seed-mode", "frame", "--photons", light["photons"], "--irradcache", light["irradcache"], "--points", light["irradpoints"],
                       "--channels", READ + (",halves,seen" if samples > 1 else ""), "--compression", "none", "-q", "-o", f"{files}.{f}.exr", "--stats", f"{files}.{f}.json"])
        if filtered:
            bench.run([bench.bin / "st-filter", *(f"{files}.{f}.exr" for f in wanted), "-q", "-o", f"{files}.filtered.exr",
                       "--stats", f"{files}.filtered.json"])
    ends = [f".{f}{end}" for f in wanted for end in (".exr", ".json")] + ([".filtered.exr", ".filtered.json"] if filtered else [])
    made = dict(zip(ends, bench.cached("frames", f"{name}-few-{samples}-{'filtered' if filtered else 'plain'}",
                                       [scene, *(bench.bin / t for t in ("photon-trace", "irradcache-build", "frame-render", "st-filter")),
                                        samples, bench.size, settings.text()], ends, make)))
    stats = [bench.out / "frames" / f"{name}-lit-{frame}.json", bench.out / "frames" / f"{name}-lit-{frame}.irradcache.json", made[f".{frame}.json"]]
    return (made[".filtered.exr"], [*stats, made[".filtered.json"]]) if filtered else (made[f".{frame}.exr"], stats)


def filter_runs(bench, name, title, halves):
    samples = [1, 2] if bench.tiny else [1, 2, 4, 8, 16]
    for filtered, curve in ((True, "spatio-temporal filter"), (False, "the same samples, unfiltered")):
        for x in samples if filtered else [4 * s for s in samples]:
            image, stats = frames_of_window(bench, name, x, filtered)
            comparison = image.with_suffix(".error.json")
            bench.compare(image, halves, comparison)
            yield run_of(title, curve, x, big(x), stats, comparison)


# ---- warping: how far apart keys may be, beside every frame traced

def walk_halves(bench, scene, size, judged):
    """Two halves of path tracing of the frames judged. Kept when tools change, as unbiased is unbiased."""
    stem = bench.out / "reference" / f"walk-{size}-{bench.reference_samples}.####.exr"
    halves = [str(stem).replace(".exr", f"_{h}.exr") for h in "ab"]
    if not all(os.path.exists(h.replace("####", f"{f:04d}")) for h in halves for f in judged):
        bench.run([bench.bin / "frame-render", scene, "--frames", ",".join(map(str, judged)), "--size", size, "--integrator", "path", "--halves", "--spp",
                   bench.reference_samples, "--seed", 1000003, "--seed-mode", "frame", "--channels", "RGBA,layers,id", "-q", "-o", stem])
    return halves


def warping_runs(bench):
    """The camera walks through S4: all of Makefile.example's stages; error of every fourth frame, and of the one after it, so that there is flicker.
    Swept: the threshold; beside it so many samples in every pixel of every frame, the filter with other --pixel-error, and the preset."""
    (scene, _), size = bench.scene("S4"), "48x28" if bench.tiny else "320x180"
    last, judged = (4, [2, 3]) if bench.tiny else (16, [2, 3, 6, 7, 10, 11, 14, 15])
    title = f"S4, hall through which the camera walks, {last + 1} frames, {size}"
    halves = walk_halves(bench, scene, size, judged)
    sides = [("warping", x, f"{x:g}", {"METHOD": "walkthrough", "THRESHOLD": x}) for x in ((1e-4, 1e-1) if bench.tiny else (5e-4, 1e-3, 2e-3, 4e-3, 1e-2))]
    sides += [("every frame traced", n, big(n), {"PIXELS": f"--spp {n} --pixel-error 0"}) for n in ((1, 4) if bench.tiny else (1, 2, 4, 8, 16))]
    sides += [("FILTER=5", x, f"{x:g}", {"FILTER": 5, "ERROR": x}) for x in ((0.05,) if bench.tiny else (0.008, 0.016, 0.032))]
    new_noise = " ".join([*pipeline.preset(bench.project)["pixels"], "--seed-mode frame"])
    sides += [] if bench.tiny else [("preset", 1, "every frame", {}), ("preset", 2, "new noise", {"PIXELS": new_noise})]
    for curve, x, label, variables in sides:
        out = bench.out / "frames" / f"walk-{curve.split()[0].replace('=', '')}-{label.replace(' ', '-')}"
        small = {"PHOTONS": "20k", "POINTS": "--point-count 1k", "CACHE": "--rays 40 --error-bound 0.6"} if bench.tiny else {}
        pipeline.run_make(bench.project, bench.bin, out, SCENE=scene, FRAMES=f"0-{last}", SIZE=size, **small, **variables)
        comparison = out / "error.json"
        bench.run([bench.bin / "aqm-compare", pipeline.frame_of(out, "####"), "--reference-halves", *halves, "--frames", ",".join(map(str, judged)), "--json",
                   comparison, "-q", "--allow-stale"])
        yield run_of(title, curve, x, label, pipeline.stats_files(out), comparison)

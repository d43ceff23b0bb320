"""The required figures, one function each: what was measured, as a table, and whether it is enough.

Ratios are of CPU seconds within one run, the sides alternating, medians of the rounds. Each function returns
{"title", "asked", "header", "rows", "met", "notes"}; "met" is None where it cannot be judged.
"""
import json
import math
import os
from pathlib import Path

from cycles import walls
from demo import demo
from two_threads import threads
from measure import Missing, big, figure, median, percent, quantity, timed, wait_for_quiet


def path_tracer(bench):
    """CPU seconds times squared error of our path tracer, over Cycles' of the same samples."""
    rows, notes, judged, peers = [], [], [], json.loads(Path(__file__).with_name("peers.json").read_text())["peers"]
    samples, rounds = (4, 1) if bench.tiny else (64, 5)
    for name in ["S2"] if bench.tiny else ["S2", "S3", "S4"]:
        try:
            scene, frame = bench.scene(name)
            halves = bench.reference_halves(name) if bench.tiny else bench.third_party_halves(name)
        except Missing as reason:
            if name == "S4":
                notes.append(f"{name} left out: {reason}")
                continue
            halves = bench.reference_halves(name)
            notes.append(f"{name} against our own reference: {reason}")
        image = bench.out / "tmp" / "path.exr"
        cpu, mse, error = [], [], []
        for seed in range(1, rounds + 1):
            stats = bench.tool("frame-render", scene, "--frame", frame, "--size", bench.size, "--integrator", "path",
                               "--spp", samples, "--seed", seed, "--channels", "RGBA", "-o", image)
            total = bench.compare(image, halves, bench.out / "tmp" / "path.json")["total"]
            cpu.append(stats["cpu_s"])
            mse.append(total["mse"])
            error.append(total["mse_standard_error"])
        mean = sum(mse) / len(mse)
        peer = next((p for p in peers["Cycles 3.4.1"] if p["scene"] == name and p["samples"] == samples), None)
        ratio = median(cpu) * mean / (peer["cpu_s"] * peer["rmse"] ** 2) if peer else None
        judged.append((name, ratio))
        rows.append([name, samples, quantity(median(cpu)), quantity(math.sqrt(max(0, mean))),
                     quantity(peer["cpu_s"]) if peer else "-", quantity(peer["rmse"]) if peer else "-", quantity(ratio)])
    met = None if bench.tiny else all(ratio <= 1.5 for name, ratio in judged if name in ("S2", "S4"))
    return figure("Path tracer against Cycles", "CPU x MSE at most 1.5x of Cycles' on S2 (S4 too)",
                  ["scene", "samples", "CPU s", "RMSE", "Cycles CPU s", "Cycles RMSE", "CPU x MSE, ours / Cycles"], rows, met,
                  notes + ["MSE: mean over the seeds; CPU: median. Cycles' rows were measured on another day."])


def photon_rate(bench):
    """photon-trace against the bare walk; what recording and the file cost of it."""
    scene, frame = bench.scene("S2")
    photons = 20000 if bench.tiny else 4 * 10**6
    output = bench.memory / f"tempolux-bench-{os.getpid()}.photons"
    common = [scene, "--frame", frame, "--photons", photons, "--threads", 2]
    sides = {"photon-trace": [], "to /dev/null": [], "nothing recorded": [], "bare walk": [],
             "bare walk, robust": []}
    try:
        for _ in range(bench.rounds):
            sides["photon-trace"].append(bench.tool("photon-trace", *common, "-o", output))
            output.unlink()
            sides["to /dev/null"].append(bench.tool("photon-trace", *common, "-o", "/dev/null"))
            sides["nothing recorded"].append(bench.tool("photon-trace", *common, "--kinds", "caustic", "-o", "/dev/null"))
            for side, robust in (("bare walk", "no"), ("bare walk, robust", "yes")):
                sides[side].append(bench.program("bare_walk", scene, "--frame", frame, "--photons", photons,
                                                 "--threads", 2, "--robust", robust))
    finally:
        output.unlink(missing_ok=True)
    cpu = {side: median([run["cpu_s"] for run in runs]) for side, runs in sides.items()}
    ratio = min(median([b["cpu_s"] / p["cpu_s"] for b, p in zip(sides[walk], sides["photon-trace"])])
                for walk in ("bare walk", "bare walk, robust"))
    ours, bare = sides["photon-trace"][0]["counts"], sides["bare walk, robust"][0]
    rows = [[side, quantity(cpu[side]), quantity(photons / cpu[side] / 1e6), quantity(cpu["bare walk, robust"] / cpu[side]),
             quantity(cpu["bare walk"] / cpu[side])] for side in sides]
    rays = (ours["rays"] / ours["paths"], bare["rays"] / bare["photons"])
    notes = [f"{big(photons)} photons on S2, whole process, 2 threads, to {output.parent}. Rays per photon: ours "
             f"{rays[0]:.4f}, bare walk {rays[1]:.4f}; stored photons per CPU s: "
             f"{ours['photons'] / cpu['photon-trace'] / 1e6:.2f} M.",
             "Robust: no ray slips through the edge between two triangles, so that a closed room stays closed, as in "
             "photon-trace; the other is Embree's default. Judged by the faster of the two.",
             f"Share of writing the bytes {percent(1 - cpu['to /dev/null'] / cpu['photon-trace'], 1)}, of recording, "
             f"encoding, checksums and writing {percent(1 - cpu['nothing recorded'] / cpu['photon-trace'], 1)}."]
    same = abs(rays[0] / rays[1] - 1) < 0.01
    return figure("Photon tracing against a bare rtcIntersect1 walk", "at least 0.5 of its photon rate",
                  ["", "CPU s", "M photons per CPU s", "rate / robust bare walk", "rate / bare walk"], rows,
                  None if bench.tiny else ratio >= 0.5 and same, notes)


def nearest(bench):
    """Exact k-nearest against nanoflann, by tests/bench/nearest."""
    found = bench.program("nearest", *(["20000", "2000", "1"] if bench.tiny else ["1000000", "100000", "5"]))
    rows = []
    for key, title in (("k50", "k = 50"), ("k50_bounded", "k = 50, radius bounded"), ("k100", "k = 100"),
                       ("k100_bounded", "k = 100, radius bounded"), ("k50_random_order", "k = 50, queries in random order")):
        case = found[key]
        best = max(case["nanoflann10_mq_per_s"], case["nanoflann32_mq_per_s"])
        rows.append([title, quantity(best), quantity(case["sets_mq_per_s"]), quantity(case["sets_ratio"]),
                     quantity(case.get("sorted_ratio"))])
    met = found["k50"]["sorted_ratio"] >= 1.2 and found["k50_bounded"]["sorted_ratio"] >= 1.6
    return figure("Exact k nearest photons against nanoflann", "1.2x; 1.6x with a radius bound",
                  ["queries", "nanoflann, M per s", "ours, M per s", "ratio", "ratio, results sorted"], rows,
                  None if bench.tiny else met, [f"{found['photons']} photons, {found['queries']} queries in Morton order, one "
                  "thread, CPU time; the better of two leaf sizes of nanoflann."])


def start(bench):
    """--help of every tool, and what it links."""
    rows, met = [], True
    quiet = bench.tiny or wait_for_quiet(60)
    tools = sorted(path for path in bench.bin.iterdir() if os.access(path, os.X_OK) and path.is_file())
    for path in tools:
        times = [timed([path, "--help"]) for _ in range(3 if bench.tiny else 20)]
        linked = bench.run(["ldd", path]).stdout
        heavy = [name for name in ("OpenImageIO", "openvdb") if name in linked]
        wall, cpu = median([t[0] for t in times]), median([t[1] for t in times])
        met = met and wall < 0.02 and not heavy
        rows.append([path.name, f"{1e3 * wall:.1f}", f"{1e3 * cpu:.1f}", ", ".join(heavy) or "neither"])
    return figure("Start of every tool", "`--help` below 20 ms; neither OpenImageIO nor OpenVDB linked",
                  ["tool", "wall ms", "CPU ms", "OpenImageIO, OpenVDB"], rows, met,
                  ["Medians of 20; judged by elapsed time."] + ([] if quiet else ["Others were using the processors."]))


def reading(bench):
    """Reading and writing a .photons file, by tests/bench/photons_io."""
    found = bench.program("photons_io", "--photons", 20000 if bench.tiny else 4000000, "--file",
                          bench.memory / f"tempolux-bench-{os.getpid()}.photons")
    rows = [[what, quantity(found[f"{kind}_gb_per_s"]), quantity(found[f"raw_{kind}_gb_per_s"]), quantity(found[f"{kind}_ratio"])]
            for what, kind in (("reading", "read"), ("writing", "write"))]
    return figure("A .photons file against its bytes", "reading at least 0.5 of read() into fresh memory",
                  ["", "GB/s", "bare bytes, GB/s", "ratio"], rows, None if bench.tiny else found["read_ratio"] >= 0.5,
                  [f"{found['photons']} photons, one thread, CPU time, checksums verified; "
                   f"checksum alone {found['crc_folded_gb_per_s']:.0f} GB/s."])


FIGURES = {"path-tracer": path_tracer, "photon-rate": photon_rate, "nearest": nearest, "threads": threads, "start": start,
           "reading": reading, "demo": demo, "walls": walls}

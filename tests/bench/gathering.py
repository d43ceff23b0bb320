"""The required figures of the gathering chain: photon-trace, irradcache-build, frame-render --irradcache.

Functions as in required.py. Errors are of linear radiance against two independent path-traced halves, whose noise is
taken out; costs are CPU seconds of all processes.
"""
import json
import math

import atrium
import chain
from chain import Settings
from measure import big, figure, median, percent, quantity
from shipped import preset

SEEDS = 8


def seeds(bench):
    return range(1, 2 if bench.tiny else SEEDS + 1)


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def standard_error(values):
    """Of the mean; 0 of a single value."""
    n = len(values)
    return math.sqrt(sum((v - mean(values)) ** 2 for v in values) / (n - 1) / n) if n > 1 else 0.0


def noise_of_halves(bench, halves, layer):
    """Standard error of the mean of the halves, relative to it: of the image (key None) and of each object."""
    output = bench.out / "tmp" / "halves.json"
    bench.run([bench.bin / "aqm-compare", *halves, "--halves", "--layer", layer, "--json", output, "-q"])
    total = json.loads(output.read_text())["total"]
    return {None: (total["bias_standard_error"] or 0) / 2} | {
        o["id"]: (o["bias_standard_error"] or 0) / 2 for o in total["objects"]}


def quality_of(bench, name, settings, size):
    """relMSE, bias and bias by object of the indirect layer over the seeds."""
    # S3 is dark: two halves of 512 samples leave 2e-4 of doubt in relMSE, of 2048 a quarter of it (half an hour, once).
    halves = bench.reference_halves(name, size, int(bench.reference_samples * (2 if name == "S3" else 1 / 8)))
    # What relMSE divides by: the same picture with little noise, from more photons and rays and a seed of its own.
    smooth, _ = chain.frame(bench, name, 1009, Settings(5 * settings.photons, (), ("--rays", 2000)), size)
    noise = noise_of_halves(bench, halves, "indirect")
    totals, cost = [], []
    for seed in seeds(bench):
        image, cpu = preset(bench, name, seed, size)
        cost.append(cpu)
        totals.append(bench.compare(image, halves, image.with_name(image.stem + "-indirect.json"), "indirect",
                                    "--relative-to", smooth)["total"])
    objects = []
    for o in totals[0]["objects"]:
        values = [next(p["bias"] for p in t["objects"] if p["id"] == o["id"]) for t in totals]
        if all(v is not None for v in values):
            objects.append({"id": o["id"], "pixels": o["pixels"], "bias": mean(values),
                            "error": math.hypot(standard_error(values), noise[o["id"]]),
                            "share": mean(next(p["share_of_squared_error"] for p in t["objects"] if p["id"] == o["id"])
                                          for t in totals)})
    biases = [t["bias"] for t in totals]
    return {"cpu": median(cost), "rmse": math.sqrt(max(0, mean(t["mse"] for t in totals))),
            "relmse": mean(t["relmse"] for t in totals), "bias": mean(biases),
            "relmse_error": math.hypot(standard_error([t["relmse"] for t in totals]), totals[0]["relmse_standard_error"]),
            "bias_error": math.hypot(standard_error(biases), noise[None]),
            "scatter": standard_error(biases) * math.sqrt(len(biases)),
            "objects": sorted(objects, key=lambda o: -abs(o["bias"]))}


def gather_quality(bench, _):
    """Indirect light of the default final settings at 640x360."""
    settings, rows, more, met, notes = chain.final(bench.project), [], [], True, []
    size = "64x36" if bench.tiny else "640x360"
    for name in ["S1"] if bench.tiny else ["S1", "S2", "S3"]:
        q = quality_of(bench, name, settings, size)
        # Objects of 100 pixels are judged, and smaller ones that are known to a third of 2 % or are beyond it by more
        # than two standard errors.
        settled = [o for o in q["objects"] if o["pixels"] >= 100 or o["error"] <= 0.02 / 3
                   or abs(o["bias"]) - 2 * o["error"] > 0.02]
        unsettled = [f"{o['id']} ({o['pixels']} pixels)" for o in q["objects"] if o not in settled]
        worst = settled[0] if settled else {"id": "-", "bias": 0.0, "error": 0.0}
        met = met and q["relmse"] <= 5e-4 and abs(q["bias"]) <= 0.003 and abs(worst["bias"]) <= 0.02
        rows.append([name, quantity(q["cpu"]), quantity(q["rmse"]), f"{q['relmse']:.2e} +- {q['relmse_error']:.0e}",
                     f"{percent(q['bias'])} +- {percent(q['bias_error'])}", percent(q["scatter"]),
                     f"{percent(worst['bias'])} +- {percent(worst['error'])} (id {worst['id']})"])
        more += [[name, o["id"], o["pixels"], percent(o["bias"]), percent(o["error"]), percent(o["share"], 1)]
                 for o in q["objects"]]
        if unsettled:
            notes.append(f"{name}: objects below 100 pixels whose bias is known to worse than a third of 2 % and may be below it: "
                         f"{', '.join(unsettled)}.")
    found = figure("Indirect light of a final frame, 640x360",
                   "relMSE at most 5e-4; bias at most 0.3 %, of each object at most 2 %",
                   ["scene", "CPU s of a frame", "RMSE", "relMSE", "bias", "scatter of one seed's bias", "worst object"], rows,
                   None if bench.tiny else met,
                   [f"Settings of Makefile.example, {SEEDS} seeds; layer indirect against path-traced halves of "
                    f"{bench.reference_samples // 16} samples each (S3: {bench.reference_samples}). relMSE is relative to a smooth frame (aqm-compare --relative-to): in the denominator the "
                    "reference's noise would count."] + notes)
    found["more"] = {"title": "By object", "header": ["scene", "object", "pixels", "bias", "standard error",
                                                      "share of squared error"], "rows": more}
    return found


def error_at(bench, name, settings, halves, size=None, rounds=5):
    """CPU seconds (median), RMSE (of the mean square), bias (mean) and its standard error, over seeds, timed afresh."""
    cost, totals = [], []
    for seed in range(1, (1 if bench.tiny else rounds) + 1):
        image, stats = chain.frame(bench, name, seed, settings, size, fresh=True)
        cost.append(chain.cost(stats))
        totals.append(bench.compare(image, halves, image.with_name(image.stem + "-error.json"))["total"])
    biases = [t["bias"] for t in totals]
    return median(cost), math.sqrt(max(0, mean(t["mse"] for t in totals))), mean(biases), standard_error(biases)


def preset_rows(bench, name, size, halves):
    """What the shipped presets make of the scene, by make: rows as judged() has them."""
    rows = []
    for quality in ("draft", "final"):
        cost, totals = [], []
        for seed in range(1, (1 if bench.tiny else 3) + 1):
            image, cpu = preset(bench, name, seed, size, quality)
            cost.append(cpu)
            totals.append(bench.compare(image, halves, image.with_name(f"{image.stem}-error.json"))["total"])
        rmse = math.sqrt(max(0, mean(t["mse"] for t in totals)))
        biases = [t["bias"] for t in totals]
        rows.append([name, "preset", f"{rmse:.5f}", quantity(bench.normalised(median(cost))),
                     f"{percent(mean(biases))} +- {percent(standard_error(biases))}", "-", f"preset {quality}"])
    return rows


def judged(bench, name, size, halves, targets):
    """Rows of the presets and of `targets`: (RMSE, normalised CPU seconds, settings); did all targets reach both?"""
    rows, met = preset_rows(bench, name, size, halves), True
    for rmse, seconds, settings in targets:
        cpu, error, bias, bias_error = error_at(bench, name, settings, halves, size)
        cpu = bench.normalised(cpu)
        good = cpu <= seconds and 0 < error <= rmse                   # 0: below what the reference resolves
        met = met and good
        rows.append([name, f"{rmse:.4f} in {seconds:g} s", f"{error:.5f}", quantity(cpu),
                     f"{percent(bias)} +- {percent(bias_error)}", "yes" if good else "**no**", f"own: `{settings.text()}`"])
    return rows, met


HEADER = ["scene", "asked: RMSE in CPU s", "RMSE", "CPU s, normalised", "bias", "reached", "settings"]
FAST = {"S2": [(0.0025, 1.5, Settings(100000, (), ("--rays", 350), ("--pixel-error", 0.004))),
               (0.0076, 0.6, Settings(30000, ("--point-count", "6k", "--light-samples", 2), ("--rays", 150, "--error-bound", 0.3),
                                      ("--spp", 4, "--pixel-error", 0.03)))],
        "S3": [(0.0030, 3.0, Settings(100000, (), ("--rays", 250), ("--pixel-error", 0.005))),
               (0.0143, 0.74, Settings(15000, ("--point-count", "3k", "--light-samples", 2), ("--rays", 40, "--error-bound", 0.5),
                                       ("--spp", 2, "--pixel-error", 0.05)))]}


def gather_speed_error(bench, _):
    """Whole frames of S2 and S3 at 320x180 against Cycles' references."""
    rows, met = [], True
    for name in ["S2"] if bench.tiny else ["S2", "S3"]:
        halves = bench.reference_halves(name) if bench.tiny else bench.third_party_halves(name)
        found, good = judged(bench, name, bench.size, halves, FAST[name])
        rows, met = rows + found, met and good
    return figure("A still frame at 320x180, everything counted",
                  "S2 RMSE .0025 in 1.5 CPU s, S3 .0030 in 3; Cycles' error at 256 samples in 1/50 of its CPU s", HEADER, rows,
                  None if bench.tiny else met, ["Against Cycles' references of 2 x 1024 samples; median and mean of 5 seeds. "
                                                 "Cycles: S2 .0076 in 30 s, S3 .0143 in 37 s."])


def cornell(bench, _):
    """The classic Cornell box."""
    size = "48x48" if bench.tiny else "256x256"
    halves = bench.reference_halves("PC", size, bench.reference_samples // 2)
    rows, met = judged(bench, "PC", size, halves, [
        (0.0013, 2, Settings(150000, (), ("--rays", 350), ("--pixel-error", 0.0045))),
        (0.0008, 4, Settings(400000, ("--point-count", "30k"), ("--rays", 800, "--error-bound", 0.15), ("--pixel-error", 0.002)))])
    met = met and all(abs(float(row[4].split(" ")[0])) < 0.3 for row in rows if row[5] != "-")
    return figure("Classic Cornell box, 256x256", "RMSE .0013 in 2 CPU s and .0008 in 4, bias below 0.3 %", HEADER, rows,
                  None if bench.tiny else met, ["Against our own path tracer, "
                                                 f"two halves of {bench.reference_samples // 4} samples each."])


def large(bench, _):
    """At 960x540 against path tracing of the same error."""
    size, samples = ("96x54", 4) if bench.tiny else ("960x540", 64)
    rows, met = [], True
    for name in ["S2"] if bench.tiny else ["S2", "S3"]:
        halves = bench.reference_halves(name, size, bench.reference_samples // 16)
        image, stats = bench.path_frame(name, samples, 1, size)
        path_cpu = chain.cost([stats])
        path_mse = bench.compare(image, halves, image.with_name(image.stem + "-error.json"))["total"]["mse"]
        settings = Settings(100000, (), ("--rays", 400), ("--pixel-error", 0.005))
        cpu, rmse, bias, bias_error = error_at(bench, name, settings, halves, size, 3)
        ratio = path_cpu * path_mse / (cpu * rmse**2) if rmse > 0 else math.inf
        met = met and ratio >= 100
        rows.append([name, quantity(cpu), f"{rmse:.5f}", f"{percent(bias)} +- {percent(bias_error)}", quantity(path_cpu),
                     f"{math.sqrt(max(0, path_mse)):.5f}", quantity(path_cpu * path_mse / rmse**2) if rmse > 0 else "-", f"{ratio:.0f}x"])
    return figure("960x540 against our path tracer", "at equal RMSE at least 100x less CPU",
                  ["scene", "CPU s", "RMSE", "bias", f"path tracing, {samples} samples: CPU s", "RMSE",
                   "CPU s at our RMSE, by 1/sqrt", "ratio"], rows, None if bench.tiny else met,
                  ["Medians of 3 seeds; the path tracer's curve is extended by its 1/sqrt law, which this size alone allows."])


def digest(bench, image):
    """Of the pixels."""
    return bench.run([bench.bin / "tempolux-info", "--digest", image]).stdout.split()[0]


def hall(bench, _):
    """S4's static hall under a moving camera: one cache for all frames."""
    scene, _frame = bench.scene("S4")
    size, last = ("48x28", 3) if bench.tiny else ("320x180", 47)
    folder = bench.out / "tmp"
    photons, cache, points = (folder / f"hall.{end}" for end in ("photons", "irradcache", "irradpoints"))
    tracing = bench.tool("photon-trace", scene, "--frame", 0, "--photons", 5000 if bench.tiny else 400000, "--kinds",
                         "caustic,indirect", "-o", photons)
    placing = bench.tool("irradcache-build", scene, "--frames", f"0-{last}", "--photons", photons, "--size", size,
                         *(["--point-count", "2k", "--rays", 50] if bench.tiny else []), "--keep-points", points, "-o", cache)
    added = [placing["results"][f"records_added.{frame}"] for frame in range(last + 1)]
    shares = [added[f] / sum(added[:f]) for f in range(1, last + 1)]
    some = [0, last // 2, last]
    digests = []
    for order in (some, some[::-1]):
        rendering = bench.tool("frame-render", scene, "--frames", ",".join(map(str, order)), "--size", size, "--irradcache", cache,
                               "--points", points, "--channels", "indirect", "-o", folder / "hall.####.exr")
        digests.append([digest(bench, folder / f"hall.{f:04d}.exr") for f in some])
    largest = max(range(1, last + 1), key=lambda f: shares[f - 1])
    rows = [[f"0-{last}", big(int(added[0])), quantity(100 * mean(shares)) + " %", f"{percent(shares[largest - 1])} (frame {largest})",
             big(int(sum(added))), "yes" if digests[0] == digests[1] else "**no**", quantity(tracing["cpu_s"] + placing["cpu_s"]),
             quantity(rendering["cpu_s"] / 3), str(int(rendering["counts"]["gathered_in_pixels"]))]]
    for file in (photons, cache, points):
        file.unlink()
    return figure("One cache for a hall that a camera walks through, S4", "after frame 0 at most 10 % new records in a frame; "
                  "the indirect layer does not depend on the order of frames",
                  ["frames", "records of frame 0", "new records in a later frame, mean", "most", "records in all",
                   "same digests in another order", "CPU s of light", "CPU s of a frame", "records missing in 3 frames"], rows,
                  None if bench.tiny else max(shares) <= 0.1 and digests[0] == digests[1],
                  [f"{size}; new records as a share of those before."])


def gather_rays(bench, _):
    """Gather rays with their look-ups against rtcIntersect1, by tests/bench/gather_rays: as many as final frames shoot."""
    rows, met = [], True
    for name, records in (("S2", 3600), ("S3", 6300)):
        scene, frame = bench.scene(name)
        amount = ["--photons", 5000, "--records", 50, "--rays", 100] if bench.tiny else ["--records", records, "--rays", 700]
        found = bench.program("gather_rays", scene, "--frame", frame, *amount)
        rate = found["rays"] / 1e6
        met = met and found["bare_over_gather"] >= 0.5
        rows.append([name, quantity(rate), quantity(rate / found["bare_cpu_s"]), quantity(rate / found["gather_cpu_s"]),
                     quantity(found["bare_over_gather"]), quantity(found["bare_cpu_s"] / found["gather_again_cpu_s"]),
                     quantity(found["rays_per_gather_ray"])])
    return figure("Gather rays and their look-ups against bare rtcIntersect1", "at least 0.5 of its ray rate",
                  ["scene", "M gather rays", "bare, M rays per CPU s", "gathering, M rays per CPU s", "ratio",
                   "once the look-up's table is filled", "rays traced per gather ray"],
                  rows, None if bench.tiny else met,
                  ["The same cosine-distributed rays, as many as a final frame of 640x360 shoots; one thread, CPU time, "
                   "sides alternating; filling the look-up's table is counted."])


def growth(bench, _):
    """Time when records, pixels and photons are doubled."""
    rows, met = [], True

    def row(what, name, settings, sizes, amounts, stage):
        """CPU seconds of a stage (-1: pixels, 0: photons ...) or of all, over what grew."""
        seconds, values = [], []
        for setting, size in zip(settings, sizes):
            found = []
            for seed in range(1, 2 if bench.tiny else 4):
                _, stats = chain.frame(bench, name, seed, setting, size, fresh=True)
                found.append(chain.cost(stats if stage is None else [stats[s] for s in stage]))
            seconds.append(median(found))
            values.append(amounts(setting, size, json.loads(stats[-2].read_text())["counts"]))
        steps = [(b / a, n / m) for a, b, m, n in zip(seconds, seconds[1:], values, values[1:]) if n > 1.2 * m]
        worst = max((time ** (math.log(2) / math.log(amount)) for time, amount in steps), default=0)
        rows.append([what, name, ", ".join(big(int(v)) for v in values), ", ".join(quantity(s) for s in seconds), f"{worst:.2f}"])
        return len(steps) > 0 and worst <= 2.1
    base = Settings(200000)
    for name in ["S2"] if bench.tiny else ["S2", "S3"]:
        finer = [Settings(base.photons, (), ("--error-bound", bound)) for bound in (0.4, 0.2, 0.1)]
        met = row("records (whole chain)", name, finer, [bench.size] * 3, lambda s, size, counts: counts["records"], None) and met
        sizes = ["48x28", "68x40"] if bench.tiny else ["320x180", "452x255", "640x360", "905x509"]
        met = row("pixels (whole chain)", name, [base] * len(sizes), sizes, lambda s, size, c: math.prod(map(int, size.split("x"))),
                  None) and met
        more = [Settings(base.photons * n) for n in (1, 2, 4, 8)]
        met = row("photons (photon-trace)", name, more, [bench.size] * 4, lambda s, size, c: s.photons, [0]) and met
        met = row("photons (photon-trace, irradcache-build)", name, more, [bench.size] * 4, lambda s, size, c: s.photons,
                  [0, 1]) and met
    return figure("Growth of the gathering chain", "records, pixels, photons doubled: time at most 2.1x",
                  ["what grows", "scene", "amounts", "CPU s", "time for twice as much, worst step"], rows,
                  None if bench.tiny else met, ["Medians of 3 seeds, CPU seconds."])


FIGURES = {"gather-quality": gather_quality, "gather-speed-error": gather_speed_error, "cornell": cornell, "large": large,
           "hall": hall, "gather-rays": gather_rays, "growth": growth} | atrium.FIGURES

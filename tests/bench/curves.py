"""Error against run time, a scene at a time: our presets and settings, our paths, and the renderers of build/peers, each against its own
reference in halves.

A point is (CPU seconds of a frame out of a range of 24, seen error). What the range shares (light that stands, the plan) is divided
by its frames; start and import of other renderers are left out. One part of the evidence for each scene.

Seen error multiplies the differences to both halves of a reference, so the reference's own noise does not add to it.
What is left is the bend of the codes' curve (the mean code of a noisy half is not the code of its mean: bend()) and the
scatter of the products. A reference grows until both are small beside the error that it judges (enough()), or until it
has cost REFERENCE_CPU; then the row says so.
"""

import fnmatch
import math
import re
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import cases
import exr
import pipeline
import pixels
from measure import Missing, figure, load, percent, quantity, save
from peer_renderers import Peer, denoised, flip, for_denoising, planes_of, write_pfm
from plot import chart
from references import FIRST, Curve, Reference, digest
from seen import Seen, blurred, code
from shipped import YARDSTICK, Side

RANGE = 24
REFERENCE_CPU = 300    # seconds that a side's reference may take
BENT = 0.2             # of an error; squares add, so it makes the error 2 % too large
SURE = 0.05            # of an error: standard error that the scatter of pixels leaves
AUXILIARY = ("RGBA", "albedo", "N")
SETTINGS = (
    ("draft", {"QUALITY": "draft"}),
    ("error .032", {"ERROR": ".032"}),
    ("final", {}),
    ("error .008", {"ERROR": ".008"}),
    ("error .004", {"ERROR": ".004"}),
)
PATHS = (4, 16, 64, 256)
PEERS = (
    ("Cycles + OIDN", "cycles", True, (4, 8, 16, 32, 64)),
    ("Cycles", "cycles", False, (16, 64, 256)),
    ("LuxCore + OIDN", "luxcore", True, (4, 16, 64)),
    ("LuxCore PhotonGI + OIDN", "luxcore", True, (16,)),
    ("Mitsuba + OIDN", "mitsuba", True, (4, 16, 64)),
)


def by_folder(out):
    """How many files a plan makes in each folder of OUT."""
    counts = {}
    for name in pipeline.made_files(out):
        counts[name.split("/")[0]] = counts.get(name.split("/")[0], 0) + 1
    return counts


def of_range(bench, wish):
    """by_folder() of the plan of a range."""
    plan = bench.out / "tmp" / "range"
    pipeline.run_make(bench.project, bench.bin, plan, "plan", **wish)
    return by_folder(plan)


def shared_out(out, together):
    """CPU seconds of a frame of a range: those of each folder of OUT by how many of its files a frame of the range
    needs. `together`: of_range()."""
    total = 0.0
    for folder, count in by_folder(out).items():
        spent = sum(stats["cpu_s"] for stats in pipeline.stats_in(out, folder))
        total += spent / count * together.get(folder, count) / RANGE
    return total


class Curves:
    def __init__(self, bench, case, size, reference_cpu):
        self.bench, self.case, self.size, self.reference_cpu = bench, case, size, reference_cpu
        self.side, self.rows, self.shown = Side(bench, case, size, 10**5), [], {}
        self.width, self.height = map(int, size.split("x"))
        self.stem = str(bench.out / "tmp" / f"curve-{case.name}")
        self.options = [*YARDSTICK, "--light-paths", "20M"]     # of our reference
        self.plans, self.references, self.left = {}, {}, []

    def judged(self, seen, halves, planes, first):
        """(seen error, FLIP): FLIP of the first seed alone, None without it."""
        reference = [[(p + q) / 2 for p, q in zip(*pair)] for pair in zip(*halves)]
        found = flip(self.bench, reference, [planes], seen.exposure, self.width, self.height) if first else []
        return seen.error(planes), found[0] if found else None

    # ---- ours

    def first_of_range(self):
        first = self.case.frame // RANGE * RANGE
        return f"{first}-{first + RANGE - 1}"

    def chain(self, variables, seed, channels=AUXILIARY):
        """(picture, CPU seconds)"""
        quality, rest = variables.get("QUALITY", "final"), {k: v for k, v in variables.items() if k != "QUALITY"}
        image, whole, stages, _ = self.side.chain(seed, channels=channels, variables=rest, quality=quality, leave=True)
        key = (quality, *rest.items())
        if key not in self.plans:
            self.plans[key] = of_range(self.bench, self.side.wish(self.first_of_range(), channels, quality, rest))
        return image, shared_out(self.side.folder, self.plans[key]) + (whole - sum(stages.values())) / RANGE

    def reference(self, judged):
        """Halves of our own paths, with what only light paths find, good enough to judge this picture."""
        reference = Reference(self.bench, self.case, self.size, self.options)
        reference.until(
            lambda *halves: enough([pixels.planes(half) for half in halves], judged, self.width, self.height),
            self.reference_cpu,
        )
        return [pixels.planes(half) for half in reference.halves]

    def reference_said(self):
        reference = Reference(self.bench, self.case, self.size, self.options)
        halves = [pixels.planes(half) for half in reference.halves]
        return self.said_of("ours", Seen(*halves), halves, reference.facts["cpu_s"])

    def said_of(self, label, seen, halves, cpu_s):
        bent = bend(seen, halves, self.width, self.height)
        return f"{label} noise {seen.halves_differ():.2f}, bend {bent:.2f} codes after {quantity(cpu_s)} CPU s"

    def ours(self):
        points, halves, seen = {}, None, None

        def judge(planes, first):
            nonlocal halves, seen
            if halves is None:
                halves = self.reference(planes)
                seen = Seen(*halves)
            return self.judged(seen, halves, planes, first)
        for label, variables in sorted(SETTINGS, key=lambda setting: setting[0] != "final"):
            many = label in ("draft", "final") and self.size == "320x180"
            seeds = range(1, 1 + (self.bench.preset_seeds if many else 2))
            def make():
                found = []
                for seed in seeds:
                    image, cpu = self.chain(variables, seed)
                    found.append((cpu, *judge([list(image.channels[c]) for c in "RGB"], seed == 1)))
                return found
            points[label] = self.bench.step(f"ours {label}", make)
        self.add("ours", {label: points[label] for label, _ in SETTINGS})
        self.references["ours"] = self.bench.step("ours reference", self.reference_said)

        def unfiltered(label, produce):
            def make():
                found = []
                for seed in (1, 2):
                    image, cpu = produce(seed)
                    for_denoising(self.stem, image)
                    planes, more = denoised(self.bench, self.stem)
                    raw = [list(image.channels[c]) for c in "RGB"]
                    found.append([(cpu + more, *judge(planes, seed == 1)), (cpu, *judge(raw, seed == 1))])
                return found
            return self.bench.step(label, make)
        try:
            if not self.left_out("ours, final unfiltered + OIDN"):
                found = unfiltered("ours, OIDN", lambda seed: self.chain({"FILTER": "none"}, seed))
                self.add("ours, final unfiltered + OIDN", {"final": [f[0] for f in found]})
            if self.left_out("our paths"):
                return
            paths = {n: unfiltered(f"paths {n}", lambda seed: self.paths(n, seed)) for n in PATHS}
            self.add("our paths + OIDN", {n: [f[0] for f in found] for n, found in paths.items()})
            self.add("our paths", {n: [f[1] for f in found] for n, found in paths.items()})
        except Missing as reason:
            self.rows.append(["Open Image Denoise", str(reason), "", "", "", ""])

    def left_out(self, side):
        """Does --sides leave it out?"""
        if any(fnmatch.fnmatch(side, wanted) for wanted in self.bench.sides):
            return False
        self.left.append(side)
        return True

    def paths(self, samples, seed):
        image, fixed, each = self.side.paths(samples, seed, AUXILIARY)
        return image, fixed + each * samples

    # ---- others

    def peer(self, label, name, clean, samples):
        key = f"{label}: "
        scene = {
            "scene": str(self.case.file),
            "size": self.size,
            "light_units": "spec" if "spec" in self.case.shared else "raw",
            "camera": self.case.camera,
            "world": str(self.case.environment) if self.case.environment else None,
            "sky": self.sky(),
            "smoke": self.smoke(),
        }
        opened = {}

        def open_peer():
            if "it" not in opened:
                if name != "cycles":
                    exporter = Peer(self.bench, "cycles", scene)
                    exported = f"{self.stem}.scene"
                    exporter.ask({"export": exported, "frame": self.case.frame})
                    exporter.close()
                    scene["scene"] = exported
                opened["it"] = Peer(self.bench, name, scene)
            return opened["it"]

        def frame(n, seed, clean, output):
            ask = open_peer().ask
            if name == "cycles":
                cpu = ask(
                    {"frame": self.case.frame, "samples": n, "seed": seed, "denoise": clean, "output": f"{output}.exr"}
                )
                return planes_of(f"{output}.exr"), cpu
            cpu = ask({"samples": n, "seed": seed, "photongi": clean and "PhotonGI" in label, "output": output})
            if not clean:
                return planes_of(f"{output}.pfm"), cpu
            planes, more = denoised(self.bench, output)
            return planes, cpu + more

        def halves(pictures):
            """Two independent pictures without denoising, good enough to judge these; they grow and are kept."""
            def all_judged(two):
                return all(enough(two, planes, self.width, self.height) for planes, _ in pictures)
            folder = self.bench.out / "every" / "reference"
            folder.mkdir(parents=True, exist_ok=True)
            stem = folder / f"{self.case.name}-{self.size}-{name}-{digest(self.case, self.size, [])}"
            facts, files = load(Path(f"{stem}.json")), [Path(f"{stem}_{h}.pfm") for h in "ab"]
            facts = facts or {"samples": 0, "cpu_s": 0.0, "parts": 0}
            two = [planes_of(file) for file in files] if facts["samples"] else None
            while not two or not all_judged(two) and 2 * facts["cpu_s"] <= self.reference_cpu:
                had, more = facts["samples"], facts["samples"] or FIRST
                for h in range(2):
                    planes, cpu = frame(more, 1000 + 2 * facts["parts"] + h, False, f"{self.stem}-more")
                    facts["cpu_s"] += cpu
                    if had:
                        planes = [
                            [(had * v + more * w) / (had + more) for v, w in zip(*pair)] for pair in zip(two[h], planes)
                        ]
                    write_pfm(files[h], self.width, self.height, planes)
                facts |= {"samples": had + more, "parts": facts["parts"] + 1}
                save(Path(f"{stem}.json"), facts)
                two = [planes_of(file) for file in files]
            return two, facts["cpu_s"], all_judged(two)

        def make(n):
            pictures = [frame(n, seed, clean, self.stem) for seed in (1, 2)]
            two, spent, converged = halves(pictures)
            seen = Seen(*two)
            judged = [
                (cpu, *self.judged(seen, two, planes, seed == 1)) for seed, (planes, cpu) in zip((1, 2), pictures)
            ]
            return {
                "points": judged,
                "said": self.said_of(label, seen, two, spent),
                "enough": converged,
            }
        try:
            found = {n: self.bench.step(key + str(n), lambda n=n: make(n)) for n in reversed(samples)}
            self.references[name] = found[samples[0]]["said"]
            converged = all(of["enough"] for of in found.values())
            self.add(
                label + ("" if converged else " (reference not converged)"),
                {n: found[n]["points"] for n in samples},
            )
        finally:
            if "it" in opened:
                opened["it"].close()

    def sky(self):
        text = " ".join(map(str, self.case.shared))
        found = re.search(r"--environment ([\d.]+),([\d.]+),([\d.]+)", text)
        return [float(v) for v in found.groups()] if found else None

    def smoke(self):
        """The file of the frame and how thick it is; None without."""
        words = dict(zip(self.case.shared[::2], self.case.shared[1::2]))
        if "--volume" not in words:
            return None
        return {
            "file": str(words["--volume"]).replace("####", f"{self.case.frame:04d}"),
            "sigma_t": float(words["--sigma-t"]),
            "albedo": [float(v) for v in words["--albedo"].split(",")],
        }

    # ---- both

    def add(self, label, points):
        mean = {
            setting: (
                statistics.mean(p[0] for p in found),
                math.sqrt(statistics.mean(p[1] ** 2 for p in found)),
                spread([p[1] for p in found]),
                len(found),
            )
            for setting, found in points.items()
        }
        self.shown[label] = mean
        self.rows += [
            [label, setting, quantity(cpu), f"{error:.2f} ± {plus:.2f}", quantity(points[setting][0][2]), seeds]
            for setting, (cpu, error, plus, seeds) in mean.items()
        ]


def reference(bench, name):
    """Is the reference of a scene complete? Its layers against photons alone, in the picture and in 4 x 4 tiles, and its halves."""
    case = next((c for c in cases.of_curves(bench) if c.name == name), None)
    if case is None:
        raise Missing(f"scene {name} is not here (../shared/scenes is absent)")
    samples, light = (64, "4M") if bench.small else (512, "20M")

    def render(*light_paths):
        out = bench.out / "tmp" / "complete.exr"
        stats = bench.tool(
            "frame-render",
            case.file,
            *case.options(),
            *YARDSTICK,
            "--size",
            "160x90",
            "--spp",
            samples,
            "--halves",
            *light_paths,
            "--audit",
            1,
            "--channels",
            "RGBA",
            "layers",
            "--compression",
            "none",
            "-o",
            out,
        )
        seen = Seen(*(pixels.planes(exr.read(out.with_name(f"complete_{h}.exr"))) for h in "ab"))
        squares = sorted(sum((u[p] - v[p]) ** 2 for u, v in zip(seen.a, seen.b)) for p in range(seen.count))
        return {
            "said": {k: v for k, v in stats["results"].items() if k.startswith("audit.")},
            "cpu": stats["cpu_s"],
            "halves": 2 ** 0.5 * seen.half_error(),
            "bright": math.fsum(squares[-(seen.count // 100):]) / max(1e-9, math.fsum(squares)),
        }
    alone, whole = bench.step("paths", render), bench.step("paths and light", lambda: render("--light-paths", light))
    rows, worst, tiles = [], 0.0, 0
    for layer in ("direct", "caustic", "indirect"):
        cells = []
        for found in (alone, whole):
            value, error = (found["said"].get(f"audit.{layer}{end}") for end in ("", "_error"))
            cells.append("-" if value is None else f"{100 * value:+.2f} ± {100 * error:.2f}")
        if value is not None:
            worst = max(worst, abs(value) / error)
        tiles += f"audit.{layer}.worst_tile" in whole["said"]
        rows.append([layer, *cells, "beyond" if f"audit.{layer}.worst_tile" in whole["said"] else "within"])
    return figure(
        f"{name}: a reference that lacks nothing",
        "each layer within 3 errors of photons alone, also by tile; halves differ by less than 4 codes",
        ["layer", "paths over photons - 1, % of the picture", "paths and light, the same", "4 x 4 tiles: 3 errors"],
        rows,
        worst <= 3 and tiles == 0 and whole["halves"] < 4,
        [
            f"Frame {case.frame}, 160x90, {samples} samples, {light} light paths: {quantity(whole['cpu'])} CPU s. "
            "Layer specular still lacks what mirrors, glass and gloss show of this light.",
            f"Halves of paths alone differ by {alone['halves']:.1f} codes after {quantity(alone['cpu'])} CPU s; 1 % of "
            f"the pixels hold {percent(alone['bright'], 0)} of the squares, with light {percent(whole['bright'], 0)}.",
            f"4 codes take at least {quantity((whole['halves'] / 4) ** 2)} times the work (error over its root).",
        ],
        f"worst layer {worst:.1f} errors, {tiles} layers with a tile beyond 3; halves {whole['halves']:.1f} codes",
        min(3 / max(worst, 0.1), 4 / whole["halves"]),
    )


def bend(seen, halves, width, height):
    """RMS in codes by which a half is off because codes are no straight line. The code of the halves' mean has half of
    the bend of a half, so twice its difference to their mean code is the bend. Boxes of 15 pixels even noise out."""
    squares = []
    for c in range(3):
        mean = [code(seen.exposure * (p + q) / 2) for p, q in zip(halves[0][c], halves[1][c])]
        apart = [2 * (m - (u + v) / 2) for m, u, v in zip(mean, seen.a[c], seen.b[c])]
        squares += [v * v for v in blurred(apart, width, height, 7)]
    return math.sqrt(statistics.fmean(squares))


def enough(halves, judged, width, height):
    """May these halves judge this picture?"""
    seen = Seen(*halves)
    squares = seen.squares(judged)
    mean = statistics.fmean(squares)
    error = math.sqrt(max(0.0, mean))
    scatter = math.sqrt(math.fsum((v - mean) ** 2 for v in squares)) / len(squares)     # d error = d mean / (2 error)
    return scatter < 2 * error * SURE * error and bend(seen, halves, width, height) < BENT * error


def spread(values):
    return statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else 0.0


def measure(bench, name, size="320x180"):
    case = next((c for c in cases.of_curves(bench) if c.name == name), None)
    if case is None:
        raise Missing(f"scene {name} is not here (../shared/scenes is absent)")
    size, title = "160x90" if bench.small else size, name if size == "320x180" else f"{name}-{size}"
    curves = Curves(bench, case, size, 60 if bench.small else REFERENCE_CPU)
    curves.ours()
    notes = []
    for label, peer, clean, samples in PEERS:
        try:
            if curves.left_out(label):
                continue
            if "--volume" in case.shared and peer != "cycles":
                raise Missing("smoke is not translated for it")
            curves.peer(label, peer, clean, samples)
        except Missing as reason:
            notes.append(f"{label}: skipped: {reason}")
    if curves.left:
        notes.append(f"Not run: {', '.join(curves.left)} (`--sides`).")
    cpu, error, plus, _ = curves.shown["ours"]["final"]
    ratio, inside, more = None, True, {}
    theirs = next((points for label, points in curves.shown.items() if label.startswith("Cycles + OIDN")), None)
    said = f"final needs {quantity(cpu)} CPU s a frame for a seen error of {error:.2f} ± {plus:.2f} codes"
    if theirs:
        needed, inside = Curve([p[:2] for p in theirs.values()]).cost(error)
        ratio = needed / cpu
        more = {"equal_error": ratio}
        said += f"; Cycles + OIDN needs {'' if inside else '~'}{quantity(needed)} CPU s for the same error, {quantity(ratio)} times as much"
    picture = bench.results / f"curve-{title}.svg"
    picture.write_text(
        chart(
            f"{name}, {size}: seen error against CPU seconds of a frame",
            "CPU s a frame",
            "codes",
            [(label, [(c, e) for c, e, *_ in points.values()]) for label, points in curves.shown.items()],
            log=True,
        )
    )
    notes = [
        f"![curves]({picture.name})",
        f"Frame {case.frame}, {size}, out of a range of {RANGE}; `~`: beyond the measured curve.",
        "Error of the references: " + ", ".join(curves.references.values()) + ".",
        *notes,
    ]
    return figure(
        f"{title}: final beside Cycles 5 with OIDN",
        "less CPU at equal seen error",
        ["side", "setting", "CPU s a frame", "seen error, codes", "FLIP", "seeds"],
        curves.rows,
        None if ratio is None else ratio > 1,
        notes,
        said,
        ratio,
        partial=bool(curves.left),
        **more,
    )

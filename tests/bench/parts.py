"""The parts of the evidence: what each judges, its scenes, what it costs, its canaries, and the function that measures it.

A function gets the Bench and returns figure(). It calls bench.step(name, function) for what takes more than seconds: a
step's result, JSON, is kept until the part is finished.
"""

import dataclasses
import json
import statistics
import sys
import tempfile
from pathlib import Path
from typing import Callable

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "pipelines"))
import cases
import combinations
import curves
import everyscene
import leaving_matrix
import paper_rows
import random_beside
import required
import results_page
import steady_rows
from measure import figure, quantity


@dataclasses.dataclass
class Part:
    name: str
    section: str           # of RESULTS.md: results_page.SECTIONS
    judges: str
    scenes: str
    cost: float            # CPU seconds, until it has been measured once
    canaries: tuple        # names in canaries.py
    run: Callable


def of_required(name):
    """A function of required.py as one step."""
    return lambda bench: bench.step(name, lambda: required.FIGURES[name](bench))


def stress(bench):
    """The table of stiff and extreme cases, a family a step."""
    script = bench.project / "tests" / "stress" / "stress.py"
    families = bench.step(
        "families", lambda: bench.run([sys.executable, "-B", script, "--bin", bench.bin, "--list"]).stdout.split()
    )

    def family(name):
        out = bench.out / "tmp" / "stress.json"
        bench.run(
            [
                sys.executable,
                "-B",
                script,
                "--bin",
                bench.bin,
                "--family",
                name,
                "--json",
                out,
                *(["--short"] if bench.small else []),
            ],
            codes=(0, 1),
        )
        return json.loads(out.read_text())
    rows, failed, count = [], [], 0
    for name in families:
        found = bench.step(name, lambda: family(name))
        bad = [row for row in found if row["verdict"] == "FAIL"]
        failed += bad
        count += len(found)
        rows.append(
            [
                name,
                len(found),
                sum(row["verdict"] == "refused as it should" for row in found),
                len(bad),
                quantity(sum(row["seconds"] for row in found)),
            ]
        )
    return figure(
        "Stiff and extreme cases",
        "every case as a law or a closed form has it, or refused with one line",
        ["family", "rows", "refused as they should", "failed", "seconds"],
        rows,
        not failed,
        [f"Failed: {row['case']}: {row['quantity']}: {row['got']}" for row in failed]
        + (["Short form."] if bench.small else []),
        f"{len(failed)} of {count} rows failed",
        1 - len(failed) / max(1, count),
    )


def random_rooms(bench):
    """Sixty random scenes, ten a step."""
    count, size, reference = (6, "48x27", 2) if bench.small else (60, "96x54", 20)
    rows = []
    for first in range(1, count + 1, 10):
        numbers = range(first, min(first + 9, count) + 1)
        rows += bench.step(f"from {first}", lambda: random_beside.rows(bench, numbers, size, 120, reference))
    within, judged, wrong, text = random_beside.summary(rows)
    return figure(
        "Sixty random scenes: is a frame as good as it says?",
        "of frames whose reference converged 90 % of the errors within 1.3 of what the frame says, none above 3",
        random_beside.HEADER,
        [random_beside.cells(row) for row in rows],
        within >= 0.9 * judged and not wrong,
        [text, "?: the reference is not converged, the row is not judged."],
        f"{within} of {judged} within 1.3; above 3: {', '.join(wrong) or 'none'}",
        within / max(1, 0.9 * judged) if not wrong else min(0.99, within / max(1, 0.9 * judged)),
    )


def all_pairs(bench):
    """All pairs of what can be asked for."""
    def run():
        with tempfile.TemporaryDirectory() as folder:
            found = combinations.verdicts(bench.bin, Path(folder), 8 if bench.small else 1)
            return [[list(pair), verdict] for pair, verdict in found]
    rows = bench.step("pairs", run)
    failed = [f"{' + '.join(pair)}: {verdict}" for pair, verdict in rows if verdict.startswith("FAIL")]
    header, cells, refused = combinations.table(rows)
    return figure(
        "All pairs of what can be asked for",
        "each pair right (mean of each frame within 2 % of path tracing, previews 10 %), or refused in one line",
        header,
        cells,
        not failed,
        ["A number: the largest difference of a frame's mean to path tracing with the same shutter, lens and smoke. "
         "*One variable*: both are values of this variable, so they exclude each other."] + refused + failed,
        f"{len(rows)} pairs, {len(failed)} wrong, {sum(verdict.startswith('refused') for _, verdict in rows)} refused",
        1 - len(failed) / len(rows),
    )


def leaving_by_scene(bench):
    """What runs in twelve scenes, and what one edit costs."""
    folder = bench.out / "leaving"
    rows, columns, broken = bench.step("scenes", lambda: leaving_matrix.of_scenes(bench.bin, folder))
    edits = bench.step("edits", lambda: leaving_matrix.of_edits(bench.bin, folder))
    header, cells = leaving_matrix.scenes_table(rows, columns)
    return figure(
        "What runs in twelve scenes, and what one edit costs",
        "no stage without what needs it; neither OpenImageIO nor OpenVDB mapped without images or volumes",
        header,
        cells,
        not broken,
        [
            f"The numbers count the files that each stage makes, by its folder. Frames {leaving_matrix.FRAMES}, "
            f"{leaving_matrix.SIZE}, QUALITY=draft.",
            "One edit in a small room of eight frames:",
            results_page.table(leaving_matrix.EDITS_HEADER, leaving_matrix.edits_table(edits)),
            "Reasons of the plan:",
            results_page.table(leaving_matrix.REASONS_HEADER, leaving_matrix.reasons(rows)),
            *broken,
        ],
        f"{len(rows)} scenes, {len(broken)} laws broken",
        1 if not broken else 0.5,
    )


def leaving_out(bench):
    script = bench.project / "tests" / "pipelines" / "leaving_out.sh"

    def run():
        done = bench.run(["sh", script, bench.bin], codes=(0, 1))
        return [line for line in done.stdout.splitlines() if line.startswith("FAILED")]
    failed = bench.step("leaving out", run)
    checks = script.read_text().count("bad '") + script.read_text().count('bad "')
    return figure(
        "What a scene does not need is not done",
        "no file, process, library, photon or record that the scene does not need",
        ["check", "outcome"],
        [[line, "failed"] for line in failed] or [[f"{checks} checks of tests/pipelines/leaving_out.sh", "all hold"]],
        not failed,
        [],
        f"{checks - len(failed)} of {checks} checks hold",
        1 - len(failed) / checks,
    )


def ablation(bench):
    """Ideas of the samplers left out in turn; the page is ablation.md, which also has what was tried by hand."""
    page = bench.results / "ablation.md"

    def run(*words):
        return bench.run(
            [
                sys.executable,
                "-B",
                bench.project / "tests" / "bench" / "ablation.py",
                "--out",
                bench.out,
                "--seeds",
                "1" if bench.small else "1,2",
                *words,
            ]
        ).stdout
    bench.step("programs", lambda: run("--build-only"))
    for name in ("S2",) if bench.small else cases.QUICK:
        text = bench.step(name, lambda: run("--built", "--scenes", f"^{name}$"))
    header, rows = paper_rows.tables(text)[-1]
    idle = [row[0] for row in rows if row[-1].startswith("no")]
    return figure(
        "What each idea of the samplers is worth",
        "each idea pays 1.15 in the median of its scenes or 2 in a class of them",
        header,
        rows,
        not idle,
        [f"What was tried by hand: [{page.name}]({page.name})."],
        f"{len(rows) - len(idle)} of {len(rows)} ideas pay",
        (len(rows) - len(idle)) / max(1, len(rows)),
    )


def scenes(bench):
    """The preset beside our path tracer, scene by scene."""
    kept = bench.out / "every" / "evidence.json"
    if not bench.small:
        names, size, seeds, reference = cases.QUICK, "160x90", 2, 60
    else:
        names, size, seeds, reference = ("S2", "S4"), "80x45", 1, 10

    def one(name):
        rows, _ = everyscene.run(bench, f"^{name}$", [size], seeds, 120, reference, kept)
        return [row for row in rows if row["scene"] == name][:1]
    rows = [row for name in names for row in bench.step(name, lambda: one(name))]
    good = [row for row in rows if "refused" not in row]
    slower = [row["scene"] for row in good if row["speed_up"] < 0.9]
    least = min((row["speed_up"] for row in good), default=0)
    return figure(
        "The preset beside our path tracer, scene by scene",
        "never slower than path tracing at equal seen error",
        everyscene.HEADER,
        [everyscene.line(row) for row in rows],
        not slower,
        everyscene.summary(rows),
        f"median speed-up {quantity(statistics.median(row['speed_up'] for row in good))} of {len(good)} scenes, least {quantity(least)}",
        least / 0.9,
    )


def figures_of_paper(bench):
    """The figures of the paper on gathering over time, drawn with our numbers."""
    out = bench.out / "papers"
    text = bench.step(
        "papers",
        lambda: bench.run(
            [
                sys.executable,
                "-B",
                bench.project / "tests" / "bench" / "papers.py",
                bench.bin,
                out,
                *(["--frames", 6, "--size", "80x45", "--rays", 1000] if bench.small else []),
            ]
        ).stdout,
    )
    (header, rows), *_ = [t for t in paper_rows.tables(text) if t[0][0].startswith("CPU s")]
    times = {row[0]: float(row[-1]) for row in rows}
    return figure(
        "A: final gathering over time, all figures of the paper",
        "the chain but for pixels costs less over time",
        header,
        rows,
        times["over time"] < times["anew"],
        [f"All figures and curves: {out / 'index.md'}".replace(str(bench.project) + "/", "")],
        f"{times['anew']:.2f} s anew, {times['over time']:.2f} s over time",
        times["anew"] / times["over time"],
    )


PAPERS = [
    ("walkthrough", "A: walkthrough: warp, masks, recursion", "S4", 500, ("walk",), paper_rows.walkthrough),
    ("metric", "A: metric with pixel flow", "S4", 120, ("warp",), paper_rows.metric),
    ("filter", "A: spatio-temporal filter", "S2 S4", 250, ("still", "filter"), paper_rows.filter_),
    ("chain", "A: walkthrough, a whole chain", "S4", 500, ("walk", "still"), paper_rows.whole_chain),
    ("photons", "A: photons over time", "made", 300, ("preview",), paper_rows.photons_over_time),
    ("localised", "A: localised gathering", "room", 150, ("localised",), paper_rows.localised),
    (
        "object",
        "A: temporal gathering for an object",
        "room",
        200,
        ("temporal",),
        lambda bench: paper_rows.temporal(bench, "object"),
    ),
    (
        "light",
        "A: temporal gathering for a light",
        "S5",
        150,
        ("temporal",),
        lambda bench: paper_rows.temporal(bench, "light"),
    ),
    ("secondary", "A: strong secondary light", "S3", 100, ("split",), paper_rows.secondary),
    ("selection", "B: selection", "S6 chimney", 250, ("smoke",), paper_rows.selection),
    ("groups", "B: groups by energy", "made", 100, ("smoke",), paper_rows.groups),
    ("deletion", "B: deletion of a group", "-", 40, ("replace",), paper_rows.deletion),
    ("textures", "B: textures and times", "S6", 150, ("smoke", "preview"), paper_rows.textures),
]

DAY = ("S8", "furnished_day", "evening_shot")   # rooms with windows
ALL = ("still", "sky", "day", "walk", "localised", "temporal", "split", "preview", "smoke", "filter", "paths", "photons")
PARTS = [
    *(
        Part(f"paper-{name}", "papers", judges, where, cost, canary, run)
        for name, judges, where, cost, canary, run in PAPERS
    ),
    Part(
        "paper-figures", "papers", "A: all figures of gathering over time", "S2", 300, ("temporal",), figures_of_paper
    ),
    *(
        Part(
            f"curve-{name}",
            "curves",
            f"{name}: error against run time beside other renderers",
            name,
            1500,
            ("still", "paths") + ("day",) * (name in DAY),
            lambda bench, name=name: curves.measure(bench, name),
        )
        for name in cases.CURVES
    ),
    *(
        Part(
            f"curve-{name}-1280x720",
            "curves",
            f"{name} at 1280x720 beside other renderers",
            name,
            9000,
            ("still", "paths"),
            lambda bench, name=name: curves.measure(bench, name, "1280x720"),
        )
        for name in ("S2", "demo")
    ),
    *(
        Part(
            f"reference-{name}",
            "curves",
            f"{name}: a reference that lacks nothing",
            name,
            300,
            ("paths", "photons"),
            lambda bench, name=name: curves.reference(bench, name),
        )
        for name in ("furnished_day", "S8")
    ),
    Part(
        "scenes",
        "curves",
        "the preset beside our path tracer, scene by scene",
        "17 scenes",
        1500,
        ("still", "sky", "paths"),
        scenes,
    ),
    *(
        Part(
            f"steady-{name}",
            "steady",
            f"{name}: steadiness beside Cycles with OIDN",
            name,
            400,
            ("still", "filter") + ("day",) * (name in DAY),
            lambda bench, name=name: steady_rows.measure(bench, name),
        )
        for name in steady_rows.SCENES
    ),
    Part("stress", "stiff", "stiff and extreme cases", "made", 1500, ALL, stress),
    Part("random", "stiff", "random scenes: is a frame as good as it says?", "made at random", 1500, ALL, random_rooms),
    Part("combinations", "stiff", "all pairs of what can be asked for", "made", 500, ALL, all_pairs),
    Part("leaving-scenes", "leaving", "what runs where, and what an edit costs", "12 scenes", 60, ALL, leaving_by_scene),
    Part(
        "leaving-out",
        "leaving",
        "what a scene does not need is not done",
        "S2",
        60,
        ("still", "sky", "photons"),
        leaving_out,
    ),
    Part(
        "path-tracer",
        "speed",
        "our path tracer against Cycles' of 2022",
        "S2 S3 S4",
        200,
        ("paths",),
        of_required("path-tracer"),
    ),
    Part(
        "photon-rate",
        "speed",
        "photon tracing against a bare walk of rays",
        "S2",
        60,
        ("photons",),
        of_required("photon-rate"),
    ),
    Part(
        "nearest", "speed", "exact k nearest photons against nanoflann", "-", 60, ("nearest",), of_required("nearest")
    ),
    Part("threads", "speed", "two threads against one", "S2", 150, ("still",), of_required("threads")),
    Part("start", "speed", "start of every tool", "-", 10, ("help",), of_required("start")),
    Part("reading", "speed", "a .photons file against its bytes", "-", 20, ("photons",), of_required("reading")),
    Part("demo", "speed", "the demo", "evening", 800, ("still", "filter"), of_required("demo")),
    Part(
        "walls",
        "speed",
        "a room from Blender beside Cycles of Debian",
        "spheres",
        120,
        ("paths",),
        of_required("walls"),
    ),
    Part("ideas", "speed", "what each idea of the samplers is worth", "17 scenes", 9000, ("still", "sky"), ablation),
]

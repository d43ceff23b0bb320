"""What each idea of lib/core/ideas.h is worth: the tools without it, CPU seconds x squared error, against the tools as they are.

    make -f Makefile.example ablation                                  all ideas, a dozen scenes
    python3 tests/bench/bench.py --only ablation --scenes 'S|hut'      some scenes

The tree is copied to OUT/ablation/source, where only the line of kLeftOut changes: each idea costs the compilation of what knows
it. An idea stays if without it CPU x MSE is 1.15 times as high in the median over all scenes, or 2 times in a kind of scene, and
nowhere less than .87 (1 / 1.15) of what it is with it; differences count beyond three standard errors.
"""
import json
import math
import re
import shutil
import statistics
import subprocess

import everyscene
from comparing import efficiency
from measure import Bench, figure, quantity

MEDIAN, IN_A_KIND = 1.15, 2.0
FOLDERS = ("lib", "tools", "formats", "modules", "cmake", "CMakeLists.txt", "CMakePresets.json", "Makefile.example")
HEADER = ["without", "CPU x MSE / with it: median", "open", "window", "closed", "least (scene)", "most (scene)", "verdict"]


def ideas(bench):
    """Names, from the header."""
    text = (bench.project / "lib" / "core" / "ideas.h").read_text()
    body = re.search(r"enum class Idea \{(.*?)\};", text, re.S).group(1)
    return [name for name in re.findall(r"^ *(\w+),? *(?:///<.*)?$", body, re.M) if name != "none"]


def built_without(bench, idea):
    """Build folder of the tools without an idea; the same for all ideas, one after the other."""
    source, build = bench.out / "ablation" / "source", bench.out / "ablation" / "build"
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    for name in FOLDERS:                                     # with their times: what has not changed is not compiled again
        bench.run(["cp", "-a", bench.project / name, source])
    header = source / "lib" / "core" / "ideas.h"
    text = header.read_text()
    header.write_text(text.replace("kLeftOut = Idea::none", f"kLeftOut = Idea::{idea}"))
    if header.read_text() == text:
        raise RuntimeError("lib/core/ideas.h: no line that says kLeftOut = Idea::none")
    if not (build / "build.ninja").exists():
        bench.run(["cmake", "--preset", "release", "-S", source, "-B", build, "-DTEMPOLUX_TESTS=OFF", "-DTEMPOLUX_BENCH=OFF"])
    bench.run(["ninja", "-C", build, "tools"])
    return build


def rows_of(bench, build, only, seeds, kept):
    """everyscene's rows of the tools in a build folder; references are shared by all."""
    other = Bench(build, bench.out, bench.project, bench.tiny, 0)
    other.programs = bench.programs
    size, reference_cpu = (bench.size, 0) if bench.tiny else ("160x90", 40)
    return everyscene.run(other, only, (size,), seeds, 60, reference_cpu, kept)[1]


def row(idea, before, after):
    """A line of the table: by scene how much more CPU x MSE without the idea, with its standard error."""
    found = []
    for new in after:
        old = next((r for r in before if r["scene"] == new["scene"]), None)
        if old and "refused" not in old and "refused" not in new:
            gain = 1 / efficiency(old, new)
            found.append((gain, new["scene"], new["kind"], math.hypot(old["uncertain"], new["uncertain"]) * gain))
    if not found:
        return [idea] + ["-"] * (len(HEADER) - 1)
    found.sort()
    median = statistics.median(g for g, *_ in found)
    kinds = {kind: [g for g, _, k, _ in found if k == kind] for kind in ("open", "window", "closed")}
    harmed = [name for g, name, _, error in found if g < 1 / MEDIAN and 1 - g > 3 * error]
    helps = median >= MEDIAN or any(v and statistics.median(v) >= IN_A_KIND for v in kinds.values())
    verdict = "stays" if helps and not harmed else f"goes: it harms {', '.join(harmed)}" if harmed else "goes: worth too little"
    return [idea, quantity(median), *(quantity(statistics.median(v)) if v else "-" for v in kinds.values()),
            f"{quantity(found[0][0])} ({found[0][1]})", f"{quantity(found[-1][0])} ({found[-1][1]})", verdict]


def ablation(bench, _, only="quick", seeds=3):
    """Each idea left out: CPU seconds x squared error over all scenes."""
    names = ideas(bench)
    if bench.tiny:                                            # nothing is built: the tools against themselves
        names, only, seeds = names[:1], "^hut-5-inside-sun$", 2
    folder = bench.out / "ablation"
    folder.mkdir(parents=True, exist_ok=True)
    before = rows_of(bench, bench.bin.parent, only or "quick", seeds, folder / "with.json")
    rows = []
    for idea in names:
        build = bench.bin.parent if bench.tiny else built_without(bench, idea)
        rows.append(row(idea, before, rows_of(bench, build, only or "quick", seeds, folder / f"{idea}.json")))
        print("  ".join(rows[-1]), flush=True)
    going = [r[0] for r in rows if r[-1].startswith("goes")]
    return figure("What each idea is worth", "1.15 in the median of CPU x MSE or 2 in a kind of scene, harm nowhere; else it goes", HEADER, rows,
                  None if bench.tiny else not going, ["lib/core/ideas.h says what each is. Preset final at 160x90, 3 seeds."],
                  measured=f"{len(rows) - len(going)} of {len(rows)} stay" + (f"; to go: {', '.join(going)}" if going else ""))


FIGURES = {"ablation": ablation}

#!/usr/bin/env python3
"""What each idea of the samplers is worth: the chain with the idea left out beside the whole chain, CPU time x squared error.

    make -f Makefile.example evidence PARTS=ideas                               all ideas on a dozen scenes at 160x90
    python3 tests/bench/ablation.py --ideas 'gradients|radii' --scenes 'S2|S4'  some of them, printed
    python3 tests/bench/ablation.py --check                                     does each idea still stand in the source as ablation_ideas.py has it?

The library knows nothing of this: an idea is left out of a copy of the sources, in OUT/ablation, by a change that ablation_ideas.py lists. Each scene is rendered
with the preset as Makefile.example does it, all processes counted, with every idea left out in turn and with the whole chain after every third.

gain = CPU x MSE without the idea / CPU x MSE with it: above 1 the idea pays. An idea stays if its gain is 1.15 in the median of the scenes where its
stage runs, or 2 in some class of scenes (closed rooms, light through windows, the open), without harm elsewhere. MSE is that against the halves of a path-traced
reference (pixels.py), so a bias counts as well.
"""
import argparse
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import cases
import pixels
from ablation_ideas import IDEAS
from measure import Bench, machine, walk_speed
from references import Reference
from shipped import YARDSTICK, Side, Unfinished, frames_without_camera

TOOLS = ("scene-plan", "photon-trace", "irradcache-build", "photonmap-split", "frame-render", "st-filter",
         "tempolux-info")
IN_MEDIAN, IN_CLASS, HARM = 1.15, 2.0, 0.87      # 0.87 = 1 / 1.15
IN_A_ROW = 3          # ideas between two runs of the whole chain, whose mean CPU time theirs is compared with: machines change their speed within a minute
WHOLE = "whole"


# ---- programs without an idea

def changed(text, old, new, where):
    """The text with one passage replaced; blanks and line breaks, which a formatter moves, are not compared."""
    tokens = re.findall(r"\w+|[^\w\s]", old)
    found = list(re.finditer(r"\s*".join(map(re.escape, tokens)), text))
    if len(found) != 1:
        raise SystemExit(f"ablation_ideas.py: {where}: the code has changed: found {len(found)} times, not once:\n{old}")
    return text[:found[0].start()] + new + text[found[0].end():]


def check(project):
    for idea in IDEAS:
        texts = {}
        for file, old, new in idea.edits:
            texts[file] = changed(texts.get(file) or (project / file).read_text(), old, new, f"{idea.name}: {file}")


def build(project, folder, idea, jobs):
    """Programs and make rules without the idea (None: all of it) in folder/NAME; made anew if they were made of other sources."""
    tree, name = folder / "tree", folder_name(idea.name if idea else WHOLE)
    files = subprocess.run(["git", "ls-files", "-z", "--", ".", ":!docs", ":!tests"], cwd=project, capture_output=True, check=True).stdout.decode().split("\0")[:-1]
    edits = {}
    for file, old, new in idea.edits if idea else ():
        edits[file] = changed(edits.get(file) or (project / file).read_text(), old, new, f"{idea.name}: {file}")
    for file in files:
        content = edits[file].encode() if file in edits else (project / file).read_bytes()
        target = tree / file
        if not target.exists() or target.read_bytes() != content:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
            shutil.copymode(project / file, target)
    environment = os.environ | {"CCACHE_BASEDIR": str(tree)}
    if not (tree / "build" / "release" / "build.ninja").exists():
        subprocess.run(["cmake", "--preset", "release", "-DTEMPOLUX_TESTS=OFF", "-DTEMPOLUX_BENCH=OFF"], cwd=tree, check=True, capture_output=True, env=environment)
    done = subprocess.run(["ninja", "-C", "build/release", f"-j{jobs}", "tools"], cwd=tree, capture_output=True, text=True, env=environment)
    if done.returncode:
        raise SystemExit(f"{name}: does not build:\n" + "\n".join(line for line in done.stdout.splitlines() if "error" in line))
    made = folder / name
    shutil.rmtree(made, ignore_errors=True)
    (made / "bin").mkdir(parents=True)
    for tool in TOOLS:
        shutil.copy2(tree / "build" / "release" / "bin" / tool, made / "bin")
    shutil.copytree(tree / "build" / "release" / "modules", made / "modules", ignore=shutil.ignore_patterns("CMakeFiles", "*.cmake"))
    shutil.copy2(tree / "Makefile.example", made)
    shutil.copytree(tree / "pipelines", made / "pipelines", ignore=shutil.ignore_patterns("scenes"))
    return made


def folder_name(name):
    return name.replace(" ", "-")


# ---- measuring

class Variant:
    """The chain without an idea; None: the whole."""

    def __init__(self, bench, folder, idea):
        self.idea, self.name = idea, idea.name if idea else WHOLE
        made = folder / folder_name(self.name)
        self.bench = Bench(made, bench.out, made, False, 0)
        self.bench.shared = bench.shared

    def runs(self, case, size, seed, patience):
        image, cpu, stages, _ = Side(self.bench, case, size, patience).chain(seed)
        return image, cpu, stages


def measure(bench, variants, case, size, seeds, patience, reference_cpu, known):
    """A row of the JSON file, one scene: `of` has by variant and seed its CPU seconds, those of the whole chain beside it, squared error and mean. Adds to `known`,
    the row of an earlier run."""
    row = known or {"scene": case.name, "kind": case.kind, "size": size, "stages": None, "of": {}}
    reference = Reference(bench, case, size, YARDSTICK)
    images, whole = {}, next(v for v in variants if not v.idea)
    for seed in seeds:
        image, before, row["stages"] = whole.runs(case, size, seed, patience)
        if not reference.agrees_with(image):
            reference.forget()
        images[WHOLE, seed] = image, before, before
        wanted = [variant for variant in variants if variant.idea and row["stages"][variant.idea.stage] > 0]
        for some in (wanted[i:i + IN_A_ROW] for i in range(0, len(wanted), IN_A_ROW)):
            made = [(variant.name, *variant.runs(case, size, seed, patience)[:2]) for variant in some]
            after = whole.runs(case, size, seed, patience)[1]
            for name, image, cpu in made:
                images[name, seed] = image, cpu, (before + after) / 2
            before = after
    row["reference_sufficient"] = reference.until(
        lambda a, b: pixels.squared_error(images[WHOLE, seeds[0]][0], a, b)[1] < 0.1 * pixels.squared_error(images[WHOLE, seeds[0]][0], a, b)[0], reference_cpu)
    a, b = reference.halves
    row["mean"] = pixels.mean_of_halves(a, b)[0]
    for (name, seed), (image, cpu, beside) in images.items():
        of = row["of"].setdefault(name, {})
        of[str(seed)] = {"cpu": cpu, "beside": beside, "mse": pixels.squared_error(image, a, b)[0], "mean": pixels.mean(image)}
    return row


def gain(row, name):
    """(CPU x MSE without / with, CPU without / with, MSE without / with, difference of the means over the picture's) over the seeds that both have; None if the idea
    has no part in the scene."""
    with_, without = row["of"][WHOLE], row["of"].get(name)
    if not without:
        return None
    seeds = [s for s in without if s in with_]
    def mean(of, what):
        return statistics.mean(of[s][what] for s in seeds)
    cpu, mse = mean(without, "cpu") / mean(without, "beside"), mean(without, "mse") / max(1e-30, mean(with_, "mse"))
    return cpu * mse, cpu, mse, (mean(without, "mean") - mean(with_, "mean")) / row["mean"]


# ---- what is printed

def judged(rows, idea):
    """Cells of an idea's line."""
    found = [(gain(row, idea.name), row) for row in rows]
    found = [(g, row) for g, row in found if g and g[0] > 0]
    if not found:
        return None
    middle = statistics.median(g[0] for g, _ in found)
    kinds = {}
    for kind in ("closed", "window", "open"):
        of = [g[0] for g, row in found if row["kind"] == kind]
        if of:
            kinds[kind] = statistics.median(of)
    (most, best), (least, worst) = max((g[0], row["scene"]) for g, row in found), min((g[0], row["scene"]) for g, row in found)
    off, where = max(((g[3], row["scene"]) for g, row in found), key=lambda p: abs(p[0]))
    pays = middle >= IN_MEDIAN or max(kinds.values()) >= IN_CLASS
    said = ("pays" if pays else "no") + (f"; harms {worst}" if least < HARM else "")
    return {"idea": idea, "median": middle, "kinds": kinds, "most": (most, best), "least": (least, worst), "off": (off, where), "pays": pays, "said": said,
            "cpu": statistics.median(g[1] for g, _ in found), "mse": statistics.median(g[2] for g, _ in found), "scenes": len(found)}


def times(value):
    return f"{value:.2f}" if value < 10 else f"{value:.0f}"


HEADER = ["left out", "what it is", "scenes", "CPU", "MSE", "gain, median", "closed", "window", "open", "most", "least", "largest change of a mean", "pays"]


def table(rows):
    lines = []
    for idea in IDEAS:
        j = judged(rows, idea)
        if not j:
            continue
        cells = [idea.name, idea.what, j["scenes"], times(j["cpu"]), times(j["mse"]), f"**{times(j['median'])}**" if j["pays"] else times(j["median"]),
                 *(times(j["kinds"][k]) if k in j["kinds"] else "" for k in ("closed", "window", "open")),
                 f"{times(j['most'][0])} {j['most'][1]}", f"{times(j['least'][0])} {j['least'][1]}",
                 f"{100 * j['off'][0]:+.1f} % {j['off'][1]}", j["said"]]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(["| " + " | ".join(HEADER) + " |", "|" + "---|" * len(HEADER), *lines]) + "\n"


def main():
    project = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=project / "out" / "bench", help="programs, references [out/bench]")
    parser.add_argument("--ideas", default="", help="regular expression: ideas whose name it is found in")
    parser.add_argument("--scenes", help="regular expression [those of everyscene.py --quick]")
    parser.add_argument("--size", default="160x90")
    parser.add_argument("--seeds", default="1,2", help="by comma; those measured before are kept [1,2]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="of the builds [all processors]")
    parser.add_argument("--patience", type=int, default=120, help="CPU seconds a process may take [120]")
    parser.add_argument("--reference-cpu", type=float, default=60, help="CPU seconds a reference may take [60]")
    parser.add_argument("--check", action="store_true", help="only: do the changes still fit the source?")
    parser.add_argument("--built", action="store_true", help="programs of an earlier run, as they are")
    parser.add_argument("--build-only", action="store_true", help="only: make the programs")
    args = parser.parse_args()
    if args.check:
        check(project)
        return
    bench, folder = Bench(project / "build" / "release", args.out.resolve(), project, False, 0), args.out.resolve() / "ablation"
    ideas = [idea for idea in IDEAS if re.search(args.ideas, idea.name)]
    for idea in (None, *ideas) if not args.built else ():
        build(project, folder, idea, args.jobs)
        print(f"built: {idea.name if idea else WHOLE}", flush=True)
    if args.build_only:
        return
    bench.bin = folder / WHOLE / "bin"
    variants = [Variant(bench, folder, idea) for idea in (None, *ideas)]
    file = folder / "rows.json"
    rows = {f"{r['scene']} {r['size']}": r for r in json.loads(file.read_text())["rows"]} if file.exists() else {}
    wanted = (lambda name: bool(re.search(args.scenes, name))) if args.scenes else lambda name: name in cases.QUICK
    for case in cases.all_cases(bench, wanted, frames_without_camera(bench)):
        key = f"{case.name} {args.size}"
        try:
            rows[key] = measure(bench, variants, case, args.size, args.seeds.split(","), args.patience, args.reference_cpu, rows.get(key))
        except Unfinished as reason:
            print(f"{key}: {reason}", flush=True)
            continue
        told = {idea.name: gain(rows[key], idea.name) for idea in ideas}
        print(f"{key}: " + ", ".join(f"{name} {times(g[0])}" for name, g in told.items() if g), flush=True)
        file.write_text(json.dumps({"machine": machine(bench), "walk": walk_speed(bench), "rows": list(rows.values())}, indent=1))
    kept = json.loads(file.read_text())
    print(table(kept["rows"]))


if __name__ == "__main__":
    main()

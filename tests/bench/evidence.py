#!/usr/bin/env python3
"""The figures of RESULTS.md, measured on this tree by one command.

    make -f Makefile.example evidence                       what is stale, cheapest first; says before what it costs
    make -f Makefile.example evidence HOURS=1               as much of it as an hour allows
    make -f Makefile.example evidence PARTS='start,paper-*' these parts, stale or not
    make -f Makefile.example evidence PARTS=list            all parts: what they judge, scenes, cost, canary
    make -f Makefile.example evidence PARTS=canaries        which rows has a change made stale? some minutes
    make -f Makefile.example evidence PARTS=accept          the change moved bytes but no figure: rows hold as they are
    make -f Makefile.example evidence PARTS=page            RESULTS.md again, from what was measured

A part (parts.py) leaves docs/results/NAME.json: figures, command, machine, commit, and what its canary did. The canary
is the part's smallest chain (canaries.py). While it makes the same data with the same instructions the row is current;
else it is marked as stale and stays. A part that was stopped, kill -9 included, goes on after its last finished step.
"""
import argparse
import fnmatch
import json
import os
import time
from pathlib import Path

import canaries
import results_page
from measure import Bench, Missing, OutOfTime, Steps, commit_of, load, machine, save, walk_speed
from parts import PARTS

COMMAND = "make -f Makefile.example evidence"
ORDERS = ("list", "canaries", "accept", "page")


def options():
    project = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--build", type=Path, default=project / "build" / "release", help="build folder [build/release]"
    )
    parser.add_argument("--out", type=Path, default=project / "out" / "bench", help="references, steps [out/bench]")
    parser.add_argument("--results", type=Path, default=project / "RESULTS.md", help="the page [RESULTS.md]")
    parser.add_argument("--docs", type=Path, default=project / "docs", help="folder of results/ [docs]")
    parser.add_argument("--parts", default="", help=f"names by comma, with * and ?; or {', '.join(ORDERS)}")
    parser.add_argument("--hours", type=float, default=0, help="wall time; 0: no limit")
    parser.add_argument(
        "--small", action="store_true", help="short settings of long parts, said on their rows: to try a part"
    )
    parser.add_argument("--seeds", type=int, default=8, help="of the presets' points of curves [8]")
    parser.add_argument(
        "--sides", default="*", help="sides of curves that are measured beside ours, by semicolon, with * and ? [*]"
    )
    parser.add_argument("--tiny", action="store_true", help="tiny sizes: does every script still run?")
    return project, parser.parse_args()


# ---- what is known

class Rows:
    """The JSON files, one a part."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def file(self, name):
        return self.folder / f"{name}.json"

    def get(self, name):
        return load(self.file(name))

    def put(self, name, row):
        save(self.file(name), row)

    def all(self):
        return {part.name: row for part in PARTS if (row := self.get(part.name))}


def cost(part, row):
    """CPU seconds: those of the last time, else as parts.py has them."""
    return row["cpu_s"] if row and row.get("cpu_s") else part.cost


def chosen(text):
    """Parts by the names in PARTS=."""
    words = [word for word in text.replace(",", " ").split()]
    for word in words:
        if not any(fnmatch.fnmatch(part.name, word) for part in PARTS):
            raise SystemExit(f"PARTS={word}: no part is called so; PARTS=list names them")
    return [part for part in PARTS if any(fnmatch.fnmatch(part.name, word) for word in words)]


def listed(rows):
    print(f"{'part':20} {'CPU s':>6} {'canary':18} {'scenes':26} judges")
    for part in PARTS:
        print(
            f"{part.name:20} {cost(part, rows.get(part.name)):6.0f} {' '.join(part.canaries):18} {part.scenes:26} {part.judges}"
        )


# ---- canaries

def watch(bench, rows, commit):
    """Runs the canaries of all measured rows and marks those whose canary does something else."""
    known = rows.all()
    ran = canaries.run_all(bench, sorted({name for part in PARTS if part.name in known for name in part.canaries}))
    stamp, strange = canaries.stamp(bench), set()
    for part in PARTS:
        row = known.get(part.name)
        if not row:
            continue
        if row["compiler"] and row["compiler"] != stamp:
            strange.add(row["compiler"])
        changes = canaries.differences(row, {name: ran[name] for name in part.canaries if name in ran}, stamp)
        was = row.get("stale")
        if changes:                       # a row that is stale stays so since its first change, with today's words
            row["stale"] = {"since": was["since"] if was else commit, "what": changes}
        elif row["canary"]:
            row["stale"] = None           # the change was taken back
        if row.get("stale") != was:
            rows.put(part.name, row)
        if row.get("stale"):
            print(f"stale: {part.name}: {'; '.join(row['stale']['what'])}", flush=True)
    for other in strange:
        print(f"instructions are not compared: rows were measured with {other}, this is {stamp}")
    print(f"{sum(bool(row.get('stale')) for row in rows.all().values())} of {len(known)} rows are stale", flush=True)


def accept(bench, rows, commit):
    """Stores what canaries do now with all rows."""
    known = rows.all()
    ran = canaries.run_all(bench, sorted({name for part in PARTS if part.name in known for name in part.canaries}))
    for part in PARTS:
        if part.name in known:
            row = known[part.name] | {
                "canary": {name: ran[name] for name in part.canaries if name in ran},
                "stale": None,
                "compiler": canaries.stamp(bench),
                "accepted": commit,
            }
            rows.put(part.name, row)


# ---- measuring

def measure(bench, part, rows, commit, deadline):
    """One part; its row is written when all of its steps are done."""
    began = os.times()
    bench.step = Steps(bench.out / "steps" / f"{part.name}.json", bench.programs_digest(), deadline)
    bench.walk = bench.step("walk", lambda: walk_speed(bench))
    row = part.run(bench)
    ended = os.times()
    cpu = sum(
        getattr(ended, kind) - getattr(began, kind) for kind in ("user", "system", "children_user", "children_system")
    )
    row |= {
        "name": part.name,
        "section": part.section,
        "command": f"{COMMAND} PARTS={part.name}",
        "machine": machine(bench),
        "walk": bench.walk,
        "load": round(os.getloadavg()[0], 1),
        "commit": commit,
        "date": time.strftime("%Y-%m-%d %H:%M", time.gmtime()),
        "cpu_s": round(cpu + bench.step.spent_before, 1),
        "compiler": canaries.stamp(bench),
        "stale": None,
        "canary": canaries.run_all(bench, part.canaries),
    }
    rows.put(part.name, row)
    if not row.get("partial"):     # else its steps serve the run that measures the rest
        bench.step.forget()
    print(results_page.told(row), flush=True)


def main():
    project, args = options()
    rows = Rows(args.docs.resolve() / "results")
    if args.parts == "list":
        listed(rows)
        return
    bench = Bench(args.build.resolve(), args.out.resolve(), project, args.tiny, 16 if args.tiny else 2048)
    bench.small, bench.results = args.tiny or args.small, rows.folder
    bench.preset_seeds, bench.sides = args.seeds, [name.strip() for name in args.sides.split(";")]
    commit, deadline = commit_of(project), time.monotonic() + 3600 * (args.hours or 1e6)
    if args.parts == "accept":
        accept(bench, rows, commit)
    elif args.parts != "page" and (args.parts == "canaries" or not args.parts):
        watch(bench, rows, commit)
    wanted = chosen(args.parts) if args.parts and args.parts not in ORDERS else []
    if not args.parts:
        wanted = [part for part in PARTS if not (row := rows.get(part.name)) or row.get("stale")]
    wanted.sort(key=lambda part: cost(part, rows.get(part.name)))
    if wanted:
        seconds = [cost(part, rows.get(part.name)) for part in wanted]
        print(
            f"{len(wanted)} parts, about {sum(seconds):.0f} CPU s: "
            + ", ".join(f"{p.name} {s:.0f}" for p, s in zip(wanted, seconds)),
            flush=True,
        )
    left_out = {}
    for part in wanted:
        print(f"== {part.name}: {part.judges}", flush=True)
        try:
            measure(bench, part, rows, commit, deadline)
        except Missing as reason:
            print(f"left out: {reason}", flush=True)
            left_out[part.name] = str(reason)
        except OutOfTime:
            print("no time is left; its finished steps are kept", flush=True)
            break
    results_page.write(rows.all(), {part.name: part for part in PARTS}, args.results.resolve(), rows.folder, left_out)
    print(f"wrote {args.results}")


if __name__ == "__main__":
    main()

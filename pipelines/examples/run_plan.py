#!/usr/bin/env python3
"""Renders a range of frames from OUT/plan.json, as make does, without make. Python's standard library only.

    make -f Makefile.example plan OUT=out        or: scene-plan room.glb --frames 0-47 -o out
    python3 pipelines/examples/run_plan.py out --jobs 4 --bin build/release/bin

Each file is made as soon as its inputs are there. A file that is there is up to date: its name ends in a key of all that
it is made from. At the end frames/F.exr are copies of the pictures. Written from formats/plan/plan.md only.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from pathlib import Path


def missing(out, entry):
    """Those files of a command that are not there."""
    return [name for name in (entry["file"], *entry.get("beside", ())) if not (out / name).exists()]


def run(out, programs, entry):
    """Runs one command inside OUT. Returns what is wrong, or None."""
    tool, *words = (os.fsencode(word) for word in entry["argv"])
    said = os.environ | {"TEMPOLUX_SAID": "state/warnings"}     # warnings that scene-plan has given already
    code = subprocess.run([os.path.join(os.fsencode(programs), tool), *words], cwd=out, env=said).returncode
    lost = missing(out, entry)
    return f"{entry['file']}: {entry['argv'][0]} ended with {code}{', without ' + lost[0] if lost else ''}" if code or lost else None


def make_all(out, programs, jobs, entries):
    """Runs commands, `jobs` at once, each after those that make its inputs. Returns what is wrong, in words."""
    maker = {name: entry["file"] for entry in entries for name in (entry["file"], *entry.get("beside", ()))}
    waits = {entry["file"]: {maker[name] for name in entry["inputs"] if name in maker} for entry in entries}
    todo = {entry["file"]: entry for entry in entries if missing(out, entry)}
    wrong, running = [], {}
    with ThreadPoolExecutor(jobs) as pool:
        while True:
            for name in [] if wrong else [name for name in todo if not waits[name] & (todo.keys() | running.keys())]:
                entry = todo.pop(name)
                if not entry["argv"]:
                    wrong.append(f"{name}: needs make: a walkthrough asks before it runs")
                    continue
                running[name] = pool.submit(run, out, programs, entry)
            if not running:
                return wrong or [f"{name}: its inputs wait for each other" for name in todo]
            wait(running.values(), return_when=FIRST_COMPLETED)
            for name in [name for name, job in running.items() if job.done()]:
                wrong += filter(None, [running.pop(name).result()])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="the folder of plan.json")
    parser.add_argument("--jobs", type=int, default=1, help="commands at once [1]")
    parser.add_argument("--bin", type=Path, default=Path("build/release/bin"), help="folder of the tools [build/release/bin]")
    args = parser.parse_args()
    plan = json.loads((args.out / "plan.json").read_text())
    if plan["format"] != "tempolux plan" or not plan["version"].startswith("2.") or "files" not in plan:
        sys.exit(f"{args.out}/plan.json: no plan of version 2.1")
    wrong = make_all(args.out, args.bin.resolve(), args.jobs, plan["files"])
    if wrong:
        sys.exit("\n".join(wrong))
    for frame, picture in plan["pictures"].items():
        shutil.copyfile(args.out / picture, args.out / "frames" / f"{frame}.exr")


if __name__ == "__main__":
    main()

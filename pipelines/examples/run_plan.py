#!/usr/bin/env python3
"""Renders a range of frames from OUT/plan.json, as make does, without make. Python's standard library only.

    make -f Makefile.example plan OUT=out        or: scene-plan room.glb --frames 0-47 -o out
    python3 pipelines/examples/run_plan.py out --jobs 4 --bin build/release/bin

Makes the files that lead to the pictures, each as soon as its inputs are there. A file that is there is up to date: its
name ends in a key of all that it is made from. Written from formats/plan/plan.md only.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from pathlib import Path


def there(out, names):
    return all((out / name).exists() for name in names)


def needed(out, plan):
    """The commands that lead to pictures which are not there."""
    for entry in plan["files"]:
        entry["makes"] = [entry["file"], *entry.get("beside", ())]
    maker = {name: entry for entry in plan["files"] for name in entry["makes"]}
    commands, names = {}, list(plan["pictures"].values())
    while names:
        entry = maker.get(name := names.pop()) or sys.exit(f"plan.json: no command makes {name}")
        if entry["file"] in commands or there(out, entry["makes"]):
            continue
        if not entry["argv"]:
            sys.exit(f"{name}: needs make: a walkthrough asks before it runs")
        commands[entry["file"]] = entry
        names += [name for name in entry["inputs"] if not name.startswith("state/")]   # scene-plan writes these
    return list(commands.values())


def run(out, programs, entry):
    """Runs one command inside OUT. Returns what is wrong, in words; "": nothing."""
    tool, *words = map(os.fsencode, entry["argv"])
    said = os.environ | {"TEMPOLUX_SAID": "state/warnings"}     # warnings that scene-plan has given
    code = subprocess.run([os.path.join(os.fsencode(programs), tool), *words], cwd=out, env=said).returncode
    return "" if code == 0 and there(out, entry["makes"]) else f"{entry['file']}: {entry['argv'][0]} ended with {code}"


def make_all(out, programs, jobs, waiting):
    """Runs commands, `jobs` at once; after an error no further one."""
    wrong, running = [], set()
    with ThreadPoolExecutor(jobs) as pool:
        while True:
            for entry in [entry for entry in waiting if there(out, entry["inputs"]) and not wrong]:
                waiting.remove(entry)
                running.add(pool.submit(run, out, programs, entry))
            if not running:
                return wrong or [f"{entry['file']}: not made: an input is missing" for entry in waiting]
            done, running = wait(running, return_when=FIRST_COMPLETED)
            wrong += [text for text in (job.result() for job in done) if text]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="the folder of plan.json")
    parser.add_argument("--jobs", type=int, default=1, help="commands at once [1]")
    parser.add_argument("--bin", type=Path, default=Path("build/release/bin"), help="of the tools [build/release/bin]")
    args = parser.parse_args()
    plan = json.loads((args.out / "plan.json").read_text())
    if plan["format"] != "tempolux plan" or not plan["version"].startswith("2.") or "files" not in plan:
        sys.exit(f"{args.out}/plan.json: no plan of version 2.1")
    if wrong := make_all(args.out, args.bin.resolve(), args.jobs, needed(args.out, plan)):
        sys.exit("\n".join(wrong))
    for frame, picture in plan["pictures"].items():
        shutil.copyfile(args.out / picture, args.out / "frames" / f"{frame}.exr")


if __name__ == "__main__":
    main()

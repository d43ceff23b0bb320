#!/usr/bin/env python3
"""What goes on at once, breaks off or has other clocks leaves no trace in the frames: two_makes.py BIN [--kills 5] [--seed 1]

Run at the top of the tree; BIN is the folder with the tools. All of it in small scenes, each frame's digest against that of an OUT in which
make ran once and alone:

  together   two makes in one OUT at once, with the same wishes and with different ones
  killed     make and all it started are killed at a random moment, by SIGKILL, SIGTERM or SIGINT, or make alone gets SIGTERM: then all that it
             started has ended before it, and has left no temporary file; then make runs to its end
  replaced   inputs are replaced by others with an older time, as cp -p does
  clocks     files of OUT, or the inputs, are two hours ahead or behind, as by a file server or a second machine: nothing is made again that
             was right, and an edit is noticed
"""
import argparse
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import random_walk                                                                   # noqa: E402

# The makes started here are independent of the make that runs the tests.
for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
    os.environ.pop(name, None)

CASES = {"frames": ("box", {"QUALITY": "final", "MOVING": "light"}), "time": ("box", {"QUALITY": "final", "MOVING": "time"}),
         "filter": ("box", {"FILTER": "3"}), "walkthrough": ("lamp", {"METHOD": "walkthrough"}), "preview": ("box", {"METHOD": "preview"})}


class Trial:
    def __init__(self, folder, tools, title):
        scene, variables = CASES[title]
        self.title, self.state = title, random_walk.first_state(scene)
        self.state["variables"] |= variables
        self.place = random_walk.Workplace(folder / title, tools, "Makefile.example", scene)
        self.place.edit(self.state)
        self.out, self.failed, self.known = self.place.folder / "out", 0, {}
        started = time.monotonic()
        self.digests(self.state)
        self.seconds = time.monotonic() - started

    def digests(self, state):
        """What make gives alone and at once."""
        key = random_walk.key(state)
        if key not in self.known:
            alone = self.place.folder / "alone"
            shutil.rmtree(alone, ignore_errors=True)
            code, text, _ = self.place.make(state, alone)
            if code:
                sys.exit(f"FAILED: {self.title}: {text[-800:]}")
            self.known[key] = self.frames(alone, state)
        return self.known[key]

    def frames(self, out, state):
        files = [p for p in random_walk.wanted(out, state) if p.suffix == ".exr"]
        return [self.place.digests([p]).get(p) if p.exists() else None for p in files]

    def start(self, state):
        command = [x for x in self.place.command(state, self.out) if not x.startswith("RUN=")]
        return subprocess.Popen(["nice", *command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)

    def finish(self, what, state=None):
        """Make runs to its end; are the frames right? Returns what ran."""
        state = state or self.state
        code, text, commands = self.place.make(state, self.out)
        good = code == 0 and self.frames(self.out, state) == self.digests(state)
        if not good:
            self.wrong(f"{what}: " + (f"make failed: {text[-300:]}" if code else "other frames"))
        return [os.path.basename(c[0]) for c in commands if os.path.basename(c[0]) != "scene-plan"]

    def wrong(self, what):
        self.failed += 1
        print(f"FAILED: {self.title}, {what}", flush=True)

    def empty(self):
        shutil.rmtree(self.out, ignore_errors=True)


def together(trial):
    other = {"frames": "light", "time": "light", "filter": "anew", "walkthrough": "anew", "preview": "anew"}[trial.title]
    different = trial.state | {"variables": trial.state["variables"] | {"MOVING": other, "FILTER": "", "METHOD": "", "SIZE": "32x18"}}
    for what, second in (("two makes at once", trial.state), ("two makes with different wishes at once", different)):
        trial.empty()
        makes = [trial.start(trial.state), trial.start(second)]
        for make in makes:
            said = make.communicate(timeout=120)[0].decode(errors="replace")
            if make.returncode:
                trial.wrong(f"{what}: one ends with {make.returncode}: {said[-300:]}")
            size = (trial.state if make is makes[0] else second)["variables"]["SIZE"]
            if not re.search(rf" frames? of {size}: .* look at |Nothing to be done", said):
                trial.wrong(f"{what}: the last line is not of {size}: {said[-300:]}")
        if second is trial.state and trial.frames(trial.out, trial.state) != trial.digests(trial.state):
            trial.wrong(f"{what}: other frames")
        trial.finish(f"{what}, then one alone")
        trial.finish(f"{what}, then the other", second)


def processes_of(group):
    """Names of the processes in a group that have not ended."""
    names = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            name, state, _, its_group = re.match(r"\d+ \((.*)\) (\S) (\d+) (\d+)", stat.read_text()).groups()
        except (OSError, AttributeError):
            continue
        names += [name] if int(its_group) == group and state != "Z" else []
    return names


def stopped(trial, make, what):
    """make alone gets SIGTERM. What it started ends first."""
    make.terminate()
    make.wait(timeout=60)
    if left := processes_of(make.pid):
        trial.wrong(f"{what}: {left} go on")
        os.killpg(make.pid, signal.SIGKILL)
    make.communicate(timeout=60)
    if left := [str(p.relative_to(trial.out)) for p in trial.out.rglob("*") if re.search(r"^[.].*[.]tmp[.]|[.]part[.]|[.]try[.]", p.name)]:
        trial.wrong(f"{what}: left are {left[:3]}")


def killed(trial, count, rng):
    for number in range(count):
        trial.empty()
        moment, name = rng.uniform(0, 1.2 * trial.seconds), rng.choice(["SIGKILL", "SIGTERM", "SIGINT", "make alone", "make alone"])
        make = trial.start(trial.state)
        try:
            make.communicate(timeout=moment)
        except subprocess.TimeoutExpired:
            if name == "make alone":
                stopped(trial, make, f"{name} after {moment:.2f} s")
            else:
                os.killpg(make.pid, getattr(signal, name))
                make.communicate(timeout=60)
        trial.finish(f"{name} after {moment:.2f} s")
    ran = trial.finish("finished, then again")
    if ran:
        trial.wrong(f"finished, then again: {ran[:4]} ran")


def replaced(trial):
    trial.empty()
    trial.finish("a first run")
    for lamp, way in ((1, "older"), (0, "older"), (2, "kept")):
        state = trial.state | {"edits": {"lamp": lamp}, "way": way}
        trial.place.edit(state)
        trial.finish(f"scene replaced by an older one (lamp {lamp})", state)
    trial.place.edit(trial.state)


def shift(paths, seconds):
    for path in paths:
        if path.is_file() and not path.is_symlink():
            info = path.stat()
            os.utime(path, ns=(info.st_atime_ns, info.st_mtime_ns + seconds * 10**9))


def clocks(trial, rng):
    for what, hours in (("two hours ahead", 2), ("two hours behind", -2), ("half of the files two hours ahead", None)):
        trial.empty()
        trial.finish("a first run")
        files = sorted(trial.out.rglob("*"))
        shift(files if hours else rng.sample(files, len(files) // 2), 3600 * (hours or 2))
        ran = trial.finish(f"OUT {what}, nothing changed")
        if ran:
            trial.wrong(f"OUT {what}, nothing changed: {len(ran)} commands ran, {sorted(set(ran))}")
        edited = trial.state | {"edits": {"object": 1}}
        trial.place.edit(edited)
        trial.finish(f"OUT {what}, scene edited", edited)
        shift(trial.place.files.iterdir(), 3600 * (hours or 2))
        ran = trial.finish(f"scene {what}, nothing changed", edited)
        trial.place.edit(trial.state)
        trial.finish(f"scene {what}, then put back", trial.state)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=Path)
    parser.add_argument("--kills", type=int, default=5, help="of all cases together")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--only", default="", help=", ".join(CASES))
    arguments = parser.parse_args()
    rng, failed = random.Random(arguments.seed), 0
    cases = [title for title in CASES if arguments.only in title]
    with tempfile.TemporaryDirectory(prefix="makes") as folder:
        for number, title in enumerate(cases):
            trial = Trial(Path(folder), arguments.bin.resolve(), title)
            together(trial)
            killed(trial, arguments.kills // len(cases) + (number < arguments.kills % len(cases)), rng)
            if number == 0:
                replaced(trial)
                clocks(trial, rng)
            print(f"{'FAILED' if trial.failed else 'ok'}: {title}", flush=True)
            failed += trial.failed
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

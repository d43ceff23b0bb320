#!/usr/bin/env python3
"""Commands that are lost, killed or cut off, and makes that are stopped: interrupted.py BIN [--long] [--only WORD] [--makefile FILE]

Run at the top of the tree; BIN is the folder with the tools. Tiny scenes. make runs in a folder that holds the pictures of another sky.

  lost         a wrapper in RUN ends with 0 without running one of the commands: make must fail and name the file, unless it shows the new
               pictures; the same command, typed again, gives the frames, previews and sheet of a clean run. With --long each single command of
               each method, else one command of each kind that no method before has
  again        as above, but RUN may lose a command once (RETRIES=1): it is named and run again, and make gives what a clean run gives
  jobs         commands joined into jobs, one for each frame, or for each segment (GROUP): the same pictures as alone, by fewer
               commands; a job is lost, named, run again; with --long each single one
  cut, late    the file of a command is cut off: as above; it is seen a second later: make waits for it
  killed       one of the frame-renders is killed with -9: all other frames are shown, one is rendered the next time
  stopped      SIGINT to make's processes while raw frames wait for their filter: they are kept, and not rendered again
  disk         raw frames that are there at once, and rendered frames that are not shown yet: few, not the whole range

--makefile: Makefile.example of another version, to see it fail.
"""

import argparse
import hashlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import walk_scenes                                                                   # noqa: E402

for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):   # independent of the make that runs the tests
    os.environ.pop(name, None)

SMALL = {
    "SIZE": "32x18",
    "PHOTONS": "1k",
    "POINTS": "--point-count 300 --light-samples 1",
    "CACHE": "--rays 20 --error-bound 1",
    "ERROR": "0.05",
    "QUALITY": "draft",
    "INDIRECT": "records",
}
METHODS = {"frames": {"FRAMES": "0-1", "MOVING": "light"}, "window": {"FRAMES": "0-1", "FILTER": "3", "MOVING": "anew"},
           "walkthrough": {"FRAMES": "0-2", "METHOD": "walkthrough", "KEY_DISTANCE": "2", "FILTER": "1"},
           "preview": {"FRAMES": "0-1", "METHOD": "preview", "INDIRECT": "", "TIME": "--segment 2"},
           "smoke": {"FRAMES": "0-1", "UPDATE": "20%", "VOLUME_OPTIONS": "--sigma-t 6 --albedo .8 --volume-frames 0-7"},
           "temporal": {"FRAMES": "0-1", "MOVING": "time", "SPLIT": "on"}}
LONG = {
    "frames": {"FRAMES": "0-2"},
    "window": {"FRAMES": "0-2"},
    "walkthrough": {"FRAMES": "0-4", "KEY_DISTANCE": "4", "THRESHOLD": "0%"},
    "preview": {"FRAMES": "0-2"},
    "smoke": {"FRAMES": "0-2"},
    "temporal": {"FRAMES": "0-2"},
}
SKY, OTHER_SKY = "1,1,1", ".2,.3,.4"


class Chain:
    """One method in a tiny scene, a folder with the pictures of another sky, and what a clean run makes."""

    def __init__(self, folder, method, arguments):
        self.folder, self.method, self.arguments = folder / method, method, arguments
        self.folder.mkdir()
        self.out, self.log, self.failed = self.folder / "out", self.folder / "log", 0
        self.values = (
            SMALL
            | METHODS[method]
            | (LONG[method] if arguments.long else {})
            | {"SCENE": str(self.scene()), "BIN": str(arguments.bin)}
        )
        if method == "smoke":
            self.values["VOLUME"] = str(self.folder / "smoke_####.vdb")
        self.values = {name: value for name, value in self.values.items() if value}

    def scene(self):
        if self.method in ("frames", "window", "preview", "temporal"):
            return Path("pipelines/scenes/S2_cornell_moving.glb").resolve()
        if self.method == "walkthrough":
            scene = self.folder / "pan.glb"
            subprocess.run(
                [
                    sys.executable,
                    "-B",
                    "pipelines/scenes/make_walkthrough.py",
                    "pan",
                    "pipelines/scenes/S1_cornell.glb",
                    scene,
                ],
                check=True,
            )
            return scene
        for frame in range(8):
            walk_scenes.vdb(
                self.arguments.bin.parent / "tests" / "make-vdb", self.folder / f"smoke_{frame:04d}.vdb", frame, 0
            )
        return Path("pipelines/scenes/S1_cornell.glb").resolve()

    def command(self, out, sky=SKY, jobs=2, run=None, **more):
        values = self.values | {"OUT": str(out), "SKY": sky, "WAIT": "0", "RETRIES": "0"} | ({"RUN": run} if run else {}) | more
        for name in ("WAIT", "RETRIES"):
            if name not in self.arguments.makefile.read_text():
                del values[name]
        return [
            "make",
            "-f",
            str(self.arguments.makefile),
            f"-j{jobs}",
            "--no-print-directory",
            "demo",
            *(f"{n}={v}" for n, v in values.items()),
        ]

    def broken(self, what, which):
        """The value of RUN that spoils a command."""
        shutil.rmtree(self.log, ignore_errors=True)
        self.log.mkdir()
        return f"sh {HERE}/broken_run.sh {self.log} {what} {which}"

    def make(self, out, **more):
        done = subprocess.run(self.command(out, **more), capture_output=True, text=True, timeout=300, errors="replace")
        return done.returncode, done.stdout + done.stderr

    def ran(self):
        """(kind, words) of each command under broken_run.sh, in order."""
        files = sorted(self.log.glob("*/command"), key=lambda f: int(f.parent.name))
        return [tuple(f.read_text().split("\n")[:2]) for f in files]

    def spoiled(self):
        return (self.log / "spoiled" / "kind").read_text().strip() if (self.log / "spoiled").exists() else None

    def pictures(self, out):
        """Digests of frames, bytes of previews and sheet."""
        frames = sorted((out / "frames").glob("*.exr"))
        lines = subprocess.run(
            [self.arguments.bin / "tempolux-info", "--digest", *frames], capture_output=True, text=True
        ).stdout.splitlines()
        shown = {Path(line.split(None, 1)[1]).name: line.split()[0] for line in lines}
        return shown | {
            p.name: hashlib.sha1(p.read_bytes()).hexdigest()
            for p in [*(out / "frames").glob("*.png"), out / "sheet.png"]
            if p.exists()
        }

    def prepare(self):
        """Runs alone with both skies."""
        self.other = self.folder / "other"
        for out, sky in ((self.other, OTHER_SKY), (self.folder / "clean", SKY)):
            code, text = self.make(out, sky=sky, run=self.broken("lost", "none"), jobs=1)
            if code:
                sys.exit(f"FAILED: {self.method}: {text[-800:]}")
        self.commands, self.clean = self.ran(), self.pictures(self.folder / "clean")

    def old_pictures(self):
        """OUT with the pictures of the other sky, and with the decisions for this one, which pilots take as long as all else."""
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.copytree(self.other, self.out)
        for decided in (self.folder / "clean" / "state").glob("*.decided"):
            shutil.copy2(decided, self.out / "state")

    def wrong(self, what):
        self.failed += 1
        print(f"FAILED: {self.method}, {what}", flush=True)

    def again(self, what, **more):
        """The same command once more gives what a clean run gives."""
        code, text = self.make(self.out, **more)
        if code or self.pictures(self.out) != self.clean:
            self.wrong(
                f"{what}, then typed again: "
                + (f"make failed: {text[-300:]}" if code else "other pictures than in a clean run")
            )
        left = [
            str(p.relative_to(self.out))
            for p in self.out.rglob("*")
            if re.search(r"^[.].*[.]tmp[.]|[.]part[.]|[.]try[.]|[.]late$", p.name)
        ]
        if left:
            self.wrong(f"{what}, then typed again: left are {left[:3]}")

    def spoil(self, what, which, retries=0, **more):
        """One command is lost or its file is cut off. Returns True if there was such a command."""
        self.old_pictures()
        code, text = self.make(self.out, run=self.broken(what, which), jobs=1, RETRIES=str(retries), **more)
        kind = self.spoiled()
        if not kind:
            return False
        tool = kind.split(":")[0]
        title = " ".join([f"{what}: {which} ({kind}), RETRIES={retries}", *more.values()])
        if retries:
            if code or self.pictures(self.out) != self.clean:
                self.wrong(f"{title}: exit {code}, or other pictures: {text[-400:]}")
            if len(re.findall(rf"^[^ ]+: not made: {tool} .*; it is run again [(]1 of {retries}[)]$", text, re.M)) != 1:
                self.wrong(f"{title}: not named once: {text[-400:]}")
            return True
        if code == 0 and self.pictures(self.out) != self.clean:
            self.wrong(f"{title}: make says success and shows other pictures")
        elif code == 0:
            self.wrong(f"{title}: make does not notice")
        elif not re.search(rf"^[^ ]+: not made: {tool} ", text, re.M):
            self.wrong(f"{title}: not named: {text[-400:]}")
        elif "Type the same command again" not in text and kind not in ("scene-plan", "tempolux-info:account"):
            self.wrong(f"{title}: no last line: {text[-400:]}")
        self.again(title)
        return True


def jobs(chain):
    """Seen to fail: a job that leaves out what another one reads; light in two jobs; a job that asks for the files of make's own RUN."""
    said = []
    for group in ("frame", "segment"):
        chain.old_pictures()
        code, text = chain.make(chain.out, run=chain.broken("lost", "none"), jobs=2, GROUP=group)
        commands = [words for _, words in chain.ran()]
        if code or chain.pictures(chain.out) != chain.clean:
            chain.wrong(f"GROUP={group}: exit {code}, or other pictures: {text[-600:]}")
        joined = [words for words in commands if "/job.sh inside " in words]
        others = [words for words in commands if "/job.sh inside " not in words]
        if len(others) != 2 or len(commands) >= len(chain.commands):   # scene-plan and the account
            chain.wrong(f"GROUP={group}: {len(joined)} jobs, and {others}")
        code, text = chain.make(chain.out, run=chain.broken("lost", "none"), GROUP=group)
        if code or len(chain.ran()) != 1:
            chain.wrong(f"GROUP={group}, typed again: exit {code}, {chain.ran()[1:]}")
        # The first command is that of scene-plan.
        for number in range(2, len(joined) + 2) if chain.arguments.long else [2 if group == "frame" else len(joined) + 1]:
            for retries in (0, 1):
                chain.spoil("lost", number, retries, GROUP=group)
        said.append(f"{len(joined)} jobs")
    return f"{len(chain.commands)} commands as {' or '.join(said)}"


def lost(chain, seen, retries=0):
    """Each command, or one of each kind that no method before had."""
    if chain.arguments.long:
        number = 1
        while chain.spoil("lost", number, retries):
            number += 1
        return f"{number - 1} commands lost" + (" and run again" if retries else "")
    kinds = [k for k in dict.fromkeys(kind for kind, _ in chain.commands) if k not in seen]
    if retries:   # the kinds have been lost one by one already
        kinds = kinds[::4]
    seen.update(kinds)
    return f"{sum(chain.spoil('lost', kind, retries) for kind in kinds)} commands lost" + (" and run again" if retries else "")


def cut(chain):
    for kind in dict.fromkeys(kind for kind, _ in chain.commands):
        if kind.split(":")[-1] in ("cache", "raw", "frames") and not chain.spoil("cut", kind):
            chain.wrong(f"cut: no {kind}")
    return "three files cut off"


def late(chain):
    chain.old_pictures()
    code, text = chain.make(chain.out, run=chain.broken("late", "frame-render:raw"), WAIT="5")
    if code or chain.pictures(chain.out) != chain.clean:
        chain.wrong(f"late: a file that is seen a second later: {text[-300:]}")
    return "a file a second late"


def count(chain, kind):
    return sum(k == kind for k, _ in chain.ran())


def killed(chain, frames):
    """One frame-render is killed."""
    more = {"FRAMES": f"0-{frames - 1}"}
    shutil.rmtree(chain.out, ignore_errors=True)
    code, text = chain.make(chain.out, run=chain.broken("killed", "frame-render:raw"), **more)
    shown = len(list((chain.out / "frames").glob("*.exr")))
    if code == 0 or shown != frames - 1 or "frame-render was ended by signal 9" not in text:
        chain.wrong(f"killed: exit {code}, {shown} of {frames} frames: {text[-400:]}")
    code, text = chain.make(chain.out, run=chain.broken("lost", "none"), **more)
    remade = count(chain, "frame-render:raw")
    if code or remade != 1:
        chain.wrong(f"killed, then typed again: exit {code}, {remade} frames rendered")
    return f"1 of {frames} frame-renders killed: {shown} finished, {remade} remade"


def stopped(chain, frames, after):
    """Filters fail, so that raw frames wait; SIGINT when there are enough."""
    more = {"FRAMES": f"0-{frames - 1}"}
    shutil.rmtree(chain.out, ignore_errors=True)
    raw = lambda: len(list((chain.out / "raw").glob("[0-9]*.exr")))                  # noqa: E731
    make = subprocess.Popen(
        chain.command(chain.out, run=chain.broken("failing", "st-filter:filtered"), **more),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    )
    end = time.monotonic() + 100
    while raw() < after and make.poll() is None and time.monotonic() < end:
        time.sleep(.01)
    if make.poll() is not None:
        chain.wrong(f"stopped: make ended by itself with {raw()} raw frames: {make.communicate()[0].decode()[-300:]}")
    os.killpg(make.pid, signal.SIGINT)
    began = time.monotonic()
    make.communicate(timeout=60)
    if time.monotonic() - began > 3:
        chain.wrong(f"stopped: ends {time.monotonic() - began:.1f} s later")
    left = [p.name for p in chain.out.rglob("*") if re.search(r"^[.].*[.]tmp[.]|[.]part[.]|[.]try[.]", p.name)]
    kept = raw()
    if kept < after or left:
        chain.wrong(f"stopped after {after} raw frames: {kept} are kept, left are {left[:3]}")
    code, text = chain.make(chain.out, run=chain.broken("lost", "none"), **more)
    remade = count(chain, "frame-render:raw")
    shown = len(list((chain.out / "frames").glob("*.exr")))
    if code or remade != frames - kept or shown != frames or raw():
        chain.wrong(
            f"stopped, then typed again: exit {code}, {remade} rendered, {shown} shown, {raw()} raw frames left: {text[-300:]}"
        )
    return f"SIGINT after {after} of {frames} raw frames: {kept} kept, {remade} rendered the next time"


def disk(chain, frames):
    """How many raw frames are there at once, and how many rendered frames are not shown yet."""
    shutil.rmtree(chain.out, ignore_errors=True)
    make = subprocess.Popen(
        chain.command(chain.out, FRAMES=f"0-{frames - 1}"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    most = behind = 0
    while make.poll() is None:
        shown = len(list((chain.out / "frames").glob("*.exr")))
        most = max(most, len(list((chain.out / "raw").glob("[0-9]*.exr"))))
        behind = max(behind, min(frames, len(list((chain.out / "raw").glob("*.json")))) - shown)
        time.sleep(.005)
    window = int(chain.values.get("FILTER", 1))
    limit = window + 4   # two jobs, each with a raw frame under way and one to be filtered
    if make.returncode or most > limit or behind > limit:
        chain.wrong(
            f"disk: exit {make.returncode}, {most} raw frames at once, {behind} frames not shown yet, at most {limit} are needed"
        )
    return f"at most {most} of {frames} raw frames at once, {behind} not shown yet"


def tests_of(chain, seen):
    """{name: test} of a method."""
    frames, after = (24, 18) if chain.arguments.long else (6, 4)
    before = set(seen)
    tests = {"lost": lambda: lost(chain, seen), "again": lambda: lost(chain, before, retries=1), "jobs": lambda: jobs(chain)}
    if chain.method == "frames":
        tests |= {"cut": lambda: cut(chain), "late": lambda: late(chain), "killed": lambda: killed(chain, frames),
                  "stopped": lambda: stopped(chain, frames, after)}
    if chain.method in ("frames", "window"):
        tests["disk"] = lambda: disk(chain, frames)
    return tests


def ordinary_kinds(folder, arguments):
    """The kinds of commands that the method `frames` has, whose test loses them."""
    chain = Chain(folder, "frames", arguments)
    chain.prepare()
    shutil.rmtree(chain.folder)
    return {kind for kind, _ in chain.commands}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=lambda p: Path(p).resolve())
    parser.add_argument("--long", action="store_true")
    parser.add_argument(
        "--only", default="", help=", ".join([*METHODS, "lost", "again", "jobs", "cut", "late", "killed", "stopped", "disk"])
    )
    parser.add_argument("--makefile", type=lambda p: Path(p).resolve(), default=Path("Makefile.example").resolve())
    arguments = parser.parse_args()
    only = set(arguments.only.split(",")) - {""}
    methods, wanted = [m for m in METHODS if m in only] or list(METHODS), only - set(METHODS)
    if "smoke" in methods and not (arguments.bin.parent / "tests" / "make-vdb").exists():
        print("skipped: smoke, built without volumes")
        methods.remove("smoke")
    failed = 0
    with tempfile.TemporaryDirectory(prefix="interrupted") as folder:
        seen = set() if "frames" in methods or arguments.long else ordinary_kinds(Path(folder), arguments)
        for method in methods:
            chain, began = Chain(Path(folder), method, arguments), time.monotonic()
            tests = {name: test for name, test in tests_of(chain, seen).items() if not wanted or name in wanted}
            if {"lost", "again", "jobs", "cut", "late"} & tests.keys():
                chain.prepare()
            for test in tests.values():
                said = test()
                print(
                    f"{'FAILED' if chain.failed else 'ok'}: {method}, {said}, {time.monotonic() - began:.0f} s",
                    flush=True,
                )
            failed += chain.failed
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

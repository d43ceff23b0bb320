#!/usr/bin/env python3
"""A queue of one command a frame: one_frame.py BIN [--only WORD] [--at-once 8]

Run at the top of the tree; BIN is the folder with the tools. Tiny scenes of all methods. Each make makes one frame in the same OUT.

  at once   all frames at once: each file is made once, the frames are those of one make alone, and one make of the whole range runs no stage
  killed    the makes that make light are killed with -9 while others wait: the others make it, and the frames are right
  gone      a claim of a host that is gone: make waits half a minute, then makes the file; of one that lives: make waits as long

Seen to fail: without claims (19 commands of light in place of 3); with the files of the last three plans kept, whatever their frames are.
"""
import argparse
import collections
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "pipelines"))
import interrupted                                                                   # noqa: E402

SHOWN = ("scene-plan", "tempolux-info", "sh", "job")   # plans, previews, sheets, digests: not stages


def stages(chain):
    """How often each command of a stage ran, by its kind."""
    return collections.Counter(kind for kind, _ in chain.ran() if kind.split(":")[0] not in SHOWN)


def difference(a, b):
    return {kind: (a[kind], b[kind]) for kind in sorted(a | b) if a[kind] != b[kind]}


def start(chain, run, frame):
    return subprocess.Popen(chain.command(chain.out, run=run, jobs=1, FRAMES=str(frame)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            text=True, start_new_session=True)


def frames(chain, out):
    return {name: digest for name, digest in chain.pictures(out).items() if name.endswith(".exr")}


def left(chain):
    return [p.name for p in chain.out.rglob("*") if p.name.endswith(".claim") or ".tmp." in p.name or ".part" in p.name]


def ended(chain, makes, what):
    for make in makes:
        said = make.communicate(timeout=60)[0]
        if make.returncode:
            chain.wrong(f"{what}: exit {make.returncode}: {said[-800:]}")


def at_once(chain, count):
    shutil.rmtree(chain.out, ignore_errors=True)
    run = chain.broken("lost", "none")
    ended(chain, [start(chain, run, frame) for frame in range(count)], "at once")
    ran = stages(chain)
    if ran != chain.alone:
        twice = collections.Counter(words for kind, words in chain.ran() if kind.split(":")[0] not in SHOWN)
        chain.wrong(f"at once: commands, and of one make: {difference(ran, chain.alone)}; twice: {[w for w in twice if twice[w] > 1]}")
    if frames(chain, chain.out) != chain.right or left(chain):
        chain.wrong(f"at once: other frames, or left are {left(chain)}")
    code, text = chain.make(chain.out, run=chain.broken("lost", "none"), FRAMES=f"0-{count - 1}")
    if code or stages(chain) or chain.pictures(chain.out) != chain.clean:
        chain.wrong(f"then the whole range: exit {code}, {stages(chain)}, or other pictures: {text[-300:]}")
    return f"{count} makes at once: {sum(ran.values())} commands, as one make"


def killed(chain, count):
    shutil.rmtree(chain.out, ignore_errors=True)
    makes = [start(chain, chain.broken("lost", "none"), frame) for frame in range(count)]
    end, claims = time.monotonic() + 60, []
    while not claims and time.monotonic() < end:
        claims = list((chain.out / "state").glob(".*.claim"))
        time.sleep(.01)
    # The first make, which makes light, ends with all that it started.
    owners = {int(claim.read_text().split()[1]) for claim in claims if claim.exists() and claim.read_text()}
    groups = {os.getpgid(owner) for owner in owners if Path(f"/proc/{owner}").exists()}
    victims = [make for make in makes if make.pid in groups]
    for make in victims:
        os.killpg(make.pid, signal.SIGKILL)
        make.communicate()
    if not victims:
        chain.wrong("killed: no make had a claim")
    ended(chain, [make for make in makes if make not in victims], "killed")
    code, text = chain.make(chain.out, run=chain.broken("lost", "none"), FRAMES=f"0-{count - 1}")
    if code or chain.pictures(chain.out) != chain.clean or left(chain):
        chain.wrong(f"killed, then the whole range: exit {code}, other pictures, or left are {left(chain)}: {text[-300:]}")
    return f"{len(victims)} of {count} makes killed: the others go on"


def gone(chain):
    light = next(p for p in sorted((chain.folder / "clean").rglob("*.photons")))
    claim = f".{light.parent.name}-{light.name}.claim"
    said = []
    for what, alive in (("a host that is gone", 0), ("a host that lives for 45 s", 45)):
        shutil.rmtree(chain.out, ignore_errors=True)
        (chain.out / "state").mkdir(parents=True)
        began = time.monotonic()
        make = start(chain, chain.broken("lost", "none"), 0)
        (chain.out / "state" / claim).write_text("elsewhere 1 0\n")
        while time.monotonic() - began < alive:
            (chain.out / "state" / claim).write_text(f"elsewhere 1 {time.monotonic() - began:.0f}\n")
            time.sleep(2)
        if alive:
            (chain.out / "state" / claim).unlink(missing_ok=True)
        text = make.communicate(timeout=120)[0]
        seconds = time.monotonic() - began
        if make.returncode or not max(28, alive) < seconds < max(28, alive) + 20 or "waits for elsewhere, process 1" not in text:
            chain.wrong(f"{what}: exit {make.returncode} after {seconds:.0f} s: {text[-300:]}")
        if left(chain):
            chain.wrong(f"{what}: left are {left(chain)}")
        said.append(f"{seconds:.0f} s")
    return f"a claim of a host that is gone, of one that lives: {' and '.join(said)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=lambda p: Path(p).resolve())
    parser.add_argument("--only", default="", help=", ".join([*interrupted.METHODS, "at_once", "killed", "gone"]))
    parser.add_argument("--at-once", type=int, default=8)
    arguments = parser.parse_args()
    arguments.long, arguments.makefile = False, Path("Makefile.example").resolve()
    only = set(arguments.only.split(",")) - {""}
    methods, wanted = [m for m in interrupted.METHODS if m in only] or list(interrupted.METHODS), only - set(interrupted.METHODS)
    if not (arguments.bin.parent / "tests" / "make-vdb").exists() and "smoke" in methods:
        print("skipped: smoke, built without volumes")
        methods.remove("smoke")
    failed, count = 0, arguments.at_once
    with tempfile.TemporaryDirectory(prefix="one_frame") as folder:
        for method in methods:
            chain = interrupted.Chain(Path(folder), method, arguments)
            chain.values["FRAMES"] = f"0-{count - 1}"
            code, text = chain.make(chain.folder / "clean", run=chain.broken("lost", "none"), jobs=1)
            if code:
                sys.exit(f"FAILED: {method}: {text[-800:]}")
            chain.alone, chain.clean = stages(chain), chain.pictures(chain.folder / "clean")
            chain.right = frames(chain, chain.folder / "clean")
            tests = {"at_once": lambda: at_once(chain, count), "killed": lambda: killed(chain, count)}
            if method == methods[0]:
                tests["gone"] = lambda: gone(chain)
            for name, test in tests.items():
                if not wanted or name in wanted:
                    began, said = time.monotonic(), test()
                    print(f"{'FAILED' if chain.failed else 'ok'}: {method}, {said}, {time.monotonic() - began:.0f} s", flush=True)
            failed += chain.failed
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

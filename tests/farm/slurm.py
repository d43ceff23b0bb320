#!/usr/bin/env python3
"""The same frames from a real Slurm, whatever is lost: slurm.py BIN [--faults 12] [--seed 1]

Run at the top of the tree; BIN is the folder with the tools. cluster.sh starts Slurm with two nodes on the loopback address; skipped
(77) where it is not installed.

  equal    a moving box and a walkthrough, by RUN='srun ...' with GROUP=frame and by `make slurm`: digests as on one machine
  faults   at a random moment, by turns under `make slurm` and under srun: a node goes down, a job is cancelled, requeued, a tool is killed,
           slurmd is killed, slurmctld is killed, the make is killed by SIGKILL, is stopped by Ctrl-C; two makes at once. Then: the same
           command, typed once more at most, ends with 0 and gives the same digests; nothing is in the queue and nothing is left behind

Seen to fail: jobs without the environment's ENVIRONMENT (sbatch sets it to BATCH); a walkthrough's interval without its keys.
"""
import argparse
import os
import random
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
    os.environ.pop(name, None)
SMALL = {"SIZE": "64x36", "QUALITY": "draft", "INDIRECT": "records", "PHOTONS": "4k", "POINTS": "--point-count 1k --light-samples 1", "WAIT": "2"}
SRUN = "srun -Q -n1 -c{threads} --mem={mem} --time={time}"


def slurm(*words):
    return subprocess.run(words, capture_output=True, text=True).stdout


class Shot:
    def __init__(self, folder, tools, name, **variables):
        self.tools, self.name, self.out = tools, name, folder / name
        self.values = SMALL | {"BIN": str(tools)} | variables
        code, text = self.make(folder / f"{name}-alone")
        if code:
            sys.exit(f"FAILED: {name}: {text[-800:]}")
        self.right = self.digests(folder / f"{name}-alone")

    def command(self, out, way=None):
        more = {"RUN": SRUN, "GROUP": "frame", "THREADS": "1"} if way == "srun" else {}
        return ["make", "-j6", "--no-print-directory", "-f", "Makefile.example", "slurm" if way == "slurm" else "demo", f"OUT={out}",
                *(f"{n}={v}" for n, v in (self.values | more).items())]

    def make(self, out, way=None):
        done = subprocess.run(self.command(out, way), capture_output=True, text=True, timeout=300)
        return done.returncode, done.stdout + done.stderr

    def start(self, way):
        return subprocess.Popen(self.command(self.out, way), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)

    def digests(self, out):
        frames = sorted((out / "frames").glob("*.exr"))
        said = subprocess.run([self.tools / "tempolux-info", "--digest", *frames], capture_output=True, text=True).stdout
        return [line.split()[0] for line in said.splitlines()] + [len(list((out / "frames").glob("*.png"))), (out / "sheet.png").exists()]

    def wrong(self):
        """What is not as it must be after a run that ended with 0."""
        left = [p.name for p in self.out.rglob("*") if re.search(r"[.]tmp[.]|[.]part[.]|[.]try[.]|^slurm-", p.name)]
        queue = slurm("squeue", "-h").strip()
        return (["other digests"] if self.digests(self.out) != self.right else []) + ([f"left are {left[:3]}"] if left else []) + \
            ([f"in the queue: {queue}"] if queue else [])


class Cluster:
    def __init__(self, folder):
        self.folder = folder
        done = subprocess.run(["sh", HERE / "cluster.sh", "start", folder], text=True, stdout=subprocess.PIPE)
        if done.returncode:
            print(done.stdout, end="")
            self.stop()
            sys.exit(done.returncode)
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        os.environ["PATH"] += ":/usr/sbin"

    def stop(self):
        subprocess.run(["sh", HERE / "cluster.sh", "stop", self.folder])

    def pid(self, name):
        return int((self.folder / f"{name}.pid").read_text())

    def mend(self):
        """All daemons run, and both nodes take jobs."""
        for name, command in (("slurmctld", ["slurmctld"]), ("slurmd.n1", ["slurmd", "-N", "n1"]), ("slurmd.n2", ["slurmd", "-N", "n2"])):
            try:
                alive = Path(f"/proc/{self.pid(name)}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
            except OSError:
                alive = False
            if not alive:
                subprocess.run(command)
        for round in range(100):
            slurm("scontrol", "update", "nodename=n1,n2", "state=resume")
            if "2" in slurm("sinfo", "-h", "-o", "%D", "-t", "idle,mixed,allocated").split():
                return
            time.sleep(.2)


def jobs(state="R"):
    return slurm("squeue", "-h", "-r", "-t", state, "-o", "%i").split()


def wait_for(found, seconds=60):
    end = time.monotonic() + seconds
    while not found() and time.monotonic() < end:
        time.sleep(.1)
    return found()


def node_down(cluster, shot, make, rng):
    slurm("scontrol", "update", "nodename=n1", "state=down", "reason=test")
    time.sleep(1)
    slurm("scontrol", "update", "nodename=n1", "state=resume")


def drained(cluster, shot, make, rng):
    slurm("scontrol", "update", "nodename=n2", "state=drain", "reason=test")


def cancelled(cluster, shot, make, rng):
    slurm("scancel", rng.choice(jobs() or jobs("PD") or ["0"]))


def requeued(cluster, shot, make, rng):
    slurm("scontrol", "requeue", rng.choice(jobs() or ["0"]))


def tool_killed(cluster, shot, make, rng):
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
            if words[0].startswith(os.fsencode(shot.tools)) and os.fsencode(shot.out) == os.fsencode(os.readlink(process / "cwd")):
                os.kill(int(process.name), signal.SIGKILL)
                return
        except OSError:
            pass


def slurmd_killed(cluster, shot, make, rng):
    os.kill(cluster.pid("slurmd.n1"), signal.SIGKILL)
    time.sleep(1)
    cluster.mend()


def slurmctld_killed(cluster, shot, make, rng):
    os.kill(cluster.pid("slurmctld"), signal.SIGKILL)
    time.sleep(1)
    cluster.mend()


def make_killed(cluster, shot, make, rng):
    os.killpg(make.pid, signal.SIGKILL)


def stopped(cluster, shot, make, rng):
    os.killpg(make.pid, signal.SIGINT)


def two_at_once(cluster, shot, make, rng):
    other = shot.start("slurm")
    said = other.communicate(timeout=300)[0]
    if other.returncode:
        raise RuntimeError(f"the second make: {said[-400:]}")


FAULTS = [node_down, make_killed, tool_killed, stopped, cancelled, slurmd_killed, two_at_once, requeued, slurmctld_killed, drained]


def fault(cluster, shot, inject, way, rng):
    """Returns what is wrong."""
    shutil.rmtree(shot.out, ignore_errors=True)
    make = shot.start(way)
    at = rng.randint(0, 4)   # so many files of pictures
    wait_for(lambda: jobs() and len(list(shot.out.glob("filtered/*.exr"))) >= at or make.poll() is not None)
    try:
        inject(cluster, shot, make, rng)
    except RuntimeError as error:
        return [str(error)]
    for second in range(200):
        try:
            said = make.communicate(timeout=1)[0]
            break
        except subprocess.TimeoutExpired:   # a job that is requeued would wait for two minutes, until its node is surely free
            for job in slurm("squeue", "-h", "-r", "-t", "PD", "-o", "%i %r").splitlines():
                if job.endswith("BeginTime"):
                    slurm("scontrol", "update", f"jobid={job.split()[0]}", "starttime=now")
    else:
        os.killpg(make.pid, signal.SIGKILL)
        return [f"goes on for 200 s: {slurm('squeue')}"]
    if inject is stopped and not wait_for(lambda: not slurm("squeue", "-h").strip(), 20):
        return [f"Ctrl-C leaves in the queue: {slurm('squeue')}"]
    cluster.mend()
    typed_again = make.returncode != 0
    if typed_again:
        code, said = shot.make(shot.out, way)
        if code:
            return [f"typed again: exit {code}: {said[-600:]}"]
    return shot.wrong()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=lambda p: Path(p).resolve())
    parser.add_argument("--faults", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="faults: " + ", ".join(f.__name__ for f in FAULTS))
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))   # the daemons end, too
    rng, failed = random.Random(arguments.seed), 0
    faults = [f for f in FAULTS if not arguments.only or f.__name__ in arguments.only.split(",")]

    def told(what, wrong, began):
        nonlocal failed
        failed += bool(wrong)
        print(f"{'FAILED' if wrong else 'ok'}: {what}{': ' if wrong else ''}{'; '.join(wrong)}, {time.monotonic() - began:.0f} s", flush=True)

    with tempfile.TemporaryDirectory(prefix="farm") as name:
        folder = Path(name)
        os.chmod(folder, 0o755)
        cluster = Cluster(folder / "cluster")
        try:
            scene = folder / "pan.glb"
            subprocess.run([sys.executable, "-B", "pipelines/scenes/make_walkthrough.py", "pan", "pipelines/scenes/S1_cornell.glb", scene], check=True)
            box = Shot(folder, arguments.bin, "box", SCENE="pipelines/scenes/S2_cornell_moving.glb", FRAMES="0-5")
            walk = Shot(folder, arguments.bin, "walk", SCENE=str(scene), FRAMES="0-6", METHOD="walkthrough", KEY_DISTANCE="3", FILTER="1")
            for shot in (box, walk) if not arguments.only else ():
                for way in ("srun", "slurm"):
                    began = time.monotonic()
                    shutil.rmtree(shot.out, ignore_errors=True)
                    code, text = shot.make(shot.out, way)
                    told(f"{shot.name} by {way}", [f"exit {code}: {text[-600:]}"] if code else shot.wrong(), began)
            for number in range(arguments.faults):
                inject = faults[number % len(faults)]
                way = "slurm" if inject in (two_at_once, requeued) or number // len(faults) % 2 == 0 else "srun"
                began, shot = time.monotonic(), (box, walk)[number // len(faults) // 2 % 2]
                told(f"{shot.name} by {way}, {inject.__name__}", fault(cluster, shot, inject, way, rng), began)
                cluster.mend()
        finally:
            cluster.stop()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

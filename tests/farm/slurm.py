#!/usr/bin/env python3
"""The same frames from a real Slurm, whatever is lost: slurm.py BIN [--faults 4] [--seed 1]

Run at the top of the tree; BIN is the folder with the tools. cluster.sh starts Slurm with two nodes on the loopback address; skipped
(77) where it is not installed.

  equal    a moving box and a walkthrough, by RUN='srun ...' with GROUP=frame, the same in an allocation of salloc, and by `make slurm`: digests as on one machine
  faults   the table of faults.py, in an OUT that holds other pictures: in each stage a node goes down or the tool is killed; at a random
           moment daemons, make or a job are killed, cancelled, requeued, the disk is full, memory is short, clocks differ, two makes run at
           once. Then: each shown frame is the old one or the right one; the same command, typed once more at most, ends with 0 and gives the
           same digests; nothing is in the queue, no process and no file is left behind

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
sys.path.insert(0, str(HERE))
from faults import clocks_apart, hungry_tools, jobs, no_memory, processes_in, slurm, slurmctld_killed, slurmd_killed, stopped, table, tool_at, wait_for    # noqa: E402

for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
    os.environ.pop(name, None)
SMALL = {"SIZE": "64x36", "QUALITY": "draft", "INDIRECT": "records", "PHOTONS": "4k", "POINTS": "--point-count 1k --light-samples 1", "WAIT": "2"}
SRUNS = {"srun": "srun -Q -n1 -c{threads} --mem={mem} --time={time}", "salloc": "srun -Q -N1 -n1 --exact -c{threads} --mem={mem}"}


def start_waiting():
    """Starts jobs that wait after a requeue, two minutes as Slurm is set up. Returns the lines of the other jobs that wait."""
    others = []
    for job in slurm("squeue", "-h", "-r", "-t", "PD", "-o", "%i %r").splitlines():
        if job.endswith("BeginTime"):
            slurm("scontrol", "update", f"jobid={job.split()[0]}", "starttime=now")
        else:
            others.append(job)
    return others


class Shot:
    def __init__(self, folder, tools, name, **variables):
        self.tools, self.name, self.out = tools, name, folder / "disk" / name
        self.alone, self.other, self.hungry = folder / f"{name}-alone", folder / f"{name}-other", folder / "hungry"
        self.values = SMALL | {"BIN": str(tools)} | variables
        for out, more in (self.alone, {}), (self.other, {"PHOTONS": "3k"}):
            code, text = self.make(out, **more)
            if code:
                sys.exit(f"FAILED: {name}: {text[-800:]}")
        self.right, self.old = self.digests(self.alone), self.digests(self.other)

    def old_pictures(self):
        """OUT holds the frames of other photons."""
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.copytree(self.other, self.out)

    def filtered(self):
        """Pictures of this plan."""
        return [p for p in (self.alone / "filtered").glob("*.exr") if (self.out / "filtered" / p.name).exists()]

    def stages(self):
        """Folders of stages, in the order of the plan."""
        lines = (self.alone / "plan.mk").read_text().splitlines()
        folders = dict.fromkeys(line.split("/")[0] for line in lines if ": words :=" in line)
        return [folder for folder in folders if any((self.alone / folder).glob("*[.]*"))]   # not those of the report

    def strange(self):
        """Frames that are neither those of the run before nor the right ones."""
        shown = self.digests(self.out)[:-2]
        return [n for n, digest in enumerate(shown) if digest not in (self.old[n], self.right[n])] if len(shown) == len(self.right) - 2 else shown

    def command(self, out, way=None, **more):
        more = ({"RUN": SRUNS[way], "GROUP": "frame", "THREADS": "1"} if way in SRUNS else {}) | more
        return [*(["salloc", "-Q", "-n2", "--mem-per-cpu=1500M"] if way == "salloc" else []), "make", "-j6", "--no-print-directory", "-f", "Makefile.example", "slurm" if way == "slurm" else "demo", f"OUT={out}",
                *(f"{n}={v}" for n, v in (self.values | more).items())]

    def make(self, out, way=None, **more):
        done = subprocess.run(self.command(out, way, **more), capture_output=True, text=True, timeout=300)
        return done.returncode, done.stdout + done.stderr

    def start(self, way, **more):
        return subprocess.Popen(self.command(self.out, way, **more), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)

    def digests(self, out):
        frames = sorted((out / "frames").glob("*.exr"))
        said = subprocess.run([self.tools / "tempolux-info", "--digest", *frames], capture_output=True, text=True).stdout
        return [line.split()[0] for line in said.splitlines()] + [len(list((out / "frames").glob("*.png"))), (out / "sheet.png").exists()]

    def wrong(self):
        """What is not as it must be after a run that ended with 0."""
        left = [p.name for p in self.out.rglob("*") if re.search(r"[.]tmp[.]|[.]part[.]|[.]try[.]|^slurm-|[.]claim$", p.name)]
        left += [" ".join(words) for _, words in processes_in(self.out)]
        wait_for(lambda: not start_waiting() and not slurm("squeue", "-h").strip(), 90)   # a controller that was killed may take ended jobs for running ones
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

    def log(self):
        return "".join(file.read_text(errors="replace") for file in self.folder.glob("*.log"))

    def forget_log(self):
        for file in self.folder.glob("slurm*.log"):
            os.truncate(file, 0)

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


def fault(cluster, shot, inject, way, stage, rng):
    """Returns what is wrong."""
    shot.old_pictures()
    more = {}
    if inject is no_memory:
        shutil.rmtree(f"{shot.hungry}.once", ignore_errors=True)
        more = {"BIN": str(shot.hungry)}
        cluster.forget_log()
    make, hit = shot.start(way, **more), None
    at = rng.randint(0, 4)   # so many pictures are there

    def moment():
        nonlocal hit
        hit = hit or (tool_at(shot, stage) if stage else None)
        return make.poll() is not None or (hit if stage else jobs() and len(shot.filtered()) >= at)

    wait_for(moment, pause=.01)
    if stage and not hit:
        make.communicate(timeout=200)
        return ["missed"]
    try:
        inject(cluster, shot, make, hit)
    except RuntimeError as error:
        os.killpg(make.pid, signal.SIGTERM)
        return [str(error)]
    for second in range(200):
        try:
            said = make.communicate(timeout=1)[0]
            break
        except subprocess.TimeoutExpired:   # a job that is requeued would wait for two minutes, until its node is surely free
            for job in start_waiting():
                if "DOWN" in job and inject in (slurmctld_killed, slurmd_killed) and second % 10 == 9:   # a new daemon may take a node for lost
                    slurm("scontrol", "update", "nodename=n1,n2", "state=resume")
    else:
        if way != "srun" or slurm("squeue", "-h").strip():
            os.killpg(make.pid, signal.SIGKILL)
            return [f"goes on for 200 s: {slurm('squeue')}"]
        os.killpg(make.pid, signal.SIGINT)   # srun waits for a job that the controller has forgotten (docs/farm.md)
        make.communicate(timeout=60)
    if inject is stopped and not wait_for(lambda: not slurm("squeue", "-h").strip(), 20):
        return [f"Ctrl-C leaves in the queue: {slurm('squeue')}"]
    cluster.mend()
    if make.returncode != 0:
        if strange := shot.strange():
            return [f"neither old nor new: {strange}"]
        code, said = shot.make(shot.out, way)
        if code:
            return [f"typed again: exit {code}: {said[-600:]}"]
    if inject is clocks_apart and "Nothing to be done" not in (said := shot.make(shot.out)[1]):
        return [f"clocks: makes something again: {said[-300:]}"]
    return shot.wrong()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=lambda p: Path(p).resolve())
    parser.add_argument("--faults", type=int, default=0, help="so many rows of the table of faults.py, spread over it; 0: all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="names of faults, divided by commas")
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))   # the daemons end, too
    rng, failed = random.Random(arguments.seed), 0

    def told(what, wrong, began):
        nonlocal failed
        failed += bool(wrong)
        print(f"{'FAILED' if wrong else 'ok'}: {what}{': ' if wrong else ''}{'; '.join(wrong)}, {time.monotonic() - began:.0f} s", flush=True)

    with tempfile.TemporaryDirectory(prefix="farm") as name:
        folder = Path(name)
        os.chmod(folder, 0o755)
        (folder / "disk").mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=200m", "farm", folder / "disk"]).returncode == 0
        cluster = Cluster(folder / "cluster")
        try:
            scene = folder / "pan.glb"
            subprocess.run([sys.executable, "-B", "pipelines/scenes/make_walkthrough.py", "pan", "pipelines/scenes/S1_cornell.glb", scene], check=True)
            box = Shot(folder, arguments.bin, "box", SCENE="pipelines/scenes/S2_cornell_moving.glb", FRAMES="0-5")
            walk = Shot(folder, arguments.bin, "walk", SCENE=str(scene), FRAMES="0-6", METHOD="walkthrough", KEY_DISTANCE="3", FILTER="1")
            hungry_tools(box.hungry, arguments.bin)
            for shot in (box, walk) if not arguments.only else ():
                for way in ("srun", "salloc", "slurm"):
                    began = time.monotonic()
                    shutil.rmtree(shot.out, ignore_errors=True)
                    code, text = shot.make(shot.out, way)
                    told(f"{shot.name} by {way}", [f"exit {code}: {text[-600:]}"] if code else shot.wrong(), began)
            rows = [row for row in table({"box": box, "walk": walk}) if not arguments.only or row[0].__name__ in arguments.only.split(",")]
            count = arguments.faults or len(rows)
            for inject, way, shot, stage in [rows[n * len(rows) // count] for n in range(count)]:
                title, began = f"{shot.name} by {way}, {inject.__name__} {stage}".strip(), time.monotonic()
                if inject.__name__ == "full_disk" and not mounted:
                    print(f"skipped: {title}: no disk can be mounted")
                    continue
                for _ in range(10):   # a short command may end before it is seen
                    wrong = fault(cluster, shot, inject, way, stage, rng)
                    cluster.mend()
                    if wrong != ["missed"]:
                        break
                told(title, wrong, began)
        finally:
            cluster.stop()
            if mounted:
                subprocess.run(["umount", "-l", folder / "disk"])
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

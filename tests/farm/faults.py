"""What can go wrong on a farm: the table of slurm.py. A fault is a function (cluster, shot, make, hit) that does harm while `make` runs;
`hit` is (process, folder) of the tool that is running, stopped by SIGSTOP, where the fault belongs to a stage."""
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path


def slurm(*words):
    return subprocess.run(words, capture_output=True, text=True).stdout


def jobs(state="R"):
    return slurm("squeue", "-h", "-r", "-t", state, "-o", "%i").split()


def wait_for(found, seconds=60, pause=.1):
    end = time.monotonic() + seconds
    while not found() and time.monotonic() < end:
        time.sleep(pause)
    return found()


def processes_in(folder):
    """(number, words) of the processes whose working folder it is."""
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if os.readlink(process / "cwd") == str(folder):
                yield int(process.name), (process / "cmdline").read_bytes().decode(errors="replace").split("\0")
        except OSError:
            pass


def tool_at(shot, stage):
    """The process of the tool that makes a file of this stage, stopped; or None."""
    for number, words in processes_in(shot.out):
        made = words[words.index("--stats") + 1] if "--stats" in words else ""   # beside the output
        if words[0].startswith(str(shot.tools)) and made.startswith(stage + "/"):
            try:
                os.kill(number, signal.SIGSTOP)
                return number
            except OSError:
                pass
    return None


def node_of(process):
    for line in Path(f"/proc/{process}/environ").read_bytes().split(b"\0"):
        if line.startswith(b"SLURMD_NODENAME="):
            return line.split(b"=")[1].decode()
    return "n1"


def node_down(cluster, shot, make, hit):
    node = node_of(hit)
    slurm("scontrol", "update", f"nodename={node}", "state=down", "reason=test")
    time.sleep(1)
    slurm("scontrol", "update", f"nodename={node}", "state=resume")


def tool_killed(cluster, shot, make, hit):
    os.kill(hit, signal.SIGKILL)


def drained(cluster, shot, make, hit):
    slurm("scontrol", "update", "nodename=n2", "state=drain", "reason=test")


def cancelled(cluster, shot, make, hit):
    slurm("scancel", random.choice(jobs() or jobs("PD") or ["0"]))


def requeued(cluster, shot, make, hit):
    slurm("scontrol", "requeue", random.choice(jobs() or ["0"]))


def slurmd_killed(cluster, shot, make, hit):
    os.kill(cluster.pid("slurmd.n1"), signal.SIGKILL)
    time.sleep(1)
    cluster.mend()


def slurmctld_killed(cluster, shot, make, hit):
    os.kill(cluster.pid("slurmctld"), signal.SIGKILL)
    time.sleep(1)
    cluster.mend()


def make_killed(cluster, shot, make, hit):
    os.killpg(make.pid, signal.SIGKILL)


def stopped(cluster, shot, make, hit):
    os.killpg(make.pid, signal.SIGINT)


def two_at_once(cluster, shot, make, hit):
    two_makes(shot)


def two_ranges_at_once(cluster, shot, make, hit):
    two_makes(shot, FRAMES="2-" + shot.values["FRAMES"].split("-")[1])


def two_makes(shot, **more):
    other = shot.start("slurm", **more)
    said = other.communicate(timeout=300)[0]
    if other.returncode:
        raise RuntimeError(f"the second make: {said[-400:]}")


def full_disk(cluster, shot, make, hit):
    """No byte is free on the disk of OUT for three seconds."""
    ballast = shot.out.parent / "ballast"
    with open(ballast, "wb", buffering=0) as file:
        try:
            while True:
                file.write(bytes(1 << 16))
        except OSError:
            pass
    time.sleep(3)
    ballast.unlink()


def no_memory(cluster, shot, make, hit):
    """One command takes more memory than its job may have: Slurm kills it (hungry_tools)."""
    if not wait_for(lambda: "emory limit" in cluster.log() or make.poll() is not None, 60) or "emory limit" not in cluster.log():
        raise RuntimeError("Slurm has killed no job for its memory")


def hungry_tools(folder, tools):
    """Tools of which frame-render takes 1 GB the first time. scene-plan hashes the real ones."""
    folder.mkdir()
    for tool in tools.iterdir():
        (folder / tool.name).symlink_to(tool)
    (folder / "frame-render").unlink()
    (folder / "frame-render").write_text(
        f"#!/bin/sh\nmkdir '{folder}.once' 2> /dev/null && exec {sys.executable} -c 'import time; x = bytearray(1 << 30); time.sleep(20)'\n"
        f"exec '{tools}/frame-render' \"$@\"\n")
    (folder / "frame-render").chmod(0o755)
    return folder


def clocks_apart(cluster, shot, make, hit):
    """Half of the files seem two hours younger, the others two hours older, as if written by machines with other clocks."""
    for number, file in enumerate(sorted(shot.out.rglob("*.*"))):
        try:
            info = os.stat(file)
            os.utime(file, ns=(info.st_atime_ns, info.st_mtime_ns + (7200 if number % 2 else -7200) * 10**9))
        except OSError:
            pass


AT_A_STAGE = [(node_down, "slurm", "box"), (node_down, "srun", "walk"), (tool_killed, "srun", "box"), (tool_killed, "slurm", "walk")]
EVERYWHERE = [slurmd_killed, slurmctld_killed, make_killed, stopped, cancelled, drained, full_disk, no_memory, clocks_apart]
BY_SLURM = [requeued, two_at_once, two_ranges_at_once]


def table(shots):
    """Rows (fault, way, shot, stage)."""
    rows = [(fault, way, shots[name], stage) for fault, way, name in AT_A_STAGE for stage in shots[name].stages()]
    rows += [(fault, way, shot, "") for fault in EVERYWHERE for shot in shots.values() for way in ("slurm", "srun")]
    return rows + [(fault, "slurm", shot, "") for fault in BY_SLURM for shot in shots.values()]

"""Makefile.example as the measurements run it, and what a run has left in OUT (formats/plan/plan.md).

Names of files inside OUT stand here and in no other script.
"""
import json
import os
import re
import subprocess
from pathlib import Path

# Parts of the work that tables show; plan.json says to which part a stage belongs.
PARTS = ("photons", "points", "cache", "frames")


# ---- running it

def command(project, tools, out, goal="demo", **variables):
    """Words of a run. Variables have the names of Makefile.example; None leaves one out. Paths are absolute."""
    return ["make", "-s", "-f", "Makefile.example", "-C", str(project), goal, f"BIN={tools}", f"OUT={out}",
            *(f"{name}={value}" for name, value in variables.items() if value is not None)]


def environment():
    """That of this process, without what a make around it says."""
    return {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}


def run_make(project, tools, out, goal="demo", **variables):
    """CPU seconds of all processes of a run."""
    before = os.times()
    done = subprocess.run(command(project, tools, out, goal, **variables), capture_output=True, text=True, env=environment())
    after = os.times()
    if done.returncode:
        raise RuntimeError(f"exit {done.returncode}: make {goal} OUT={out}\n{done.stderr}")
    return after.children_user - before.children_user + after.children_system - before.children_system


def estimate(project, tools, **variables):
    """What `make estimate` says: CPU seconds, bytes of all files, most bytes on the disk, bytes of memory of the largest
    command."""
    done = subprocess.run(command(project, tools, "none", "estimate", NODES="1", CORES="1", **variables), capture_output=True, text=True,
                          env=environment(), check=True)
    cpu, size, unit = re.search(r"^all +(\S+) +(\S+) (\S+)$", done.stdout, re.M).groups()
    most, of = re.search(r"^disk: at most (\S+) (\S+)", done.stdout, re.M).groups()
    memory = re.search(r"^memory of a job: up to (\d+) MB", done.stdout, re.M)[1]
    units = {"kB": 1e3, "MB": 1e6, "GB": 1e9}
    return {"cpu_s": float(cpu), "bytes": float(size) * units[unit], "disk": float(most) * units[of], "memory": float(memory) * 1e6}


# ---- the tools alone

def chain(run, common, stem, photons=(), points=(), records=(), pixels=(), map_beside=False):
    """Photons, points, records and a frame by the tools alone, as STEM.photons, .irradpoints, .irradcache and .exr; run(tool, *words) runs one.
    `common`: the scene and options of all tools; `map_beside`: the frame reads the photons, too. Returns what the four runs return."""
    lit, points_file, cache = (f"{stem}.{end}" for end in ("photons", "irradpoints", "irradcache"))
    return [run("photon-trace", *common, *photons, "-o", lit),
            run("irradcache-build", "points", *common, "--photons", lit, *points, "-o", points_file),
            run("irradcache-build", "records", *common, "--points", points_file, *records, "-o", cache),
            run("frame-render", *common, "--points", points_file, "--irradcache", cache, *(("--photons", lit) if map_beside else ()), *pixels,
                "-o", f"{stem}.exr")]


# ---- what it has left

def plan_of(out):
    return json.loads((Path(out) / "plan.json").read_text())


def folders_of(out, parts=PARTS):
    """Folders of OUT with the files of these parts of the work."""
    return {stage["folder"] for stage in plan_of(out)["stages"] if stage["part"] in parts}


def made_files(out):
    """Names inside OUT that the current plan makes, relative to it: the first of each command's."""
    return [entry["file"] for entry in plan_of(out)["files"]]


def stats_in(out, *folders):
    """Statistics of all processes of the current plan that have run and whose files are in these folders of OUT."""
    stems = [Path(out) / name.split(".")[0] for name in made_files(out) if name.split("/")[0] in folders]
    files = [stem.with_name(stem.name + end) for stem in stems for end in (".json", ".warp.json")]
    return [json.loads(file.read_text()) for file in files if file.exists()]


def stats_of(out, parts=PARTS):
    """Statistics of all processes of the current plan that have run, of these parts of the work."""
    return stats_in(out, *folders_of(out, parts))


def cpu_of(out):
    """CPU seconds by part of the work."""
    return {part: sum(stats["cpu_s"] for stats in stats_of(out, (part,))) for part in PARTS}


def picture_of(out, frame):
    """The file that a frame shows."""
    return Path(out) / plan_of(out)["pictures"][f"{frame:04d}"]


def frame_of(out, frame):
    """The frame, under its plain name; `frame` may be a pattern of #."""
    return Path(out) / "frames" / (f"{frame}.exr" if isinstance(frame, str) else f"{frame:04d}.exr")


def bytes_of(out):
    """Bytes of all files that the plan makes: what `make estimate` speaks of."""
    files = [Path(out) / name for name in made_files(out)]
    return sum(file.stat().st_size for file in files if file.exists())


def majorants_of(out, first):
    """Bounds of the media of the segment that starts at `first`: a plan has them with --update."""
    found = set(re.findall(rf"--majorants (state/{first:04d}-\S+)", (Path(out) / "plan.mk").read_text()))
    if len(found) != 1:
        raise RuntimeError(f"{out}/plan.mk: {len(found)} files of majorants for the segment of frame {first}; plan with --update")
    return Path(out) / found.pop()


# ---- the preset

def preset(project, name="final"):
    """Options of QUALITY=final or draft as lib/plan/stages.cpp has them: words by kind."""
    row = re.search(rf"constexpr Preset k{name.capitalize()}\{{(.*)\}};", (project / "lib" / "plan" / "stages.cpp").read_text()).group(1)
    photons, points, rays, records, error, samples = (part.strip().strip('"') for part in row.split(", "))
    return {"photons": int(photons.replace("'", "")), "points": points.split(), "records": ["--rays", rays, *records.split()],
            "pixels": ["--spp", samples, "--pixel-error", error]}

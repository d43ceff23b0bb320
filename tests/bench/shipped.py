"""The chain as a user runs it, by make with Makefile.example, and our path tracer beside it: pictures and CPU seconds."""
import json
import os
import resource
import shutil
import subprocess
from pathlib import Path

import cases
import exr
import pipeline

STAGES = pipeline.PARTS
CHANNELS = ("RGBA", "layers")


class Unfinished(Exception):
    """A run was refused or took longer than it may."""


# The path tracer that is compared with: without what adaptive frames learn of lights, and with one ray to one of all lights.
YARDSTICK = ["--integrator", "path"]


def frames_without_camera(bench):
    """Does --camera auto frame a scene that has no camera?"""
    scene = bench.out / "tmp" / "no-camera.gltf"
    made = cases.open_scenes.Scene()
    made.quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1), made.material(0.5, 1.0))
    made.save(scene)
    done = subprocess.run([bench.bin / "scene-plan", scene, "-q", "-o", bench.out / "tmp" / "no-camera"], capture_output=True)
    return done.returncode == 0


class Side:
    """Runs of the chain or of the path tracer on one scene at one size."""

    def __init__(self, bench, case, size, patience):
        self.bench, self.case, self.size, self.patience = bench, case, size, patience
        self.folder = bench.out / "every" / f"run-{os.getpid()}"     # other runs may use the same references

    def spend(self, command):
        """CPU seconds of a command and all it starts; each of its processes may take `patience` of them."""
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (self.patience, self.patience))
        before = os.times()
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, env=pipeline.environment(), preexec_fn=limit)
        after = os.times()
        if done.returncode:
            lines = [line for line in done.stderr.splitlines() if line and not line.startswith("make")]
            raise Unfinished(lines[0] if lines else f"a process took more than {self.patience} CPU s")
        return after.children_user - before.children_user + after.children_system - before.children_system

    def wish(self, frames, channels=CHANNELS, quality="final", variables=None):
        """Variables of Makefile.example for the scene."""
        case = self.case
        return {"SCENE": case.file.resolve(), "FRAMES": frames, "SIZE": self.size, "CAMERA": case.camera, "CHANNELS": ",".join(channels),
                "TIME": " ".join(map(str, case.shared)), "QUALITY": quality, "ENVIRONMENT": case.environment and case.environment.resolve(), **(variables or {})}

    def chain(self, seed, quality="final", channels=CHANNELS, keep=None, variables=None, leave=False):
        """(picture, CPU seconds, those of each stage, what frame-render and the filter say of the frame); `keep`: a file that the frame is moved to, None:
        then the picture is read. `variables`: further ones of Makefile.example; `leave`: the run stays in self.folder."""
        shutil.rmtree(self.folder, ignore_errors=True)
        frame = pipeline.frame_of(self.folder, self.case.frame)
        cpu = self.spend(pipeline.command(self.bench.project, self.bench.bin, self.folder, f"frames/{frame.name}", RUN=f"sh {Path(__file__).with_name('with_seed.sh')} {seed}",
                                          **self.wish(self.case.frame, channels, quality, variables)))
        stages = pipeline.cpu_of(self.folder)
        said = {name: value for stats in pipeline.stats_of(self.folder, ("frames",)) if stats["tool"] in ("frame-render", "st-filter") for name, value in stats["results"].items()}
        image = shutil.move(frame, keep) if keep else exr.read(frame)
        if not leave:
            shutil.rmtree(self.folder)
        return image, cpu, stages, said

    def paths(self, spp, seed, channels=CHANNELS):
        """(picture, CPU seconds that do not depend on the samples, those of a sample per pixel)"""
        image, stats = self.bench.out / "tmp" / f"path-{os.getpid()}.exr", self.bench.out / "tmp" / f"path-{os.getpid()}.json"
        cpu = self.spend([self.bench.bin / "frame-render", self.case.file, *self.case.options(), *YARDSTICK, "--size", self.size,
                          "--spp", spp, "--seed", seed, "--channels", *channels, "--compression", "none", "-q", "-o", image, "--stats", stats])
        render = sum(p["cpu_s"] for p in json.loads(stats.read_text())["phases"] if p["name"] == "render")
        return exr.read(image), cpu - render, render / spp


def preset(bench, name, seed, size=None, quality="final"):
    """(file of the frame with layers and ids, CPU seconds of all processes): one of our scenes, rendered afresh."""
    case = next(case for case in cases.ours(bench) if case.name == name)
    keep = bench.out / "frames" / f"{name}-{quality}-{seed}.exr"
    image, cpu, *_ = Side(bench, case, size or bench.size, 10**5).chain(seed, quality, (*CHANNELS, "id"), keep)
    return Path(image), cpu

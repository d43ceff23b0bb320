"""Path-traced references that grow as they are needed and are kept, and what an error costs path tracing."""
import hashlib
import json
import math
from pathlib import Path

import exr
import pixels
from shipped import CHANNELS

FIRST = 64            # samples per pixel of the first halves together
VIEW = ("worldToCamera", "worldToNDC")


def digest(case, size, options):
    """Of all that the picture depends on but the programs."""
    result = hashlib.sha256()
    files = sorted(p for p in case.file.parent.rglob("*") if p.is_file()) if case.file.suffix == ".gltf" else [case.file]
    for file in files + ([case.environment] if case.environment else []):
        result.update(file.read_bytes())
    result.update(repr((case.frame, case.camera, case.shared, size, options)).encode())
    return result.hexdigest()[:12]


class Reference:
    """Two halves of a path-traced picture, kept from run to run. `options`: of the path tracer."""

    def __init__(self, bench, case, size, options):
        self.bench, self.case, self.size, self.options = bench, case, size, list(options)
        folder = bench.out / "every" / "reference"
        folder.mkdir(parents=True, exist_ok=True)
        self.stem = folder / f"{case.name}-{size}-{digest(case, size, options)}"
        self.files = [self.stem.with_name(f"{self.stem.name}_{h}.exr") for h in "ab"]
        self.facts_file = Path(f"{self.stem}.json")
        self.facts = {"spp": 0, "cpu_s": 0.0, "parts": 0}
        self.halves = None
        if self.facts_file.exists() and all(f.exists() for f in self.files):
            self.facts = json.loads(self.facts_file.read_text())
            self.halves = [exr.read(f) for f in self.files]

    def agrees_with(self, image):
        """Is it seen by the same camera? If not, it was rendered when --camera auto or the file's reader meant another one."""
        return not self.halves or self.facts["view"] == view(image)

    def forget(self):
        self.facts, self.halves = {"spp": 0, "cpu_s": 0.0, "parts": 0}, None

    def grow(self):
        """Twice the samples: further halves with a seed of their own, averaged with those there are."""
        had, more = self.facts["spp"], self.facts["spp"] or FIRST
        temporary = self.stem.with_name(self.stem.name + "-more.exr")
        stats = self.bench.tool("frame-render", self.case.file, *self.case.options(), *self.options, "--size", self.size, "--spp", more,
                                "--seed", 1000003 + self.facts["parts"], "--halves", "--channels", *CHANNELS, "--compression", "none",
                                "-o", temporary)
        parts = [temporary.with_name(f"{temporary.stem}_{h}.exr") for h in "ab"]
        added = [exr.read(part) for part in parts]
        self.facts |= {"view": view(added[0]), "spp": had + more, "cpu_s": self.facts["cpu_s"] + stats["cpu_s"],
                       "parts": self.facts["parts"] + 1}
        if self.halves:
            for old, new in zip(self.halves, added):
                for name, values in new.channels.items():
                    for i, v in enumerate(old.channels[name]):
                        values[i] = (had * v + more * values[i]) / (had + more)
        self.halves = added
        for file, image in zip(self.files, added):
            exr.write(file, image.width, image.height, image.channels)
        for file in (temporary, *parts):
            file.unlink()
        self.facts_file.write_text(json.dumps(self.facts))

    def until(self, sufficient, most_cpu):
        """Grows until sufficient(half, half), or until growing again would cost more than `most_cpu` seconds in all; was it?"""
        if not self.halves:
            self.grow()
        while not sufficient(*self.halves):
            if 2 * self.facts["cpu_s"] > most_cpu:
                return False
            self.grow()
        return True


def view(image):
    return [image.attributes[name].hex() for name in VIEW if name in image.attributes]


class Curve:
    """What seen error costs: straight lines between measured points of log CPU over log error, error ~ 1/sqrt(CPU) beyond them."""

    def __init__(self, points):
        """points: (CPU seconds, error)"""
        self.points = sorted((cpu, error) for cpu, error in points if error > 0)

    def cost(self, error):
        """(CPU seconds for this error, is it inside the measured points?)"""
        logs = [(math.log(c), math.log(e)) for c, e in self.points]
        wanted = math.log(max(error, 1e-9))
        for (c0, e0), (c1, e1) in zip(logs, logs[1:]):
            if e1 <= wanted <= e0 and e1 < e0:
                return math.exp(c0 + (c1 - c0) * (e0 - wanted) / (e0 - e1)), True
        c, e = logs[0] if wanted > logs[0][1] else logs[-1]
        return math.exp(c + 2 * (e - wanted)), False

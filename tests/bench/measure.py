"""What all measurements share: running tools, their statistics, medians, the machine."""
import hashlib
import json
import math
import os
import shlex
import subprocess
import time
from pathlib import Path


NORMAL_WALK = 5.0     # million photons per CPU second of one thread: walk_speed() of the machine on which the limits were set


class Missing(Exception):
    """A measurement lacks a program or file; it is left out and the page says so."""


class OutOfTime(Exception):
    """The next step would begin after the time that was given."""


def load(file):
    """The JSON of a file; None if there is none."""
    return json.loads(file.read_text()) if file.exists() else None


def save(file, value):
    """Whole or not at all, whatever happens meanwhile."""
    part = file.with_name(f"{file.name}.{os.getpid()}")
    part.write_text(json.dumps(value, indent=1) + "\n")
    os.replace(part, file)


class Steps:
    """Results of a part's steps, kept in a file until the part is finished: a run that was stopped goes on after the last of them. Those of
    other programs are forgotten."""

    def __init__(self, file, programs, deadline=math.inf):
        self.file, self.deadline = file, deadline
        self.file.parent.mkdir(parents=True, exist_ok=True)
        self.kept = load(file) or {}
        if self.kept.get("programs") != programs:
            self.kept = {"programs": programs, "cpu_s": 0.0, "found": {}}
        self.spent_before = self.kept["cpu_s"]

    def __call__(self, name, make):
        if name not in self.kept["found"]:
            if time.monotonic() > self.deadline:
                raise OutOfTime
            before = os.times()
            made = make()
            after = os.times()
            self.kept["found"][name] = made
            self.kept["cpu_s"] += sum(getattr(after, k) - getattr(before, k) for k in ("user", "system", "children_user", "children_system"))
            save(self.file, self.kept)
        return self.kept["found"][name]

    def forget(self):
        self.file.unlink(missing_ok=True)


class Bench:
    """Where things are, how much is to be measured, and what has been run."""

    def __init__(self, build, out, project, tiny, reference_samples):
        self.bin, self.programs = build / "bin", build / "tests" / "bench"
        self.out, self.project, self.tiny = out, project, tiny
        self.reference_samples = 16 if tiny else reference_samples
        self.size = "48x28" if tiny else "320x180"
        self.rounds = 1 if tiny else 5
        self.small, self.results = tiny, out      # short settings of long parts; where pages and pictures go
        self.preset_seeds, self.sides = 8, ["*"]  # of curves: seeds of the presets' points, sides beside ours
        self.walk = None      # walk_speed() at the beginning of the part that is being measured
        shared = project / ".." / "shared" / "scenes"
        self.shared = shared if shared.is_dir() else None
        memory = Path("/dev/shm")
        self.memory = memory if os.access(memory, os.W_OK) else out
        self.step = lambda name, make: make()     # evidence.py keeps what steps find
        for folder in (out, out / "frames", out / "reference", out / "tmp"):
            folder.mkdir(parents=True, exist_ok=True)

    def normalised(self, cpu_s):
        """CPU seconds as a processor would take whose bare walk makes NORMAL_WALK million photons a second; those measured, where
        its speed is not known. Processors of one name differ by 1.8."""
        return cpu_s * (self.walk or NORMAL_WALK) / NORMAL_WALK

    def programs_digest(self):
        """Of the tools and their modules."""
        result = hashlib.sha256()
        for folder in (self.bin, self.bin.parent / "modules"):
            for file in sorted(p for p in folder.glob("*") if p.is_file()):
                result.update(file.read_bytes())
        return result.hexdigest()[:16]

    # ---- scenes

    def scene(self, name):
        """(file, frame) of a scene by its short name."""
        files = {"S1": ("S1_cornell.glb", 0), "S2": ("S2_cornell_moving.glb", 10), "S3": ("S3_indirect_room.glb", 1),
                 "S4": ("S4_atrium.glb", 10), "PC": ("cornell_classic.gltf", 0)}
        file, frame = files[name]
        for folder in (self.project / "pipelines" / "scenes", self.shared and self.shared / "made"):
            if folder and (folder / file).exists():
                return folder / file, frame
        raise Missing(f"{file} is not here (../shared/scenes is absent)")

    def third_party_halves(self, name):
        """Cycles' reference of a scene, two files."""
        file, frame = self.scene(name)
        halves = [self.shared / "ref" / f"{file.stem}_f{frame:04d}_{h}.exr" for h in "ab"] if self.shared else []
        if self.tiny or not halves or not all(h.exists() for h in halves):
            raise Missing("the references of ../shared/scenes are absent" if not self.tiny else "short form")
        return halves

    # ---- programs

    def tool(self, name, *arguments):
        """Runs a tool of ours; its statistics."""
        stats = self.out / "tmp" / "stats.json"
        self.run([self.bin / name, *arguments, "--stats", stats, "-q"])
        return json.loads(stats.read_text())

    def program(self, name, *arguments):
        """Runs a benchmark program that prints JSON."""
        if not (self.programs / name).exists():
            raise Missing(f"{name} has not been built")
        return json.loads(self.run([self.programs / name, *arguments]).stdout)

    def run(self, command, variables=None, codes=(0,)):
        command = [str(part) for part in command]
        done = subprocess.run(command, capture_output=True, text=True, env=os.environ | (variables or {}))
        if done.returncode not in codes:
            raise RuntimeError(f"exit {done.returncode}: {shlex.join(command)}\n{done.stderr}")
        return done

    # ---- frames that several measurements look at

    def cached(self, folder, stem, inputs, suffixes, make, fresh=False):
        """Files folder/stem-KEY+suffix, made once per content of `inputs` (files and option strings)."""
        digest = hashlib.sha256()
        for part in inputs:
            digest.update(part.read_bytes() if isinstance(part, Path) else str(part).encode())
        name = f"{stem}-{digest.hexdigest()[:10]}"
        files = [self.out / folder / (name + suffix) for suffix in suffixes]
        if fresh or not all(file.exists() for file in files):
            make(name)
        return files

    def reference_halves(self, name, size=None, samples=None):
        """Our own reference, two files. Kept when tools change: unbiased is unbiased; remove the folder to renew it."""
        scene, frame = self.scene(name)
        samples = 16 if self.tiny else samples or self.reference_samples
        options = ["--frame", frame, "--size", size or self.size, "--integrator", "path", "--halves", "--spp",
                   samples, "--seed", 1000003, "--channels", "RGBA,layers,id"]

        def make(stem):
            print(f"  reference of {name}, {samples} samples per pixel ...", flush=True)
            self.run([self.bin / "frame-render", scene, *options, "-q", "-o", self.out / "reference" / f"{stem}.exr"])
        return self.cached("reference", name, [scene, *options], ["_a.exr", "_b.exr"], make)

    def compare(self, frame, halves, output, layer=None, *options):
        """aqm-compare against reference halves; its JSON, kept in `output`. A reference may be from an older version, whose
        hashes of the same scene may differ."""
        self.run([self.bin / "aqm-compare", frame, "--reference-halves", *halves, "--json", output, "-q", "--allow-stale",
                  *(["--layer", layer] if layer else []), *options])
        return json.loads(Path(output).read_text())


def figure(title, asked, header, rows, met, notes=(), measured="", worth=None, paper="", **more):
    """A row of RESULTS.md. `measured`: the value that was asked for, in a few words; `worth`: what was reached over what was asked, at least 1 if
    met; `paper`: the paper's figure and against what it stands."""
    return {"title": title, "asked": asked, "header": header, "rows": rows, "met": met, "notes": list(notes), "measured": measured, "worth": worth,
            "paper": paper, **more}


def median(values):
    ordered = sorted(values)
    middle = len(ordered) // 2
    return ordered[middle] if len(ordered) % 2 else (ordered[middle - 1] + ordered[middle]) / 2


def timed(command):
    """(wall seconds, CPU seconds) of one process."""
    begin = time.monotonic()
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"exit {process.returncode}: {command}")
    return time.monotonic() - begin, usage.ru_utime + usage.ru_stime


def running_processes():
    """Threads that want a processor at this moment, without this one."""
    return int(Path("/proc/loadavg").read_text().split()[3].split("/")[0]) - 1


def wait_for_quiet(seconds):
    """Waits until nobody else wants a processor for a second, at most `seconds`; did it happen?"""
    end, quiet = time.monotonic() + seconds, 0
    while quiet < 5:
        quiet = quiet + 1 if running_processes() <= 0 else 0
        if time.monotonic() > end:
            return False
        time.sleep(0.2)
    return True


def commit_of(project):
    """With a plus where the sources differ from it."""
    def git(*words):
        return subprocess.run(["git", "-C", str(project), *words], capture_output=True, text=True).stdout.strip()
    changed = git("status", "--porcelain", "-uno", "--", "lib", "tools", "formats", "modules", "pipelines", "CMakeLists.txt", "cmake")
    return (git("rev-parse", "--short", "HEAD") or "unknown") + ("+" if changed else "")


def machine(bench):
    """One line: processors, their kind and their speed now, version of the project. Processors of one name differ by a factor
    of two: the speed, of one thread of bare_walk on S2, makes CPU seconds comparable."""
    model = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                  if line.startswith("model name")), "unknown processor")
    speed = bench.walk or walk_speed(bench)
    speed = f", bare walk {speed:.1f} M photons/s" if speed else ""
    return f"{len(os.sched_getaffinity(0))} x {model}{speed}, commit {commit_of(bench.project)}"


def walk_speed(bench):
    """Million photons that the bare walk sends through S2 in a CPU second of one thread; None where it is not built."""
    photons = 20000 if bench.tiny else 10**6
    try:
        scene, frame = bench.scene("S2")
        return photons / 1e6 / median([bench.program("bare_walk", scene, "--frame", frame, "--photons", photons, "--threads", 1)["cpu_s"]
                                       for _ in range(3)])
    except Missing:   # what was measured is not lost for it
        return None


def quantity(value, digits=3):
    """A number with `digits` significant digits, without exponents where people read."""
    if value is None:
        return "-"
    if isinstance(value, str) or isinstance(value, int):
        return str(value)
    return f"{value:.{digits}g}" if 1e-3 <= abs(value) < 1e4 or value == 0 else f"{value:.{digits - 1}e}"


def percent(value, digits=2):
    return f"{100 * value:.{digits}f} %"


def big(count):
    """10000 -> 10k."""
    for unit, size in (("M", 10**6), ("k", 10**3)):
        if count >= size and count % size == 0:
            return f"{count // size}{unit}"
    return str(count)

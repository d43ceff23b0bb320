"""Runs tools within bounds of time and memory, looks at every number they write, and keeps the rows of the table."""
import dataclasses
import json
import math
import os
import pathlib
import resource
import struct
import subprocess
import sys
import threading
import time

import exr

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "formats"))
import read_irradcache  # noqa: E402
import read_photons  # noqa: E402

SHORT, FULL, LONG = range(3)
GIB = 1 << 30
CASES = []                                     # (family, name, level, function), in the order of the table


def case(family, name, level=SHORT):
    def register(function):
        CASES.append((family, name, level, function))
        return function
    return register


class Failed(Exception):
    """The case cannot go on; the row says why."""


@dataclasses.dataclass
class Run:
    command: str
    code: int
    seconds: float
    cpu: float
    memory: int                                # bytes; never below that of this script
    out: bytes
    err: str
    killed: bool


@dataclasses.dataclass
class Row:
    case: str
    quantity: str
    expected: str
    got: str
    error: str
    seconds: float
    verdict: str


def shown(value):
    return value if isinstance(value, str) else f"{value:.6g}"


def finite_json(text):
    def refuse(word):
        raise Failed(f"{word} in JSON")
    return json.loads(text, parse_constant=refuse)


class Session:
    def __init__(self, tools, scratch, level, sanitized=False):
        """`sanitized`: the tools carry run-time checks, so what they cost says nothing and is not judged."""
        self.tools, self.scratch, self.level = pathlib.Path(tools), pathlib.Path(scratch), level
        self.sanitized = sanitized
        self.rows, self.title, self.mark, self.count = [], "", time.monotonic(), 0

    def pick(self, short, full, long=None):
        return (short, full, full if long is None else long)[self.level]

    def path(self, ending):
        self.count += 1
        return str(self.scratch / f"{self.count:05d}{ending}")

    def forget(self):
        """Photons and points of cases that make many."""
        for file in self.scratch.iterdir():
            if file.suffix in (".photons", ".irradpoints"):
                file.unlink()

    # ---- rows ----

    def begin(self, title):
        self.title, self.mark = title, time.monotonic()

    def row(self, quantity, expected, got, error, verdict):
        now = time.monotonic()
        self.rows.append(Row(self.title, quantity, shown(expected), shown(got), error, now - self.mark, verdict))
        self.mark = now
        return self.rows[-1]

    def near(self, quantity, expected, got, tolerance):
        """Relative tolerance; absolute if 0 is expected."""
        error = got / expected - 1 if expected else got
        good = math.isfinite(got) and abs(error) <= tolerance
        self.row(quantity, expected, got, f"{error:+.1e} of {tolerance:.1e}", "ok" if good else "FAIL")

    def at_most(self, quantity, limit, got):
        self.row(quantity, f"<= {limit:.4g}", got, "", "ok" if 0 <= got <= limit else "FAIL")

    def cost_at_most(self, quantity, limit, got):
        """Seconds, memory, and their ratios."""
        if not self.sanitized:
            self.at_most(quantity, limit, got)

    def true(self, quantity, good, got="", expected="yes"):
        self.row(quantity, expected, got or ("yes" if good else "no"), "", "ok" if good else "FAIL")

    def skipped(self, why):
        self.row(why, "", "", "", "skipped")

    # ---- tools ----

    def run(self, tool, *arguments, timeout=120, address_space=8 * GIB, sink=None):
        """`sink`: called with pieces of standard output as they come."""
        command = [str(self.tools / tool), *map(str, arguments)]
        outputs = [open(self.scratch / name, "w+b") for name in ("stdout", "stderr")]

        def limit():
            if not self.sanitized:
                resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        start = time.monotonic()
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE if sink else outputs[0],
                                   stderr=outputs[1], preexec_fn=limit)
        timer = threading.Timer(timeout * (10 if self.sanitized else 1), process.kill)
        timer.start()
        if sink:
            while piece := process.stdout.read1(1 << 20):
                sink(piece)
            process.stdout.close()
        _, status, usage = os.wait4(process.pid, 0)
        killed = not timer.is_alive()
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        texts = []
        for file in outputs:
            file.seek(0)
            texts.append(file.read())
            file.close()
        return Run(" ".join([tool, *command[1:]]), process.returncode, time.monotonic() - start,
                   usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, texts[0],
                   texts[1].decode("utf-8", "replace"), killed)

    def done(self, run, codes=(0,)):
        """The run, if it ended well; otherwise the case ends here."""
        if run.killed:
            raise Failed(f"no end after {run.seconds:.0f} s: {run.command}")
        if run.code not in codes:
            raise Failed(f"exit {run.code}: {run.command}: {run.err.strip()[:300]}")
        return run

    def refused(self, quantity, run, output=None, codes=(2,), seconds=None, memory=None):
        """Exit code, exactly one line on stderr, no output; within the limits."""
        lines = run.err.splitlines()
        faults = [] if run.code in codes and not run.killed else [f"exit {run.code}"]
        if run.killed:
            faults.append(f"no end after {run.seconds:.0f} s")
        if len(lines) != 1:
            faults.append(f"{len(lines)} lines on stderr")
        if output and os.path.exists(output):
            faults.append("left an output")
        if seconds and run.seconds > seconds and not self.sanitized:
            faults.append(f"{run.seconds:.1f} s")
        if memory and run.memory > memory and not self.sanitized:
            faults.append(f"{run.memory / 1e6:.0f} MB")
        expected = "exit " + " or ".join(map(str, codes)) + ", one line"
        self.row(quantity, expected, ", ".join(faults) or f"exit {run.code}", "",
                 "FAIL" if faults else "refused as it should")

    def render(self, scene, size, spp, *options, timeout=300):
        """frame-render, and the frame it made: every number in it is finite, its statistics are JSON."""
        out, stats = self.path(".exr"), self.path(".json")
        run = self.run("frame-render", scene, "--size", f"{size[0]}x{size[1]}", "--spp", spp, "--compression", "none",
                       "--stats", stats, "-o", out, *options, timeout=timeout)
        self.done(run)
        try:
            image = exr.read(out)
        except ValueError as error:
            raise Failed(str(error)) from None
        if image.not_finite():
            raise Failed(f"NaN or infinity in {image.not_finite()}: {run.command}")
        image.path, image.run = out, run
        image.stats = self.read_json(stats)
        return image

    def read_json(self, path):
        with open(path, encoding="utf-8") as file:
            return finite_json(file.read())

    def phase(self, stats, name):
        return next(p["cpu_s"] for p in stats["phases"] if p["name"] == name)

    def photons(self, scene, count, *options, timeout=300):
        """photon-trace into a file, which is read whole; totals and statistics as one dict."""
        out, stats = self.path(".photons"), self.path(".json")
        run = self.done(self.run("photon-trace", scene, "--photons", count, "--stats", stats, "-o", out, *options,
                                 timeout=timeout))
        result = {"path": out, "run": run, "stats": self.read_json(stats)}
        if os.path.getsize(out) < 8 << 20:
            self.read_in_python(out)
        info = self.done(self.run("tempolux-info", "--json", out, timeout=timeout))
        result.update(finite_json(info.out))
        return result

    def read_in_python(self, path):
        try:
            return read_photons.read_photons(path)
        except ValueError as error:
            raise Failed(f"{path}: {error}") from None

    def cached(self, scene, size, spp=4, *, photons=None, common=(), points=(), records=(), pixels=(), seed=0, timeout=300):
        """The frame by photon-trace, irradcache-build and frame-render --irradcache; beside it the files (`photons`,
        `points`, `records`), the cache as read in Python and the statistics of its making. `common`: options of the
        last two stages, `points`, `records`, `pixels` of one; `seed`: of all. Indirect light comes from points: 2 x 2000 in the
        short form, where the tools take 2 x 20 000."""
        files = [self.path(end) for end in (".photons", ".irradpoints", ".irradcache", ".json")]
        common = (*common, "--seed", seed)
        self.done(self.run("photon-trace", scene, "--photons", photons or self.pick("20k", "200k"), "--kinds",
                           "caustic,indirect", "--seed", seed, "-o", files[0], timeout=timeout))
        run = self.done(self.run("irradcache-build", scene, "--photons", files[0], "--keep-points", files[1], "--size",
                                 f"{size[0]}x{size[1]}", *self.pick(("--point-count", "2k", "--rays", 200), ()), *points, *records, *common,
                                 "-o", files[2], "--stats", files[3], timeout=timeout))
        self.done(self.run("tempolux-info", "--check", *files[:3]))
        image = self.render(scene, size, spp, "--irradcache", files[2], "--points", files[1], "--photons", files[0], "--channels",
                            "RGBA,layers", *common, *pixels, timeout=timeout)
        image.photons, image.points, image.records = files[:3]
        image.cache, image.building, image.build = self.read_cache(files[2]), self.read_json(files[3]), run
        return image

    def read_cache(self, path):
        try:
            return read_irradcache.read_irradcache(path)
        except ValueError as error:
            raise Failed(f"{path}: {error}") from None

    def photon_totals(self, scene, count, *options, timeout=600):
        """Totals of a stream that is not kept: the end block of photons.md 7."""
        tail = b""

        def keep(piece):
            nonlocal tail
            tail = (tail + piece)[-112:]
        stats = self.path(".json")
        run = self.run("photon-trace", scene, "--photons", count, "--stats", stats, "-o", "-", *options,
                       timeout=timeout, sink=keep)
        self.done(run)
        mark, photons, *sums, _ = struct.unpack("<4sQ12dI", tail)
        if mark != b"END!" or not all(map(math.isfinite, sums)):
            raise Failed(f"no end block, or sums that are not finite: {run.command}")
        return {"photons": photons, "stored": sums[0:3], "emitted": sums[3:6], "escaped": sums[6:9],
                "absorbed": sums[9:12], "seconds": run.seconds, "cpu": run.cpu,
                "memory": self.read_json(stats)["peak_memory_bytes"]}

    def like_paths(self, title, scene, size=(32, 32), layer="indirect", tolerance=None, spp=None, **cached):
        """A layer through the cache against the path tracer's, in the mean: 4 standard errors of the latter, and 1 % (5 % in the
        short form, whose points and photons are few). Returns both images."""
        paths = self.render(scene, size, spp or self.pick(64, 1024), "--integrator", "path", "--channels", "RGBA,layers,id",
                            *cached.get("common", ()), timeout=900)
        image = self.cached(scene, size, 16, **cached)
        mean = paths.mean(layer + ".G")
        self.near(f"{title}, cache: {layer} light, paths'", mean, image.mean(layer + ".G"),
                  (tolerance or self.pick(0.05, 0.01)) + (4 * paths.sigma_of_mean(layer + ".G") / mean if mean else 0))
        return paths, image

    def info(self, path):
        return finite_json(self.done(self.run("tempolux-info", "--json", path)).out)

    # ---- laws that many cases use ----

    def same_image(self, quantity, a, b, factor=1.0, exactly=False, share=0.005, layer=""):
        """b = factor * a. Exactly, or to rounding: a path whose decisions hang on a rounding may go another way, so
        that a pixel in some hundred may differ; the mean may not, beyond what these pixels carry."""
        va, vb = a.rgb(layer), b.rgb(layer)
        if exactly:
            differing = sum(x * factor != y for x, y in zip(va, vb))
            self.true(f"{quantity}: values that differ", differing == 0, str(differing), "0")
            return
        mean = math.fsum(va) / len(va) * factor
        differing = sum(abs(x * factor - y) > 1e-3 * (abs(x * factor) + mean) for x, y in zip(va, vb)) / len(va)
        self.at_most(f"{quantity}: share of pixels that differ", share, differing)
        self.near(f"{quantity}: mean", mean, math.fsum(vb) / len(vb), share)

"""The gathering chain as the figures and curves run it: photon-trace, irradcache-build, frame-render --irradcache.

Every process is counted: each writes its statistics, which load, read, write and all else are part of.
"""
import dataclasses
import json
from pathlib import Path

from pipeline import preset


@dataclasses.dataclass(frozen=True)
class Settings:
    """Options of the stages; what is not named stays at the tools' defaults."""
    photons: int = 200000
    points: tuple = ()        # options of irradcache-build that make the points
    records: tuple = ()       # ... that place the records
    pixels: tuple = ()        # of frame-render
    steps: bool = False       # points and records by two processes, as Makefile.example does; else by one

    split: bool = False       # bright points are sampled explicitly (photonmap-split); with steps
    caustics: bool = False    # pixels read the photons too: scenes with mirrors or glass

    def text(self):
        return " ".join(map(str, ("photons", self.photons, *self.points, *self.records, *self.pixels)))


def final(project):
    """Those of QUALITY=final, records with the rays that they get at most."""
    words = preset(project)
    return Settings(words["photons"], *(tuple(words[kind]) for kind in ("points", "records", "pixels")), steps=True)


def light(bench, name, stem, seed, settings, size, keep):
    """photon-trace and irradcache-build; statistics files. `keep`: (photons, points, cache) to be written."""
    scene, frame = bench.scene(name)
    stats = [bench.out / "frames" / f"{stem}-{stage}.json" for stage in ("photons", "points", "cache", "split")]
    common = [scene, "--frame", frame, "--seed", seed, "-q"]
    photons, points, cache = keep
    bench.run([bench.bin / "photon-trace", *common, "--photons", settings.photons, "--kinds", "caustic,indirect",
               "-o", photons, "--stats", stats[0]])
    build, gather = bench.bin / "irradcache-build", ["--size", size, *settings.records, "-o", cache]
    if settings.steps:
        bench.run([build, "points", *common, "--photons", photons, *settings.points, "-o", points, "--stats", stats[1]])
        read = ["--points", points]
        if settings.split:
            low, high = (points.with_name(f"{points.name}-{part}") for part in ("low", "high"))
            bench.run([bench.bin / "photonmap-split", points, "--low", low, "--high", high, "-q", "--stats", stats[3]])
            read = ["--points", low, "--high", high]
        bench.run([build, "records", *common, *read, *gather, "--stats", stats[2]])
        for part in read[1::2] if settings.split else []:
            part.unlink()
        return stats if settings.split else stats[:3]
    bench.run([build, *common, "--photons", photons, *settings.points, "--keep-points", points, *gather, "--stats", stats[2]])
    return [stats[0], stats[2]]


def frame(bench, name, seed, settings, size=None, fresh=False):
    """(frame with layers and ids, statistics files of all processes), made once for each program and setting; `fresh`:
    made and timed again in any case."""
    size = size or bench.size
    if bench.tiny:
        settings = dataclasses.replace(settings, photons=settings.photons // 20, points=("--point-count", "1k"))
    scene, number = bench.scene(name)
    tools = [bench.bin / tool for tool in ("photon-trace", "irradcache-build", "frame-render")]
    suffixes = [".exr", "-photons.json", *(["-points.json"] if settings.steps else []), *(["-split.json"] if settings.split else []), "-cache.json", ".json"]

    def make(stem):
        keep = [bench.memory / f"tempolux-bench-{stem}.{end}" for end in ("photons", "irradpoints", "irradcache")]
        files = bench.out / "frames" / stem
        try:
            light(bench, name, stem, seed, settings, size, keep)
            spare = ["--points", keep[1], *(["--photons", keep[0]] if settings.caustics or not settings.steps else [])]
            bench.run([tools[2], scene, "--frame", number, "--irradcache", keep[2], *spare, "--seed", seed, "--size", size,
                       *settings.pixels, "--channels", "RGBA,layers,id", "-q", "-o", f"{files}.exr",
                       "--stats", f"{files}.json"])
        finally:
            for file in keep:
                file.unlink(missing_ok=True)
    image, *stats = bench.cached("frames", f"{name}-chain-{settings.photons}-{seed}",
                                 [scene, *tools, number, seed, size, settings.steps, settings.split, settings.caustics, settings.text()], suffixes, make, fresh)
    return image, stats


STATES = 24              # of light in a segment, which what stands is computed for once
KEPT = 8                 # frames that kept records follow from, before the one that is judged


def updated_frame(bench, name, seed, settings, low):
    """The same by what movers change of what stands, records gathered where their influence is above `low` (2.5 times that: in full). Of what
    stands 1/STATES of the cost counts."""
    scene, number = bench.scene(name)
    tools = [bench.bin / tool for tool in ("photon-trace", "irradcache-build", "frame-render")]
    stages = ("standing", "photons", "points", "cache")
    photons = settings.photons // 20 if bench.tiny else settings.photons
    count = ("--point-count", "1k") if bench.tiny else settings.points

    def make(stem):
        files = bench.out / "frames" / stem
        kept = {n: bench.memory / f"tempolux-bench-{stem}-{n}" for n in ("s.photons", "s.paths", "s.irradpoints", "s.irradcache", "d.photons",
                                                                         "u.irradpoints", "u.irradcache")}
        common, stands = [scene, "--frame", number, "--seed", seed, "-q"], []
        influence = ["--influence", low]

        def run(tool, *words, stats=None):
            mine = stats or f"{files}-part.json"
            bench.run([tool, *words, "--stats", mine])
            if not stats:
                stands.append(json.loads(open(mine).read()))
        try:
            gather = ["--size", bench.size, *settings.records]
            run(tools[0], *common, "--map", "static", "--photons", photons, "--kinds", "indirect", "-o", kept["s.photons"], "--paths", kept["s.paths"])
            run(tools[1], "points", *common, "--map", "static", "--photons", kept["s.photons"], *count, "-o", kept["s.irradpoints"])
            run(tools[1], "records", *common, "--map", "static", "--points", kept["s.irradpoints"], *gather, "-o", kept["s.irradcache"])
            standing = stands[0] | {"cpu_s": sum(s["cpu_s"] for s in stands) / STATES, "wall_s": sum(s["wall_s"] for s in stands) / STATES}
            (bench.out / "frames" / f"{stem}-standing.json").write_text(json.dumps(standing))
            run(tools[0], scene, "--frame", number, "-q", "--map", "dynamic", "--static", kept["s.paths"], "-o", kept["d.photons"],
                stats=f"{files}-photons.json")
            run(tools[1], "points", *common, "--update", kept["s.irradpoints"], "--photons", kept["s.photons"], "--dynamic", kept["d.photons"], *count,
                "-o", kept["u.irradpoints"], stats=f"{files}-points.json")
            run(tools[1], "records", *common, "--update", kept["s.irradcache"], "--points", kept["u.irradpoints"], "--dynamic", kept["d.photons"],
                *gather, "-o", kept["u.irradcache"], stats=f"{files}-cache.json")
            run(tools[2], *common, "--irradcache", kept["u.irradcache"], "--points", kept["u.irradpoints"], *influence, "--size", bench.size,
                *settings.pixels, "--channels", "RGBA,layers,id", "-o", f"{files}.exr", stats=f"{files}.json")
        finally:
            for file in (*kept.values(), bench.out / "frames" / f"{stem}-part.json"):
                file.unlink(missing_ok=True)
    image, *stats = bench.cached("frames", f"{name}-updated-{low}-{seed}", [scene, *tools, number, seed, bench.size, low, settings.text()],
                                 [".exr", *(f"-{stage}.json" for stage in stages), ".json"], make)
    return image, stats


def kept_frame(bench, name, seed, settings):
    """The same by records whose samples are kept: KEPT frames before it, from a first one that is gathered anew. Of what stands and of the first frame's
    records beyond those of a later one 1/STATES of the cost counts."""
    scene, number = bench.scene(name)
    tools = [bench.bin / tool for tool in ("photon-trace", "irradcache-build", "gather-temporal", "frame-render")]
    stages = ("standing", "photons", "points", "cache")
    photons = settings.photons // 20 if bench.tiny else settings.photons
    count = ("--point-count", "1k") if bench.tiny else settings.points

    def make(stem):
        files = bench.out / "frames" / stem
        kept = {n: bench.memory / f"tempolux-bench-{stem}-{n}" for n in ("s.photons", "s.paths", "s.irradpoints", "d.photons", "d.irradpoints", "radsamples", "irradcache")}
        once, common = [], ["-q", "--seed", seed]

        def run(tool, *words, to):
            bench.run([tool, *words, "--stats", to])
            return json.loads(Path(to).read_text())
        try:
            first = number - (2 if bench.tiny else KEPT)
            part = f"{files}-part.json"
            stands = [scene, "--frame", number, *common, "--map", "static"]
            once.append(run(tools[0], *stands, "--photons", photons, "--kinds", "indirect", "-o", kept["s.photons"], "--paths", kept["s.paths"], to=part))
            once.append(run(tools[1], "points", *stands, "--photons", kept["s.photons"], *count, "-o", kept["s.irradpoints"], to=part))
            for f in range(first, number + 1):
                run(tools[0], scene, "--frame", f, "-q", "--map", "dynamic", "--static", kept["s.paths"], "-o", kept["d.photons"], to=f"{files}-photons.json")
                run(tools[1], "points", scene, "--frame", f, *common, "--update", kept["s.irradpoints"], "--photons", kept["s.photons"], "--dynamic",
                    kept["d.photons"], *count, "-o", kept["d.irradpoints"], to=f"{files}-points.json")
                stats = run(tools[2], "final", scene, "--frame", f, *common, "--points", kept["d.irradpoints"], "--size", bench.size, *settings.records,
                            *(["--previous", kept["radsamples"]] if f > first else []), "-o", kept["radsamples"], "--cache", kept["irradcache"],
                            to=f"{files}-cache.json")
                if f == first:
                    once.append(stats)
            beyond = {k: sum(s[k] for s in once) - stats[k] for k in ("cpu_s", "wall_s")}
            Path(f"{files}-standing.json").write_text(json.dumps(once[0] | {k: v / STATES for k, v in beyond.items()}))
            run(tools[3], scene, "--frame", number, *common, "--irradcache", kept["irradcache"], "--points", kept["d.irradpoints"], "--size", bench.size,
                *settings.pixels, "--channels", "RGBA,layers,id", "-o", f"{files}.exr", to=f"{files}.json")
        finally:
            for file in (*kept.values(), bench.out / "frames" / f"{stem}-part.json"):
                file.unlink(missing_ok=True)
    image, *stats = bench.cached("frames", f"{name}-kept-{seed}", [scene, *tools, number, seed, bench.size, settings.text()],
                                 [".exr", *(f"-{stage}.json" for stage in stages), ".json"], make)
    return image, stats


def cost(stats):
    """CPU seconds of all processes."""
    return sum(json.loads(file.read_text())["cpu_s"] for file in stats)

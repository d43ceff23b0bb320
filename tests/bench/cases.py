"""The scenes that the chain is judged on: ours, those of open_scenes.py, those made by others; what each is rendered with."""
import dataclasses
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import daylight  # noqa: E402
import open_scenes  # noqa: E402
from furnish import Asset, bounds, looking  # noqa: E402

SKY_OF_SUN = ("--environment", "0.1,0.12,0.15")     # beside the sun of `-sun` scenes: an eighth of its light
# Of a file by others what it is rendered with: frame, options of all tools, environment map below hdri.
AS_MADE = {"evening_shot": (10, ("--light-units", "spec"), "evening_sky.exr")}
WITH_SUN = ("house", "low-poly-jungle", "GrassFieldInstanced", "CesiumMan", "issum", "lamborghini", "DepthOfFieldExample")

# Few scenes that stand for all: closed rooms, light through windows, open grounds, lone objects, leaves, many lamps.
QUICK = ("S2", "S4", "S8", "hut-50-inside-both", "hut-5000-outside-both", "street-both", "leaves", "lamps", "house", "low-poly-jungle-sun",
         "CesiumMan", "living_room", "cam", "level_two_lamps", "evening_shot", "S8-day", "S8-paper")


@dataclasses.dataclass
class Case:
    name: str
    file: Path
    frame: int
    kind: str                 # closed: room lit by lamps in it; window: light from outside; open: open air, lone objects
    camera: str = "auto"
    shared: tuple = ()        # options of all tools
    environment: Path | None = None
    note: str = ""            # what was added to the file

    @property
    def family(self):
        """Scenes of one family count as one in medians: huts on all grounds under all lights."""
        return self.name.partition("-")[0] if self.name.startswith(("hut-", "street-")) else self.name

    def options(self):
        """Of every tool, as Makefile.example passes them."""
        return ["--frame", self.frame, "--camera", self.camera, *(["--environment", self.environment] if self.environment else []),
                *self.shared]


def ours(bench):
    made = bench.shared / "made" if bench.shared else bench.project / "pipelines" / "scenes"
    for name, file, frame, kind, shared in (
            ("S1", "S1_cornell.glb", 0, "closed", ()), ("S2", "S2_cornell_moving.glb", 10, "closed", ()),
            ("S3", "S3_indirect_room.glb", 1, "closed", ()), ("S4", "S4_atrium.glb", 10, "closed", ()),
            ("S5", "S5_moving_light.glb", 10, "window", ()),
            ("S8", "S8_window_room.glb", 17, "window", ("--light-units", "spec", "--environment", "1.1,1.5,2"))):
        if (made / file).exists():
            yield Case(name, made / file, frame, kind, shared=shared)
    yield Case("PC", bench.project / "pipelines" / "scenes" / "cornell_classic.gltf", 0, "closed")


# Of the curves: a name and what of all_cases it is, or a file with frame and options.
CURVES = ("S2", "S4", "S5", "S8", "demo", "furnished_day", "evening_shot", "living_room", "house-sun", "smoke")


def of_curves(bench):
    """The ten scenes with curves beside other renderers, as far as they are here."""
    made = bench.shared and bench.shared / "made"
    yield Case("demo", bench.project / "pipelines" / "scenes" / "evening.glb", 24, "closed")
    if made:
        yield Case("furnished_day", made / "furnished_day.glb", 12, "window", environment=made / "furnished_day_world.exr")
        yield Case("smoke", made / "S6_smoke.glb", 12, "closed", shared=("--volume", made / "S6_smoke_vdb" / "smoke_####.vdb", "--sigma-t", "10", "--albedo", ".85,.85,.88"))
    for case in all_cases(bench, lambda name: name in CURVES, False):
        yield dataclasses.replace(case, frame=24) if case.name == "S2" else case


def scripted(folder, wanted):
    for name, (file, camera, shared) in open_scenes.make(folder, wanted).items():
        kind = "closed" if name in ("partition", "leaves", "lamps") else "window" if "inside" in name else "open"
        yield Case(name, file, 0, kind, camera, tuple(shared))


def copied(asset, folder):
    """The file, or for .gltf its folder, in a new place."""
    if asset.path.suffix == ".gltf":
        return asset.copied(folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    copy = Path(shutil.copyfile(asset.path, folder / asset.path.name))
    copy.chmod(0o644)
    return Asset(copy)


def by_day(bench, folder, wanted):
    for name, (file, frame, sky) in daylight.make(bench.shared, folder, wanted).items():
        yield Case(name, file, frame, "closed" if name.endswith("paper") else "window", shared=sky)


def found_names(folder):
    """{name: file}. A file called scene is known by its folder's name, one beside its twin by its suffix too."""
    files = sorted(p for p in folder.rglob("*.gl*") if p.suffix in (".gltf", ".glb"))
    stems = [p.parent.name if p.stem == "scene" else p.stem.partition("_the_")[0] for p in files]
    return {stem if stems.count(stem) == 1 else f"{stem}{p.suffix}": p for stem, p in zip(stems, files)}


def framed(copy):
    """Gives a file without a camera one that sees all of it, from the upper right in front."""
    lower, upper = bounds(copy.gltf)
    centre, r = [(a + b) / 2 for a, b in zip(lower, upper)], max(1e-6, sum((b - a) ** 2 for a, b in zip(lower, upper)) ** 0.5 / 2)
    eye = [c + r * x for c, x in zip(centre, (0.9, 0.9, 2.9))]
    copy.gltf.setdefault("cameras", []).append({"type": "perspective", "perspective": {"yfov": 0.66, "znear": 0.001 * r}})
    copy.node(name="AddedCamera", camera=len(copy.gltf["cameras"]) - 1, matrix=looking(eye, [c - e for c, e in zip(centre, eye)]))


def found(bench, folder, wanted, auto_frames):
    """Those made by others; without a light under an environment map, some also under a sun. `auto_frames`: --camera auto frames
    a scene without a camera; else it gets one here."""
    top = bench.shared / "found" if bench.shared else None
    if not top or not top.is_dir():
        return
    light = next((top / "hdri").glob("*.hdr"))
    for name, file in found_names(top / "gltf").items():
        for sun in (False, True) if name in WITH_SUN else (False,):
            title = name + "-sun" if sun else name
            if not wanted(title):
                continue
            if name in AS_MADE:
                frame, options, sky = AS_MADE[name]
                yield Case(name, file, frame, "closed", shared=options, environment=top / "hdri" / sky)
                continue
            asset, added = Asset(file), []
            camera = not asset.has_camera and not auto_frames
            if camera or sun:
                asset = copied(asset, folder / title)
            if camera:
                framed(asset)
                added.append("camera")
            if sun:
                asset.sun([-0.5, -0.8, -0.6])
                added.append("sun")
            dark = not asset.has_light
            yield Case(title, asset.save() if added else file, 10, "open" if dark or sun else "closed",
                       shared=SKY_OF_SUN if sun else (), environment=light if dark else None,
                       note=", ".join(added + (["environment map"] if dark else [])))


def all_cases(bench, wanted, auto_frames):
    folder = bench.out / "every" / "scenes"
    yield from (case for case in ours(bench) if case.name != "PC" and wanted(case.name))
    yield from scripted(folder, wanted)
    yield from by_day(bench, folder, wanted)
    yield from found(bench, folder / "found", wanted, auto_frames)

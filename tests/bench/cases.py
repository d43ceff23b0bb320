"""The scenes that the chain is judged on: ours, those of open_scenes.py, those made by others; what each is rendered with."""
import dataclasses
import shutil
from pathlib import Path

import open_scenes
from furnish import Asset

SKY_OF_SUN = ("--environment-color", "0.1,0.12,0.15")     # beside the sun of `-sun` scenes: an eighth of its light
WITH_SUN = ("house", "low-poly-jungle", "GrassFieldInstanced", "CesiumMan", "issum", "lamborghini", "DepthOfFieldExample")

# Few scenes that stand for all: closed rooms, light through windows, open grounds, lone objects, leaves, many lamps.
QUICK = ("S2", "S4", "S8", "hut-50-inside-both", "hut-5000-outside-both", "street-both", "leaves", "lamps", "house", "low-poly-jungle-sun",
         "CesiumMan", "living_room")


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
            ("S8", "S8_window_room.glb", 17, "window", ("--light-units", "spec", "--environment-color", "1.1,1.5,2"))):
        if (made / file).exists():
            yield Case(name, made / file, frame, kind, shared=shared)
    yield Case("PC", bench.project / "pipelines" / "scenes" / "cornell_classic.gltf", 0, "closed")


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


def found_names(folder):
    """{name: file}. A file called scene is known by its folder's name, one beside its twin by its suffix too."""
    files = sorted(p for p in folder.rglob("*.gl*") if p.suffix in (".gltf", ".glb"))
    stems = [p.parent.name if p.stem == "scene" else p.stem.partition("_the_")[0] for p in files]
    return {stem if stems.count(stem) == 1 else f"{stem}{p.suffix}": p for stem, p in zip(stems, files)}


def found(bench, folder, wanted):
    """Those made by others; without a light under an environment map, some also under a sun."""
    top = bench.shared / "found" if bench.shared else None
    if not top or not top.is_dir():
        return
    light = next((top / "hdri").glob("*.hdr"))
    for name, file in found_names(top / "gltf").items():
        for sun in (False, True) if name in WITH_SUN else (False,):
            title = name + "-sun" if sun else name
            if not wanted(title):
                continue
            asset, added = Asset(file), []
            if sun:
                asset = copied(asset, folder / title)
                asset.sun([-0.5, -0.8, -0.6])
                added.append("sun")
            dark = not asset.has_light
            yield Case(title, asset.save() if sun else file, 10, "open" if dark or sun else "closed",
                       shared=SKY_OF_SUN if sun else (), environment=light if dark else None,
                       note=", ".join(added + (["environment map"] if dark else [])))


def all_cases(bench, wanted):
    folder = bench.out / "every" / "scenes"
    yield from (case for case in ours(bench) if case.name != "PC" and wanted(case.name))
    yield from scripted(folder, wanted)
    yield from found(bench, folder / "found", wanted)

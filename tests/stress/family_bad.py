"""Bad input: every broken glTF of ../shared/scenes/bad through every tool that opens scenes. With -q: what a reader
ignores is said on lines of its own, the error is one line."""
import pathlib

from scenes import Scene
from session import case

# Without a lamp only frame-render takes these. The meshopt streams of the first are whole; of the others a property of
# the wrong type that glTF does not require is left out: a texture, a transform of it, a material's factors, a name.
SOUND = {"meshoptimizer-fuzz.glb", "badExtension.gltf", "badNumber.gltf", "badObject.gltf", "badString.gltf",
         "badUint.gltf"}

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "shared/scenes/bad"


@case("bad input", "files of ../shared/scenes/bad")
def files(s):
    found = sorted(p for p in FOLDER.rglob("*") if p.suffix in (".gltf", ".glb"))
    if not found:
        s.skipped("../shared/scenes/bad is not there")
        return
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.5))
    scene.point_light((0, 0, 0), 1)
    map_ = s.photons(scene.save(s.path(".gltf")), 100)["path"]
    for file in found:
        for tool, options, ending in [("photon-trace", ["--photons", "1k"], ".photons"),
                                      ("irradcache-build", ["--photons", map_, "--size", "16x16"], ".irradcache"),
                                      ("frame-render", ["--size", "16x16", "--spp", "1"], ".exr"),
                                      ("scene-plan", [], "")]:
            out = s.path(ending)
            run = s.run(tool, "-q", file, *options, "-o", out, timeout=20, address_space=2 << 30)
            written = out if ending else out + "/plan.json"
            if tool == "frame-render" and file.name in SOUND:
                s.true(f"{tool} {file.name}, which is sound or mended", run.code == 0 and not run.err, f"exit {run.code}", "exit 0")
            else:
                s.refused(f"{tool} {file.relative_to(FOLDER)}", run, written, seconds=2, memory=300e6)

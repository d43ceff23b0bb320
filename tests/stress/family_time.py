"""Time: one frame, reversed ranges, teleports, things that come and go, a lamp out for one frame, 10^4 frames."""
import math
import os

from scenes import Scene
from session import case

KEYS = [f / 24 for f in range(4)]


def stage(s, change):
    """A dark floor; a matte block that `change` animates (4 frames, stepped); a lamp."""
    scene = Scene()
    scene.quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2), scene.material(0.5))
    block = scene.room((-0.2, 0, -0.2), (0.2, 0.4, 0.2), scene.material(0.8))
    lamp = scene.quad((-0.5, 0, -0.5), (0.5, 0, -0.5), (0.5, 0, 0.5), (-0.5, 0, 0.5), scene.material(0.0, 5.0),
                      translation=[0, 2, 0])
    scene.camera((0, 1.5, 3), (0, 0.2, 0), fov=0.8)
    change(scene, block, lamp)
    return scene.save(s.path(".gltf"))


def plan(s, scene, frames, timeout=60):
    out = s.path(".plan")
    run = s.done(s.run("scene-plan", scene, "--frames", frames, "-o", out, timeout=timeout))
    return s.read_json(os.path.join(out, "plan.json")), run, out


def pictures(s, scene, object_):
    """Of frames 0 .. 3: pixels of the object, mean radiance; by path tracing and by photons of the same frame."""
    seen, light = [], []
    for frame in range(4):
        map_ = s.photons(scene, "10k", "--frame", frame)
        s.render(scene, (48, 36), 1, "--photons", map_["path"], "--frame", frame)
        image = s.render(scene, (48, 36), 16, "--channels", "RGBA,Z,id,motion", "--frame", frame)
        seen.append([i for i, o in enumerate(image.channels["id.object"]) if o == object_])
        light.append(image.mean())
    return seen, light


@case("time", "one frame, odd ranges")
def ranges(s):
    scene = stage(s, lambda scene, block, lamp: scene.animate(block, "translation", KEYS,
                                                              [(0.1 * f, 0, 0) for f in range(4)]))
    plan_, _, _ = plan(s, scene, "2")
    s.true("plan of one frame", plan_ is not None)
    for text in ("0-", "0-3x0", "1,,2", "0-99999999999", "a", ""):
        out = s.path(".plan")
        s.refused(f"scene-plan --frames '{text}'", s.run("scene-plan", scene, f"--frames={text}", "-o", out), out)
    # A range may count down: the same files as upwards.
    folders = []
    for text in ("0-3", "3-0"):
        folder = s.path("")
        os.mkdir(folder)
        s.done(s.run("photon-trace", scene, "--frames", text, "--photons", "1k", "-o", f"{folder}/####.photons"))
        s.done(s.run("frame-render", scene, "--frames", text, "--size", "16x16", "--spp", 1,
                     "-o", f"{folder}/####.exr"))
        plan(s, scene, text)
        folders.append(folder)
    names = sorted(os.listdir(folders[0]))
    s.true("frames 3-0: files of the same names as of 0-3", len(names) == 8 and names == sorted(os.listdir(folders[1])))
    for name in names:
        same = s.run("tempolux-info", "--diff", *(f"{folder}/{name}" for folder in folders))
        s.true(f"{name} of 3-0 and of 0-3: the same data", same.code == 0)


@case("time", "teleport, birth and end")
def comes_and_goes(s):
    jump = [(0, 0, 0), (0, 0, 0), (1000, 0, 0), (0, 0, 0)]
    seen, light = pictures(s, stage(s, lambda scene, block, lamp: scene.animate(
        block, "translation", KEYS, jump, "STEP")), 1)
    s.true("teleport: seen in frames 0, 1, 3", [bool(x) for x in seen] == [True, True, False, True])
    s.true("teleport: the same pixels in 0, 1, 3", seen[0] == seen[1] == seen[3])
    s.near("teleport: light in frame 3 as in frame 0", light[0], light[3], 1e-6)
    sizes = [(0, 0, 0), (1, 1, 1), (1, 1, 1), (0, 0, 0)]
    scene = stage(s, lambda scene, block, lamp: scene.animate(block, "scale", KEYS, sizes, "STEP"))
    seen, light = pictures(s, scene, 1)
    s.true("born in 1, gone in 3", [bool(x) for x in seen] == [False, True, True, False])
    s.near("light in frame 3 as in frame 0", light[0], light[3], 1e-6)
    plan_, _, _ = plan(s, scene, "0-3")
    s.true("the plan says that it moves", "scale" in str(plan_))


@case("time", "a lamp out for one frame")
def lamp_out(s):
    """Off by scale 0: no flux, a black frame, and all as before in the next."""
    on, off = (1, 1, 1), (0, 0, 0)
    scene = stage(s, lambda scene, block, lamp: scene.animate(lamp, "scale", KEYS, [on, on, off, on], "STEP"))
    _, light = pictures(s, scene, 1)
    s.near("frame 2: mean radiance", 0, light[2], 0)
    s.near("frame 3 as frame 1", light[1], light[3], 1e-6)
    for frame, flux in [(1, 2 * math.pi * 5), (2, 0)]:
        map_ = s.photons(scene, "10k", "--frame", frame)
        s.near(f"frame {frame}: emitted flux, W", flux, map_["emitted_flux_W"][1], 1e-5)

    def always_off(scene, block, lamp):
        scene.animate(lamp, "scale", KEYS, [off] * 4, "STEP")
    scene = stage(s, always_off)
    out = s.path(".photons")
    run = s.run("photon-trace", scene, "--photons", "10k", "-o", out)
    if run.code == 0:
        s.near("never on: emitted flux, W", 0, s.info(out)["emitted_flux_W"][1], 0)
    else:
        s.refused("never on: photon-trace", run, out)
    s.near("never on: mean radiance", 0, s.render(scene, (16, 16), 4).mean(), 0)


def over_time(s, scene, size=(48, 36)):
    """Frames 0 .. 3 with records that keep their incoming light from frame to frame, and with records of each frame alone,
    at the same places: irradcache-build has others, with other noise."""
    folder = s.path("")
    os.mkdir(folder)
    maps, kept, fresh = [], [], []
    for f in range(4):
        maps.append(s.photons(scene, "20k", "--frame", f, "--kinds", "caustic,indirect")["path"])
        s.done(s.run("irradcache-build", "points", scene, "--frame", f, "--photons", maps[f], "--point-count", "2k", "-o", f"{folder}/p{f}.irradpoints"))
        s.done(s.run("gather-temporal", "final", scene, "--frame", f, "--points", f"{folder}/p{f}.irradpoints", "--size", f"{size[0]}x{size[1]}",
                     "-o", f"{folder}/a{f}.radsamples", "--cache", f"{folder}/a{f}.irradcache"))
    s.done(s.run("gather-temporal", "final", scene, "--frames", "0-3", "--points", f"{folder}/p#.irradpoints", "--size", f"{size[0]}x{size[1]}",
                 "-o", f"{folder}/s#.radsamples", "--cache", f"{folder}/k#.irradcache"))
    s.done(s.run("tempolux-info", "--check", *(f"{folder}/{k}{f}.{end}" for f in range(4) for k, end in (("s", "radsamples"), ("k", "irradcache")))))
    for side, name in ((kept, "k"), (fresh, "a")):
        for f in range(4):
            side.append(s.render(scene, size, 4, "--frame", f, "--irradcache", f"{folder}/{name}{f}.irradcache", "--points", f"{folder}/p{f}.irradpoints",
                                 "--photons", maps[f], "--channels", "RGBA,layers"))
    return kept, fresh


@case("time", "records over time")
def records_over_time(s):
    """A block that is elsewhere for a frame, is born and goes, a lamp that is out for a frame: indirect light as that of records of the frame alone.
    Some hundred records of 500 rays, of which few see the block: 3 %."""
    def block_at(places):
        return stage(s, lambda scene, block, lamp: scene.animate(block, "translation", KEYS, places, "STEP"))

    def sized(what, sizes):
        return stage(s, lambda scene, block, lamp: scene.animate(block if what == "block" else lamp, "scale", KEYS, sizes, "STEP"))
    none, whole = (0, 0, 0), (1, 1, 1)
    for title, scene in [("teleport", block_at([(0, 0, 0), (0, 0, 0), (1, 0, 0), (0, 0, 0)])), ("1 km away and back", block_at([(0, 0, 0), (0, 0, 0), (1000, 0, 0), (0, 0, 0)])),
                         ("born, gone", sized("block", [none, whole, whole, none])), ("lamp out", sized("lamp", [whole, whole, none, whole]))]:
        kept, fresh = over_time(s, scene)
        for f in range(4):
            s.near(f"{title}, frame {f}: indirect light", fresh[f].mean("indirect.G"), kept[f].mean("indirect.G"), 0.03)


@case("time", "10^4 frames")
def ten_thousand(s):
    """Of a tiny scene whose block moves in every frame: linear in the frames, 2.5 ms of CPU each is the bound: of three
    new files each the system takes 0.4 ms where creating one is slow."""
    n = s.pick(2000, 10000)
    keys = [f / 24 for f in range(n)]
    scene = stage(s, lambda scene, block, lamp: scene.animate(block, "translation", keys,
                                                              [(0.0001 * f, 0, 0) for f in range(n)]))
    cost = []
    for frames in (f"0-{n // 10 - 1}", f"0-{n - 1}"):
        _, run, out = plan(s, scene, frames, timeout=300)
        cost.append(run.cpu)
    s.cost_at_most(f"scene-plan of {n} frames: CPU seconds", 2.5e-3 * n, cost[1])
    s.cost_at_most("CPU seconds, ratio to linear growth", 2, cost[1] / cost[0] / 10)
    run = s.done(s.run("scene-plan", scene, "--frames", f"0-{n - 1}", "-o", out))
    s.cost_at_most("again, nothing changed: CPU seconds", 1e-4 * n + 1, run.cpu)
    with open(os.path.join(out, "plan.mk"), encoding="utf-8") as file:
        text = file.read()
    s.true("plan.mk names the last frame", f"{n - 1}" in text)
    image = s.render(scene, (48, 36), 4, "--frame", n - 1)
    s.true("the last frame renders", image.mean() > 0, f"{image.mean():.3g}")

"""Time of a camera: it stops, goes back, cuts, jumps far away and back; what ibr-warp makes of it, and st-filter along its flow.

Surfaces shine and reflect nothing, each in its own radiance: a pixel that lies inside one shows exactly that, whatever was warped or filtered. A
ghost, a blend across a cut or a trail is another number.
"""
import exr
from scenes import Scene
from session import case

SIZE, KEYS = (64, 48), (0, 4)
RADIANCE = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 3.0]


def room(s, path, interpolation="LINEAR", eye=(0.3, 0.2, 0.8)):
    """Six walls and a block; `path`: where the camera is at frames 0 .. 5."""
    scene = Scene()
    low, high = -1.5, 1.5
    corner = [(low if i & 1 == 0 else high, low if i & 2 == 0 else high, low if i & 4 == 0 else high) for i in range(8)]
    for radiance, side in zip(RADIANCE, ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))):
        scene.quad(*(corner[i] for i in side), scene.material(0.0, radiance))
    scene.room((-0.3, -1.0, -0.9), (0.1, -0.1, -0.5), scene.material(0.0, RADIANCE[6]))
    camera = scene.camera(eye, (-0.1, -0.3, -1), fov=1.0)
    scene.animate(camera, "translation", [f / 24 for f in range(len(path))], path, interpolation)
    return scene.save(s.path(".gltf"))


def inside(ids, width, height):
    """Pixels whose eight neighbours see the same object."""
    around = [dy * width + dx for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
    return [p for y in range(1, height - 1) for x in range(1, width - 1)
            if len({ids[(p := y * width + x) + step] for step in around}) == 1]


def wrong(image, truth, masked=None):
    """Of the pixels inside surfaces that are not masked: how many show another radiance than their own; and how many there are."""
    ids, green = truth.channels["id.object"], truth.channels["G"]
    pixels = [p for p in inside(ids, *SIZE) if not masked or masked[p] == 0]
    return sum(abs(image.channels["G"][p] - green[p]) > 1e-5 * green[p] for p in pixels), len(pixels)


def walked(s, scene):
    """Frames 0 .. 5 rendered, and 1 .. 3 warped from keys 0 and 4: (truth by frame, warped frame and mask by frame)."""
    truth = [s.render(scene, SIZE, 4, "--integrator", "path", "--frame", f, "--channels", "RGBA,layers,Z,N,id,motion,samples") for f in range(6)]
    warped = {}
    for frame in range(1, 4):
        out, mask = s.path(".exr"), s.path(".exr")
        s.done(s.run("ibr-warp", *(truth[k].path for k in KEYS), "--scene", scene, "--frame", frame, "--slow", 0, "-o", out, "--mask", mask, "-q"))
        warped[frame] = exr.read(out), exr.read(mask).channels["why"]
    return truth, warped


def check(s, name, truth, warped, least_given):
    for frame, (image, mask) in warped.items():
        s.near(f"{name}, frame {frame}: not finite", 0, len(image.not_finite()), 0)
        bad, count = wrong(image, truth[frame], mask)
        s.near(f"{name}, frame {frame}: wrong of {count} given", 0, bad, 0)
        s.true(f"{name}, frame {frame}: given", count >= least_given * len(inside(truth[frame].channels['id.object'], *SIZE)), str(count))
    out = s.path(".exr")
    s.done(s.run("st-filter", *(t.path for t in truth[:5]), "-o", out, "-q"))
    image = exr.read(out)
    s.near(f"{name}: filtered, not finite", 0, len(image.not_finite()), 0)
    s.near(f"{name}: filtered, wrong", 0, wrong(image, truth[2])[0], 0)


@case("camera", "it stops")
def stops(s):
    path = [(0.3 - 0.05 * f, 0.2, 0.8) for f in (0, 1, 2, 2, 2, 2)]
    truth, warped = walked(s, room(s, path))
    check(s, "stops", truth, warped, 0.9)
    same = warped[3][0].channels["G"] == truth[4].channels["G"]
    s.true("frame 3 is key 4 to the bit, edges too", same)
    s.near("frame 3: masked", 0, sum(w != 0 for w in warped[3][1]), 0)


@case("camera", "it goes back")
def goes_back(s):
    check(s, "back", *walked(s, room(s, [(0.3 - 0.05 * f, 0.2, 0.8) for f in (0, 1, 2, 1, 0, -1)])), 0.9)


@case("camera", "it cuts to the other side of the room")
def cuts(s):
    truth, warped = walked(s, room(s, [(0.3, 0.2, 0.8)] * 2 + [(-0.9, 0.9, 0.3)] * 4, "STEP"))
    check(s, "cut", truth, warped, 0.9)
    for frame, key in ((1, 0), (2, 4), (3, 4)):
        s.true(f"frame {frame} is key {key} to the bit", warped[frame][0].channels["G"] == truth[key].channels["G"])


@case("camera", "it jumps 10^4 m away for one frame")
def teleports(s):
    truth, warped = walked(s, room(s, [(0.3, 0.2, 0.8)] * 2 + [(0.3, 0.2, 1e4)] + [(0.3, 0.2, 0.8)] * 3, "STEP"))
    check(s, "teleport", truth, warped, 0)
    for frame in (1, 3):
        s.true(f"frame {frame} is a key to the bit", warped[frame][0].channels["G"] in (truth[0].channels["G"], truth[4].channels["G"]))

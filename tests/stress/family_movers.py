"""Dynamic maps at their ends: photons that all take away, all in one point; movers that enclose the lamp, that jump far away."""
import math

import session  # noqa: F401  (puts read_photons on the path)
from read_irradpoints import read_irradpoints
from read_photons import FLUX, RECORD
from scenes import Scene, box_mesh
from session import case

KEYS = [f / 24 for f in range(4)]
GONE, THERE = (0, 0, 0), (1, 1, 1)


def chain(s, scene, frame, kinds="indirect", points="1k", photons="20k"):
    """The static map, the dynamic map of a frame, points and records that follow from them, and the frame; points of the global map."""
    common = ["--frame", frame, "-q"]
    names = {n: s.path(f".{n}.{e}") for n, e in (("static", "photons"), ("paths", "paths"), ("dynamic", "photons"), ("whole", "photons"),
                                                 ("stands", "irradpoints"), ("updated", "irradpoints"), ("anew", "irradpoints"),
                                                 ("cache", "irradcache"), ("localised", "irradcache"))}
    trace = ["photon-trace", scene, *common]
    s.done(s.run(*trace, "--map", "static", "--photons", photons, "--kinds", kinds, "-o", names["static"], "--paths", names["paths"]))
    s.done(s.run(*trace, "--map", "dynamic", "--static", names["paths"], "-o", names["dynamic"]))
    s.done(s.run(*trace, "--photons", photons, "--kinds", kinds, "-o", names["whole"]))
    make = ["irradcache-build", "points", scene, *common, "--point-count", points]
    s.done(s.run(*make, "--map", "static", "--photons", names["static"], "-o", names["stands"]))
    s.done(s.run(*make, "--update", names["stands"], "--photons", names["static"], "--dynamic", names["dynamic"], "-o", names["updated"]))
    s.done(s.run(*make, "--photons", names["whole"], "-o", names["anew"]))
    gather = ["irradcache-build", "records", scene, *common, "--size", "16x16", "--rays", 64]
    s.done(s.run(*gather, "--map", "static", "--points", names["stands"], "-o", names["cache"]))
    s.done(s.run(*gather, "--update", names["cache"], "--points", names["updated"], "--dynamic", names["dynamic"], "-o", names["localised"]))
    image = s.render(scene, (16, 16), 4, "--frame", frame, "--irradcache", names["localised"], "--points", names["updated"], "--channels",
                     "RGBA,layers,influence")
    return names, image


def fluxes(s, path):
    return [r[FLUX + 1] for b in s.read_in_python(path).blocks for r in RECORD.iter_unpack(b.records)]


def mean_of(path, kind):
    values = [sum(p.irradiance[kind]) / 3 for p in read_irradpoints(path).points if p.set == 0]
    return math.fsum(values) / len(values)


def room_with(s, change, **lamp):
    """A room of 2 m that reflects half, a lamp in it, a black box around the lamp that `change` animates."""
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.5))
    box = scene.mesh(*box_mesh((-0.1, 0.4, -0.1), (0.1, 0.6, 0.1)), scene.material(0.0))
    if lamp:
        scene.spot_light(**lamp)
    else:
        scene.point_light((0, 0.5, 0), 1.0)
    change(scene, box)
    scene.camera((0, 0, 0.9), (0, 0, -1))
    return scene.save(s.path(".gltf"))


@case("movers", "photons, negative only")
def negative(s):
    """A black box closes around the lamp: every photon of what stands is taken away, none comes. What is left is exactly nothing: points
    of each place sum the same photons, first with one sign, then the other, in discs whose area both know by probes; cut at 0."""
    scene = room_with(s, lambda scene, box: scene.animate(box, "scale", KEYS, [GONE, GONE, THERE, THERE], "STEP"))
    names, image = chain(s, scene, 2)
    flux, stands = fluxes(s, names["dynamic"]), fluxes(s, names["static"])
    s.true("all dynamic photons are negative", len(flux) > 0 and max(flux) < 0, f"{max(flux):.3g}", "< 0")
    s.near("flux of dynamic photons / static, exact", -1, math.fsum(flux) / math.fsum(stands), 0)
    s.near("direct light of the points, W/m^2", 0, mean_of(names["updated"], "direct"), 0)
    before = mean_of(names["stands"], "indirect")
    # The k-th photon of the static disc is not summed there, but is in the sum that takes away: a fiftieth; areas differ by 15 % at edges.
    s.near("indirect light of the points / before", 0, mean_of(names["updated"], "indirect") / before, 0.05)
    s.near("radiance of the frame", 0, image.mean() / (before / math.pi), 0.05)
    s.true("nothing is below 0", min(image.rgb()) >= 0, f"{min(image.rgb()):.3g}", ">= 0")


@case("movers", "dynamic photons in one point")
def one_point(s):
    """A spot of 1e-6 rad: of what it lights all photons start at one place, the floor's, or the box's when that is in the way."""
    lamp = {"position": (0.3, 0.9, 0.3), "target": (0.3, -1, 0.3), "intensity": 1e6, "inner": 0, "outer": 1e-6}
    scene = room_with(s, lambda scene, box: scene.animate(box, "translation", KEYS, [(0, 0, 0), (0, 0, 0), (0.3, 0, 0.3), (0, 0, 0)], "STEP"), **lamp)
    names, image = chain(s, scene, 2, kinds="direct,indirect")
    flux = fluxes(s, names["dynamic"])
    s.true("static + dynamic: both signs", min(flux) < 0 < max(flux))
    whole = math.fsum(fluxes(s, names["whole"]))
    s.near("static + dynamic / global, flux", 1, (math.fsum(fluxes(s, names["static"])) + math.fsum(flux)) / whole, 1e-6)
    s.near("the box covers what is lit: indirect light / before", 0, mean_of(names["updated"], "indirect") / mean_of(names["stands"], "indirect"), 0.05)
    s.true("frame and influence are finite", all(math.isfinite(v) for c in image.channels.values() for v in c))


@case("movers", "a mover jumps far away")
def far(s):
    """For one frame 10^4 m off, so that the box of the segment is as large: at that frame it touches nothing, and the light is the room's alone.
    Tolerance: the points stand in the same places; their estimates differ by radii that the box's own photons do not shorten."""
    scene = room_with(s, lambda scene, box: scene.animate(box, "translation", KEYS, [(0, 0, 0.5), (0, 0, 0.5), (1e4, 0, 0), (0, 0, 0.5)], "STEP"))
    for frame in (1, 2, 3):
        names, image = chain(s, scene, frame, points="500")
        s.near(f"frame {frame}: static + dynamic / global, flux", 1, (math.fsum(fluxes(s, names["static"])) + math.fsum(fluxes(s, names["dynamic"])))
               / math.fsum(fluxes(s, names["whole"])), 1e-6)
        s.near(f"frame {frame}: indirect light of updated points / anew", 1, mean_of(names["updated"], "indirect") / mean_of(names["anew"], "indirect"), 0.03)
        s.true(f"frame {frame}: finite", all(math.isfinite(v) for c in image.channels.values() for v in c))

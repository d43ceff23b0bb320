"""Media: closed forms (docs/methods/formulas.md), by paths and by photons; voxels that lie in the world or in index space in unusual ways.

The smoke is a cube of density 1, 16 voxels of .05 m: its integral along a line across its middle is .8 m (family_media.py).
"""
import math
import struct
import subprocess
from pathlib import Path

import exr
from family_media import ACROSS, EDGE, N, cube, lit_wall
from scenes import Scene
from session import case

UNITS = Path(__file__).resolve().parents[3] / "shared/scenes/made/units"
HALF_SPACE = {0.5: 0.115226, 0.8: 0.285255, 0.9: 0.414947, 0.99: 0.752721, 0.999: 0.912845}   # 1 - sqrt(1 - albedo) H(1), Chandrasekhar 1950


def made(s, *place, kind="float"):
    """The cube by make-vdb; `place`: edge of a voxel, first centre, then what follows the type."""
    program, path = s.tools.parent / "tests" / "make-vdb", s.path(".vdb")
    subprocess.run([program, path, *[str(N)] * 3, *map(str, place[:4]), "density", "fog", "0", kind, *map(str, place[4:])],
                   input=struct.pack(f"<{N ** 3}f", *[1.0] * N ** 3), check=True)
    return path


@case("media", "shared units V1 (Beer and Lambert) and V2 (one octant: axes)")
def units(s):
    """A cube of 1 m, of which V2 fills x, y, z > 0 alone, 2 / m, seen from 8 m above before radiance 4. A ray that is tan a off the vertical passes
    1 / cos a times the height. Without --integrator the camera's rays are dimmed by the exact integral; float32 leaves 1e-5."""
    if not UNITS.exists() or not cube(s):
        return s.skipped("no shared scenes, or built without volumes")
    width, height, spp = 33, 19, s.pick(64, 16384)
    metre = 2 * math.tan(0.24870998909352288 / 2) / height                  # of a pixel, at 1 m
    for name, steps, depth_of in (("V1_beer", (1, 2, 3), lambda x, y: 1), ("V2_octant", (2, 3, 4), lambda x, y: 0.5 if x > 0 and y > 0 else 0)):
        exact = s.render(UNITS / f"{name}.gltf", (width, height), 16)
        paths = s.render(UNITS / f"{name}.gltf", (width, height), spp, "--integrator", "path")
        for right, down in ((1, 1), (-1, 1), (1, -1), (-1, -1)):               # pixels of a quarter that are wholly in the smoke or beside it
            some = [(right * x, down * y) for x in steps for y in steps]
            left = [math.exp(-2 * depth_of(x, y) * math.hypot(1, x * metre, y * metre)) for x, y in some]
            known, share = 4 * sum(left) / len(left), sum(left) / len(left)
            for way, image, noise in (("", exact, 0), (", by paths", paths, 4 * math.sqrt((1 - share) / share / (len(some) * spp)))):
                seen = [image.channels["G"][(9 + y) * width + 16 + x] for x, y in some]
                s.near(f"{name}, {'right' if right > 0 else 'left'} {'down' if down > 0 else 'up'}{way}", known, sum(seen) / len(seen), 1e-4 + noise)


@case("media", "a beam of photons through a slab and into a half-space")
def beam(s):
    """A spot of 1 mrad at normal incidence, a black screen behind. Of black smoke exp(-tau) passes; of white smoke too thick to pass
    1 - sqrt(1 - albedo) H(1) comes back, whatever the density's profile along the beam. Shares of n photons: s.e. sqrt((1 - p) / (p n))."""
    volume = cube(s)
    if not volume:
        return s.skipped("built without volumes")
    scene = Scene()
    scene.quad((-9, -9, -9), (9, -9, -9), (9, 9, -9), (-9, 9, -9), scene.material(0.0))
    scene.spot_light((0, 0, 1), (0, 0, 0), 1, 5e-4, 1e-3)
    path, n = scene.save(s.path(".gltf")), s.pick(20000, 4000000)
    smoke = ("--volume", volume)
    for tau in s.pick((1.0,), (1e-6, 0.1, 1.0, 2.0)):
        map_ = s.photons(path, n, "--kinds", "direct", *smoke, "--sigma-t", tau / ACROSS, "--albedo", 0, timeout=600)
        s.near(f"passes tau = {tau:g}", math.exp(-tau), map_["stored_flux_W"][1] / map_["emitted_flux_W"][1], 1e-5 + 4 * math.sqrt(math.expm1(tau) / n))
    for albedo, back in HALF_SPACE.items():
        if s.level == 0 and albedo > 0.9:
            continue
        count = n // 10 if albedo > 0.95 else n                               # their paths are long, their shares large
        map_ = s.photons(path, count, "--kinds", "indirect", *smoke, "--sigma-t", 2000 / ACROSS, "--albedo", albedo, timeout=600)
        s.near(f"half-space of albedo {albedo:g}", back, map_["escaped_flux_W"][1] / map_["emitted_flux_W"][1], 4 * math.sqrt((1 - back) / back / count))


@case("media", "a half-space under an even sky, by paths")
def half_space(s):
    """By reciprocity the eye that looks straight down at a half-space under radiance 1 sees the share of a beam that it sends back. All pixels see the
    same: their spread is the error of the mean."""
    volume = cube(s)
    if not volume:
        return s.skipped("built without volumes")
    scene = Scene()
    scene.quad((-9, -9, -1), (9, -9, -1), (9, 9, -1), (-9, 9, -1), scene.material(0.0))
    scene.camera((0, 0, 2), (0, 0, -1), half_height=0.01)
    path, size = scene.save(s.path(".gltf")), (32, 32)
    for albedo, back in HALF_SPACE.items():
        if s.level == 0 and albedo != 0.9:
            continue
        spp = s.pick(4, 256)
        image = s.render(path, size, spp, "--integrator", "path", "--volume", volume, "--sigma-t", 2000 / ACROSS, "--albedo", albedo,
                         "--environment", "1,1,1", timeout=600)
        s.near(f"albedo {albedo:g}", back, image.mean("G"), 4 * image.sigma_of_mean("G") / back)


def seen_at_right_angle(sigma):
    """int sigma f exp(-sigma F) exp(-sigma f ACROSS / 2) dz along the ray through the middle; f its density, F the integral of f from the eye."""
    steps, seen, way = 20000, 0.0, 0.0
    for i in range(steps):
        z = (i + 0.5) / steps * (N + 1) - 1                                   # voxels, from where density begins
        f, dz = max(0.0, min(1.0, z + 1, N - z)), EDGE * (N + 1) / steps
        seen += sigma * f * math.exp(-sigma * (way + 0.5 * f * dz) - sigma * f * ACROSS / 2) * dz
        way += f * dz
    return seen


@case("media", "single scattering at a right angle, g from -.9 to .9, optical depth 1e-6 to 20")
def right_angle(s):
    """A sun from above, the eye at the side, albedo .002: light scattered twice is below .1 % of what is seen. E = 1: L = albedo p(0) times the
    integral above, p(0) = (1 - g^2) / (4 pi (1 + g^2)^1.5). All pixels see the same: their spread is the error of the mean."""
    volume = cube(s)
    if not volume:
        return s.skipped("built without volumes")
    scene = Scene()
    scene.sun((0, -1, 0), 1)
    scene.quad((-9, -9, -9), (9, -9, -9), (9, 9, -9), (-9, 9, -9), scene.material(0.0))
    scene.camera((0, 0, 2), (0, 0, -1), half_height=0.001)
    path, albedo = scene.save(s.path(".gltf")), 0.002
    for g, tau in s.pick(((0.5, 1), (0, 1e-6), (0, 20)), ((-0.9, 1), (-0.5, 1), (0, 1), (0.5, 1), (0.9, 1), (0, 1e-6), (0, 1e-3), (0, 5), (0, 20))):
        expected = albedo * (1 - g * g) / (4 * math.pi * (1 + g * g) ** 1.5) * seen_at_right_angle(tau / ACROSS)
        smoke = ("--volume", volume, "--sigma-t", tau / ACROSS, "--albedo", albedo, "--phase-g", g)
        if tau >= 1:                                                          # in thinner smoke paths collide too rarely
            image = s.render(path, (32, 32), s.pick(16, 2048), "--integrator", "path", *smoke)
            s.near(f"g = {g:g}, tau = {tau:g}, by paths", expected, image.mean("G"), 0.001 + 4 * image.sigma_of_mean("G") / expected)
        photons = s.photons(path, "20k", "--kinds", "indirect,volume", *smoke)
        clear = s.render(path, (32, 32), 1, "--photons", photons["path"], *smoke, "--channels", "RGBA,layers,Z")
        out = s.path(".exr")
        s.done(s.run("volume-compose", path, *smoke, "--photons", photons["path"], "--base", clear.path, "--spp", s.pick(4, 64), "-o", out))
        image = exr.read(out)
        s.near(f"g = {g:g}, tau = {tau:g}, by volume-compose", expected, image.mean("G"), 0.001 + 4 * image.sigma_of_mean("G") / expected)


def seen_through(s, scene, volumes):
    """Share of the light that comes through these volumes, each (file, extinction)."""
    smoke = [word for file, sigma in volumes for word in ("--volume", file, "--sigma-t", sigma, "--albedo", 0)]
    return s.render(scene, (8, 8), 1, *smoke).mean("G")


@case("media", "cubes turned, stretched, sheared, far from index 0, tiny, huge; tiles; overlapping")
def places(s):
    """The camera looks along -z through the middle, a hair wide; its rays are dimmed by the exact integral. Turned by 45 degrees about y, a line
    across the middle has density f(u)^2, f the ramp at the ends: sqrt(2) EDGE (N - 1 + 2/3); sheared by as much the same without the root of 2."""
    if not cube(s):
        return s.skipped("built without volumes")
    low = -(N - 1) / 2 * EDGE
    centred = (EDGE, low, low, low)
    scene = Scene()
    scene.quad((-1e7, -1e7, -1), (1e7, -1e7, -1), (1e7, 1e7, -1), (-1e7, 1e7, -1), scene.material(0.0, 1.0))
    scene.camera((0, 0, 2), (0, 0, -1), half_height=1e-9)
    wall = scene.save(s.path(".gltf"))
    c = EDGE * math.sqrt(0.5)
    turned, stretched, sheared = (c, 0, c, 0, EDGE, 0, -c, 0, c), (EDGE, 0, 0, 0, EDGE, 0, 0, 0, EDGE / 2), (EDGE, 0, EDGE, 0, EDGE, 0, 0, 0, EDGE)

    def first_of(m):
        return [-(N - 1) / 2 * sum(m[3 * r:3 * r + 3]) for r in range(3)]
    cases = {
        "as it is": (made(s, *centred), ACROSS), "half a voxel aside": (made(s, EDGE, low + EDGE / 2, low - EDGE / 2, low), ACROSS),
        "tiles": (made(s, *centred, kind="tiles"), ACROSS),
        "turned by 45 degrees": (made(s, EDGE, *first_of(turned), 0, *turned), math.sqrt(2) * EDGE * (N - 1 + 2 / 3)),
        "half as thick": (made(s, EDGE, *first_of(stretched), 0, *stretched), ACROSS / 2),
        "sheared": (made(s, EDGE, *first_of(sheared), 0, *sheared), EDGE * (N - 1 + 2 / 3)),
        "mirrored": (made(s, EDGE, low, low, -low, 0, EDGE, 0, 0, 0, EDGE, 0, 0, 0, -EDGE), ACROSS),
        **{f"from index {first}": (made(s, *centred, first), ACROSS) for first in (-7, -100003, 3000001, -200000011)},
        "voxels of 1e-4 m": (made(s, 1e-4, *[-(N - 1) / 2 * 1e-4] * 3), N * 1e-4),
        "voxels of 1e6 m, the eye within": (made(s, 1e6, *[-(N - 1) / 2 * 1e6] * 3), 3),
    }
    for name, (file, length) in cases.items():
        s.near(name, math.exp(-1), seen_through(s, wall, [(file, 1 / length)]), 1e-4)
    both = [(cases["as it is"][0], 0.5 / ACROSS), (cases["turned by 45 degrees"][0], 0.25 / cases["turned by 45 degrees"][1]), (cases["tiles"][0], 0.25 / ACROSS)]
    s.near("three overlapping", math.exp(-1), seen_through(s, wall, both), 1e-4)
    s.near("extinction 0", 1, seen_through(s, wall, [(cases["as it is"][0], 0)]), 1e-6)
    run = s.run("frame-render", wall, "--size", "8x8", "--volume", made(s, 1e20, 0, 0, 0), "-o", s.path(".exr"))
    s.refused("voxels of 1e20 m", run)
    s.true("says why", "beyond 1e15 m" in run.err, run.err.strip()[-80:])


@case("media", "a cube of extinction 100 and 1e4 in a room of one radiance, through the whole chain")
def thick(s):
    """Walls emit 1 and reflect .5: radiance 2, and 2 of the smoke, too, if it is white, as light is the same everywhere and no filter blurs it. Of black
    smoke nothing is seen. Of n photons some .4 n enter the smoke (the walls let each meet it 2 x .64 / 4 times), a 24th of them where the eye looks, and
    one in 3 gets across a voxel of depth 5: they count as n / 180. At 1e4 it is one in 400, so few that only finite values are asked."""
    volume = cube(s)
    if not volume:
        return s.skipped("built without volumes")
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.5, 1.0))
    scene.camera((0, 0, 0.9), (0, 0, -1), half_height=0.2)
    path = scene.save(s.path(".gltf"))
    for sigma, albedo, n in ((1e4, 0, 500), (1e4, 1, s.pick(500, 5000)), (100, 1, s.pick(5000, 100000))):
        smoke = ("--volume", volume, "--sigma-t", sigma, "--albedo", albedo)
        photons = s.photons(path, n, "--kinds", "direct,indirect,volume", *smoke, timeout=600)
        clear = s.render(path, (16, 16), 1, "--photons", photons["path"], *smoke, "--channels", "RGBA,layers,Z")
        out = s.path(".exr")
        s.done(s.run("volume-compose", path, *smoke, "--photons", photons["path"], "--direct", "photons", "--base", clear.path, "--spp", s.pick(4, 64),
                     "-o", out, timeout=600))
        image = exr.read(out)
        s.true(f"{sigma:g} / m, albedo {albedo}: finite", not image.not_finite(), str(image.not_finite()))
        if sigma == 100:
            s.near("white: radiance", 2, image.mean("G"), 4 / math.sqrt(n / 180))
        elif albedo == 0:
            s.at_most("black: radiance", 0, image.mean("G"))

"""Media: what is seen through a slab, rooms of one radiance with smoke that loses nothing, flux of photons, updates.

Volumes are made by make-vdb, which lies beside the tests. A slab of n voxels of edge h and density 1 has the integral n h along a line across
its middle: between voxels density is linear, and falls from 1 to 0 over the last half of them on either side and another half beyond.
"""
import glob
import math
import struct
import subprocess

from scenes import Scene
from session import case

N, EDGE = 16, 0.05
ACROSS = N * EDGE                              # m


def cube(s):
    """A cube of density 1 about the origin; None without make-vdb."""
    program = s.tools.parent / "tests" / "make-vdb"
    if not program.exists():
        return None
    path, low = s.path(".vdb"), str(-(N - 1) / 2 * EDGE)
    subprocess.run([program, path, *[str(N)] * 3, str(EDGE), low, low, low], input=struct.pack(f"<{N ** 3}f", *[1.0] * N ** 3), check=True)
    return path


def lit_wall(s):
    """A lamp of radiance 1 that fills the view, behind the cube."""
    scene = Scene()
    scene.quad((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), scene.material(0.0, 1.0))
    scene.camera((0, 0, 2), (0, 0, -1), half_height=0.1)
    return scene.save(s.path(".gltf"))


@case("media", "Beer and Lambert through a slab, optical depth 1e-6 to 1e4")
def slab(s):
    """Smoke that absorbs all: exp(-tau) of the lamp is left. Of n paths a share p comes through: standard error sqrt((1 - p) / (p n))."""
    volume = cube(s)
    if not volume:
        return s.skipped("built without volumes")
    scene, size, spp = lit_wall(s), (32, 32), s.pick(16, 256)
    paths = size[0] * size[1] * spp
    for tau in s.pick((1e-6, 1.0, 1e4), (1e-6, 1e-3, 0.1, 1.0, 5.0, 20.0, 80.0, 1e4)):
        image = s.render(scene, size, spp, "--integrator", "path", "--volume", volume, "--sigma-t", tau / ACROSS, "--albedo", 0)
        left = math.exp(-tau)
        if left * paths > 100:
            s.near(f"seen through tau = {tau:g}", left, image.mean("G"), 1e-6 + 4 * math.sqrt((1 - left) / left / paths))
        else:
            s.at_most(f"seen through tau = {tau:g}", left + 4 / paths, image.mean("G"))


@case("media", "closed rooms of one radiance, lossless smoke of optical depth 1e-6 to 1e3")
def furnace(s):
    """All walls emit 1 and reflect .5: radiance 2 everywhere, with lossless smoke too, whatever its phase function. Paths of 32 x 32 pixels by
    n samples; of one the standard deviation is below its mean."""
    volume = cube(s)
    if not volume:
        return s.skipped("built without volumes")
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.5, 1.0))
    scene.camera((0, 0, 0.9), (0, 0, -1))
    path, spp = scene.save(s.path(".gltf")), s.pick(16, 256)
    for tau in s.pick((1.0, 100.0), (1e-6, 0.1, 1.0, 10.0, 1e3)):
        for g in s.pick((0.0,), (0.0, 0.9, -0.9)):
            image = s.render(path, (32, 32), spp if tau < 50 else max(4, spp // 16), "--integrator", "path", "--volume", volume,
                             "--sigma-t", tau / ACROSS, "--albedo", 1, "--phase-g", g, timeout=600)
            n = 1024 * (spp if tau < 50 else max(4, spp // 16))
            s.near(f"radiance, tau = {tau:g}, g = {g:g}", 2.0, image.mean("G"), 4 / math.sqrt(n))


@case("media", "flux of photons in smoke; updates and further paths")
def flux(s):
    """In a black room all that a lamp emits is absorbed, by smoke or by walls: emitted = escaped + absorbed to rounding (1e-6 of float32).
    An update of all groups is a fresh map, to the digest."""
    volume = cube(s)
    if not volume:
        return s.skipped("built without volumes")
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.3))
    scene.point_light((0.6, 0.7, 0.2), 1)
    path = scene.save(s.path(".gltf"))
    for tau, albedo, g in s.pick(((2, 0.8, 0.5),), ((1e-6, 1, 0), (1e-3, 0.5, 0.9), (2, 0.8, 0.5), (2, 1, -0.9), (1e3, 0.9999, 0), (1e4, 0.5, 0))):
        smoke = ("--volume", volume, "--sigma-t", tau / ACROSS, "--albedo", albedo, "--phase-g", g)
        map_ = s.photons(path, s.pick("20k", "50k"), "--kinds", "indirect,volume", *smoke)
        emitted, gone = map_["emitted_flux_W"][1], map_["escaped_flux_W"][1] + map_["absorbed_flux_W"][1]
        s.near(f"tau = {tau:g}, albedo {albedo:g}, g = {g:g}: escaped + absorbed over emitted", 1.0, gone / emitted, 1e-6)
    plan = s.path("plan")
    smoke = ("--volume", volume, "--sigma-t", 5, "--albedo", 0.8)
    s.done(s.run("scene-plan", path, *smoke, "--frames", "0-1", "--update", "10%", "-o", plan))
    majorants, = glob.glob(f"{plan}/state/0000-*.majorants")
    common = (*smoke, "--majorants", majorants, "--kinds", "indirect,volume")
    first = s.photons(path, "50k", "--pilots", "3%", *common)
    again = s.photons(path, "50k", "--update", first["path"], "--strategy", "all", "--frame", 1, *common)
    s.true("an update of all groups has the digest of a fresh map", first["digest"] == again["digest"])
    more = s.photons(path, "50k", "--update", first["path"], "--refine", "20k", *common)
    s.near("flux emitted with 20k further paths", first["emitted_flux_W"][1], more["emitted_flux_W"][1], 1e-6)

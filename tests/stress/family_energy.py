"""Energy: closed boxes of three shapes and any reflectance, by photons and by path tracing; metals in a furnace.

A point light of flux F in a closed room of surface S, reflectance rho: every reflection keeps rho of the flux, so the
surfaces receive F / (1 - rho) in all, F / (S (1 - rho)) per area in the mean.

Photons: a path that survives with probability rho arrives n times, P(n > k) = rho^k; n has mean 1/(1-rho) and
variance rho/(1-rho)^2, so the total of N paths has the relative standard deviation sqrt(rho / N). 4 sigma = 0.3 %
needs 1.78M rho paths.

Path tracing: orthographic cameras that look at each wall squarely and see all of it take points uniform in area, so
the mean of their pixels times pi / rho is the mean irradiance of the wall.
"""
import math

from scenes import Scene, area_of, room_mesh, sphere_mesh
from session import LONG, case

INTENSITY = 1.0
FLUX = 4 * math.pi * INTENSITY


def cube(rho):
    scene = Scene()
    mesh = room_mesh((-1, -1, -1), (1, 1, 1))
    scene.mesh(*mesh, scene.material(rho))
    scene.camera((0, 0, 0.9), (0, 0, -1), half_height=1, name="wall")
    return scene, area_of(*mesh), [("wall", (64, 64), 1.0)]               # all six walls are alike


def corridor(rho):
    scene = Scene()
    mesh = room_mesh((-5, -0.5, -0.5), (5, 0.5, 0.5))
    scene.mesh(*mesh, scene.material(rho))
    scene.camera((0, 0, 0.4), (0, 0, -0.5), half_height=0.5, name="side")
    scene.camera((-4.9, 0, 0), (5, 0, 0), half_height=0.5, name="end")
    return scene, area_of(*mesh), [("side", (160, 16), 40 / 42), ("end", (64, 64), 2 / 42)]


def sphere(rho):
    """8 * 48^2 triangles; by symmetry irradiance is uniform but for (angle of a triangle)^2 / 8 = 1e-4, and the mean
    over a narrow view differs from that over the sphere by less."""
    scene = Scene()
    positions, triangles, _ = sphere_mesh((0, 0, 0), (1, 1, 1), 48)
    scene.mesh(positions, triangles, scene.material(rho))
    scene.camera((0, 0, 0.5), (0.1, 0.2, -1), fov=1.5, name="view")
    return scene, area_of(positions, triangles), [("view", (64, 64), 1.0)]


SHAPES = {"cube": cube, "corridor": corridor, "sphere": sphere}


def build(s, shape, rho):
    scene, area, views = SHAPES[shape](rho)
    scene.point_light((0, 0, 0), INTENSITY)
    return scene.save(s.path(".gltf")), area, views


def photon_totals(s, shape, rho, paths):
    path, _, _ = build(s, shape, rho)
    # Seeds of their own: else all shapes share one sequence of survivals.
    totals = s.photon_totals(path, paths, "--seed", list(SHAPES).index(shape), timeout=1800)
    s.near(f"photons, {shape}, rho {rho:g}: stored flux, W", FLUX / (1 - rho), totals["stored"][1],
           4 * math.sqrt(rho / paths) + 1e-6)
    s.near(f"photons, {shape}, rho {rho:g}: escaped", 0, totals["escaped"][1] / FLUX, 0)
    s.near(f"photons, {shape}, rho {rho:g}: emitted - escaped - absorbed", 0,
           (totals["emitted"][1] - totals["escaped"][1] - totals["absorbed"][1]) / FLUX, 1e-5)


@case("energy", "closed boxes, photons")
def closed_boxes_photons(s):
    for shape in SHAPES:
        for rho in s.pick((0, 0.9, 0.99) if shape != "sphere" else (0.9,), (0, 0.5, 0.9, 0.99)):
            # full: 4 sigma are 0.3 % at 0.99, less below
            paths = s.pick(20000 if rho > 0.95 else 100000, 1800000)
            photon_totals(s, shape, rho, paths)


@case("energy", "closed boxes, path tracing")
def closed_boxes_paths(s):
    """The standard error comes from the spread of the pixels, which contains the differences between places, so it is
    too large rather than too small; the full form asks for 0.3 % in any case."""
    for shape in SHAPES:
        for rho in s.pick((0.9, 0.99) if shape == "cube" else (0.9,), (0.5, 0.9, 0.99)):
            path, area, views = build(s, shape, rho)
            mean = variance = 0.0
            for camera, size, share in views:
                spp = s.pick(8, 512)
                image = s.render(path, size, spp, "--integrator", "path", "--camera", camera, timeout=1800)
                mean += share * image.mean()
                variance += (share * image.sigma_of_mean())**2
            expected = FLUX / (area * (1 - rho))
            sigma = math.sqrt(variance) * math.pi / rho / expected
            s.near(f"path tracing, {shape}, rho {rho:g}: irradiance, W/m^2", expected, mean * math.pi / rho,
                   min(4 * sigma, s.pick(1, 0.003)) + (2e-4 if shape == "sphere" else 0))


@case("energy", "closed boxes, irradiance cache")
def closed_boxes_cache(s):
    """The indirect layer alone is rho F / (S (1 - rho)) in the mean, times rho / pi in the picture. Photons: 4 sqrt(rho / N)
    as above; points, gathering and interpolation: 2 % in the short form (2000 points, 200 rays, 32 x 32 pixels). The full form
    asks for 1 % in all: 4 sigma of the photons are at most 0.52 % of it. (Several seeds where one map would not fit memory.)"""
    for shape in SHAPES:
        for rho in s.pick((0, 0.9) if shape == "cube" else (0.5,), (0, 0.5, 0.9, 0.99)):
            path, area, views = build(s, shape, rho)
            paths, seeds = s.pick((20000, 1), (100000, 6) if rho > 0.95 else (600000, 1))
            mean = 0.0
            for seed in range(seeds):
                for camera, size, share in views:
                    size = s.pick((size[0] // 2, size[1] // 2), size)
                    image = s.cached(path, size, photons=paths, common=("--camera", camera), seed=seed, timeout=1800)
                    mean += share * image.mean("indirect.G") / seeds
                    s.forget()
            expected = rho / math.pi * FLUX * rho / (area * (1 - rho))
            s.near(f"cache, {shape}, rho {rho:g}: indirect radiance", expected, mean,
                   s.pick(4 * math.sqrt(rho / paths) + 0.02, 0.01))


@case("energy", "reflectance 0.999 and 1")
def nearly_lossless(s):
    """Survival is bounded by 0.998, so above it a path's flux grows while it lives: at 0.999 the total T of a path has
    P(T > t) falling as t^-2, and N paths behave as if cut after k = 500 ln N bounces:
    variance / mean^2 = (k - 1500) / 500 - 1 = ln N - 4, so 4 sigma = 4 sqrt((ln N - 4) / N).
    At 1 there is no answer; it must end, and nothing be NaN."""
    for shape in SHAPES:
        paths = s.pick(2000, 100000)
        path, _, _ = build(s, shape, 0.999)
        totals = s.photon_totals(path, paths, timeout=300)
        s.near(f"photons, {shape}, rho 0.999: stored flux, W", FLUX / 0.001, totals["stored"][1],
               4 * math.sqrt((math.log(paths) - 4) / paths))
        s.near(f"photons, {shape}, rho 0.999: escaped", 0, totals["escaped"][1] / FLUX, 0)
        path, _, views = build(s, shape, 1)
        totals = s.photon_totals(path, 2000, timeout=120)
        s.cost_at_most(f"photons, {shape}, rho 1: CPU seconds", 30, totals["cpu"])
        s.near(f"photons, {shape}, rho 1: escaped", 0, totals["escaped"][1] / FLUX, 0)
        image = s.render(path, (8, 8), 8, "--integrator", "path", "--camera", views[0][0])
        s.cost_at_most(f"path tracing, {shape}, rho 1: CPU seconds", 30, image.run.cpu)
        image = s.cached(path, (8, 8), photons=300, common=("--camera", views[0][0]))
        s.cost_at_most(f"cache, {shape}, rho 1: CPU seconds", 30, image.build.cpu)


@case("energy", "furnace of any reflectance")
def furnace(s):
    """Every surface emits 1 and reflects rho: radiance 1 / (1 - rho) everywhere. By paths: 4 standard errors, from the spread of
    pixels that are all alike, and not above the 0.5 % that are asked for. Through the cache, photons leave 4 sqrt(rho / N) of
    the indirect part (0.36 % of 1M), and points 16 shadow rays each towards walls that lie beside them: 0.5 %."""
    for shape in SHAPES:
        for rho in s.pick((0, 0.9), (0, 0.5, 0.9, 0.99)):
            scene, _, views = SHAPES[shape](rho)
            for material in scene.document["materials"]:
                material["emissiveFactor"] = [1, 1, 1]
            path = scene.save(s.path(".gltf"))
            image = s.render(path, (32, 32), s.pick(16, 640 if rho > 0.95 else 256), "--camera", views[0][0],
                             "--seed", list(SHAPES).index(shape), timeout=1800)
            s.near(f"{shape}, rho {rho:g}: radiance", 1 / (1 - rho), image.mean(),
                   min(4 * image.sigma_of_mean() * (1 - rho) + 1e-5, s.pick(1, 0.005)))
            if s.pick(rho == 0.9, rho < 0.95):
                image = s.cached(path, (32, 32), 16, photons=s.pick(None, "1M"), common=("--camera", views[0][0]),
                                 points=s.pick((), ("--light-samples", 16)), timeout=1800)
                s.near(f"{shape}, rho {rho:g}, cache: radiance", 1 / (1 - rho), image.mean(), s.pick(0.04, 0.005))
                s.forget()


@case("energy", "metals and gloss in a furnace")
def metals(s):
    """A sphere whose reflectance is nowhere above 1 in an enclosure of radiance 1 cannot be brighter than 1; it is
    darker by what single scattering loses. The enclosure reflects nothing. Means over the sphere's pixels, and 4
    standard errors."""
    kinds = [(f"metal, roughness {r:g}", {"metallic": 1.0, "roughness": r}) for r in (0, 0.05, 0.3, 0.6, 1)]
    kinds += [(f"gloss over white, roughness {r:g}", {"specular": 1.0, "roughness": r}) for r in (0, 0.05, 0.3, 1)]
    for title, parameters in kinds:
        scene = Scene()
        scene.room((-2, -2, -2), (2, 2, 2), scene.material(0.0, 1.0))
        positions, triangles, normals = sphere_mesh((0, 0, 0), (1, 1, 1), 24, inwards=False)
        ball = scene.mesh(positions, triangles, scene.material(1.0, **parameters), normals)
        scene.camera((0, 0, 1.9), (0, 0, 0), half_height=1)
        image = s.render(scene.save(s.path(".gltf")), (48, 48), s.pick(32, 256), "--channels", "RGBA,id")
        ids = image.channels["id.object"]
        values = [v for v, i in zip(image.channels["G"], ids) if i == ball]
        mean = math.fsum(values) / len(values)
        sigma = math.sqrt(math.fsum((v - mean)**2 for v in values)) / len(values)
        s.at_most(f"{title}: radiance", 1 + 4 * sigma + 1e-5, mean)
        s.true(f"{title}: radiance above 0.3", mean > 0.3, f"{mean:.4f}")


@case("energy", "500 bounces in the mean", LONG)
def deep(s):
    """At 0.998, where survival is at its bound, 4 sqrt(rho / N) still holds."""
    photon_totals(s, "cube", 0.998, 450000)

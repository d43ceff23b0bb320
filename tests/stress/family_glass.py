"""Glass, mirrors and gloss: what goes in comes out, by path tracing and through the cache."""
import math

from scenes import Scene, box_mesh, sphere_mesh
from session import case


def fresnel(cos_o, ior):
    c = math.sqrt(1 - (1 - cos_o**2) / ior**2)
    return (((cos_o - ior * c) / (cos_o + ior * c))**2 + ((ior * cos_o - c) / (ior * cos_o + c))**2) / 2


def slab_transmittance(angle, colour, ior=1.5, thickness=0.2, distance=0.25):
    """(1-F)^2 a / (1 - F^2 a^2), a: transmittance of the way within."""
    f = fresnel(math.cos(angle), ior)
    a = colour**(thickness / math.sqrt(1 - (math.sin(angle) / ior)**2) / distance)
    return (1 - f)**2 * a / (1 - (f * a)**2)


SLABS = [(colour, angle) for colour in (1.0, 0.3) for angle in (0.0, 0.9, 1.3)]


def add_slab(scene, colour):
    scene.mesh(*box_mesh((-4, -4, -0.1), (4, 4, 0.1)), scene.glass(attenuation=(colour, 0.25) if colour < 1 else None))


@case("energy", "Fresnel slab")
def slab(s):
    """A screen of radiance 1 seen through a slab, and the flux of a beam through it: the closed form within 1 %. N paths of 0
    or 1 leave 4 sqrt((1-T) / (T N)), T >= 0.16: 0.9 % of 10^6, so that this is their noise or less."""
    side, spp, paths = s.pick((32, 16, "20k"), (64, 256, "1M"))
    count = {"20k": 20000, "1M": 1000000}[paths]
    for colour, angle in SLABS:
        expected = slab_transmittance(angle, colour)
        title = f"colour {colour:g}, {angle:g} rad"
        away = (math.sin(angle), 0, -math.cos(angle))
        scene = Scene()
        add_slab(scene, colour)
        scene.quad((-40, -40, -3), (40, -40, -3), (40, 40, -3), (-40, 40, -3), scene.material(0.0, 1.0, one_sided=True))
        eye = (-math.tan(angle), 0, 1)
        scene.camera(eye, [e + d for e, d in zip(eye, away)], half_height=0.05)
        image = s.render(scene.save(s.path(".gltf")), (side, side), spp, "--integrator", "path")

        def noise(n, t=expected):
            return 4 * math.sqrt((1 - t) / (t * n))
        s.near(f"{title}: radiance", expected, image.mean(), s.pick(noise(side * side * spp) + 0.001, 0.01))
        scene = Scene()
        add_slab(scene, colour)
        scene.quad((-40, -40, -3), (40, -40, -3), (40, 40, -3), (-40, 40, -3), scene.material(0.0))
        scene.spot_light(eye, [e + d for e, d in zip(eye, away)], 1e6, 0, 1e-3)
        totals = s.photon_totals(scene.save(s.path(".gltf")), paths, "--kinds", "direct")   # a plate is passed straight
        s.near(f"{title}: direct flux on a floor / emitted", expected, totals["stored"][1] / totals["emitted"][1],
               s.pick(noise(count) + 0.001, 0.01))


@case("energy", "lens")
def lens(s):
    """A beam onto a ball of clear glass in a black room: all of it arrives, as caustic. Nothing is lost at a boundary, so that
    only roulette makes noise: 1 %."""
    scene = Scene()
    scene.room((-2, -2, -2), (2, 2, 2), scene.material(0.0))
    positions, triangles, _ = sphere_mesh((0, 0, 0), (0.5, 0.5, 0.5), 24, inwards=False)
    scene.mesh(positions, triangles, scene.glass())
    scene.spot_light((0, 1.5, 0), (0, 0, 0), 100, 0.1, 0.3)                # the ball is seen under asin(1/3) = 0.34 rad
    totals = s.photon_totals(scene.save(s.path(".gltf")), s.pick("20k", "200k"), "--kinds", "caustic")
    s.near("caustic flux / emitted", 1, totals["stored"][1] / totals["emitted"][1], 0.01)
    s.near("escaped / emitted", 0, totals["escaped"][1] / totals["emitted"][1], 0)


@case("energy", "rough glass in a furnace")
def furnace(s):
    """Walls of radiance 1 that reflect nothing, a cube of clear glass before the camera: 1 whatever the roughness, within 0.5 %.
    A path scatters by up to 1.2 about it: 4 sigma are 0.5 % of 10^6 paths."""
    for ior in (1.1, 1.5, 2.4):
        for roughness in (0.0, 0.1, 0.3, 0.6, 1.0) if ior == 1.5 else (0.3,):
            scene = Scene()
            scene.room((-2, -2, -2), (2, 2, 2), scene.material(0.0, 1.0))
            ball = scene.mesh(*box_mesh((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)), scene.glass(roughness, ior))
            scene.camera((1.4, 0.9, 1.6), (0, 0, 0), half_height=0.5)
            image = s.render(scene.save(s.path(".gltf")), (48, 48), s.pick(16, 512), "--integrator", "path", "--channels", "RGBA,id")
            mean, sigma = over(image, ball)
            s.near(f"ior {ior:g}, roughness {roughness:g}: radiance", 1, mean, s.pick(0.005 + 4 * sigma, 0.005))


def over(image, thing, channel="G"):
    """Mean over the pixels of an object, and its standard error if they are alike."""
    values = [v for v, i in zip(image.channels[channel], image.channels["id.object"]) if i == thing]
    mean = math.fsum(values) / len(values)
    return mean, math.sqrt(math.fsum((v - mean)**2 for v in values)) / len(values)


@case("energy", "glass, mirror and gloss in a furnace, through the cache")
def furnace_cache(s):
    """Walls that emit 1 and reflect half, and a ball that loses nothing: 2 everywhere. Balls that lose what single scattering
    loses: the path tracer's picture. 1 % (5 % in the short form), and four standard errors of the paths."""
    kinds = [("glass", lambda c: c.glass(), True), ("rough glass", lambda c: c.glass(0.3), False),
             ("mirror", lambda c: c.material(1.0, metallic=1.0, roughness=0.0), True),
             ("metal, roughness 0.3", lambda c: c.material(1.0, metallic=1.0, roughness=0.3), False),
             ("gloss over grey, roughness 0.1", lambda c: c.material(0.5, specular=1.0, roughness=0.1), False)]
    for title, material, lossless in kinds if s.pick(False, True) else kinds[:1]:
        scene = Scene()
        scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.5, 1.0, one_sided=True))
        positions, triangles, normals = sphere_mesh((0, -0.2, 0), (0.4, 0.4, 0.4), 16, inwards=False)
        scene.mesh(positions, triangles, material(scene), None if "glass" in title else normals)
        scene.camera((0, 0, 0.95), (0, -0.1, 0), fov=1.2)
        path = scene.save(s.path(".gltf"))
        paths = s.render(path, (48, 32), s.pick(16, 256), "--integrator", "path")
        noise = 4 * paths.sigma_of_mean() / paths.mean()
        cached = s.cached(path, (48, 32), 16)
        s.near(f"{title}: mean of the picture, paths'", paths.mean(), cached.mean(), s.pick(0.05, 0.01) + noise)
        if lossless:
            s.near(f"{title}: radiance", 2, cached.mean(), s.pick(0.05, 0.01))
            s.near(f"{title}: radiance by paths", 2, paths.mean(), 0.005 + noise)

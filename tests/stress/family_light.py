"""Light: strengths from 1e-20 to 1e30 side by side, many lights, tiny ones, grazing, edge-on, behind."""
import math

from scenes import Scene, grid_mesh, irradiance_of_polygon
from session import case

STRENGTHS = [1e-20, 1.0, 1e20, 1e30]
RHO = 0.5


@case("light", "emitters of 1e-20 .. 1e30 in one scene")
def strengths(s):
    """Closed cubes side by side, each a furnace: L = Le / (1 - rho). Light sampling goes to the strongest cube, so in
    the others the light must come from what scattering finds. A path's sum has a standard deviation of at most about
    L/2 (its terms rho^k with and without one of them), so the tolerance is 4 * 0.5 / sqrt(samples)."""
    scene = Scene()
    for i, strength in enumerate(STRENGTHS):
        x = 4.0 * i
        scene.room((x - 1, -1, -1), (x + 1, 1, 1), scene.material(RHO, strength, one_sided=True))
        scene.camera((x + 0.1, 0.2, 0.9), (x - 0.3, -0.2, -1), name=f"cube{i}")
    path = scene.save(s.path(".gltf"))
    side, spp = s.pick((64, 32), (128, 64))
    images = [s.render(path, (side, side), spp, "--halves", "--camera", f"cube{i}") for i in range(len(STRENGTHS))]
    for strength, image in zip(STRENGTHS, images):
        s.near(f"radiance in the cube of {strength:g}", strength / (1 - RHO), image.mean(),
               4 * 0.5 / math.sqrt(side * side * spp))
        out = s.path(".json")
        a, b = (image.path.replace(".exr", f"_{half}.exr") for half in "ab")
        s.done(s.run("aqm-compare", a, b, "--json", out))
        error = s.read_json(out)["total"]["rmse"]
        s.true("aqm-compare of its halves: rmse below L", error is not None and error < 2 * strength, f"{error}")
        s.done(s.run("tempolux-info", "--png", s.path(".png"), image.path))
    flux = math.fsum(math.pi * 24 * x for x in STRENGTHS)
    map_ = s.photons(path, "20k", "--importance", "none")
    s.near("photons: emitted flux, W", flux, map_["emitted_flux_W"][1], 1e-5)   # flux of a photon is a float
    # By what is seen the strongest cube has at least a quarter of the paths, and their number differs by up to 2 from that share.
    map_ = s.photons(path, "20k")
    s.near("photons by what is seen: emitted flux, W", flux, map_["emitted_flux_W"][1], 2 / (0.25 * 20000))
    s.near("photons: escaped", 0, map_["escaped_flux_W"][1] / flux, 0)
    # Photons are shared out by flux, so that all of them are in the strongest cube; nothing else may get of its light.
    # There: 20k paths, 4 sqrt(rho / N) = 2 %, and 1 % for points and gathering.
    for i, strength in enumerate(STRENGTHS):
        cached = s.cached(path, (32, 32), 16, photons="20k", common=("--camera", f"cube{i}"))
        if strength == max(STRENGTHS):
            s.near(f"cache: radiance in the cube of {strength:g}", strength / (1 - RHO), cached.mean(), 0.03)
        else:
            s.at_most(f"cache: radiance in the cube of {strength:g}", strength / (1 - RHO) * 1.1, cached.mean())


def lit_room(path, strength, size=1.0):
    scene = Scene()
    scene.room((0, 0, 0), (size, size, size), scene.material([0.75, 0.5, 0.25]))
    a, b, y = 0.375 * size, 0.625 * size, 0.984375 * size
    scene.quad((a, y, a), (b, y, a), (b, y, b), (a, y, b), scene.material(0.0, strength))
    scene.camera((0.5 * size, 0.5 * size, 0.9375 * size), (0.5 * size, 0.375 * size, 0))
    return scene.save(path)


@case("light", "one emitter times 2^-66 .. 2^99")
def linearity(s):
    """Light is linear, and a power of two changes no digit: the same images and totals, times the power."""
    def results(strength):
        path = lit_room(s.path(".gltf"), strength)
        map_ = s.photons(path, "20k")
        return (s.render(path, (48, 36), 8), s.render(path, (48, 36), 4, "--photons", map_["path"]),
                s.cached(path, (48, 36)), map_)
    one = results(1.0)
    for power in (-66, 66, 99):
        scaled = results(2.0**power)
        for i, name in enumerate(("path tracing", "photons", "cache")):
            s.same_image(f"2^{power}, {name}", one[i], scaled[i], factor=2.0**power, exactly=True)
        s.near(f"2^{power}, photons: stored flux", one[3]["stored_flux_W"][0] * 2.0**power,
               scaled[3]["stored_flux_W"][0], 1e-12)


@case("light", "1e30 in a room of 1e6 m")
def too_much(s):
    """Flux 8e41 W is beyond float32 (3.4e38): the frame is right (radiance is 1e30), photons are refused or right."""
    path = lit_room(s.path(".gltf"), 1e30, 1e6)
    reference = s.render(lit_room(s.path(".gltf"), 1.0, 1e6), (48, 36), 8)
    image = s.render(path, (48, 36), 8)
    s.near("mean of the frame", reference.mean() * 1e30, image.mean(), 0.005)
    one, many = (s.cached(lit_room(s.path(".gltf"), strength, 1e6), (48, 36)).mean("indirect.G") for strength in (1.0, 1e20))
    s.near("1e20 in a room of 1e6 m, cache: mean of the indirect layer", one * 1e20, many, 0.03)
    out = s.path(".photons")
    run = s.run("photon-trace", path, "--photons", "10k", "-o", out)
    if run.code == 0:
        flux = s.info(out)["emitted_flux_W"][1]
        s.near("photons: emitted flux, W", 2 * math.pi * 1e30 * 0.25**2 * 1e12, flux, 1e-5)
    else:
        s.refused("photons", run, out, codes=(2, 3))


def floor_probe(scene, rho, height=0.25, half=1e-3):
    """A plate of 2 cm at the origin, looked at from above by an orthographic camera of 2 mm."""
    scene.quad((-0.01, 0, 0.01), (0.01, 0, 0.01), (0.01, 0, -0.01), (-0.01, 0, -0.01), scene.material(rho))
    scene.camera((0, height, 0), (0, 0, 0), half_height=half)


@case("light", "10^4 lights")
def many_lights(s):
    """The same square lamp in 2 and in 10^4 triangles: the same picture (4 sigma of both, from the spread of equal
    pixels) and, by a tree of depth log2(10^4) = 13, far from 10^4 times the time: at most 10 times."""
    cost, means = [], []
    for n in (1, 71):
        scene = Scene()
        floor_probe(scene, 0.8)
        scene.mesh(*grid_mesh((-0.5, 1, -0.5), (1, 0, 0), (0, 0, 1), n, n), scene.material(0.0, 5.0))
        image = s.render(scene.save(s.path(".gltf")), (64, 64), s.pick(64, 256))
        cost.append(s.phase(image.stats, "render"))
        means.append(image)
    corners = [(-0.5, 1, -0.5), (0.5, 1, -0.5), (0.5, 1, 0.5), (-0.5, 1, 0.5)]
    closed = 0.8 / math.pi * irradiance_of_polygon((0, 0, 0), (0, 1, 0), corners, 5.0)
    for name, image in zip(("2 triangles", "10082 triangles"), means):
        s.near(f"lamp of {name}: radiance of the plate", closed, image.mean(),
               4 * image.sigma_of_mean() / closed + 2e-6)
    s.cost_at_most("CPU time of 10082 triangles / of 2", 10, cost[1] / cost[0])

    scene = Scene()
    floor_probe(scene, 0.8)
    expected = 0.0
    for i in range(10000):
        position = (-1 + 0.02 * (i % 100), 0.5 + (i * 7919 % 1000) / 1000, -1 + 0.02 * (i // 100))
        intensity = 1e-3 * (1 + i % 5)
        scene.point_light(position, intensity)
        expected += 0.8 / math.pi * intensity * position[1] / math.dist(position, (0, 0, 0))**3
    image = s.render(scene.save(s.path(".gltf")), (64, 64), s.pick(64, 256))
    s.near("10000 point lights: radiance of the plate", expected, image.mean(),
           4 * image.sigma_of_mean() / expected + 2e-6)
    s.cost_at_most("CPU time of 10000 point lights / of 2 triangles", 10, s.phase(image.stats, "render") / cost[0])


@case("light", "10^4 lights, tiny and grazing, through the cache")
def through_cache(s):
    """A closed room, rho 0.5, but for the lamp: what the lights send first lies on its walls, indirect light is the rest."""
    cost = []
    for n in (1, 71):
        scene = indirect_room()
        scene.mesh(*grid_mesh((-0.5, 0.95, -0.5), (1, 0, 0), (0, 0, 1), n, n), scene.material(0.0, 5.0))
        _, image = s.like_paths(f"lamp of {2 * n * n} triangles", scene.save(s.path(".gltf")))
        cost.append(image.build.cpu)
    s.cost_at_most("irradcache-build, CPU time of 10082 triangles / of 2", 10, cost[1] / cost[0])
    scene = indirect_room()
    for i in range(10000):
        position = (-0.8 + 0.016 * (i % 100), -0.5 + (i * 7919 % 1000) / 1000, -0.8 + 0.016 * (i // 100))
        scene.point_light(position, 1e-4 * (1 + i % 5))
    _, image = s.like_paths("10000 point lights", scene.save(s.path(".gltf")))
    s.cost_at_most("irradcache-build, CPU time of 10000 point lights / of 2 triangles", 10, image.build.cpu / cost[0])
    for side in (1e-6, 1e-10):
        scene, half = indirect_room(), side / 2
        scene.quad((-half, 0, -half), (half, 0, -half), (half, 0, half), (-half, 0, half), scene.material(0.0, 1 / side**2))
        s.like_paths(f"emitter of {side * side:.0e} m^2", scene.save(s.path(".gltf")))
    # At 0.01 rad the floor gets next to nothing, the wall all of it; below the floor nothing is lit. (A lamp so near to the
    # floor that its spot there is smaller than what gather rays find is another matter: family_photons, "all in one point".)
    upright = [(0, 0.3, -0.2), (0, 0.5, -0.2), (0, 0.5, 0.2), (0, 0.3, 0.2)]
    above = [(-0.1, 2, -0.1), (0.1, 2, -0.1), (0.1, 2, 0.1), (-0.1, 2, 0.1)]
    for title, add in (("sun at cos 1e-2", lambda c: c.sun((0, -1e-2, -1), 3)),
                       ("lamp edge-on", lambda c: c.quad(*upright, c.material(0, 20.0))),
                       ("light below the floor", lambda c: c.point_light((0, -1e-4, 0), 1.0)),
                       ("lamp that looks away", lambda c: c.quad(*reversed(above), c.material(0, 20.0, one_sided=True)))):
        scene = Scene()
        grey = scene.material(RHO)
        scene.quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1), grey)
        scene.quad((-1, 0, -1), (1, 0, -1), (1, 1, -1), (-1, 1, -1), grey)
        add(scene)
        scene.camera((0, 2.2, 2.2), (0, 0.35, -0.1), fov=0.45)
        s.like_paths(f"floor, wall, {title}", scene.save(s.path(".gltf")))


def indirect_room():
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(RHO))
    scene.camera((0.2, 0.1, 0.9), (0, -0.3, -1), fov=1.2)
    return scene


def probe(s, title, add_light, expected, tolerance=1e-4, spp=None):
    """Expected: irradiance at the origin, up. The mean over 2 mm differs from it by second derivatives, (1e-3 / d)^2 or
    1e-5 at d = 0.3 m; the linear term leaves 1e-3 / sqrt(samples) of noise."""
    scene = Scene()
    floor_probe(scene, 0.8)
    add_light(scene)
    image = s.render(scene.save(s.path(".gltf")), (16, 16), spp or s.pick(64, 256))
    sigma = image.sigma_of_mean()
    s.near(title, 0.8 / math.pi * expected, image.mean(),
           tolerance + (4 * sigma * math.pi / 0.8 / expected if expected else 0))
    return image


@case("light", "tiny emitters")
def tiny(s):
    """A square of 1 cd upright, at the origin, where float32 is fine; the plate stands 1 m below it, 0.3 m aside."""
    for side in (1e-6, 1e-10):
        half = side / 2
        scene = Scene()
        scene.quad((-half, 0, -half), (half, 0, -half), (half, 0, half), (-half, 0, half),
                   scene.material(0.0, 1 / side**2))
        scene.quad((-0.31, -1, 0.01), (-0.29, -1, 0.01), (-0.29, -1, -0.01), (-0.31, -1, -0.01), scene.material(0.8))
        scene.camera((-0.3, -0.75, 0), (-0.3, -1, 0), half_height=1e-3)
        path = scene.save(s.path(".gltf"))
        distance2 = 1 + 0.3**2
        expected = 0.8 / math.pi / distance2**2                # I cos cos / d^2, I = 1 cd
        image = s.render(path, (16, 16), 64)
        s.near(f"emitter of {side * side:.0e} m^2: radiance of the plate", expected, image.mean(), 1e-4)
        map_ = s.photons(path, "10k")
        s.near(f"emitter of {side * side:.0e} m^2: emitted flux, W", 2 * math.pi, map_["emitted_flux_W"][1], 1e-5)


@case("light", "grazing, edge-on, behind")
def directions(s):
    for cosine in (1e-2, 1e-4, 1e-6):
        probe(s, f"point light at cos {cosine:g}", lambda scene, c=cosine: scene.point_light((0, c, 1), 10),
              10 * cosine / (1 + cosine**2)**1.5)
    probe(s, "sun at cos 1e-4", lambda scene: scene.sun((1, -1e-4, 0), 3), 3e-4)
    wall = [(-0.5, 1e-3, -0.5), (0.5, 1e-3, -0.5), (0.5, 1, -0.5), (-0.5, 1, -0.5)]
    probe(s, "wall that stands on the horizon",
          lambda scene: scene.quad(*wall, scene.material(0.0, 5.0)),
          irradiance_of_polygon((0, 0, 0), (0, 1, 0), wall, 5.0), spp=s.pick(1024, 4096))
    low = [(-0.5, 1e-4, -3), (0.5, 1e-4, -3), (0.5, 2e-4, -3), (-0.5, 2e-4, -3)]
    probe(s, "strip of 0.1 mm just above the horizon", lambda scene: scene.quad(*low, scene.material(0.0, 5e3)),
          irradiance_of_polygon((0, 0, 0), (0, 1, 0), low, 5e3), spp=s.pick(1024, 4096))
    # Edge-on: the lamp lies in the plane z = 0 that halves the plate. At |z| <= 1 mm it is seen under |z| / d, d > 0.7:
    # E <= L A cos |z| / d^3 with L = 5, A = 0.25, cos <= 1.
    scene = Scene()
    floor_probe(scene, 0.8)
    scene.quad((0.5, 0.5, 0), (1, 0.5, 0), (1, 1, 0), (0.5, 1, 0), scene.material(0.0, 5.0))
    image = s.render(scene.save(s.path(".gltf")), (16, 16), 64)
    s.at_most("lamp edge-on", 0.8 / math.pi * 5 * 0.25 * 1e-3 / 0.7**3, image.mean())
    square = [(-0.5, 1, -0.5), (0.5, 1, -0.5), (0.5, 1, 0.5), (-0.5, 1, 0.5)]        # shines down
    probe(s, "one-sided lamp that looks at the plate",
          lambda scene: scene.quad(*square, scene.material(0.0, 5.0, one_sided=True)),
          irradiance_of_polygon((0, 0, 0), (0, 1, 0), square, 5.0), spp=s.pick(1024, 4096))
    probe(s, "one-sided lamp that looks away",
          lambda scene: scene.quad(*reversed(square), scene.material(0.0, 5.0, one_sided=True)), 0, 0)
    below = [(x, -y, z) for x, y, z in square]
    probe(s, "lamp below the plate", lambda scene: scene.quad(*below, scene.material(0.0, 5.0)), 0, 0)
    probe(s, "point light below the plate", lambda scene: scene.point_light((0, -0.5, 0), 10), 0, 0)
    probe(s, "point light in the plane of the plate", lambda scene: scene.point_light((0.5, 0, 0), 10), 0, 0)
    probe(s, "spot that looks away", lambda scene: scene.spot_light((0, 1, 0), (0, 2, 0), 10, 0.1, 0.2), 0, 0)

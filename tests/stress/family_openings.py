"""Light through small openings: the sky and the sun in a closed room through a hole of 1e-3 of a wall."""
import math

from scenes import Scene, irradiance_of_polygon
from session import case

RHO = 0.5
SIDE = 2 * math.sqrt(1e-3)                     # of the hole, m: 1e-3 of a wall of 2 x 2 m
HOLE = SIDE * SIDE                             # m^2
WALLS = 24 - HOLE                              # m^2


def shell(scene, reflectance, d):
    """A cube of 2 m + 2 d whose ceiling has the hole in its middle; the hole's corners, seen from below."""
    wall, h, r = scene.material(reflectance), SIDE / 2, 1 + d
    a = [(-r, r, -r), (r, r, -r), (r, r, r), (-r, r, r)]
    b = [(-h, r, -h), (h, r, -h), (h, r, h), (-h, r, h)]
    for i in range(4):
        j = (i + 1) % 4
        scene.quad(a[i], a[j], b[j], b[i], wall)
    scene.quad((-r, -r, r), (r, -r, r), (r, -r, -r), (-r, -r, -r), wall)
    for x in (-r, r):
        scene.quad((x, -r, -x), (x, -r, x), (x, r, x), (x, r, -x), wall)
        scene.quad((x, -r, x), (-x, -r, x), (-x, r, x), (x, r, x), wall)
    return b


def room(scene):
    """The room, and a black one close around it that no light leaves again: photons outside are then absorbed and not stored. The slit
    between them is 1e-4 m: 0.2 % of the hole's width."""
    shell(scene, 0.0, 1e-4)
    return shell(scene, RHO, 0.0)


def chain(s, path, size, spp, photons, *options):
    """The frame with its layers by photons, points, records; `options` of all tools."""
    photon_map, points, cache = s.photons(path, photons, *options)["path"], s.path(".irradpoints"), s.path(".irradcache")
    s.done(s.run("irradcache-build", path, "--photons", photon_map, "--keep-points", points, "--size", f"{size[0]}x{size[1]}", "-o", cache, *options))
    return s.render(path, size, spp, "--irradcache", cache, "--points", points, "--channels", "RGBA,layers", *options)


def interreflected(flux):
    """Irradiance that the walls have on average of light scattered at least once, W/m^2: each bounce leaves the share RHO, of
    which HOLE / WALLS leaves the room on average, by reciprocity (all that the hole emits meets walls)."""
    kept = RHO * (1 - HOLE / WALLS)
    return flux / WALLS * kept / (1 - kept)


@case("light", "sky through an opening of 1e-3 of the wall")
def sky(s):
    """The hole is a lamp of the sky's radiance L. On the floor below its middle the direct light is Lambert's formula, which
    changes there by less than 1 % over the 0.2 m that are seen: cos^4 of 2.9 degrees. The sky's photons are aimed at the scene's sphere
    of radius sqrt(3): a share of HOLE / (pi 3) / 2 or more of them enters."""
    scene, radiance = Scene(), 100.0
    hole = room(scene)
    scene.camera((0, -0.5, 0), (0, -1, 0), half_height=0.1)
    path, options = scene.save(s.path(".gltf")), ("--environment", f"{radiance:g}")
    direct = RHO / math.pi * irradiance_of_polygon((0, -1, 0), (0, 1, 0), hole, radiance)
    size, spp = s.pick(((32, 32), 64), ((96, 96), 1024))
    paths = s.render(path, size, spp, "--integrator", "path", "--channels", "RGBA,layers", *options)
    noise = paths.sigma_of_mean("direct.G") / direct
    s.near("direct light below it, path tracing", direct, paths.mean("direct.G"), 0.01 + 4 * noise)
    entering = s.pick(10**6, 10**7) * HOLE / (6 * math.pi)
    stored(s, path, s.pick("1M", "10M"), math.pi * radiance * HOLE, entering, *options)
    through = chain(s, path, size, s.pick(16, 64), s.pick("1M", "10M"), *options)
    hits = size[0] * size[1] * s.pick(16, 64) * HOLE / 4 / (4 * math.pi)      # of light samples that know nothing of the hole
    if hits > 16:
        s.near("direct light below it, chain", direct, through.mean("direct.G"), 0.01 + 4 / math.sqrt(hits))
    alike(s, paths, through, entering)


def stored(s, path, count, flux, entering, *options):
    """Photons scattered at least once, all of them inside: their flux. One that enters is stored so RHO / (1 - RHO) = 1 times in the
    mean with a variance of RHO / (1 - RHO)^2 = 2, and the number that enters varies as well: 3 / entering in all."""
    found = s.photons(path, count, "--kinds", "indirect", *options)["by_kind"]["indirect"]["flux_W"][1]
    s.near("photons scattered inside: flux, W", interreflected(flux) * WALLS, found, 4 * math.sqrt(3 / entering))


def alike(s, paths, through, entering):
    """Indirect light of both: 4 standard errors of the path tracer, 4 of the photons that entered, and what points and gathering may add."""
    mean = paths.mean("indirect.G")
    s.near("indirect light, chain against paths", mean, through.mean("indirect.G"),
           s.pick(0.05, 0.02) + 4 * math.hypot(paths.sigma_of_mean("indirect.G") / mean, 1 / math.sqrt(entering)))


@case("light", "sun through an opening of 1e-3 of the wall")
def sun(s):
    """The sun stands overhead: on the floor a square as large as the hole has its irradiance E, and no more. The camera sees the
    floor from above without perspective: the mean of the direct layer is RHO / pi E (hole / floor). An edge pixel is known to
    what its samples tell of its share: 4 edges of n pixels by spp samples each."""
    scene, irradiance = Scene(), 1000.0
    room(scene)
    scene.sun((0, -1, 0), irradiance)
    scene.camera((0, 0.99, 0), (0, -1, 0), half_height=1)
    path = scene.save(s.path(".gltf"))
    side, spp = s.pick((64, 64), (128, 256))
    expected = RHO / math.pi * irradiance * HOLE / 4
    edge = 4 * SIDE / 2 * side                 # pixels that an edge of the square crosses
    tolerance = 4 * math.sqrt(edge / 4 / spp) / (SIDE / 2 * side) ** 2
    paths = s.render(path, (side, side), spp, "--integrator", "path", "--channels", "RGBA,layers")
    s.near("direct light on the floor, path tracing", expected, paths.mean("direct.G"), tolerance)
    entering = s.pick(10**6, 10**7) * HOLE / (3 * math.pi)      # the sun's disc covers the scene's sphere
    stored(s, path, s.pick("1M", "10M"), irradiance * HOLE, entering)
    through = chain(s, path, (side, side), s.pick(16, 64), s.pick("1M", "10M"))
    s.near("direct light on the floor, chain", expected, through.mean("direct.G"), 2 * tolerance)
    alike(s, paths, through, entering)

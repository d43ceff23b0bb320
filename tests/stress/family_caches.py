"""Irradiance caches where lengths degenerate: no distance, no hit, no record, records closer than floats, radii clamped.

The law of most cases is a furnace: every wall emits 1 and reflects 0.5, so the radiance is 2 wherever one looks and
whatever the radii are. Tolerance: 4 sqrt(rho / N) of N paths (2 % of 20k, 0.6 % of 200k), and 1 % for points, gathering
and interpolation.
"""
import math
import struct

import session  # noqa: F401  (puts read_irradcache on the path)
from read_irradcache import write_irradcache
from scenes import Scene
from session import case

RHO = 0.5
LOWER, UPPER = (-1, -1, -1), (1, 1, 1)


def tolerance(s):
    return s.pick(0.03, 0.016)


def furnace_room(s, fill=None, eye=(0.3, 0.2, 0.8), target=(-0.4, -0.2, -1), **camera):
    scene = Scene()
    wall = scene.material(RHO, 1.0, one_sided=True)
    scene.room(LOWER, UPPER, wall)
    if fill:
        fill(scene, wall)
    scene.camera(eye, target, **(camera or {"fov": 1.2}))
    return scene.save(s.path(".gltf"))


def looked_at(s, title, image, pixels, radiance=None):
    s.near(f"{title}: radiance", 1 / (1 - RHO), image.mean() if radiance is None else radiance, tolerance(s))
    placed(s, title, image, pixels)


def placed(s, title, image, pixels):
    """No more records than points looked at: a pixel's centre, and four places in a pixel at an edge."""
    s.true(f"{title}: records", 1 <= len(image.cache.records) <= 5 * pixels, str(len(image.cache.records)), f"1 .. {5 * pixels}")
    radii = [r.radius for r in image.cache.records]
    s.true(f"{title}: radii", all(0 < r < math.inf for r in radii), f"{min(radii):.2g} .. {max(radii):.2g}", "above 0")


def mean_of_maps(s, path, size, spp):
    """The first frame of some, and the radiance in the mean of them. One place in a corner sees near walls: half its
    indirect light, a quarter of all, comes from a few neighbourhoods, say four, of k = 50 photons, 14 % of noise each:
    1.8 % in one frame, and six of them stay within 1.6 % at 2 sigma."""
    frames = [s.cached(path, size, spp, seed=seed) for seed in range(s.pick(1, 6))]
    return frames[0], sum(f.mean() for f in frames) / len(frames)


@case("caches", "zero hit distance")
def touching(s):
    """A plate at 0, 1e-7 and 1e-5 m above the floor: gather rays from below it, and from the floor there, hit at once. And
    a camera that stands 1e-6 m before a wall, and in a corner. Rays start 2^-20 m (of coordinates of 1 m) above a surface:
    of the plates nearer than that the floor below shines past them, or not: up to 1 of 24 m^2 more shine, and of the
    radiance that is the part that is reflected."""
    hidden = 1 * RHO / (1 - RHO) / 24
    for height in (0.0, 1e-7, 1e-5):
        def plate(scene, wall, y=height - 1):
            both = scene.material(RHO, 1.0)
            scene.quad((-0.5, y, 0.5), (0.5, y, 0.5), (0.5, y, -0.5), (-0.5, y, -0.5), both)
        title, image = f"plate {height:g} m above the floor", s.cached(furnace_room(s, plate), (32, 24), 16)
        if height > 2**-20:
            looked_at(s, title, image, 32 * 24)
            continue
        low, high = (1 - tolerance(s)) / (1 - RHO), (1 + tolerance(s)) * (1 / (1 - RHO) + hidden)
        s.true(f"{title}: radiance", low < image.mean() < high, f"{image.mean():.5g}", f"{low:.4g} .. {high:.4g}")
        placed(s, title, image, 32 * 24)
    for title, eye, target in [("wall", (0.2, 0.1, -1 + 1e-6), (0.2, 0.1, -2)),
                               ("corner", (-1 + 1e-6, -1 + 1e-6, -1 + 1e-6), (-2, -2, -2))]:
        image, radiance = mean_of_maps(s, furnace_room(s, None, eye, target), (16, 16), 16)
        looked_at(s, f"camera 1e-6 m before a {title}", image, 256, radiance)


@case("caches", "kept from frame to frame")
def over_time_in_a_furnace(s):
    """A plate that lies 1e-7 m above the floor, rises, touches the ceiling and is gone: what is kept holds for the furnace in each frame."""
    from family_time import KEYS, over_time

    def plate(scene, wall):
        moved = scene.quad((-0.5, 0, 0.5), (0.5, 0, 0.5), (0.5, 0, -0.5), (-0.5, 0, -0.5), scene.material(RHO, 1.0))
        scene.animate(moved, "translation", KEYS, [(0, 1e-5 - 1, 0), (0, -0.5, 0), (0, 1 - 1e-5, 0), (0, 5, 0)], "STEP")
    for f, image in enumerate(over_time(s, furnace_room(s, plate), (32, 24))[0]):
        s.near(f"frame {f}: radiance", 1 / (1 - RHO), image.mean(), 2 * tolerance(s))


@case("caches", "all misses")
def misses(s):
    """A floor under a lamp and nothing above it: no gather ray hits. No light, and the largest radius of records that
    saw nothing: 32 pixels (PlacementOptions::unseen_radius_px) of 2 x 0.9 / 32 = .056 m, rounded to the power of two
    1 / 16. Records that fill what wider classes left are smaller, down to 4 pixels."""
    scene = Scene()
    scene.quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1), scene.material(0.8))
    scene.point_light((0, 1, 0), 1.0)
    scene.camera((0, 2, 0), (0, 0, 0), half_height=0.9)
    image = s.cached(scene.save(s.path(".gltf")), (32, 32))
    records = image.cache.records
    s.near("indirect light", 0, max(map(abs, image.rgb("indirect"))), 0)
    s.near("largest radius, m", 32 / 16, max(r.radius for r in records), 1e-5)
    s.true("smallest radius: 4 pixels at least", min(r.radius for r in records) >= 4 / 16)
    s.true("no radius is raised: the least is 4 pixels", all(r.radius == r.radius_unclamped for r in records))
    s.true("gradients", all(g == 0 for r in records for g in (*r.rotational, *r.translational)), expected="0")


@case("caches", "0 and 1 record")
def few(s):
    """A cache with all records but one taken out, and with none: where one is missing a ray of the hemisphere takes its place,
    which ends at points, or goes on as a path where there are none. The picture is that of a full cache, to the noise of 24 x 16 x 64
    such rays: the radiance that one brings scatters by less than its mean, 1 / sqrt(24576) = 0.6 %, of the half that is indirect."""
    path = furnace_room(s)
    full = s.cached(path, (24, 16), 4)
    for count in (0, 1):
        cache, file = s.read_cache(full.records), s.path(".irradcache")
        cache.records = cache.records[:count]
        write_irradcache(file, cache)
        s.done(s.run("tempolux-info", "--check", file))
        for title, points in (("and points", ("--points", full.points)), ("alone", ())):
            image = s.render(path, (24, 16), 64, "--irradcache", file, *points)
            s.near(f"{count} records {title}: radiance", 1 / (1 - RHO), image.mean(), tolerance(s))
            for name, some in (("gathered_in_pixels", True), ("points_read", bool(points))):
                made = image.stats["counts"][name]
                s.true(f"{count} records {title}: {name}", (made > 0) == some, f"{made:g}", "> 0" if some else "0")


@case("caches", "records closer than float spacing")
def crowded(s):
    """An edge of the room through a picture 2e-7 m high: pixels are 6e-9 m apart, where floats are 6e-8 m apart. Then a cache
    whose records all stand in one point, and at points one float apart."""
    for title, eye, target in [("wall", (0.3, 0.2, 0.5), (0.3, 0.2, -1)), ("edge", (-0.5, -0.5, 0.2), (-1, -1, 0.2))]:
        path = furnace_room(s, None, eye, target, half_height=1e-7)
        image, radiance = mean_of_maps(s, path, (32, 32), 4)
        looked_at(s, f"picture of 2e-7 m, {title}", image, 32 * 32, radiance)
        s.cost_at_most(f"picture of 2e-7 m, {title}: CPU seconds", 20, image.build.cpu)
    path = furnace_room(s)
    full = s.cached(path, (24, 16), 4)
    cache = s.read_cache(full.records)
    first = cache.records[0]
    for title, step in (("in one point", 0), ("one float apart", 1)):
        cache.records = []
        for i in range(5000):
            x = struct.unpack("<f", struct.pack("<I", struct.unpack("<I", struct.pack("<f", first.position[0]))[0] + i * step))[0]
            record = type(first)(**{**vars(first), "position": (x, *first.position[1:]), "radius": 1e-7 * (1 + i % 7)})
            cache.records.append(record)
        file = s.path(".irradcache")
        write_irradcache(file, cache)
        image = s.render(path, (24, 16), 64, "--irradcache", file, "--points", full.points)
        s.near(f"5000 records {title}: radiance", 1 / (1 - RHO), image.mean(), tolerance(s))
        s.cost_at_most(f"5000 records {title}: CPU seconds", 20, image.run.cpu)


@case("caches", "error bound at both ends")
def clamped(s):
    """Error bounds at both ends. In a furnace both are right."""
    path = furnace_room(s)
    for title, options in [("error bound 0.001", ("--error-bound", 0.001)), ("error bound 2", ("--error-bound", 2))]:
        image = s.cached(path, (24, 16), 4, records=options, timeout=120)
        looked_at(s, title, image, 24 * 16)
        s.cost_at_most(f"{title}: CPU seconds", 60, image.build.cpu)

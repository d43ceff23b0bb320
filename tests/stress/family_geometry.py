"""Geometry that is allowed and unpleasant. Most rooms are furnaces: every wall emits 1 inwards and reflects 0.5, so
the radiance is 2 wherever one looks; and as they are closed, no photon may escape. A hole shows in both."""
import array
import math
import random

from scenes import Scene, leaves_mesh, room_mesh, sphere_mesh
from session import FULL, LONG, case

RHO = 0.5


def furnace(s, title, fill, escaped=0.0, spp=None, ending=".gltf", timeout=300, photons=None, cache=True):
    """fill(scene, material). Pixels are all alike: 4 standard errors. `escaped`: share of the flux that may leave."""
    scene = Scene()
    fill(scene, scene.material(RHO, 1.0, one_sided=True))
    scene.camera((0.3, 0.2, 0.8), (-0.4, -0.2, -1), fov=1.2)
    path = scene.save(s.path(ending))
    image = s.render(path, (48, 48), spp or s.pick(16, 128), timeout=timeout)
    s.near(f"{title}: radiance", 1 / (1 - RHO), image.mean(), 4 * image.sigma_of_mean() * (1 - RHO) + escaped + 1e-5)
    totals = s.photon_totals(path, photons or s.pick(100000, 1000000), timeout=timeout)
    s.at_most(f"{title}: share of the photons' flux that escapes", escaped, totals["escaped"][1] / totals["emitted"][1])
    if cache:
        # Photons 4 sqrt(rho / N) = 2 %, at 200k paths 0.6 %; points lit by 4 shadow rays each and gathering: 1 %.
        through = s.cached(path, (32, 32), 16, timeout=timeout)
        s.near(f"{title}, cache: radiance", 1 / (1 - RHO), through.mean(), s.pick(0.03, 0.015) + escaped)
    return image, totals


LOWER, UPPER = (-1, -1, -1), (1, 1, 1)


@case("geometry", "slivers of aspect 1e6")
def slivers(s):
    """Strips of 2e-6 x 2 m between ordinary ones. Where a strip ends at an edge the neighbouring wall has no vertex;
    the rounding of a float32 at 1 m, 6e-8 m, over the strips' ends leaves no gap that a ray in 1e6 finds."""
    cuts = [0, 0.2, 0.2 + 1e-6, 0.5, 0.5 + 1e-6, 0.5 + 2e-6, 0.9, 0.9 + 1e-6, 1]
    furnace(s, "slivers", lambda scene, m: scene.room(LOWER, UPPER, m, cuts=cuts))

    def needles(scene, material):
        """Each wall as a fan of 100 triangles around a point on its edge, the last ones thin as 1e-6."""
        positions, triangles = room_mesh(LOWER, UPPER)
        for wall in range(6):
            a, b, _, d = (positions[12 * wall + 3 * k:12 * wall + 3 * k + 3] for k in range(4))
            corner = [positions[12 * wall + k] for k in range(3)]
            u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, positions[12 * wall + 6:12 * wall + 9])]
            steps = [0.0] + [10**(-6 + 6 * k / 49) for k in range(50)]
            rim = [[1.0, t] for t in steps] + [[t, 1.0] for t in reversed(steps[:-1])]
            points = array.array("f", corner)
            for p, q in rim:
                points.extend(c + p * x + q * y for c, x, y in zip(corner, u, v))
            fan = array.array("I")
            for k in range(1, len(rim)):
                fan.extend((0, k + 1, k))
            scene.mesh(points, fan, material)
    furnace(s, "needles", needles)


def lamp_room(scene, wall, extra=None):
    scene.mesh(*wall)
    scene.quad((-0.3, 0.95, -0.3), (0.3, 0.95, -0.3), (0.3, 0.95, 0.3), (-0.3, 0.95, 0.3), scene.material(0.0, 5.0))
    scene.camera((0.3, 0.2, 0.8), (-0.4, -0.2, -1), fov=1.2)
    if extra:
        extra(scene)


@case("geometry", "zero-area and duplicate triangles, coincident surfaces")
def degenerate(s):
    """Zero-area triangles and copies of matte walls change nothing: the same light to 4 sigma of both images, and the
    photons' total as it was. A coincident wall of another reflectance: either may be seen, so the light lies between
    that of the two alone."""
    def room(path, rho, change=None, second=None):
        scene = Scene()
        positions, triangles = room_mesh(LOWER, UPPER)
        if change:
            positions, triangles = change(positions, triangles)
        lamp_room(scene, (positions, triangles, scene.material(rho)))
        if second is not None:
            scene.mesh(*room_mesh(LOWER, UPPER), scene.material(second))
        return scene.save(path)

    def zero_areas(positions, triangles):
        triangles = triangles + array.array("I", [0, 0, 0, 0, 1, 1, 0, 1, 0, 5, 5, 6])
        first = len(positions) // 3
        line = array.array("f", [-1, -1, -1, 0, 0, 0, 1, 1, 1])                # collinear, across the room
        return positions + line, triangles + array.array("I", [first, first + 1, first + 2])

    def twice(positions, triangles):
        return positions, triangles + triangles

    count, size, spp = s.pick("50k", "500k"), (48, 48), s.pick(16, 128)
    plain = room(s.path(".gltf"), RHO)
    reference, totals = s.render(plain, size, spp), s.photons(plain, count)
    for title, change in [("zero-area triangles", zero_areas), ("every triangle twice", twice)]:
        path = room(s.path(".gltf"), RHO, change)
        image, map_ = s.render(path, size, spp), s.photons(path, count)
        differing = math.hypot(reference.sigma_of_mean(), image.sigma_of_mean()) / reference.mean()
        s.near(f"{title}: mean of the image", reference.mean(), image.mean(), 4 * differing)
        s.near(f"{title}: stored flux", totals["stored_flux_W"][1], map_["stored_flux_W"][1], 1e-3)
        s.near(f"{title}: escaped", 0, map_["escaped_flux_W"][1], 0)
        a, b = s.cached(plain, (32, 24)), s.cached(path, (32, 24))
        s.near(f"{title}: mean of the indirect layer, cache", a.mean("indirect.G"), b.mean("indirect.G"), s.pick(0.04, 0.01))
    dark, bright = s.render(room(s.path(".gltf"), 0.3), size, spp), s.render(room(s.path(".gltf"), 0.7), size, spp)
    path = room(s.path(".gltf"), 0.3, second=0.7)
    image, map_ = s.render(path, size, spp), s.photons(path, count)
    s.true("coincident walls of 0.3 and 0.7: mean in between", dark.mean() * 0.99 < image.mean() < bright.mean() * 1.01,
           f"{image.mean():.4g}", f"{dark.mean():.4g} .. {bright.mean():.4g}")
    s.near("coincident walls of 0.3 and 0.7: escaped", 0, map_["escaped_flux_W"][1], 0)


@case("geometry", "cracks")
def cracks(s):
    """Walls that share no vertex but lie edge to edge let nothing through. Walls drawn in by 1e-5 m leave twelve gaps
    about that wide: 24 m * 1.4e-5 m / 24 m^2 = 1.4e-5 of what arrives; per path 1 / (1 - rho) arrivals: 3e-5."""
    furnace(s, "unwelded", lambda scene, m: scene.room(LOWER, UPPER, m, cuts=7))
    positions, triangles = room_mesh(LOWER, UPPER)
    g = 1e-5
    for wall in range(6):
        flat = [len({positions[12 * wall + 3 * k + axis] for k in range(4)}) == 1 for axis in range(3)]
        for k in range(4):
            for axis in range(3):
                if not flat[axis]:
                    positions[12 * wall + 3 * k + axis] *= 1 - g
    furnace(s, "gaps of 1e-5 m", lambda scene, m: scene.mesh(positions, triangles, m), escaped=1e-4)


@case("geometry", "1 triangle")
def one_triangle(s):
    scene = Scene()
    scene.mesh([-1, -1, 0, 1, -1, 0, 0, 1, 0], [0, 1, 2], scene.material(0.5, 3.0))
    scene.camera((0, 0, 2), (0, 0, 0), half_height=1)
    path = scene.save(s.path(".gltf"))
    image = s.render(path, (64, 64), 16, "--channels", "RGBA,Z,N,P,id,albedo,motion")
    # Half of the picture's 2 x 2 m. Of 16 samples in each of the 300 pixels at the edge, +-2: 2 / 16 sqrt(300) / 2048.
    s.near("mean: half of the pixels at 3", 1.5, image.mean(), 4 * 0.001)
    s.near("largest value", 3.0, max(image.channels["G"]), 1e-6)
    map_ = s.photons(path, "10k")
    s.near("photons: emitted flux, W", 2 * math.pi * 3 * 2, map_["emitted_flux_W"][1], 1e-5)
    s.near("photons: escaped flux, W", map_["emitted_flux_W"][1], map_["escaped_flux_W"][1], 1e-12)
    s.near("photons: stored", 0, map_["photons"], 0)
    through = s.cached(path, (32, 32), 16)
    s.near("cache: indirect light", 0, through.mean("indirect.G"), 0)
    s.near("cache: mean", 1.5, through.mean(), 0.01)


def million(s, n, count):
    """6 walls of n x n cells; all of them lamps."""
    image, totals = furnace(s, f"{12 * n * n} triangles", lambda scene, m: scene.room(LOWER, UPPER, m, cuts=n),
                            ending=".glb", spp=16, photons=100000, timeout=600)
    # Vertices, search tree, light tree and the file itself: 1 kB per triangle, and 64 MB of program.
    s.cost_at_most(f"{12 * n * n} triangles: MB of memory", 64 + 12e-3 * n * n, image.stats["peak_memory_bytes"] / 1e6)
    s.cost_at_most(f"{12 * n * n} triangles: seconds", 60 * count, image.run.seconds)


@case("geometry", "10^5 triangles, all emit")
def hundred_thousand(s):
    million(s, 92, 1)


@case("geometry", "10^6 triangles, all emit", FULL)
def one_million(s):
    million(s, 289, 1)


@case("geometry", "10^7 triangles, all emit", LONG)
def ten_million(s):
    million(s, 913, 10)


@case("geometry", "inverted normals")
def inverted(s):
    """Which way a two-sided wall's normals or corners go must not matter."""
    def room(path, flip_normals, flip_winding):
        scene = Scene()
        positions, triangles, normals = sphere_mesh((0, 0, 0), (1, 1, 1), 12)
        if flip_normals:
            normals = array.array("f", (-x for x in normals))
        if flip_winding:
            triangles = array.array("I", reversed(triangles))
        scene.mesh(positions, triangles, scene.material(0.7), normals)
        scene.point_light((0.2, 0.3, 0), 1)
        scene.camera((0, 0, 0.5), (0.1, 0.2, -1), fov=1.5)
        return scene.save(path)
    size, spp = (48, 48), s.pick(16, 64)
    plain = room(s.path(".gltf"), False, False)
    reference, totals, direct = s.render(plain, size, spp), s.photons(plain, "50k"), s.cached(plain, (32, 32), 16)
    for title, normals, winding in [("normals", True, False), ("winding", False, True), ("both", True, True)]:
        path = room(s.path(".gltf"), normals, winding)
        image, map_ = s.render(path, size, spp), s.photons(path, "50k")
        # Another order of triangles and corners is another sequence of roundings and choices: 4 sigma of both.
        sigma = math.hypot(reference.sigma_of_mean(), image.sigma_of_mean()) / reference.mean()
        s.near(f"{title} inverted: mean of the image", reference.mean(), image.mean(), 4 * sigma)
        # Shading normals lean away from the facets by up to pi/48 and bring noise of their own: (pi/48)^2 = 0.4 %.
        s.near(f"{title} inverted: stored flux", totals["stored_flux_W"][1], map_["stored_flux_W"][1], 0.004)
        through = s.cached(path, (32, 32), 16)
        s.near(f"{title} inverted: mean of the indirect layer, cache", direct.mean("indirect.G"), through.mean("indirect.G"),
               s.pick(0.04, 0.01))


@case("geometry", "non-uniform and negative scale")
def scaled(s):
    """Scale by powers of two is exact, so a node's scale and the same scale in the vertices make the same bits. A
    mirrored node turns the winding: its one-sided lamps must still shine inwards."""
    def by_node(scene, material, scale=(2, 1, 0.5)):
        scene.room(LOWER, UPPER, material, scale=list(scale))

    def images(fill):
        scene = Scene()
        fill(scene, scene.material(RHO, 1.0))
        scene.camera((0.3, 0.2, 0.4), (-0.4, -0.2, -1), fov=1.2)
        return s.render(scene.save(s.path(".gltf")), (48, 48), 16)
    a = images(by_node)
    b = images(lambda scene, m: scene.room((-2, -1, -0.5), (2, 1, 0.5), m))
    s.same_image("room scaled (2, 1, 0.5)", b, a, exactly=True)

    for scale in [(-1, 1, 1), (-1, -1, -1), (1, -1, -1)]:
        def mirrored(scene, material, scale=scale):
            scene.room(LOWER, UPPER, material, scale=list(scale))
        furnace(s, f"one-sided lamps, scale {scale}", mirrored)

    def ellipsoid(radii, scale):
        scene = Scene()
        positions, triangles, normals = sphere_mesh((0, 0, 0), radii, 12)
        scene.mesh(positions, triangles, scene.material(0.7), normals, scale=list(scale))
        scene.point_light((0.2, 0.3, 0), 1)
        scene.camera((0, 0, 0.25), (0.1, 0.2, -1), fov=1.5)
        return s.render(scene.save(s.path(".gltf")), (48, 48), 16, "--channels", "RGBA,N")
    s.same_image("ellipsoid by scale, its normals by the inverse transpose", ellipsoid((2, 1, 0.5), (1, 1, 1)),
                 ellipsoid((1, 1, 1), (2, 1, 0.5)))

    scene = Scene()
    scene.room(LOWER, UPPER, scene.material(RHO, 1.0), scale=[1, 1, 0])
    scene.camera((0.3, 0.2, 0.8), (-0.4, -0.2, -1), fov=1.2)
    image = s.render(scene.save(s.path(".gltf")), (16, 16), 16)
    s.true("a room scaled flat: values from 0 to 2", 0 <= min(image.channels["G"]) and max(image.channels["G"]) < 20,
           f"{max(image.channels['G']):.3g}")


@case("geometry", "10^5 leaves in a furnace", FULL)
def leaves(s):
    """Bushes of 10^5 leaves of 2 x 1 cm that emit and reflect as the walls do: the radiance is 2 wherever one looks, and no record
    or point may take the light of another leaf for its own. The path tracer's is exact but for its noise."""
    middles = [(-0.5 + i % 2, -0.5 + i // 2 % 2, -0.6 + 0.6 * (i // 4)) for i in range(12)]
    mesh = leaves_mesh(random.Random(5), 10**5, middles, 0.3, 0.01, 0.005)

    def fill(scene, material):
        scene.room(LOWER, UPPER, material)
        scene.mesh(*mesh, scene.material(RHO, 1.0))
    furnace(s, "10^5 leaves", fill, ending=".glb", timeout=600)

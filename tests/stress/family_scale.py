"""Scale: a room of 1e-4 m, 1 m and 1e6 m, and one of 1 m that stands at 1e5 m from the origin.

Law: radiance of area lights does not change with size s, their flux goes with s^2; a point light gives the same
radiance if its intensity goes with s^2. With the same seed every random decision is the same, so the images are equal:
to the bit if s is a power of two (then all floats are those of s = 1 with another exponent), else to rounding.

Through the irradiance cache the random numbers of a gather are drawn by where it stands, to the bit: other numbers at
another size. There the pictures are equal to the noise of gathering.
"""
import math

from scenes import Scene
from session import case

POINT = 0.05                                   # cd at s = 1
RADIANCE = 4.0
SIDE = 0.25                                    # of the square emitter
# 200 rays leave a record about 10 % of noise, some 200 records or more a picture 0.7 %; photons are the same: 4 sigma.
CACHE_NOISE = 0.03


def room(path, s=1.0, baked=(0, 0, 0), node=None):
    """All coordinates are multiples of 1/64, so that `baked`, whose ulp is 1/128 at 1e5, moves them exactly."""
    scene = Scene()

    def at(x, y, z):
        return [s * c + b for c, b in zip((x, y, z), baked)]
    wall, screen = scene.material([0.75, 0.5, 0.25]), scene.material(0.5)
    scene.room(at(0, 0, 0), at(1, 1, 1), wall)
    scene.quad(at(0.25, 0, 0.25), at(0.75, 0, 0.375), at(0.6875, 0.5, 0.625), at(0.1875, 0.5, 0.5), screen)
    lamp = scene.material(0.0, RADIANCE)
    scene.quad(at(0.375, 0.984375, 0.375), at(0.625, 0.984375, 0.375), at(0.625, 0.984375, 0.625),
               at(0.375, 0.984375, 0.625), lamp)
    scene.point_light(at(0.25, 0.75, 0.75), POINT * s * s)
    scene.camera(at(0.5, 0.5, 0.9375), at(0.5, 0.375, 0))
    if node:
        scene.move_all(translation=node)
    return scene.save(path)


def check(s, title, reference, scene, size, exactly):
    images, map_, cached = pictures(s, scene)
    for name, a, b in zip(("path tracing", "photons"), reference[0], images):
        s.same_image(f"{title}, {name}", a, b, exactly=exactly)
    s.near(f"{title}, cache: mean of the indirect layer", reference[2].mean("indirect.G"), cached.mean("indirect.G"), CACHE_NOISE)
    s.near(f"{title}, cache: records", len(reference[2].cache.records), len(cached.cache.records), 0.25)
    flux = (2 * math.pi * RADIANCE * SIDE**2 + 4 * math.pi * POINT) * size**2       # two-sided lamp; point light
    s.near(f"{title}, photons: emitted flux, W", flux, map_["emitted_flux_W"][1], 1e-5)
    s.near(f"{title}, photons: escaped of a closed room", 0, map_["escaped_flux_W"][1] / flux, 0)
    # Paths that go another way by a rounding: less than one in 1e3 (session.same_image).
    s.near(f"{title}, photons: stored flux / s^2", reference[1]["stored_flux_W"][1],
           map_["stored_flux_W"][1] / size**2, 1e-12 if exactly else 1e-3)


def pictures(s, scene):
    size = s.pick((48, 36), (96, 72))
    map_ = s.photons(scene, s.pick("20k", "100k"))
    options = ["--channels", "RGBA,layers,Z,N,P,id,albedo"]
    return [s.render(scene, size, 8, "--integrator", "path", *options),
            # The same samples everywhere: how many more a pixel gets is a rounded number, which the last bit of a
            # neighbour can tip over at sizes that are no powers of two.
            s.render(scene, size, 4, "--photons", map_["path"], "--pixel-error", 0, *options)], map_, s.cached(
                scene, size, pixels=("--pixel-error", 0))


@case("scale", "sizes from 1e-4 to 1e6 m")
def sizes(s):
    reference = pictures(s, room(s.path(".gltf")))
    for title, size, exactly in [("2^-13 m", 2.0**-13, True), ("2^20 m", 2.0**20, True), ("1e-4 m", 1e-4, False),
                                 ("1e6 m", 1e6, False)]:
        check(s, title, reference, room(s.path(".gltf"), size), size, exactly)


@case("scale", "1 m at 1e5 m from the origin")
def far_away(s):
    """Scene space begins near the geometry, so that positions keep their digits; 1e5 is a multiple of all ulps here.
    Camera and vertices are rounded once more than in the room at the origin: equal to rounding."""
    reference = pictures(s, room(s.path(".gltf")))
    far = (1e5, -1e5, 1e5)
    check(s, "node at 1e5", reference, room(s.path(".gltf"), node=far), 1.0, False)
    check(s, "vertices at 1e5", reference, room(s.path(".gltf"), baked=far), 1.0, False)

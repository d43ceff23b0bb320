"""Light from all around: uniform, black, one pixel, one bright pixel, 8k wide, damaged; from 1e-20 to 1e20."""
import math
import struct

import exr
from family_light import floor_probe
from scenes import Scene
from session import case

RHO = 0.5


def write_hdr(path, width, rows):
    """Radiance RGBE; rows: (how many times, bytes of a line, or one pixel for all of it, run-length encoded)."""
    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (sum(r[0] for r in rows), width))
        for times, line in rows:
            if len(line) == 4 and width < 8:
                line = line * width
            elif len(line) == 4:
                line = struct.pack(">BBH", 2, 2, width) + b"".join(
                    b"".join(bytes([128 + min(127, width - x), c]) for x in range(0, width, 127)) for c in line)
            file.write(line * times)
    return path


def plate(s):
    scene = Scene()
    floor_probe(scene, RHO)
    return scene.save(s.path(".gltf"))


def chain(s, path, size, spp, *environment, photons="100k"):
    """The frame of the photon chain: photon-trace, irradcache-build, frame-render."""
    map_, cache = s.photons(path, photons, *environment)["path"], s.path(".irradcache")
    s.done(s.run("irradcache-build", path, "--photons", map_, "--size", f"{size[0]}x{size[1]}", "-o", cache,
                 *environment))
    return s.render(path, size, spp, "--photons", map_, "--irradcache", cache, *environment)


@case("light", "uniform sky of 1e-20 .. 1e20")
def uniform(s):
    """A plate shows rho L. A sample's standard deviation is below L (light sampling meets the upper half only)."""
    path = plate(s)
    side, spp = s.pick((32, 64), (64, 256))
    for strength in (1e-20, 1.0, 1e20):
        options = ("--environment", "1", "--environment-strength", strength)
        for name, image in (("path tracing", s.render(path, (side, side), spp, *options)),
                            ("photon chain", chain(s, path, (side, side), spp, *options))):
            s.near(f"sky of {strength:g}, {name}", RHO * strength, image.mean(), 4 * RHO / math.sqrt(side * side * spp))


@case("light", "a white bowl under a uniform sky is a furnace")
def furnace(s):
    """Floor and three walls of reflectance 1 under a sky of 1: 1 everywhere, but for the estimate of the photons."""
    scene = Scene()
    white = scene.material(1.0)
    scene.quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1), white)
    scene.quad((-1, 0, -1), (1, 0, -1), (1, 1, -1), (-1, 1, -1), white)
    scene.quad((-1, 0, 1), (-1, 0, -1), (-1, 1, -1), (-1, 1, 1), white)
    scene.quad((1, 0, -1), (1, 0, 1), (1, 1, 1), (1, 1, -1), white)
    scene.camera((0, 2.2, 2.2), (0, 0.35, -0.1), fov=0.45)
    path = scene.save(s.path(".gltf"))
    size, spp, options = (48, 32), s.pick(256, 1024), ("--environment", "1")
    image = s.render(path, size, spp, *options, "--channels", "RGBA,layers")
    s.near("path tracing", 1, image.mean(), 0.003)
    s.near("photon chain", 1, chain(s, path, size, 64, *options, photons=s.pick("400k", "4M")).mean(), 0.01)


@case("light", "environment of 1x1, black, one bright pixel")
def small_maps(s):
    path = plate(s)
    grey = write_hdr(s.path(".hdr"), 1, [(1, b"\x80\x80\x80\x81")])
    s.near("1x1: the plate", RHO, s.render(path, (32, 32), 64, "--environment", grey).mean(), 4 * RHO / math.sqrt(32 * 32 * 64))
    black = write_hdr(s.path(".hdr"), 8, [(4, b"\0\0\0\0")])
    s.near("black: the plate", 0, s.render(path, (8, 8), 4, "--environment", black).mean(), 0)
    out = s.path(".photons")
    s.true("black: no photons, exit 2", s.run("photon-trace", path, "--environment", black, "-o", out).code == 2)
    scene = Scene()
    floor_probe(scene, RHO)
    scene.point_light((0, 1, 0), 10)
    lit = scene.save(s.path(".gltf"))
    s.same_image("black, with a lamp", s.render(lit, (16, 16), 16), s.render(lit, (16, 16), 16, "--environment", black),
                 exactly=True)
    # One pixel of 64 x 32 at 8.5 rows from +Y: E = L 2 pi / w int hat sin cos over two rows (formats/conventions.md).
    for value, byte in ((2.0, b"\x80\x80\x80\x82"), (2.0**60, b"\x80\x80\x80\xbd")):
        bright = write_hdr(s.path(".hdr"), 64, [(8, b"\0\0\0\0"), (1, b"\0\0\0\0" * 16 + byte + b"\0\0\0\0" * 47),
                                                (23, b"\0\0\0\0")])
        d, steps = math.pi / 32, 2000
        t = 8.5 * d
        hat = math.fsum((1 - abs(x)) * math.sin(2 * (t + d * x)) / 2 * 2 * d / steps
                        for x in (2 * (i + 0.5) / steps - 1 for i in range(steps)))
        expected = RHO / math.pi * value * 2 * math.pi / 64 * hat
        image = s.render(path, (16, 16), 64, "--environment", bright)
        s.near(f"one pixel of {value:g}: the plate", expected, image.mean(), 4 * image.sigma_of_mean() / expected + 1e-5)
        map_ = s.photons(path, "10k", "--environment", bright)
        s.near(f"one pixel of {value:g}: light is kept", map_["emitted_flux_W"][1],
               map_["escaped_flux_W"][1] + map_["absorbed_flux_W"][1], 1e-4)


@case("light", "environment 8192 x 4096 with a sun of one pixel")
def wide(s):
    """A sky of 1 above the horizon and a pixel of 2^20 at the zenith's edge: time and memory, and the closed form."""
    path = plate(s)
    width = 8192
    sun = b"\x80\x80\x80\x81" * 100 + b"\x80\x80\x80\x95" + b"\x80\x80\x80\x81" * (width - 101)
    name = write_hdr(s.path(".hdr"), width, [(1024, b"\x80\x80\x80\x81"), (1, sun), (1023, b"\x80\x80\x80\x81"),
                                              (2048, b"\0\0\0\0")])
    image = s.render(path, (16, 16), 64, "--environment", name)
    d = math.pi / 4096
    t = 1024.5 * d
    expected = RHO / math.pi * (math.pi + (2.0**20 - 1) * 2 * math.pi / width * d * math.sin(t) * math.cos(t))
    s.near("the plate", expected, image.mean(), 4 * image.sigma_of_mean() / expected + 1e-3)  # half a row at the horizon
    s.cost_at_most("memory, bytes per pixel of the map", 40, image.run.memory / (width * 4096))


@case("light", "environment damaged, negative, not a number")
def damaged(s):
    path = plate(s)
    colours = {c: [1.0] * 32 for c in "RGB"}

    def run(name, out):
        return s.run("frame-render", path, "--size", "8x8", "--spp", 4, "--environment", name, "-o", out)
    for word, value in (("NaN", math.nan), ("infinity", math.inf)):
        name, out = s.path(".exr"), s.path(".exr")
        exr.write(name, 8, 4, {**colours, "G": [1.0] * 9 + [value] + [1.0] * 22})
        s.refused(word, run(name, out), out)
    name, out = s.path(".exr"), s.path(".exr")
    exr.write(name, 8, 4, {**colours, "G": [1.0] * 9 + [-1e30] + [1.0] * 22})
    negative = s.done(run(name, out))
    s.true("negative: one warning", negative.err.count("\n") == 1 and "taken as 0" in negative.err, negative.err.strip()[-60:])
    good = write_hdr(s.path(".hdr"), 8, [(4, b"\x80\x80\x80\x81")])
    with open(good, "rb") as file:
        data = file.read()
    for cut in (20, len(data) - 1):
        name, out = s.path(".hdr"), s.path(".exr")
        with open(name, "wb") as file:
            file.write(data[:cut])
        s.refused(f"cut after {cut} bytes", run(name, out), out)
    for option, value in (("strength", "-1"), ("strength", "nan"), ("rotation", "inf"), ("color", "1,2"), ("color", "nan")):
        out = s.path(".exr")
        given = [] if option == "color" else ["--environment", good]
        s.refused(f"--environment-{option} {value}",
                  s.run("frame-render", path, *given, f"--environment-{option}", value, "-o", out), out)

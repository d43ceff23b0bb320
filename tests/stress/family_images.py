"""Images: one pixel, one column, 16k wide; black; NaN and infinity on input; beyond half floats; depth and motion far
out."""
import math
import os

import exr
from family_environment import write_hdr
from scenes import Scene
from session import FULL, case

NAN, INF = float("nan"), float("inf")


def furnace(s, emission=1.0, rho=0.5):
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(rho, emission))
    scene.camera((0.3, 0.2, 0.8), (-0.4, -0.2, -1), fov=1.2)
    return scene.save(s.path(".gltf"))


def sizes(s, shapes):
    """In a furnace every picture has the same mean, whatever its shape: 4 standard errors, of one path about L/4."""
    scene = furnace(s)
    map_ = s.photons(scene, "10k")
    for width, height, spp in shapes:
        image = s.render(scene, (width, height), spp, "--channels", "RGBA,layers,Z,N,P,id,albedo,motion")
        s.near(f"{width}x{height}: radiance", 2, image.mean(), 4 * 0.25 / math.sqrt(width * height * spp))
        s.render(scene, (width, height), 1, "--photons", map_["path"])
        png, out = s.path(".png"), s.path(".json")
        s.done(s.run("tempolux-info", "--png", png, image.path))
        s.done(s.run("aqm-compare", image.path, image.path, "--json", out))
        s.near(f"{width}x{height}: difference to itself", 0, s.read_json(out)["total"]["rmse"], 0)


@case("images", "1x1, 1x10^4, 10^4x1")
def odd_sizes(s):
    sizes(s, [(1, 1, 10000), (1, 10000, 2), (10000, 1, 2)])


@case("images", "16k wide")
def wide(s):
    sizes(s, [(16384, 4, 1)])


@case("images", "16k x 1k", FULL)
def wide_and_high(s):
    """Read by tempolux-info, which counts; our reader in Python is for small pictures."""
    out = s.path(".exr")
    s.done(s.run("frame-render", furnace(s), "--size", "16384x1024", "--spp", 1, "-o", out, timeout=600))
    green = next(c for c in s.info(out)["channels"] if c["channel"] == "G")
    s.near("16384x1024: radiance", 2, green["mean"], 4 * 0.25 / math.sqrt(16384 * 1024))
    s.true("no NaN, no infinity", not green.get("nans") and not green.get("infinities"))


@case("images", "black and constant")
def black(s):
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.5))
    scene.point_light((0, 0, 5), 1)                     # outside the closed room
    scene.camera((0, 0, 0.9), (0, 0, -1))
    path = scene.save(s.path(".gltf"))
    map_ = s.photons(path, "10k")
    for name, options in [("path tracing", []), ("photons", ["--photons", map_["path"]])]:
        image = s.render(path, (16, 16), 4, *options, "--channels", "RGBA,layers,Z", "--halves")
        s.near(f"{name}: the dark side of a wall", 0, max(image.rgb()), 0)
        a, b = (image.path.replace(".exr", f"_{half}.exr") for half in "ab")
        out = s.path(".json")
        s.done(s.run("aqm-compare", image.path, "--reference-halves", a, b, "--json", out))
        s.near(f"{name}: error of black against black", 0, s.read_json(out)["total"]["rmse"], 0)
        s.done(s.run("tempolux-info", "--png", s.path(".png"), image.path))
    for value in (0.0, 1.0, 2e-38, 3e38):
        path = s.path(".exr")
        exr.write(path, 16, 8, {c: [value] * 128 for c in "RGB"})
        out = s.path(".json")
        s.done(s.run("aqm-compare", path, path, "--json", out))
        s.near(f"constant {value:g}: error against itself", 0, s.read_json(out)["total"]["rmse"], 0)
        green = next(c for c in s.info(path)["channels"] if c["channel"] == "G")
        s.near(f"constant {value:g}: mean", value, green["mean"], 1e-6)
        s.done(s.run("tempolux-info", "--png", s.path(".png"), path))
    bright, dark, out = s.path(".exr"), s.path(".exr"), s.path(".json")
    exr.write(bright, 4, 4, {c: [3e38] * 16 for c in "RGB"})
    exr.write(dark, 4, 4, {c: [0.0] * 16 for c in "RGB"})
    s.done(s.run("aqm-compare", bright, dark, "--json", out))
    s.near("3e38 against black: rmse", 3e38, s.read_json(out)["total"]["rmse"], 1e-6)


@case("images", "NaN and infinity on input")
def not_numbers(s):
    """aqm-compare refuses them and says where; tempolux-info counts them or refuses; neither writes them on."""
    good = s.path(".exr")
    exr.write(good, 8, 4, {c: [0.5] * 32 for c in "RGB"})
    other = s.path(".exr")
    exr.write(other, 8, 4, {c: [0.25] * 32 for c in "RGB"})
    for name, value in [("NaN", NAN), ("+inf", INF), ("-inf", -INF)]:
        values = [0.5] * 32
        values[13] = value
        bad = s.path(".exr")
        exr.write(bad, 8, 4, {"R": [0.5] * 32, "G": values, "B": [0.5] * 32})
        for title, arguments in [("test", [bad, good]), ("reference", [good, bad]),
                                 ("half", [good, "--reference-halves", other, bad])]:
            out = s.path(".json")
            s.refused(f"aqm-compare, {name} in the {title}", s.run("aqm-compare", "-q", *arguments, "--json", out),
                      out)
        run = s.run("tempolux-info", "--json", bad)
        if run.code == 0:
            facts = s.info(bad)
            green = next(c for c in facts["channels"] if c["channel"] == "G")
            counted = green.get("nans", 0) + green.get("infinities", 0)
            s.near(f"tempolux-info, {name}: pixels counted", 1, counted, 0)
            s.near(f"tempolux-info, {name}: mean of the others", 0.5, green["mean"], 1e-6)
        else:
            s.refused(f"tempolux-info, {name}", run)
        png = s.path(".png")
        run = s.run("tempolux-info", "--png", png, bad)
        if run.code == 0:
            s.true(f"tempolux-info --png, {name}: a picture", os.path.getsize(png) > 0)
        else:
            s.refused(f"tempolux-info --png, {name}", run, png)
        run = s.run("tempolux-info", "--check", bad)
        s.true(f"tempolux-info --check, {name}: not valid", run.code in (1, 2), f"exit {run.code}", "exit 1")


@case("images", "beyond half floats")
def halves(s):
    for value, good in [(65504.0, True), (65600.0, False), (1e20, False)]:
        scene, out = furnace(s, value, 0.0), s.path(".exr")
        run = s.run("frame-render", scene, "--size", "8x8", "--spp", 1, "--half", "--compression", "none", "-o", out)
        if good:
            s.done(run)
            s.near(f"{value:g} as half", value, max(exr.read(out).channels["G"]), 0)
        else:
            s.refused(f"{value:g} as half", run, out, codes=(2, 3))
    # 2^-14 is the least half with all its digits, 2^-24 the least there is; half of that is a tie, to even.
    for title, value, expected in [("2^-14", 2.0**-14, 2.0**-14), ("2^-24", 2.0**-24, 2.0**-24),
                                   ("1.5 2^-24", 1.5 * 2.0**-24, 2.0**-23), ("2^-25", 2.0**-25, 0), ("1e-10", 1e-10, 0)]:
        scene, out = furnace(s, value, 0.0), s.path(".exr")
        s.done(s.run("frame-render", scene, "--size", "8x8", "--spp", 1, "--half", "--compression", "none", "-o", out))
        s.near(f"{title} as half: the nearest", expected, max(exr.read(out).channels["G"]), 0)


@case("images", "RGBE at both ends")
def rgbe(s):
    """A sky of one value c 2^(e-136), seen directly: from the largest, 255 2^119, which is beyond the 1e30 that are
    taken, down to where products with weights of a thousandth leave float32 (2^-126 times 2^10): there, less may come out."""
    scene = Scene()
    scene.quad((-1, -9, 1), (1, -9, 1), (1, -9, -1), (-1, -9, -1), scene.material(0.5))
    scene.camera((0, 0, 0), (0, 0, -1), fov=0.5)
    path = scene.save(s.path(".gltf"))
    for mantissa, exponent in ((255, 255), (128, 255), (128, 228), (128, 136), (128, 11), (128, 4), (1, 1)):
        value = mantissa * 2.0**(exponent - 136)
        sky = write_hdr(s.path(".hdr"), 8, [(4, bytes([mantissa] * 3 + [exponent]))])
        if value > 1e30:
            out = s.path(".exr")
            run = s.run("frame-render", path, "--environment", sky, "--size", "8x8", "-o", out)
            s.refused(f"{mantissa} 2^{exponent - 136}", run, out)
            continue
        image = s.render(path, (8, 8), 1, "--environment", sky)
        got = image.mean()
        low = value < 2.0**-116
        s.true(f"{mantissa} 2^{exponent - 136}: radiance", 0 <= got <= value * (1 + 1e-6) and (low or got >= value * (1 - 1e-6)),
               f"{got:.6g}", ("at most " if low else "") + f"{value:.6g}")


@case("images", "depth 0")
def depth_zero(s):
    """Pixels of depth 0 on input; and a camera whose eye lies in the surface it looks along."""
    path = s.path(".exr")
    exr.write(path, 16, 8, {c: [0.5] * 128 for c in "RGB"} | {"Z": [0.0] * 64 + [2.0] * 64})
    depth = next(c for c in s.info(path)["channels"] if c["channel"] == "Z")
    s.near("tempolux-info: mean depth", 1, depth["mean"], 1e-6)
    for name, options in (("tempolux-info --png --layer Z", ("tempolux-info", "--png", s.path(".png"), "--layer", "Z", path)),
                          ("aqm-compare", ("aqm-compare", "-q", path, path, "--json", s.path(".json")))):
        run = s.run(*options)
        s.true(f"{name}: done, or refused in one line", run.code == 0 or (run.code == 2 and len(run.err.splitlines()) == 1),
               f"exit {run.code}", "exit 0 or 2")
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.5, 1.0))
    scene.quad((-0.5, 0, 0.5), (0.5, 0, 0.5), (0.5, 0, -0.5), (-0.5, 0, -0.5), scene.material(0.5, 1.0))
    scene.camera((0, 0, 0), (0.3, 0, -1), fov=1.0)
    image = s.render(scene.save(s.path(".gltf")), (32, 32), 16, "--channels", "RGBA,Z,P,id,motion")
    nearest = min(image.channels["Z"])
    s.true("eye in a surface: depth 0 or more, to rounding", nearest >= -1e-5, f"{nearest:.3g}", ">= -1e-5")
    s.near("eye in a surface: radiance", 2, image.mean(), 0.05)


@case("images", "infinite depth, motion of 10^4 pixels")
def far(s):
    """A plate of 0.2 m, 100 rows of 0.02 m: in frame 1 it stands 200 m to the right, which is 10^4 pixels."""
    scene = Scene()
    plate = scene.quad((-0.1, -0.1, 0), (0.1, -0.1, 0), (0.1, 0.1, 0), (-0.1, 0.1, 0), scene.material(0.5, 1.0))
    scene.animate(plate, "translation", [0, 1 / 24, 2 / 24], [(0, 0, 0), (200, 0, 0), (200, -400, 0)])
    scene.camera((0, 0, 1), (0, 0, 0), half_height=1)
    path = scene.save(s.path(".gltf"))
    channels = ["--channels", "RGBA,Z,N,P,id,motion"]
    image = s.render(path, (100, 100), 4, *channels)
    depth, forward = image.channels["Z"], image.channels["forward.u"]
    seen = [i for i, z in enumerate(depth) if math.isfinite(z)]
    s.near("pixels that see the plate", 100, len(seen), 0)
    s.true("depth elsewhere +inf", sum(z == INF for z in depth) == 9900)
    s.near("forward.u of the plate, pixels", 10000, math.fsum(forward[i] for i in seen) / len(seen), 1e-5)
    s.near("forward.v of the plate, pixels", 0, max(abs(v) for v in image.channels["forward.v"]), 1e-3)
    s.near("motion elsewhere", 0, max(abs(v) for i, v in enumerate(forward) if depth[i] == INF), 0)
    image = s.render(path, (100, 100), 4, *channels, "--frame", 1)
    s.true("frame 1: nothing in the picture", all(z == INF for z in image.channels["Z"]))
    depth = next(c for c in s.info(image.path)["channels"] if c["channel"] == "Z")
    s.near("tempolux-info: infinite depths counted", 10000, depth.get("infinities", 0), 0)
    out = s.path(".json")
    run = s.run("aqm-compare", "-q", image.path, image.path, "--layer", "Z", "--json", out)
    if run.code == 0:
        s.true("aqm-compare of infinite depths: JSON without NaN", s.read_json(out)["total"] is not None)
    else:
        s.refused("aqm-compare of infinite depths", run, out)


@case("images", "st-filter: 1x1, black, constant, NaN and infinity, motion of 10^4 pixels")
def filtered(s):
    """A constant picture stays; what is no number is left out and filled from around, and none comes out."""
    def frame(width, height, value, motion=0.0, odd=None):
        count, path = width * height, s.path(".exr")
        colour = [value] * count
        if odd is not None:
            colour[count // 2] = odd
        channels = {c: colour for c in "RGB"} | {"Z": [2.0] * count, "samples": [1.0] * count}
        channels |= {f"{way}.{c}": [sign * motion] * count for way, sign in (("forward", 1), ("backward", -1)) for c in "uv"}
        exr.write(path, width, height, channels)
        return path

    def run(name, path, expected, tolerance):
        out = s.path(".exr")
        s.done(s.run("st-filter", "-q", path, path, path, "-o", out))
        image = exr.read(out)
        s.near(f"st-filter, {name}: not finite", 0, len(image.not_finite()), 0)
        s.near(f"st-filter, {name}: largest", expected, max(image.rgb()), tolerance)
        s.near(f"st-filter, {name}: least", expected, min(image.rgb()), tolerance)

    for width, height in ((1, 1), (1, 100), (100, 1)):
        run(f"{width}x{height}", frame(width, height, 0.5), 0.5, 1e-6)
    for value in (0.0, 1e-30, 1.0, 1e17, 3e38):   # above 1e18 light stays as it is
        run(f"constant {value:g}", frame(16, 16, value), value, 1e-6)
    for name, odd in (("NaN", NAN), ("+inf", INF), ("-inf", -INF)):
        run(name, frame(16, 16, 0.5, odd=odd), 0.5, 1e-6)
    for motion in (1e4, -1e4, 3e38):
        run(f"motion {motion:g}", frame(16, 16, 0.5, motion), 0.5, 1e-6)


@case("images", "ibr-warp: 1x1, one column, a row, NaN, depth 0 and none, values above 65504")
def warped(s):
    """A key warped to its own view is itself to the bit; what is no number or no depth is refused and said where."""
    def warp(key, view):
        out = s.path(".exr")
        return s.run("ibr-warp", "-q", key, "--view", view, "-o", out, "--mask", s.path(".exr")), out

    scene = furnace(s, 7e4)
    for width, height in ((1, 1), (1, 100), (100, 1), (16, 16)):
        key = s.render(scene, (width, height), 1, "--channels", "RGBA,Z,N,id")
        run, out = warp(key.path, key.path)
        s.done(run)
        image = exr.read(out)
        s.true(f"{width}x{height}: its own view is itself to the bit", image.rgb() == key.rgb())
    matrices = "worldToCamera", "worldToNDC"
    for name, channel, value in (("NaN", "G", NAN), ("infinity", "G", INF), ("depth 0", "Z", 0.0), ("depth -1", "Z", -1.0), ("depth NaN", "Z", NAN)):
        bad = s.path(".exr")
        channels = {c: list(v) for c, v in key.channels.items() if c in ("R", "G", "B", "Z")}
        channels[channel][37] = value
        exr.write(bad, 16, 16, channels, {m: key.attributes[m] for m in matrices})
        run, out = warp(bad, key.path)
        s.refused(f"{name} in a key", run, out)
    far = s.path(".exr")
    channels = {c: list(v) for c, v in key.channels.items() if c in ("R", "G", "B", "Z")}
    channels["Z"] = [INF] * 256
    exr.write(far, 16, 16, channels, {m: key.attributes[m] for m in matrices})
    run, out = warp(far, far)
    s.done(run)
    s.true("nothing but sky: its own view is itself to the bit", exr.read(out).rgb() == key.rgb())


@case("images", "ibr-warp and st-filter: frames of Blender and Nuke")
def of_others(s):
    """The same key under other programs' channel names: warped alike, with one warning; a data window that was cropped shows nothing outside; depth that
    is infinite, names that st-filter reads, too; what is wrong is said with the file's name."""
    scene = Scene()
    scene.room((-1, -1, -1), (1, 1, 1), scene.material(0.0, 1.0))
    scene.room((-0.3, -0.6, -0.7), (0.1, 0.0, -0.3), scene.material(0.0, 4.0))
    camera = scene.camera((-0.1, 0.1, 0.9), (-0.1, 0.1, -1), fov=1.0)
    scene.animate(camera, "translation", [0, 4 / 24], [(-0.1, 0.1, 0.9), (0.1, 0.1, 0.9)])
    path, size = scene.save(s.path(".gltf")), (64, 48)
    ours = {f: s.render(path, size, 1, "--integrator", "path", "--frame", f, "--channels", "RGBA,specular,Z,N,id") for f in (0, 2, 4)}
    matrices = "worldToCamera", "worldToNDC"
    ids, width = ours[2].channels["id.object"], size[0]   # inside one surface: the 8 pixels around see it, too
    whole = [y * width + x for y in range(1, size[1] - 1) for x in range(1, width - 1)
             if len({ids[(y + dy) * width + x + dx] for dy in (-1, 0, 1) for dx in (-1, 0, 1)}) == 1]

    def blender(image):
        theirs = {f"View Layer.Combined.{c}": image.channels[c] for c in "RGBA"} | {f"View Layer.Normal.{c}": image.channels["N." + c] for c in "XYZ"}
        return theirs | {"View Layer.Depth.Z": [1e10 if z == INF else z for z in image.channels["Z"]], "View Layer.Denoising Depth.Z": [1.0] * len(image.channels["Z"])}

    def nuke(image):
        return {c: image.channels[c] for c in "RGBA"} | {"depth.Z": image.channels["Z"]}

    def written(image, channels, frame=None, place=None, shown=size):
        out = s.path(".exr")
        exr.write(out, *shown, channels, {m: image.attributes[m] for m in matrices}, None if frame is None else {"tempolux:frame": frame}, place)
        return out

    def warp(*arguments):
        out, mask = s.path(".exr"), s.path(".exr")
        run = s.run("ibr-warp", *arguments, "--slow", 0, "-o", out, "--mask", mask)
        return run, out, mask

    def given(mask):
        return sum(why == 0 for why in exr.read(mask).channels["why"])

    run, out, mask = warp(ours[0].path, ours[4].path, "--scene", path, "--frame", 2)
    s.done(run)
    of_ours = given(mask)
    for name, theirs in (("Blender", blender), ("Nuke", nuke)):
        # With a scene: of its frame, though they know no objects.
        keys = [written(ours[f], theirs(ours[f]), f) for f in (0, 4)]
        run, out, mask = warp(*keys, "--scene", path, "--frame", 2)
        s.done(run)
        s.true(f"{name}, a scene: pixels given", given(mask) >= 0.9 * of_ours, str(given(mask)), f"nearly {of_ours}")
        green, truth, why = exr.read(out).channels["G"], ours[2].channels["G"], exr.read(mask).channels["why"]
        s.near(f"{name}, a scene: wrong of those given", 0, sum(abs(green[p] - truth[p]) > 1e-5 * truth[p] for p in whole if why[p] == 0), 0)
        # Without one.
        view = written(ours[2], theirs(ours[2]))
        run, out, mask = warp(*keys, "--view", view)
        s.done(run)
        s.near(f"{name}: warnings", 1, len(run.err.splitlines()), 0)
        s.near(f"{name}: not finite", 0, len(exr.read(out).not_finite()), 0)
        s.true(f"{name}: has depth under our name", "Z" in exr.read(out).channels)
        run, alone, mask = warp(*keys, "--view", keys[0])
        s.done(run)
        s.true(f"{name}: its own view is itself to the bit", exr.read(alone).rgb() == ours[0].rgb())
        filtered = s.path(".exr")
        s.done(s.run("st-filter", "-q", *keys, "-o", filtered))
        s.true(f"{name}, st-filter: R, G, B", all(c in exr.read(filtered).channels for c in "RGBZ"))
    # Depth is infinite in a channel that is not called Z; a data window that was cropped.
    sky = nuke(ours[2])
    sky["depth.Z"] = [INF if p == 5 else z for p, z in enumerate(sky["depth.Z"])]
    run, out, mask = warp(ours[0].path, "--view", written(ours[2], sky))
    s.done(run)
    x, y, width, height = 10, 6, 40, 30
    crop = {n: [v[(y + j) * size[0] + x + i] for j in range(height) for i in range(width)] for n, v in nuke(ours[0]).items()}
    cropped = written(ours[0], crop, None, (x, y, *size), (width, height))
    run, out, mask = warp(cropped, "--view", ours[0].path)
    s.done(run)
    why = exr.read(mask).channels["why"]
    inside = [p for p in range(len(why)) if x < p % size[0] < x + width - 1 and y < p // size[0] < y + height - 1]
    # Beside a key's pixels the nearest of 16 counts, at most 2 away.
    outside = [p for p in range(len(why)) if not (x - 2 <= p % size[0] < x + width + 2 and y - 2 <= p // size[0] < y + height + 2)]
    s.true("cropped: the inside is given", sum(why[p] == 0 for p in inside) > 0.8 * len(inside))
    s.near("cropped: given outside", 0, sum(why[p] == 0 for p in outside), 0)
    for name, channel, value in (("normal of infinity", "View Layer.Normal.X", INF), ("negative depth", "View Layer.Depth.Z", -1.0)):
        bad = blender(ours[0])
        bad[channel] = [value] * len(bad[channel])
        run, out, mask = warp(written(ours[0], bad), "--view", ours[2].path)
        s.refused(name, run, out)
    many = blender(ours[0]) | {f"View Layer.Light{i}.{c}": ours[0].channels[c] for i in range(21) for c in "RGB"}
    run, out, mask = warp(written(ours[0], many), "--view", ours[2].path)
    s.refused("67 channels of colour", run, out)
    run, out, mask = warp(written(ours[0], {c: v for c, v in blender(ours[0]).items() if "Depth" not in c}), "--view", ours[2].path)
    s.refused("no depth", run, out)
    # Nothing in common: all is masked, and said.
    other = Scene()
    other.room((-9, -9, -9), (9, 9, 9), other.material(0.0, 1.0))
    other.camera((0, 0, 8), (0, 0, -1), fov=1.0)
    strange = s.render(other.save(s.path(".gltf")), size, 1, "--integrator", "path", "--channels", "RGBA,specular,Z,N,id")
    run, out, mask = warp(strange.path, "--view", ours[2].path)
    s.done(run)
    s.near("another scene: given", 0, given(mask), 0)
    s.true("another scene: said", "do they show the same scene" in run.err, run.err)

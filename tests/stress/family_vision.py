"""What a viewer sees (aqm-compare --metric aqm, --flow): odd sizes, black, constant, values beyond all displays, flow that says nothing."""
import array
import math

import exr
from session import FULL, case

NAN, INF = float("nan"), float("inf")


def frame(s, width, height, value):
    """R = G = B = value(x, y)."""
    path = s.path(".exr")
    plane = [value(x, y) for y in range(height) for x in range(width)]
    exr.write(path, width, height, {c: plane for c in "RGB"})
    return path


def flow(s, width, height, pixels=0.0, valid=3):
    path, count = s.path(".exr"), width * height
    channels = {f"{way}.{axis}": [pixels] * count for way in ("forward", "backward") for axis in "uv"} | {"speed": [abs(pixels)] * count}
    exr.write(path, width, height, channels | {"valid": array.array("I", [valid] * count)})
    return path


def judged(s, first, second, *options):
    """AQM in percent, the largest and the smallest probability."""
    out, map_ = s.path(".json"), s.path(".exr")
    s.done(s.run("aqm-compare", "-q", first, second, "--metric", "aqm", "--json", out, "-o", map_, *options))
    probability = exr.read(map_).channels["P"]
    return s.read_json(out)["total"]["aqm"]["percent"], max(probability), min(probability)


def within(s, name, found):
    percent, most, least = found
    s.true(f"{name}: an answer from 0 to 1", 0 <= least <= most <= 1 and 0 <= percent <= 100, f"{percent:g} %, {least:g} to {most:g}")


@case("vision", "one pixel, one line, 16k wide, black, constant")
def sizes(s):
    for width, height in [(1, 1), (1, 500), (500, 1), (16384, 8)]:
        grey = frame(s, width, height, lambda x, y: 0.5)
        lit = frame(s, width, height, lambda x, y: 0.5 + 0.2 * ((x + y) % 7 == 0))
        s.near(f"{width}x{height}: seen in equal frames, %", 0, judged(s, grey, grey)[0], 0)
        within(s, f"{width}x{height}: dots on grey", judged(s, grey, lit, "--flow", flow(s, width, height, 3)))
    black, dim = frame(s, 40, 30, lambda x, y: 0), frame(s, 40, 30, lambda x, y: 1e-30)
    s.near("black and black, %", 0, judged(s, black, black)[0], 0)
    s.near("black and 1e-30 at exposure 0, %", 0, judged(s, black, dim, "--exposure", 0)[0], 0)
    white = frame(s, 40, 30, lambda x, y: 1)
    s.near("constant, and another constant: frequency 0, %", 0, judged(s, white, frame(s, 40, 30, lambda x, y: 0.7))[0], 0)


@case("vision", "values of 1e20, negative, NaN, infinity")
def values(s):
    grey = frame(s, 64, 48, lambda x, y: 0.5)
    for name, value in [("1e20", 1e20), ("3e38", 3e38), ("-5", -5.0), ("1e-40", 1e-40)]:
        dotted = frame(s, 64, 48, lambda x, y, v=value: v if x == 20 and y == 20 else 0.5)
        found = judged(s, grey, dotted, "--exposure", 0)
        within(s, f"a pixel of {name}", found)
        s.true(f"a pixel of {name} is seen", found[1] > 0.75, f"P {found[1]:g}")
        all_of_it = frame(s, 64, 48, lambda x, y, v=value: v)
        within(s, f"all of {name}", judged(s, grey, all_of_it))
    for name, value in [("NaN", NAN), ("infinity", INF)]:
        bad = frame(s, 64, 48, lambda x, y, v=value: v if x == 20 and y == 20 else 0.5)
        out = s.path(".exr")
        s.refused(f"a pixel of {name}", s.run("aqm-compare", "-q", bad, grey, "--metric", "aqm", "-o", out), out)
        hole = s.path(".exr")
        exr.write(hole, 64, 48, {"why": [float(i == 20 * 64 + 20) for i in range(64 * 48)]})
        s.near(f"a pixel of {name} that does not count, %", 0, judged(s, bad, grey, "--except", hole)[0], 0)


@case("vision", "flow: unknown, of 1e20 pixels, of another size, not finite")
def flows(s):
    grey = frame(s, 64, 48, lambda x, y: 0.5)
    lines = frame(s, 64, 48, lambda x, y: 0.5 + 0.1 * (x % 8 < 4))
    still = judged(s, grey, lines)[0]
    s.near("flow of 0, as without flow, %", still, judged(s, grey, lines, "--flow", flow(s, 64, 48))[0], 0)
    s.near("nothing known, as without flow, %", still, judged(s, grey, lines, "--flow", flow(s, 64, 48, 0, 0))[0], 0)
    s.near("1e20 pixels per frame: nobody sees, %", 0, judged(s, grey, lines, "--flow", flow(s, 64, 48, 1e20), "--eye", "fixed")[0], 0)
    for name, path in [("another size", flow(s, 8, 8)), ("NaN", flow(s, 64, 48, NAN)), ("infinity", flow(s, 64, 48, INF))]:
        out = s.path(".json")
        s.refused(f"flow of {name}", s.run("aqm-compare", "-q", grey, lines, "--flow", path, "--json", out), out)
    for option, value in [("--fps", 0), ("--exposure", 1e9), ("--eye", "none"), ("--display", "tv")]:
        out = s.path(".json")
        s.refused(f"{option} {value}", s.run("aqm-compare", "-q", grey, lines, "--metric", "aqm", option, value, "--json", out), out)


@case("vision", "16k x 1k", FULL)
def large(s):
    """Read and judged within memory: 16 bytes a pixel and frame, and spectra of 4 times that."""
    width, height = 16384, 1024
    a = frame(s, width, height, lambda x, y: 0.5)
    out = s.path(".json")
    s.done(s.run("aqm-compare", "-q", a, a, "--metric", "aqm", "--json", out, timeout=600))
    s.true("finite", math.isfinite(s.read_json(out)["total"]["aqm"]["percent"]))

#!/usr/bin/env python3
"""The model of vision beside what is known otherwise: the tables of docs/methods/vision.md.

    python3 -B tests/bench/vision.py errors BIN OUT          five errors of equal RMSE, beside FLIP; pictures into OUT
    python3 -B tests/bench/vision.py flow BIN SCENE OUT      two pairs of warped keys of S4, flow x1, x3, x5
    python3 -B tests/bench/vision.py speed BIN SCENE OUT     1920x1080: normalised CPU seconds, threads (BIN/../tests/bench/bare_walk, S2)

Tables go to standard output. Only the standard library.
"""
import json
import math
import random
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "stress"))
import exr  # noqa: E402
import pipeline  # noqa: E402

SIZE, PPD = 192, 37.84          # pixels; of the display office


def run(*words, codes=(0,), **options):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, **options)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(map(str, words))}: exit {done.returncode}: {done.stderr}")
    return done


def judge(tools, out, first, second, *options):
    """The tool's JSON, and the largest probability."""
    run(tools / "aqm-compare", "-q", first, second, "--metric", "aqm", "--json", out / "a.json", "-o", out / "p.exr", "--allow-stale", *options)
    return json.loads((out / "a.json").read_text()), max(exr.read(str(out / "p.exr")).channels["P"])


# Five errors of one root mean square

def picture(shift=0.0, levels=None):
    """A ramp from .3 to .5 over which a panel lies that is .25 brighter, its upper edge oblique, at sub-pixel accuracy. levels: the ramp in steps."""
    plane = []
    for y in range(SIZE):
        for x in range(SIZE):
            ramp = 0.3 + 0.2 * x / SIZE
            if levels:
                ramp = (math.floor(ramp / levels) + 0.5) * levels
            inside = min(1.0, max(0.0, y + 0.5 - (0.62 * SIZE + 0.1 * x + shift)))
            plane.append(ramp + 0.25 * inside)
    return plane


def disturbed(kind, size):
    """The picture with an error whose root mean square is about `size`; scaled to it where it is a sum."""
    base = picture()
    if kind == "shifted edge":
        return picture(shift=size * math.sqrt(SIZE) / 0.25)
    if kind == "banding":
        return picture(levels=size * math.sqrt(12))
    rng = random.Random(7)
    if kind == "dot":
        error = [1.0 if i == 60 * SIZE + 70 else 0.0 for i in range(SIZE * SIZE)]
    elif kind == "blotch":
        error = [math.exp(-((x - 70) ** 2 + (y - 60) ** 2) / (2 * 12 ** 2)) for y in range(SIZE) for x in range(SIZE)]
    else:
        error = [rng.gauss(0, 1) for _ in range(SIZE * SIZE)]
    scale = size / math.sqrt(math.fsum(e * e for e in error) / len(error))
    return [b + scale * e for b, e in zip(base, error)]


def write(path, plane):
    exr.write(str(path), SIZE, SIZE, {c: plane for c in "RGB"})


def convolved(plane, kernel_x, kernel_y):
    """Separable, borders continued."""
    rx, ry = len(kernel_x) // 2, len(kernel_y) // 2
    rows = []
    for y in range(SIZE):
        row = plane[y * SIZE:(y + 1) * SIZE]
        row = [row[0]] * rx + row + [row[-1]] * rx
        rows.append([sum(k * row[x + i] for i, k in enumerate(kernel_x)) for x in range(SIZE)])
    out = []
    for y in range(SIZE):
        taken = [rows[min(max(y + i - ry, 0), SIZE - 1)] for i in range(len(kernel_y))]
        out += [sum(k * t[x] for k, t in zip(kernel_y, taken)) for x in range(SIZE)]
    return out


def flip(reference, test, ppd):
    """Mean and largest FLIP of grey pictures: Andersson et al., FLIP: a difference evaluator for alternating images, 2020, whose achromatic
    channel alone is there (for grey the two others are 0, and clamping to the gamut is clamping to [0, 1])."""
    b1 = 0.0047
    radius = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi ** 2)) * ppd)
    kernel = [math.exp(-(math.pi * i / ppd) ** 2 / b1) for i in range(-radius, radius + 1)]
    kernel = [k / sum(kernel) for k in kernel]

    def lightness(plane):
        def f(t):
            return t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
        return [116 * f(min(max(v, 0), 1)) - 16 for v in convolved(plane, kernel, kernel)]
    sd = 0.5 * 0.082 * ppd
    reach = range(-math.ceil(3 * sd), math.ceil(3 * sd) + 1)
    gauss = [math.exp(-i * i / (2 * sd * sd)) for i in reach]

    def signed(kernel):
        up, down = sum(k for k in kernel if k > 0), -sum(k for k in kernel if k < 0)
        return [k / up if k > 0 else k / down for k in kernel]
    smooth = [g / sum(gauss) for g in gauss]
    edge = signed([-i * g for i, g in zip(reach, gauss)])
    point = signed([(i * i / (sd * sd) - 1) * g for i, g in zip(reach, gauss)])

    def features(plane, kernel):
        return [math.hypot(a, b) for a, b in zip(convolved(plane, kernel, smooth), convolved(plane, smooth, kernel))]
    most, knee = 41.2761, 0.4 * 41.2761          # HyAB distance of green and blue, Hunt-adjusted, to the power .7
    values = []
    parts = zip(lightness(reference), lightness(test), features(reference, edge), features(test, edge), features(reference, point), features(test, point))
    for l1, l2, e1, e2, p1, p2 in parts:
        colour = abs(l1 - l2) ** 0.7
        colour = colour * 0.95 / knee if colour < knee else 0.95 + (colour - knee) / (most - knee) * 0.05
        feature = (max(abs(e1 - e2), abs(p1 - p2)) / math.sqrt(2)) ** 0.5
        values.append(colour ** (1 - feature) if colour > 0 else 0.0)
    return sum(values) / len(values), max(values)


def errors(tools, out):
    write(out / "base.exr", picture())
    print("| error | RMSE | AQM % | largest P | FLIP, mean | FLIP, largest | seen from RMSE |\n|---|---|---|---|---|---|---|")
    sheet, maps = [], []
    for kind in ("dot", "blotch", "banding", "noise", "shifted edge"):
        name = kind.replace(" ", "-")
        plane, path = disturbed(kind, 0.003), out / f"{name}.exr"
        write(path, plane)
        json_, most = judge(tools, out, path, out / "base.exr", "--exposure", 0)
        run(tools / "aqm-compare", "-q", path, out / "base.exr", "-o", out / f"{name}.map.png", "--exposure", 0)
        run(tools / "tempolux-info", "--png", out / f"{name}.png", path, "--exposure", 0)
        sheet.append(out / f"{name}.png")
        maps.append(out / f"{name}.map.png")
        low, high = 1e-5, 0.1
        while high / low > 1.05:
            middle = math.sqrt(low * high)
            write(out / "t.exr", disturbed(kind, middle))
            most_there = judge(tools, out, out / "t.exr", out / "base.exr", "--exposure", 0)[1]
            low, high = (low, middle) if most_there > 0.75 else (middle, high)
        mean, largest = flip(picture(), plane, PPD)
        total = json_["total"]
        print(f"| {kind} | {total['rmse']:.4f} | {total['aqm']['percent']:.2f} | {most:.3f} | {mean:.4f} | {largest:.3f} | {high:.5f} |", flush=True)
    run(tools / "tempolux-info", "--sheet", out / "vision-errors.png", "--columns", 5, *sheet, *maps)


# Flow x1, x3, x5

def key(tools, scene, out, frame):
    """A rendered key frame with little noise."""
    size = ["--size", "320x180"]
    pipeline.chain(lambda tool, *words: run(tools / tool, *words), [scene, "--frame", frame], out / str(frame),
                   ["--photons", "700k", "--kinds", "caustic,indirect"], (), [*size, "--rays", 212],
                   [*size, "--spp", 16, "--pixel-error", 0.004, "--channels", "RGBA,specular,Z,N,id"], map_beside=True)


def flow(tools, scene, out):
    print("| pair | eyes | flow x1 | x3 | x5 | x3 / x1 | x5 / x1 |\n|---|---|---|---|---|---|---|")
    for frame in (0, 16, 32):
        key(tools, scene, out, frame)
    for first, second in ((0, 16), (16, 32)):
        run(tools / "ibr-warp", out / f"{first}.exr", out / f"{second}.exr", "--scene", scene, "--frame", (first + second) // 2, "-o", out / "w.exr",
            "--mask", out / "why.exr", "--flow", out / "flow.exr", "--separate")
        for eye in ("track", "fixed"):
            seen = [judge(tools, out, out / "w_1.exr", out / "w_2.exr", "--except", out / "why.exr", "--flow", out / "flow.exr", "--eye", eye,
                          "--fps", 24 * times)[0]["total"]["aqm"]["percent"] for times in (1, 3, 5)]
            print(f"| {first}, {second} | {eye} | {seen[0]:.2f} | {seen[1]:.2f} | {seen[2]:.2f} | {seen[1] / seen[0]:.2f} | {seen[2] / seen[0]:.2f} |",
                  flush=True)
    print("| the authors' | | 11.37 tracked, 10.56 not | 3.00 | .93 | .28 of 10.56 | .09 of 10.56 |")


def speed(tools, scene, out):
    rng = random.Random(1)
    width, height = 1920, 1080
    for name in ("a", "b"):
        plane = [0.4 + 0.1 * math.sin(i % width / 30) + 0.05 * rng.random() for i in range(width * height)]
        exr.write(str(out / f"{name}.exr"), width, height, {c: plane for c in "RGB"})
    walk = tools.parent / "tests" / "bench" / "bare_walk"

    def stats(*words):
        run(*words, "--stats", out / "s.json")
        return json.loads((out / "s.json").read_text())
    rows = []
    for _ in range(3):
        pace = 1 / json.loads(run(walk, scene, "--frame", 10, "--photons", 10 ** 6, "--threads", 1).stdout)["cpu_s"] if walk.exists() else math.nan
        one, two, plain = (stats(tools / "aqm-compare", "-q", out / "a.exr", out / "b.exr", *words, "--allow-stale")
                           for words in (["--metric", "aqm", "--threads", 1], ["--metric", "aqm", "--threads", 2], ["--threads", 1]))
        wall = [next(p["wall_s"] for p in s["phases"] if p["name"] == "vision") for s in (one, two)]
        rows.append((one["cpu_s"], one["cpu_s"] * pace / 5, plain["cpu_s"], wall[0] / wall[1], one["peak_memory_bytes"] / 1e6))
    middle = [sorted(column)[1] for column in zip(*rows)]
    print("| 1920x1080 | CPU s | normalised | without the model, CPU s | vision on two threads | MB |\n|---|---|---|---|---|---|")
    print(f"| median of 3 | {middle[0]:.2f} | {middle[1]:.2f} | {middle[2]:.2f} | {middle[3]:.2f} x | {middle[4]:.0f} |")


def main(what, tools, *rest):
    out = Path(rest[-1]).resolve()
    out.mkdir(parents=True, exist_ok=True)
    {"errors": errors, "flow": flow, "speed": speed}[what](Path(tools).resolve(), *rest[:-1], out)


if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[1] not in ("errors", "flow", "speed"):
        sys.exit(__doc__)
    main(*sys.argv[1:])

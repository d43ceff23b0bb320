"""A .blend by Cycles without a denoiser beside its export by our path tracer, each twice: ratios by object with errors.

    SIZE=160x90 python3 tests/bench/blender_paths.py SHOT.blend BLENDER OUT FRAME SAMPLES -- the make line of the exporter

Cycles with caustics, no clamping, 128 bounces. An object's mean is that of its pixels that are not at its edge. The
error of the mean of n pixels is the root of the sum of (a - b)^2, over 2 n, of two pictures a, b with other random
numbers. Highlights smaller than a pixel are met by few samples, and their error is underrated. Objects with a channel
beyond 3 % by more than two errors are marked far; noisy: two errors exceed 3 %, so nothing is known. KEEP=1: pictures
that are there are not rendered again.
"""

import math
import os
import pathlib
import shlex
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from blender_beside import SIZE, TOP, channels, cycles, exr, preview  # noqa: E402

LIMIT = 0.03
SHARED = {"ENVIRONMENT": "--environment", "SKY": "--environment", "CAMERA": "--camera"}


def ours(line, frame, samples, seed, path):
    words = dict(word.split("=", 1) for word in line if "=" in word)
    more = [part for name, option in SHARED.items() if name in words for part in (option, words[name])]
    more += shlex.split(words.get("TIME", ""))
    subprocess.run(
        [
            TOP / "build/release/bin/frame-render",
            words["SCENE"],
            *more,
            *("--frame", frame, "--size", f"{SIZE[0]}x{SIZE[1]}", "--integrator", "path", "--spp", samples),
            *("--seed", str(seed), "-q", "-o", path),
        ],
        check=True,
    )


def inner(index):
    """{object: its pixels that are not at its edge}"""
    width, height = SIZE
    found = {}
    for i, value in enumerate(index):
        x, y = i % width, i // width
        if 0 < x < width - 1 and 0 < y < height - 1 and all(index[i + s] == value for s in (-1, 1, -width, width)):
            found.setdefault(int(value), []).append(i)
    return found


def mean(pair, where):
    """(mean of two pictures over these pixels, its error)"""
    a, b = pair
    n = len(where)
    return (
        math.fsum(a[i] + b[i] for i in where) / (2 * n),
        math.sqrt(math.fsum((a[i] - b[i]) ** 2 for i in where)) / (2 * n),
    )


def main():
    blend, blender, out, frame, samples = sys.argv[1:6]
    out = pathlib.Path(out).resolve()
    out.mkdir(parents=True, exist_ok=True)
    kept = bool(os.environ.get("KEEP"))
    listed, pairs = out / "names", ([], [])
    for seed in (1, 2):
        path = out / f"{frame}_ours{seed}.exr"
        if not kept or not path.exists():
            ours(sys.argv[7:], frame, samples, seed, path)
        pairs[0].append(exr.read(path))
        path = out / f"{frame}_theirs{seed}.exr"
        if not kept or not path.exists():
            names = cycles(blend, blender, out, f"{frame}:caustics", -int(samples), seed, f"theirs{seed}")
            listed.write_text("\n".join(f"{n} {name}" for n, name in names.items()))
        pairs[1].append(exr.read(path))
    preview(out, int(frame), pairs[0][0], pairs[1][0])
    names = dict((int(n), name) for n, name in (t.split(" ", 1) for t in listed.read_text().splitlines()))
    first = pairs[1][0]
    index = next(iter((channels(first, "IndexOB") or channels(first, "Object Index")).values()))
    lines = []
    for number, where in inner(index).items():
        if len(where) < 12:
            continue
        ratios = []
        for c in "RGB":
            (a, da), (b, db) = (
                mean([image.channels[c] if k == 0 else channels(image, "Combined")[c] for image in pair], where)
                for k, pair in enumerate(pairs)
            )
            ratios.append((a / b, a / b * math.hypot(da / max(a, 1e-9), db / max(b, 1e-9))) if b > 1e-4 else (1, 0))
        far = max((abs(r - 1) - 2 * e for r, e in ratios))
        word = "far" if far > LIMIT else "noisy" if max(2 * e for _, e in ratios) > LIMIT else ""
        lines.append((max(abs(r - 1) for r, _ in ratios), names.get(number, "nothing"), len(where), ratios, word))
    print(f"frame {frame}: {sum(line[0] <= LIMIT for line in lines)} of {len(lines)} objects within 3 %, "
          f"{sum(line[-1] == 'far' for line in lines)} far, {sum(line[-1] == 'noisy' for line in lines)} noisy")
    for _, name, pixels, ratios, word in sorted(lines, reverse=True):
        print(f"  {name:34} {pixels:6}  " + "  ".join(f"{r:.3f} +- {e:.3f}" for r, e in ratios) + f"  {word}")


if __name__ == "__main__":
    main()

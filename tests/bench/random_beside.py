#!/usr/bin/env python3
"""Sixty scenes made at random (tests/support/random_scenes.py): is a final frame as good as it says?

    python3 -B tests/bench/random_beside.py --out OUT   scenes 1 to 60 at 96x54: about half an hour of CPU
    python3 -B tests/bench/random_beside.py --out OUT --scenes 7,19   some of them again

Each is rendered as Makefile.example does it, and judged against halves of a path-traced reference that
grows until its noise is below half of the frame's error, or to --reference-cpu. What is still above is
"not converged", and not judged. Columns: seen error in codes (seen.py); what the frame says, the noise
left and the biases that its audit found, joined; their ratio; `!` outside of 1/1.3 to 1.3, `!!` above 3:
silently wrong. Layers: chain over reference - 1 in % of the picture with three errors, where they differ
by more. Asked: 90 % of the ratios from 1/1.3 to 1.3, none above 3.
"""

import argparse
import math
import statistics
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "stress"), str(HERE.parent / "support")]
import pixels  # noqa: E402
import random_scenes  # noqa: E402
from cases import Case  # noqa: E402
from everyscene import bias, shown  # noqa: E402
from measure import Bench  # noqa: E402
from references import Reference  # noqa: E402
from seen import Seen  # noqa: E402
from shipped import YARDSTICK, Side, Unfinished  # noqa: E402

LIMITS = (1.3, 3)  # of seen error over what is said: not within, silently wrong
LEAST = 0.3  # codes: errors below are not judged, as 8-bit pictures do not hold them


def said_in_codes(said, picture, seen):
    """Noise and audited biases in codes. A bias of a share b of the picture is b x mean in linear light, times
    the slope of the sRGB curve at the mean."""
    mean = max(1e-30, picture * seen.exposure)
    slope = 255 * (12.92 if mean < 0.0031308 else 1.055 / 2.4 * mean ** (1 / 2.4 - 1))
    layers = (f"audit.{layer}" for layer in pixels.LAYERS if layer != "direct")
    found = ((said.get(name, 0), said.get(name + "_error", math.inf)) for name in layers)
    biases = sum(
        value for value, error in found if abs(value) > max(0.02, 3 * error)
    )  # those that a frame warns of
    return math.hypot(said.get("noise.codes") or 0, biases * mean * slope)


def measured(bench, case, size, patience, reference_cpu):
    """A row of one scene."""
    side = Side(bench, case, size, patience)
    image, cpu, _, said = side.chain(1)
    reference = Reference(bench, case, size, [*YARDSTICK, "--light-paths", "1M"])
    if not reference.agrees_with(image):
        reference.forget()

    def error(a, b):
        seen = Seen(pixels.planes(a), pixels.planes(b))
        return seen, seen.error(pixels.planes(image))

    def enough(a, b):
        seen, found = error(a, b)
        return seen.halves_differ() < max(LEAST, found) / 2

    reference.until(enough, reference_cpu)
    a, b = reference.halves
    seen, found = error(a, b)
    mean, _ = pixels.mean_of_halves(a, b)
    if mean <= 0:
        raise Unfinished("the picture is black")
    off = {layer or "picture": bias([image], (a, b), layer, mean) for layer in ("", *pixels.LAYERS)}
    return {
        "scene": case.name,
        "kind": case.kind,
        "note": case.note,
        "cpu_s": cpu,
        "seen": found,
        "said": said_in_codes(said, mean, seen),
        "reference_noise": seen.halves_differ(),
        "converged": seen.halves_differ() < max(LEAST, found),
        "not_finite": image.not_finite(),
        "off": {layer: [r["difference"], r["bar"]] for layer, r in off.items() if r["apart"]},
        "shown": shown(bench, case, size, (a, image, image))[:2],
    }


def ratio(row):
    return max(LEAST, row["seen"]) / max(LEAST, row["said"])


HEADER = ["scene", "kind", "extreme", "CPU s", "seen", "said", "ratio", "layers that differ"]


def cells(row):
    if "refused" in row:
        return [row["scene"], row["kind"], row["note"], "", "", "", "", row["refused"]]
    off = ", ".join(f"{layer} {100 * d:+.1f}±{100 * e:.1f}" for layer, (d, e) in row["off"].items())
    mark = "" if row["converged"] else "?"
    mark += "!!" if ratio(row) > LIMITS[1] else "!" if not 1 / LIMITS[0] <= ratio(row) <= LIMITS[0] else ""
    finite = f" NOT FINITE {row['not_finite']}" if row["not_finite"] else ""
    return [
        row["scene"],
        row["kind"],
        row["note"],
        f"{row['cpu_s']:.1f}",
        f"{row['seen']:.2f}",
        f"{row['said']:.2f}",
        f"{ratio(row):.2f}{mark}",
        off + finite,
    ]


def rows(bench, numbers, size, patience, reference_cpu):
    """Rows of these scenes, each printed when it is known."""
    found = []
    for number in numbers:
        file, kind, options, extremes = random_scenes.make(bench.out / "random", number)
        case = Case(file.stem, file, 2, kind, shared=tuple(options), note=" ".join(extremes))
        try:
            row = measured(bench, case, size, patience, reference_cpu)
        except (Unfinished, RuntimeError) as reason:
            row = {"scene": case.name, "kind": kind, "note": case.note, "refused": str(reason)[:300]}
        found.append(row)
        print(" | ".join(cells(row)), flush=True)
    return found


def summary(rows):
    """(frames within the first limit, frames judged, names of those above the second limit, a sentence)"""
    good = [row for row in rows if "refused" not in row]
    judged = [row for row in good if row["converged"]]
    within = sum(1 / LIMITS[0] <= ratio(row) <= LIMITS[0] for row in judged)
    wrong = [row["scene"] for row in judged if ratio(row) > LIMITS[1]]
    return (
        within,
        len(judged),
        wrong,
        (
            f"{len(rows)} scenes: {len(rows) - len(good)} refused or black, "
            f"{len(good) - len(judged)} references not converged; of {len(judged)} judged {within} within "
            f"{LIMITS[0]}, above {LIMITS[1]}: {', '.join(wrong) or 'none'}; "
            f"median ratio {statistics.median(map(ratio, judged or good)):.2f}."
        ),
    )


def main():
    project = HERE.parents[1]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--build", type=Path, default=project / "build" / "release", help="build folder [build/release]"
    )
    parser.add_argument(
        "--out", type=Path, default=project / "out" / "bench", help="references, pictures [out/bench]"
    )
    parser.add_argument("--scenes", default="1-60", help="numbers: 1-60 or 3,7")
    parser.add_argument("--size", default="96x54")
    parser.add_argument("--patience", type=int, default=120, help="CPU seconds a process may take [120]")
    parser.add_argument(
        "--reference-cpu", type=float, default=20, help="CPU seconds a reference may take [20]"
    )
    args = parser.parse_args()
    bench = Bench(args.build.resolve(), args.out.resolve(), project, False, 0)
    first, _, last = args.scenes.partition("-")
    found = rows(
        bench,
        range(int(first), int(last) + 1) if last else map(int, args.scenes.split(",")),
        args.size,
        args.patience,
        args.reference_cpu,
    )
    print(summary(found)[-1])
    pictures = [file for row in found for file in row.get("shown", [])]
    bench.run(
        [
            bench.bin / "tempolux-info",
            "--sheet",
            bench.out / "random.png",
            "--columns",
            8,
            "--exposure",
            0,
            *pictures,
        ]
    )
    print(f"pictures, reference and frame: {bench.out / 'random.png'}")


if __name__ == "__main__":
    main()

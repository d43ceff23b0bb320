#!/usr/bin/env python3
"""What st-filter takes of the noise of blurred frames, and whether a filtered frame is ever worse than its
raw one.

    python3 -B tests/bench/blur_filter.py --out /tmp/blurfilter --scenes S2,S4

For each scene, with a shutter of 180 degrees and f/2.8 (weak) and with 360 degrees and f/0.2 (strong),
focus on the median depth: the chain's raw frame at the samples of QUALITY=draft and final; "pinhole": the
raw frame filtered without the means of its features, as before there were any; "filtered": filtered as it
is. Printed: RMS error against the halves of a path-traced frame of --reference samples, in 8-bit sRGB
codes of one exposure, of single pixels and of means over boxes of 5x5 and 15x15. Files that exist are used
again.
"""

import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import blur
import exr
import filter_few
import pipeline
import pixels
from seen import Seen, blurred

FRAMES = {"S2": 12, "S4": 8, "S8": 17, "evening_shot": 12}
FOCUS = {"S2": 2.73, "S4": 6.01, "S8": 3.85, "evening_shot": 3.18}  # m: median depth
SAMPLES = {"draft": "--spp 2 --pixel-error 0.05", "final": "--spp 4 --pixel-error 0.016"}
BOXES = (1, 5, 15)
MEANS = ("coverage.mean.", "coverage.error.")


def kinds(name):
    focus = {"FOCUS": FOCUS[name]}
    return {"weak": {"SHUTTER": 180, "FSTOP": 2.8} | focus, "strong": {"SHUTTER": 360, "FSTOP": 0.2} | focus}


def run(options, tool, *words):
    subprocess.run([options.bin / tool, *map(str, words), "-q"], check=True)


def raw_frame(options, name, kind, quality):
    file = options.out / f"{name}.{kind}.{quality}.exr"
    if file.exists():
        return file
    variables = filter_few.scenes(options.shared)[name][1]
    wish = {
        "SIZE": options.size,
        "FRAMES": FRAMES[name],
        "FILTER": 1,
        "METHOD": "frames",
        "QUALITY": quality,
        "PIXELS": SAMPLES[quality],
    }
    wish |= variables | kinds(name)[kind]
    folder = options.out / name

    def make(goal):
        subprocess.run(
            pipeline.command(blur.TOP, options.bin, folder, goal, **wish),
            check=True,
            env=pipeline.environment(),
            stdout=subprocess.DEVNULL,
        )

    make("plan")
    raw = next(file for file in pipeline.made_files(folder) if file.startswith(f"raw/{FRAMES[name]:04d}-"))
    make(raw)
    (folder / raw).rename(file)
    return file


def without_means(file):
    """The raw frame as it was before frame-render wrote means."""
    out = file.with_suffix(".pinhole.exr")
    image = exr.read(file)
    exr.write(
        out,
        image.width,
        image.height,
        {name: values for name, values in image.channels.items() if not name.startswith(MEANS)},
    )
    return out


def filtered(options, file):
    out = file.with_suffix(".f.exr")
    run(options, "st-filter", file, "-o", out)
    return out


def reference(options, name, kind):
    """Halves of a path-traced frame."""
    stem = options.out / f"ref_{name}.{kind}.exr"
    halves = [stem.with_name(f"ref_{name}.{kind}_{half}.exr") for half in "ab"]
    if all(half.exists() for half in halves):
        return halves
    variables, wish = filter_few.scenes(options.shared)[name][1], kinds(name)[kind]
    named = {"LIGHT_UNITS": "--light-units", "SKY": "--environment", "ENVIRONMENT": "--environment"}
    words = [variables["SCENE"], "--frame", FRAMES[name], "--camera", "auto", "--size", options.size]
    words += [word for key, value in variables.items() if key in named for word in (named[key], value)]
    words += ["--shutter", wish["SHUTTER"], "--f-stop", wish["FSTOP"], "--focus", wish["FOCUS"]]
    run(
        options,
        "frame-render",
        *words,
        "--integrator",
        "path",
        "--spp",
        options.reference,
        "--halves",
        "--channels",
        "RGBA",
        "-o",
        stem,
    )
    return halves


def boxed(planes, image, box):
    return [blurred(plane, image.width, image.height, box // 2) for plane in planes] if box > 1 else planes


def errors(halves, image):
    """RMS by box [codes]. Codes are those of the box means: codes of noisy pixels are too dark on the mean,
    and raw pixels more than filtered ones."""
    found = []
    for box in BOXES:
        seen = Seen(*(boxed(pixels.planes(half), half, box) for half in halves))
        found.append(seen.error(boxed(pixels.planes(image), image, box)))
    return found


def main():
    options = blur.options_of(
        __doc__,
        ",".join(FRAMES),
        reference=("192", "samples of the reference"),
        kinds=("weak,strong", "which blur"),
        qualities=("draft,final", "of the raw frames"),
    )
    options.out.mkdir(parents=True, exist_ok=True)
    over_raw, over_pinhole = [], []
    for name in options.scenes.split(","):
        for kind in options.kinds.split(","):
            halves = [exr.read(half) for half in reference(options, name, kind)]
            for quality in options.qualities.split(","):
                raw = raw_frame(options, name, kind, quality)
                files = {
                    "raw": raw,
                    "pinhole": filtered(options, without_means(raw)),
                    "filtered": filtered(options, raw),
                }
                cells = {label: errors(halves, exr.read(file)) for label, file in files.items()}
                for label, row in cells.items():
                    print(
                        f"{name:13} {kind:7} {quality:6} {label:9} {' '.join(f'{v:6.2f}' for v in row)}",
                        flush=True,
                    )
                over_raw += [f / r for f, r in zip(cells["filtered"], cells["raw"])]
                over_pinhole += [f / p for f, p in zip(cells["filtered"], cells["pinhole"])]
    print(f"filtered over raw: at most {max(over_raw):.3f}; over pinhole: at most {max(over_pinhole):.3f}")


if __name__ == "__main__":
    main()

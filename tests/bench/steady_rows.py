"""Steadiness of our frames and of Cycles' denoised ones on both sides of a segment's border: a part of the evidence for each scene."""

import re
import shutil
from pathlib import Path

import cases
import exr
import pipeline
import pixels
import steady
from measure import Missing, figure, quantity
from peer_renderers import Peer, planes_of
from shipped import Side

BORDER = 24            # first frame of the second segment
AROUND = 2             # frames on each side of it
SAMPLES = 64           # of Cycles
PAIR = 2               # frames of Cycles: it has no segments, and a pair holds more than 200 boxes of 15 x 15 pixels
SCENES = ("demo", "S2", "S5", "S8", "furnished_day", "evening_shot")


def frames_of(case):
    """Around the border, or in the middle where the shot ends before."""
    if case.name == "evening_shot":
        return range(10, 14), None
    return range(BORDER - AROUND, BORDER + AROUND), AROUND


def ours(side, frames, seed):
    """R, G, B planes of frames made as one range."""
    shutil.rmtree(side.folder, ignore_errors=True)
    cpu = side.spend(
        pipeline.command(
            side.bench.project,
            side.bench.bin,
            side.folder,
            "demo",
            RUN=f"sh {Path(__file__).with_name('with_seed.sh')} {seed}",
            **side.wish(f"{frames[0]}-{frames[-1]}", ("RGBA",)),
        )
    )
    pictures = [pixels.planes(exr.read(pipeline.frame_of(side.folder, f))) for f in frames]
    return pictures, cpu / len(frames)


def flows(side, frames):
    """Motion of each frame to the next."""
    out = str(side.bench.out / "tmp" / "flow.####.exr")
    side.bench.tool(
        "frame-render",
        side.case.file,
        "--frames",
        f"{frames[0]}-{frames[-1]}",
        *side.case.options()[2:],
        "--integrator",
        "path",
        "--spp",
        1,
        "--size",
        side.size,
        "--channels",
        "motion",
        "--compression",
        "none",
        "-o",
        out,
    )
    images = [exr.read(out.replace("####", f"{f:04d}")) for f in frames]
    return [[image.channels[f"forward.{c}"] for c in "uv"] for image in images]


def cycles(bench, case, size, frames):
    """Frames by Cycles with OIDN: {how seeds go: (R, G, B planes of two runs)} and CPU seconds of a frame. A frame that
    both ways share is rendered once."""
    sky = re.search(r"--environment ([\d.]+),([\d.]+),([\d.]+)", " ".join(map(str, case.shared)))
    peer = Peer(
        bench,
        "cycles",
        {
            "scene": str(case.file),
            "size": size,
            "light_units": "spec" if "spec" in case.shared else "raw",
            "camera": case.camera,
            "world": str(case.environment) if case.environment else None,
            "sky": [float(v) for v in sky.groups()] if sky else None,
        },
    )
    out, pictures, cpu = bench.out / "tmp" / "steady-cycles.exr", {}, 0.0

    def picture(frame, seed):
        nonlocal cpu
        if (frame, seed) not in pictures:
            cpu += peer.ask({"frame": frame, "samples": SAMPLES, "seed": seed, "denoise": True, "output": str(out)})
            pictures[frame, seed] = planes_of(out)
        return pictures[frame, seed]
    try:
        runs = {
            "a seed a frame": [[picture(f, 100 * run + f) for f in frames] for run in (1, 2)],
            "one seed": [[picture(f, 100 * run + frames[0]) for f in frames] for run in (1, 2)],
        }
    finally:
        peer.close()
    return runs, cpu / len(pictures)


def measure(bench, name):
    case = next((c for c in cases.of_curves(bench) if c.name == name), None)
    if case is None:
        raise Missing(f"scene {name} is not here (../shared/scenes is absent)")
    size = "160x90" if bench.small else "320x180"
    side, (frames, border) = Side(bench, case, size, 10**5), frames_of(case)
    width, height = map(int, size.split("x"))
    moves = flows(side, frames)

    def of_ours():
        (first, cpu), (second, _) = (ours(side, frames, seed) for seed in (1, 2))
        return {"found": steady.steadiness(first, second, width, height, moves, border), "cpu": cpu}

    def of_cycles():
        runs, cpu = cycles(bench, case, size, frames[:PAIR])
        return {
            how: {"found": steady.steadiness(*two, width, height, moves[:PAIR]), "cpu": cpu}
            for how, two in runs.items()
        }
    rows = {"final": bench.step("ours", of_ours)}
    notes = []
    try:
        for how, row in bench.step("cycles", of_cycles).items():
            rows[f"Cycles {SAMPLES} + OIDN, {how}"] = row
    except Missing as reason:
        notes.append(f"Cycles: skipped: {reason}")
    mine, *theirs = (row["found"]["frame to frame"][2] for row in rows.values())
    ratio = min(theirs) / max(mine, 1e-3) if theirs else None
    cell = rows["final"]["found"]
    jump = max(cell["border over within"], default=0)
    return figure(
        f"{name}: steadiness",
        "boxes of 15 pixels have less noise from frame to frame than those of Cycles with OIDN, and at most twice as much across "
        "a segment's border as within a segment",
        ["side", "CPU s a frame", *steady.HEADER],
        [[side_, quantity(row["cpu"]), *steady.cells(row["found"])] for side_, row in rows.items()],
        None if ratio is None else ratio >= 1 and jump <= 2,
        [f"Frames {frames[0]} to {frames[-1]} (Cycles: the first {PAIR}), {size}, two seeds; codes.", *notes],
        f"the noise from frame to frame is {', '.join(f'{v:.2f}' for v in cell['frame to frame'])} codes in boxes of 1, 5 and 15 "
        f"pixels; across a border it is {jump:.1f} times as large as within a segment"
        + (f"; that of Cycles is {quantity(ratio)} times ours" if ratio else ""),
        ratio and min(ratio, 2 / max(jump, 0.1)),
        **({"steadier": ratio} if ratio else {}),
    )

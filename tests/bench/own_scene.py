#!/usr/bin/env python3
"""What evidence.py measures, for one scene of the user's: a page with frames, curves, account, steadiness, costs and commands.

    make -f Makefile.example report SCENE=my.glb FRAMES=0-47 OUT=my        writes my/report/scene.html beside index.html

run.sh starts it with make's variables. The frame is the first of REPORT_FRAMES. Curves: three settings and path tracing of 4, 16, 64 samples, two
seeds a point, each judged against halves of a path-traced reference that grows to REPORT_CPU seconds (300).
"""

import base64
import html
import os
import re
import shlex
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
import pipeline
import pixels
import steady
import steady_rows
from cases import Case
from curves import SETTINGS, Curves
from measure import Bench, quantity
from plot import chart
from references import Curve
from results_page import table
from seen import Seen

OPTIONS = {"SKY": "--environment", "LIGHT_UNITS": "--light-units", "VOLUME": "--volume"}
PASSED = ("SKY", "LIGHT_UNITS", "VOLUME", "VOLUME_OPTIONS", "METHOD", "INDIRECT", "MOVING", "SPLIT")
STYLE = """body{font:15px sans-serif;max-width:60em;margin:2em auto;padding:0 1em}table{border-collapse:collapse}td,th{border:1px solid #ccc;padding:.2em .5em}
pre{background:#f4f4f4;padding:.5em;overflow:auto}.both{position:relative;display:inline-block}.both img{display:block;max-width:100%}
.both .over{position:absolute;top:0;left:0;clip-path:inset(0 50% 0 0)}input{width:100%}"""
SCRIPT = """const s=document.getElementById('s'),o=document.getElementById('o');s.oninput=()=>{o.style.clipPath='inset(0 '+(100-s.value)+'% 0 0)'};s.oninput()"""


def the_case(environ):
    """The user's scene with its wishes; the first frame that is reported."""
    asked = environ["REPORT_FRAMES"]
    frame = int(re.match(r"\d+", environ["FRAMES"] if asked == "ends" else asked).group())
    shared = [word for name, option in OPTIONS.items() if environ.get(name) for word in (option, environ[name])]
    shared += environ.get("VOLUME_OPTIONS", "").split() + environ.get("TIME", "").split()
    return Case(
        "own",
        Path(environ["SCENE"]),
        frame,
        "own",
        environ.get("CAMERA", "auto"),
        tuple(shared),
        Path(environ["ENVIRONMENT"]) if environ.get("ENVIRONMENT") else None,
    )


class Own(Curves):
    """Curves of the user's scene: make gets the user's own variables."""

    def __init__(self, bench, environ):
        super().__init__(bench, the_case(environ), environ["SIZE"], float(environ.get("REPORT_CPU", 300)))
        wish, plain = self.side.wish, {name: environ[name] for name in PASSED if environ.get(name)}
        self.side.wish = lambda frames, channels=("RGBA",), quality="final", variables=None: {
            **wish(frames, channels, quality, variables), **plain, "TIME": environ.get("TIME", ""), **(variables or {})}


def picture(bench, planes, exposure, width, height):
    """A PNG as a data URI."""
    file = bench.out / "tmp" / "shown.exr"
    exr.write(file, width, height, {c: [v * exposure for v in plane] for c, plane in zip("RGB", planes)})
    bench.run([bench.bin / "tempolux-info", "--png", file.with_suffix(".png"), file, "--exposure", 0])
    return "data:image/png;base64," + base64.b64encode(file.with_suffix(".png").read_bytes()).decode()


def of_markdown(text):
    """A table as HTML."""
    lines = [[html.escape(cell.strip()) for cell in line.strip("|").split("|")] for line in text.strip().splitlines()]
    rows = [
        "<tr>" + "".join(f"<{tag}>{cell}</{tag}>" for cell in line) + "</tr>"
        for i, line in enumerate(lines)
        if i != 1
        for tag in ("th" if i == 0 else "td",)
    ]
    return "<table>" + "".join(rows) + "</table>"


def steadiness(own, frames):
    runs = [steady_rows.ours(own.side, frames, seed)[0] for seed in (1, 2)]
    return steady.steadiness(*runs, own.width, own.height, steady_rows.flows(own.side, frames))


def main():
    environ = os.environ
    project, out = Path(environ["TOP"]), Path(environ["OUT"])
    bench = Bench(Path(environ["BIN"]).parent, out / "report" / "files", project, False, 0)
    bench.bin, bench.small = Path(environ["BIN"]), True
    own = Own(bench, environ)
    points = {}
    shown = None
    for label, variables in SETTINGS[:3]:
        found = []
        for seed in (1, 2):
            image, cpu = own.chain(variables, seed)
            planes = [list(image.channels[c]) for c in "RGB"]
            halves = own.reference(planes)
            found.append((cpu, Seen(*halves).error(planes), None))
        points[label] = found
        if label == "final":
            shown, stages = planes, pipeline.cpu_of(own.side.folder)
            said = {k: v for s in pipeline.stats_of(own.side.folder, ("frames",)) for k, v in s["results"].items()}
    own.add("this chain", points)
    paths = {
        n: [
            (image_cpu[1], Seen(*halves).error(pixels.planes(image_cpu[0])), None)
            for seed in (1, 2)
            for image_cpu in (own.paths(n, seed),)
        ]
        for n in (4, 16, 64)
    }
    own.add("path tracing", paths)
    seen = Seen(*halves)
    cpu, error, plus, _ = own.shown["this chain"]["final"]
    needed, inside = Curve([p[:2] for p in own.shown["path tracing"].values()]).cost(error)
    frames = range(own.case.frame, own.case.frame + 2)
    calm = steadiness(own, frames)
    reference = [[(p + q) / 2 for p, q in zip(*pair)] for pair in zip(*halves)]
    svg = chart(
        f"Seen error against CPU seconds of a frame, {own.size}",
        "CPU s a frame",
        "codes",
        [(l, [(c, e) for c, e, *_ in p.values()]) for l, p in own.shown.items()],
        log=True,
    )
    wish = own.side.wish(environ["FRAMES"])
    command = "make -f Makefile.example " + " ".join(
        f"{k}={shlex.quote(str(v))}"
        for k, v in wish.items()
        if v not in (None, "") and k not in ("CHANNELS", "QUALITY")
    )
    account = table(
        ["frame " + str(own.case.frame), "the frame says", "measured"],
        [
            ["noise, codes", quantity(said.get("noise.codes")), f"{error:.2f} ± {plus:.2f} (all error)"],
            *[
                [
                    f"bias of layer {layer}",
                    f"{100 * said[f'audit.{layer}']:+.1f} ± {100 * said[f'audit.{layer}_error']:.1f} % of the picture",
                    "",
                ]
                for layer in pixels.LAYERS
                if f"audit.{layer}" in said
            ],
        ],
    )
    converged = (
        ""
        if seen.halves_differ() < 2 * error
        else f" The reference's own noise is {seen.halves_differ():.2f} codes: it is not converged, give it more by REPORT_CPU."
    )
    parts = [
        f"<h1>{html.escape(own.case.file.name)}</h1><p>Frame {own.case.frame}, {own.size}: {quantity(cpu)} CPU s, seen error {error:.2f} codes. Path tracing takes "
        f"{'' if inside else 'about '}{quantity(needed)} CPU s for this error.{converged}</p>",
        f"<h2>Final, and the reference</h2><div class=both><img src='{picture(bench, reference, seen.exposure, own.width, own.height)}' alt=reference>"
        f"<img id=o class=over src='{picture(bench, shown, seen.exposure, own.width, own.height)}' alt=final></div><input id=s type=range min=0 max=100 value=50 aria-label='left: final, right: reference'>",
        "<h2>Curves</h2>",
        svg,
        of_markdown(
            table(
                ["side", "setting", "CPU s a frame", "seen error, codes", "seeds"],
                [row[:4] + row[5:] for row in own.rows],
            )
        ),
        "<h2>The frame's own account</h2>",
        of_markdown(account),
        "<h2>Steadiness</h2>",
        of_markdown(table(["frames", *steady.HEADER], [[f"{frames[0]}, {frames[-1]}", *steady.cells(calm)]])),
        "<h2>Where CPU seconds go</h2>",
        of_markdown(table(["stage", "CPU s"], [[stage, quantity(value)] for stage, value in stages.items()])),
        "<h2>Commands</h2>",
        *(f"<pre>{html.escape(command + more)}</pre>" for more in (" QUALITY=draft", "", " ERROR=.008")),
    ]
    page = out / "report" / "scene.html"
    policy = "<meta http-equiv=Content-Security-Policy content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\">"
    page.write_text(
        f"<!doctype html><meta charset=utf-8>{policy}<title>{html.escape(own.case.file.name)}</title><style>{STYLE}</style>"
        + "\n".join(parts)
        + f"<script>{SCRIPT}</script>\n"
    )
    shutil.rmtree(own.side.folder, ignore_errors=True)
    print(f"look at {page}: frames, curves, steadiness, account")


if __name__ == "__main__":
    main()

"""The thirteen systems of the two papers, a function each: the paper's figure, what is asked of ours, and what it does on this tree.

The scripts beside this file measure most of them and print tables; here they run at one size, and the value that is judged is read from
their words. CPU seconds of both sides of a ratio are of one run, in turns.
"""

import json
import math
import re
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import cases  # noqa: E402
import pipeline
import pixels
from measure import Missing, Steps, figure, percent, quantity
from references import Reference
from seen import Seen
from shipped import YARDSTICK, Side

HERE = Path(__file__).resolve().parent


def said(bench, step, script, *words):
    """What a script of this folder prints, as one step."""
    return bench.step(step, lambda: bench.run([sys.executable, "-B", HERE / script, *words]).stdout)


def tables(text):
    """[(header, rows)] of a script's Markdown."""
    found = []
    for block in re.findall(r"(?:^\|.*\|$\n?)+", text, re.M):
        lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in block.strip().splitlines()]
        if len(lines) > 2:
            found.append((lines[0], lines[2:]))
    return found


def number(text):
    """The first number in a text."""
    return float(re.search(r"-?\d*\.?\d+(?:e-?\d+)?", text).group())


def over(text, pattern):
    found = re.search(pattern, text)
    if not found:
        raise Missing(f"the script said no {pattern}")
    return [float(group) for group in found.groups()]


# ---- A: walkthrough

KEYS = 16             # frames between the first keys


def walk(bench):
    """S4 between two keys as METHOD=walkthrough makes it, and some of its frames rendered whole. Two parts read it, so it is kept aside."""
    step = Steps(bench.out / "steps" / "walk-of-S4.json", bench.programs_digest())
    scene, size = bench.scene("S4")[0], "640x360"
    common = {"SCENE": scene, "SIZE": size, "KEY_DISTANCE": KEYS}

    def walked():
        out = bench.out / "walk"
        cpu = pipeline.run_make(bench.project, bench.bin, out, FRAMES=f"0-{KEYS}", METHOD="walkthrough", **common)
        warps = [json.loads(f.read_text())["counts"] for f in sorted((out / "walked").glob("*.warp.json"))]
        rays = sum(stats["counts"].get("camera_rays", 0) for stats in pipeline.stats_of(out, ("frames",)))
        render = sum(
            p["cpu_s"]
            for stats in pipeline.stats_of(out, ("frames",))
            for p in stats["phases"]
            if p["name"] == "render"
        )
        seen = [float(v) for v in re.findall(r"seen ([\d.]+)%", (out / "walk.log").read_text())]
        return {"cpu": cpu, "warps": warps, "rays": rays, "render": render, "keys": KEYS + 1 - len(warps), "seen": seen}

    def whole():
        out = bench.out / "whole"
        cpu = pipeline.run_make(bench.project, bench.bin, out, FRAMES=f"0-{KEYS}x4", METHOD="frames", **common)
        rays = sum(stats["counts"].get("camera_rays", 0) for stats in pipeline.stats_of(out, ("frames",)))
        render = sum(
            p["cpu_s"]
            for stats in pipeline.stats_of(out, ("frames",))
            for p in stats["phases"]
            if p["name"] == "render"
        )
        return {"cpu": cpu, "rays": rays, "render": render, "frames": KEYS // 4 + 1}
    return step("walked", walked), step("whole", whole), size


def walkthrough(bench):
    walked, _, size = walk(bench)
    frames = KEYS                                # between keys and one of the two keys: what a long walk repeats
    pixels_all = walked["warps"][0]["pixels"]
    causes = sorted({c for w in walked["warps"] for c in w if c.startswith("traced_")})
    share = {c[7:]: sum(w.get(c, 0) for w in walked["warps"]) / (frames * pixels_all) for c in causes}
    traced = sum(w["traced"] for w in walked["warps"]) / (frames * pixels_all)
    whole = traced + (walked["keys"] - 1) / frames
    shares = [w["traced"] / pixels_all for w in walked["warps"]]
    error = statistics.stdev(shares) / math.sqrt(len(shares))
    rows = [[name, percent(value, 1)] for name, value in sorted(share.items(), key=lambda p: -p[1])] + [
        ["keys", percent((walked["keys"] - 1) / frames, 1)],
        ["all", percent(whole, 1)],
    ]
    return figure(
        "A: walkthrough: warp, masks, recursion",
        "at most 22 % of the pixels traced on S4",
        ["S4: traced because of", "pixels"],
        rows,
        whole <= 0.22,
        [
            f"{size}, final, frames 0 to {KEYS}, keys counted; AQM between keys: {', '.join(f'{v:.1f} %' for v in walked['seen'])} of the pixels. Spread of frames: ±{percent(error, 1)}."
        ],
        f"{percent(whole, 1)} ± {percent(error, 1)}",
        0.22 / whole,
        "49.5 % (atrium), 35.1 % (room)",
    )


def whole_chain(bench):
    walked, whole, size = walk(bench)
    frames = KEYS + 1
    ratio = {what: whole[what] / whole["frames"] * frames / walked[what] for what in ("cpu", "rays", "render")}
    rows = [
        [name, quantity(whole[what] / whole["frames"]), quantity(walked[what] / frames), quantity(ratio[what])]
        for name, what in (
            ("camera samples", "rays"),
            ("CPU s, phase render", "render"),
            ("CPU s, all processes", "cpu"),
        )
    ]
    worth = min(ratio["rays"] / 8.3, ratio["render"] / 5, ratio["cpu"] / 2.5)
    return figure(
        "A: walkthrough, a whole chain",
        "8.3x fewer camera samples than every frame rendered, phase render 5x, CPU 2.5x",
        ["S4, a frame", "every frame rendered", "walkthrough", "ratio"],
        rows,
        worth >= 1,
        [
            f"{size}, final; frames 0 to {KEYS} with their keys; every frame: mean of {whole['frames']} of them, light included. Both sides are adaptive."
        ],
        f"samples {quantity(ratio['rays'])}x, render {quantity(ratio['render'])}x, CPU {quantity(ratio['cpu'])}x",
        worth,
        "8.3x, against a fixed number of samples in every pixel (adaptive supersampling of every frame)",
    )


def metric(bench):
    text = said(bench, "flow", "vision.py", "flow", bench.bin, bench.scene("S4")[0], bench.out / "vision")
    header, rows = tables(text)[0]
    ours = [row for row in rows if "authors" not in row[0]]
    three, five = (statistics.mean(number(row[i]) for row in ours) for i in (5, 6))
    spread = statistics.stdev([number(row[5]) for row in ours]) / math.sqrt(len(ours))
    worth = min(0.28 / three if three > 0 else 9, 0.09 / five if five > 0 else 9)
    return figure(
        "A: metric with pixel flow",
        "flow x3 leaves at most .28 of the visible errors, x5 at most .09",
        header,
        rows,
        worth >= 1,
        ["S4, 320x180: two pairs of warped keys, AQM % by the speed of the flow; the eye follows or rests."],
        f"x3 {three:.2f} ± {spread:.2f}, x5 {five:.2f}",
        worth,
        "11.37 % of the pixels at the flow's speed, 3.00 % at x3, .93 % at x5",
    )


def filter_(bench):
    """Seen error of filtered frames of n samples beside unfiltered ones of 4 n."""
    rows, gains = [], []
    for name in ("S2", "S4"):
        case = next(c for c in cases.ours(bench) if c.name == name)
        side, size = Side(bench, case, "160x90", 10**5), "160x90"

        def judged(samples, window):
            def make():
                errors, cpu = [], []
                reference = Reference(bench, case, size, YARDSTICK)
                for seed in (1, 2):
                    image, spent, *_ = side.chain(
                        seed, variables={"FILTER": window, "PIXELS": f"--spp {samples} --pixel-error 0"}
                    )
                    reference.until(lambda a, b: Seen(pixels.planes(a), pixels.planes(b)).halves_differ() < 0.7, 40)
                    errors.append(Seen(*(pixels.planes(h) for h in reference.halves)).error(pixels.planes(image)))
                    cpu.append(spent)
                return statistics.mean(errors), abs(errors[0] - errors[1]) / 2, statistics.mean(cpu)
            return bench.step(f"{name} {samples} {window}", make)
        for n in (2, 4, 8):
            alone, window, plain, more = judged(n, 1), judged(n, 5), judged(n, "none"), judged(4 * n, "none")
            gains.append(more[0] / window[0])
            rows.append(
                [name, n, *(f"{e:.2f} ± {s:.2f}" for e, s, _ in (plain, alone, window, more)), quantity(gains[-1])]
            )
    return figure(
        "A: spatio-temporal filter",
        "seen error of a filtered frame of n samples at most that of an unfiltered one of 4 n",
        ["scene", "n", "not filtered", "filtered alone", "five frames", "not filtered, 4 n", "4 n over five frames"],
        rows,
        min(gains) >= 1,
        ["160x90, one frame of the preset's light, two seeds; codes."],
        f"4 n over filtered: {quantity(min(gains))} to {quantity(max(gains))}",
        min(gains),
        "flicker seen at one sample a pixel goes with 5 frames (no figure)",
    )


# ---- A: light over time

def photons_over_time(bench):
    text = said(bench, "period", "density.py", bench.bin, bench.out / "density", "period")
    header, rows = tables(text)[0]
    saves = {int(row[0]): number(row[4]) for row in rows}
    worth = min(saves[60] / 10, saves[240] / 20)
    return figure(
        "A: photons over time",
        "at equal error 10x fewer photons a frame if light changes with a period of 60 frames, 20x at 240",
        header,
        rows,
        worth >= 1,
        [
            "A room whose lamp changes by 30 %; errors over 25 frames; the best window of one size is the most that a window can save."
        ],
        f"{quantity(saves[60])}x at 60, {quantity(saves[240])}x at 240",
        worth,
        "10 to 40 thousand photons a frame look like 845 thousand",
    )


def localised(bench):
    text = said(bench, "moving", "moving.py", bench.bin, bench.out / "moving", "--frames", "8-12")
    header, rows = tables(text)[0]
    row = {cells[0]: [number(cell) for cell in cells[1:]] for cells in rows}
    records, cpu = row["anew"][3] / row["updated"][3], row["anew"][2] / row["updated"][2]
    worth = min(records / 4, cpu / 3.2)
    return figure(
        "A: localised gathering",
        "4x fewer records, 3.2x less CPU in phase records",
        header,
        rows,
        worth >= 1,
        [
            text.partition("\n")[0] + ".",
            "A furnished room of 8 x 6 x 3 m, an object of .5 m moves; 320x180, a million paths, thresholds .06 and .15; means of three frames.",
        ],
        f"{quantity(records)}x fewer records, {quantity(cpu)}x less CPU",
        worth,
        "3 to 4x fewer samples, 1.4 to 3.2x faster",
    )


def temporal(bench, what):
    work = bench.out / f"temporal-{what}"
    if what == "object":
        import moving_room
        work.mkdir(parents=True, exist_ok=True)
        scene, words, asked = work / "room.glb", [], 6
        if not scene.exists():
            moving_room.make(scene, 50_000)
    else:
        made = bench.shared and bench.shared / "made" / "S5_moving_light.glb"
        if not made or not made.exists():
            raise Missing("S5_moving_light.glb is not here (../shared/scenes is absent)")
        scene, words, asked = made, ["--light", "anew"], 4
    text = said(
        bench, "over time", "temporal.py", bench.bin, scene, work, "--frames", 9, "--judge", 8, "--seeds", 3, *words
    )
    fresh, kept, ratio = over(text, r"fresh ([\d.]+) s, over time ([\d.]+) s: ([\d.]+) x")
    rays, = over(text, r"from hits ([\d.]+) %")
    error, plus, flicker, _ = over(text, r"RMSE ([\d.]+) \+- ([\d.]+);.*flicker ([\d.]+) \+- ([\d.]+) of a seed")
    worth = min(ratio / asked, 1.1 / error, 0.4 / flicker)
    return figure(
        f"A: temporal gathering, a moving {what}",
        f"phase records {asked}x less CPU, error within 10 % of frame by frame, flicker at most .4x",
        ["", "frame by frame", "over time", "ratio"],
        [
            ["phase records, CPU s a frame", fresh, kept, f"{ratio:.2f}"],
            ["rays, % of frame by frame", 100, rays, f"{rays / 100:.2f}"],
            ["RMSE, indirect", "1", f"{error:.3f} ± {plus:.3f}", f"{error:.2f}"],
            ["flicker, of a seed a frame", "1", f"{flicker:.3f}", f"{flicker:.2f}"],
        ],
        worth >= 1,
        [
            f"{scene.name}, 320x180, 9 frames of one segment, error at frame 8, three seeds.",
            *[line for line in text.splitlines() if line.startswith("frame 8")],
        ],
        f"records {ratio:.1f}x, error {error:.2f} ± {plus:.2f}, flicker {flicker:.2f}",
        worth,
        (
            "9.1x for an object, phase of gathering alone"
            if what == "object"
            else "5.2x for light, phase of gathering alone"
        ),
    )


def secondary(bench):
    text = said(bench, "split", "split.py", bench.bin, bench.out / "split", "--seeds", 4)
    found = re.findall(
        r"rays alone / split: ([\d.]+) \+- ([\d.]+); of relative variance ([\d.]+);.*CPU ([\d.]+); "
        r"means differ by (-?[\d.]+) \+- ([\d.]+)",
        text,
    )
    (variance, apart, relative, cpu, bias, error), pixel = [float(v) for v in found[0]], [float(v) for v in found[1]]
    return figure(
        "A: strong secondary light",
        "variance at equal CPU 2x lower, unbiased, on a scene with a hot spot",
        ["way", "variance, rays alone / split", "relative variance", "CPU, rays alone / split", "means differ by, %"],
        [
            ["a record", f"{variance} ± {apart}", relative, cpu, f"{bias} ± {error}"],
            ["a pixel without records", f"{pixel[0]} ± {pixel[1]}", *pixel[2:4], f"{pixel[4]} ± {pixel[5]}"],
        ],
        variance * cpu >= 2 and abs(bias) <= 3 * error,
        [f"S3 with its lamp narrowed to a cone, 160x90, four seeds; {text.partition(chr(10))[0]}."],
        f"{variance:.1f} ± {apart:.1f}x lower variance at {cpu:.2f} of the CPU",
        variance * cpu / 2,
        "768 samples in 21 minutes, split 278 in 9 minutes",
    )


# ---- B: selective photon tracing

def make_vdb(bench):
    program = bench.programs.parent / "make-vdb"
    if not program.exists():
        raise Missing("built without volumes")
    return ["--make-vdb", program]


def selection(bench):
    text = said(
        bench,
        "updates",
        "selective.py",
        bench.bin,
        "updates",
        *make_vdb(bench),
        "--folder",
        bench.out / "selective",
        "--shares",
        "10%",
        "--strategies",
        "oldest,random,census,hybrid",
    )
    header, rows, shares = None, [], []
    for (header, found), name in zip(tables(text), re.findall(r"^(\S+), frames", text, re.M)):
        rows += [[name, *row] for row in found]
        best = max(
            ([number(w) for w in re.findall(r"\d+", row[3])] for row in found if row[1] not in ("oldest", "random")),
            key=lambda p: p[0],
        )
        shares.append(best[0] / best[1])
    return figure(
        "B: selection",
        "the best strategy below oldest and random in 90 % of the frames from the sixth on",
        ["scene", *header],
        rows,
        min(shares) >= 0.9,
        ["24 frames of one segment, 299 880 paths, a tenth traced again, pilots counted; RMSE of the layer volume."],
        f"in {percent(min(shares), 0)} of the frames",
        min(shares) / 0.9,
        "below the order by age in every frame",
    )


def groups(bench):
    text = said(
        bench,
        "deviation",
        "selective.py",
        bench.bin,
        "deviation",
        *make_vdb(bench),
        "--folder",
        bench.out / "selective",
        "--passes",
        30,
    )
    header, rows = tables(text)[0]
    first, last, equal = number(rows[0][1]), number(rows[-1][1]), number(rows[-1][2])
    return figure(
        "B: groups by energy",
        "deviation after 30 passes at most 5 % above its start",
        header,
        rows,
        last <= 1.05 * first,
        ["A point lamp, 400 bins of equal solid angle; further photons in the groups that fly to a ball of smoke."],
        f"{first:.4f} at the start, {last:.4f} after {rows[-1][0]}; by number of photons {equal:.2f}",
        1.05 * first / last,
        "stays at its start",
    )


def deletion(bench):
    found = bench.step("replace", lambda: bench.program("replace_photons"))
    times = {int(total): 1e3 * seconds for total, seconds in found.items() if total != "replaced"}
    spread = max(times.values()) / min(times.values())
    return figure(
        "B: deletion of a group",
        "equal time within 20 % for totals of 300 thousand to 30 million photons",
        ["photons in the volume", f"ms to replace {found['replaced']}"],
        [[total, f"{ms:.2f}"] for total, ms in times.items()],
        spread <= 1.2,
        ["One thread, median of 9, sides in turns."],
        f"{min(times.values()):.1f} to {max(times.values()):.1f} ms, {spread:.2f}x",
        1.2 / spread,
        "1 ms for a group of 300 thousand photons",
    )


def textures(bench):
    """Frames of S6 from its photons alone, a tenth traced again in each: lighting and rendering apart, as the paper has them."""
    made = bench.shared and bench.shared / "made"
    if not made or not (made / "S6_smoke.glb").exists():
        raise Missing("S6_smoke.glb is not here (../shared/scenes is absent)")
    scene, out = made / "S6_smoke.glb", bench.out / "textures"
    smoke = ["--volume", made / "S6_smoke_vdb/smoke_####.vdb", "--sigma-t", 10, "--albedo", ".85,.85,.88"]
    first, frames = 4, "5-8"

    def spent(paths):
        out.mkdir(exist_ok=True)
        file = {end: out / f"{end}.####.{end}" for end in ("photons", "meshirrad", "exr")}
        bench.run(
            [
                bench.bin / "scene-plan",
                scene,
                *smoke,
                "--frames",
                f"{first}-8",
                "--update",
                "10%",
                "-q",
                "-o",
                out / "plan",
            ]
        )
        frozen = [
            scene,
            *smoke,
            "--majorants",
            pipeline.majorants_of(out / "plan", 0),
            "--photons",
            paths,
            "--kinds",
            "indirect,volume",
        ]
        bench.tool("photon-trace", *frozen, "--frame", first, "--pilots", "3%", "-o", file["photons"])
        light = bench.tool(
            "photon-trace",
            *frozen,
            "--frames",
            frames,
            "--update",
            file["photons"],
            "--share",
            "10%",
            "--strategy",
            "fde",
            "-o",
            file["photons"],
        )
        common = [scene, *smoke, "--frames", frames, "--photons", file["photons"]]
        surfaces = bench.tool("st-filter", "mesh", *common, "-o", file["meshirrad"])
        clear = bench.tool(
            "frame-render",
            scene,
            *smoke,
            "--frames",
            frames,
            "--meshirrad",
            file["meshirrad"],
            "--size",
            "640x360",
            "--spp",
            1,
            "--pixel-error",
            0,
            "--channels",
            "RGBA,layers,Z",
            "-o",
            out / "clear.####.exr",
        )
        smoky = bench.tool(
            "volume-compose",
            *common,
            "--base",
            out / "clear.####.exr",
            "--spp",
            1,
            "--light-samples",
            1,
            "-o",
            file["exr"],
        )
        return [light["cpu_s"] / 4, sum(part["cpu_s"] for part in (surfaces, clear, smoky)) / 4]
    rows, worth, words = [], [], []
    for paths, lighting, rendering in ((299880, 0.52, 0.17), (999810, 1.58, 0.32)):
        ours = [bench.normalised(seconds) for seconds in bench.step(f"{paths}", lambda: spent(paths))]
        worth.append((lighting + rendering) / sum(ours))
        words.append(f"{ours[0]:.2f} + {ours[1]:.2f} s")
        rows.append([paths, f"{lighting} + {rendering}", words[-1], quantity(worth[-1])])
    return figure(
        "B: textures and times",
        "lighting and rendering in the paper's seconds, both rows",
        ["paths", "the paper: lighting + rendering, s", "ours, normalised CPU s", "the paper over ours"],
        rows,
        min(worth) >= 1,
        [
            "S6, frames 5 to 8, 640x360, light textures and radiance volume, a tenth of the paths traced again. The paper's rendering is a graphics card's."
        ],
        ", ".join(words),
        min(worth),
        ".52 + .17 s (299 880 photons), 1.58 + .32 s (999 810), two Pentium IV and a Radeon 9700",
    )

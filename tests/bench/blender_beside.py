"""A .blend by Cycles beside its export by us: means by object (Cycles' object index) and by tiles of 8x6, all channels, linear.

    python3 tests/bench/blender_beside.py SHOT.blend BLENDER OUT FRAMES -- the make line of the exporter

BLENDER: Python of a virtual environment with bpy, or a program. The line is run with SIZE=320x180, FRAMES and BIN put behind it. Cycles: 128
samples and OIDN, with the shot's motion blur and depth of field, as ours; --caustics as words of FRAMES' end (1,18:caustics) keep its
light through glass. SIZE=192x108 in the environment: a smaller picture. KEEP_CYCLES=1, KEEP_OURS=1: what is there is not rendered again. Written: OUT/F_cycles.exr, OUT/ours/frames/*.exr, OUT/F.png: ours above, Cycles below, at one exposure.
"""

import os
import pathlib
import shlex
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "tests/stress"))
import exr  # noqa: E402

SIZE, TILES = tuple(map(int, os.environ.get("SIZE", "320x180").split("x"))), (8, 6)
RENDER = """
import bpy, sys
blend, out, frames, width, height, samples, seed, tail = sys.argv[-8:]
bpy.ops.wm.open_mainfile(filepath=blend)
scene, caustics = bpy.context.scene, "caustics" in frames
cycles, render = scene.cycles, scene.render
render.engine, cycles.device = "CYCLES", "CPU"
render.resolution_x, render.resolution_y, render.resolution_percentage = int(width), int(height), 100
render.use_compositing = render.use_sequencer = False
render.film_transparent = False
cycles.samples, cycles.denoiser, cycles.seed = abs(int(samples)), "OPENIMAGEDENOISE", int(seed)
cycles.use_denoising, cycles.use_adaptive_sampling = int(samples) > 0, False
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
cycles.caustics_reflective = cycles.caustics_refractive = caustics
if caustics:
    cycles.blur_glossy = 0
for kind in ("max", "diffuse", "glossy", "transmission"):
    setattr(cycles, kind + "_bounces", 128)  # ours has no limit
cycles.pixel_filter_type = "BOX"
cycles.filter_width = 1.0
for i, thing in enumerate(scene.objects):
    thing.pass_index = i + 1
    print("OBJECT", i + 1, thing.name)
view = bpy.context.view_layer
view.use_pass_object_index = True
settings = render.image_settings
if hasattr(settings, "media_type"):
    settings.media_type = "MULTI_LAYER_IMAGE"
settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "32", "ZIP"
for name in ("use_exr_interleave",):
    if hasattr(settings, name):
        setattr(settings, name, True)
render.use_file_extension = False
for frame in map(int, frames.split(":")[0].split(",")):
    scene.frame_set(frame)
    render.filepath = f"{out}/{frame}_{tail}.exr"
    bpy.ops.render.render(write_still=True)
"""


def cycles(blend, blender, out, frames, samples=128, seed=0, tail="cycles"):
    """Writes OUT/F_TAIL.exr; samples below 0: as many without OIDN. Returns the names of the objects by index."""
    script = out / "render.py"
    script.write_text(RENDER)
    words = [blend, out, frames, *SIZE, samples, seed, tail]
    line = (
        [blender, "-B", script, *words]
        if os.path.basename(blender).startswith("python")
        else [blender, "-b", "-P", script, "--", *words]
    )
    done = subprocess.run(list(map(str, line)), capture_output=True, text=True)
    found = {}
    for text in done.stdout.splitlines():
        if text.startswith("OBJECT "):
            _, number, name = text.split(" ", 2)
            found[int(number)] = name
    if done.returncode or not found:
        sys.exit(done.stderr[-2000:] + done.stdout[-2000:])
    return found


def channels(image, word):
    """R, G, B or another pass of Cycles' file."""
    names = [n for n in image.channels if n.split(".")[-2:-1] == [word]] or [n for n in image.channels if word in n]
    return {n.split(".")[-1]: image.channels[n] for n in names}


def mean(values, where):
    return sum(values[i] for i in where) / len(where)


def rows(ours, theirs, names):
    """(group, name, pixels, means of ours and of Cycles by channel, share of our brightest pixel), where Cycles has light."""
    width, height = SIZE
    rgb, index = channels(theirs, "Combined"), channels(theirs, "IndexOB") or channels(theirs, "Object Index")
    index = next(iter(index.values()))
    objects, tiles = {}, {}
    for y in range(height):
        for x in range(width):
            i = y * width + x
            tiles.setdefault((x * TILES[0] // width, y * TILES[1] // height), []).append(i)
            inner = (
                0 < x < width - 1
                and 0 < y < height - 1
                and all(index[i + s] == index[i] for s in (-1, 1, -width, width))
            )
            if inner:
                objects.setdefault(names.get(int(index[i]), "nothing"), []).append(i)
    for group, found in (("object", objects), ("tile", tiles)):
        for name, where in found.items():
            if len(where) < 12:
                continue
            a, b = ([mean(c[k], where) for k in "RGB"] for c in (ours.channels, rgb))
            yield group, name, len(where), a, b, max(
                max(ours.channels[k][i] for i in where) / max(len(where) * m, 1e-9) for k, m in zip("RGB", a)
            )


def main():
    blend, blender, out, frames = sys.argv[1:5]
    line = shlex.split(" ".join(map(shlex.quote, sys.argv[6:]))) if len(sys.argv) > 6 else []
    out = pathlib.Path(out).resolve()
    out.mkdir(parents=True, exist_ok=True)
    names = (
        cycles(blend, blender, out, frames)
        if not (out / "names").exists() or not os.environ.get("KEEP_CYCLES")
        else dict((int(n), name) for n, name in (t.split(" ", 1) for t in (out / "names").read_text().splitlines()))
    )
    (out / "names").write_text("\n".join(f"{n} {name}" for n, name in names.items()))
    numbers = list(map(int, frames.split(":")[0].split(",")))
    if line and not os.environ.get("KEEP_OURS"):
        more = [
            f"SIZE={SIZE[0]}x{SIZE[1]}",
            f"FRAMES={','.join(map(str, numbers))}",
            f"OUT={out}/ours",
            f"BIN={TOP}/build/release/bin",
        ]
        done = subprocess.run([*line, *more], cwd=out, capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stdout[-3000:] + done.stderr[-3000:])
    report(out, numbers, names)


def preview(out, number, ours, theirs):
    """Ours above, Cycles below, one exposure, sRGB."""
    rgb = channels(theirs, "Combined")
    both = {k: list(ours.channels[k]) + list(rgb[k]) for k in "RGB"}
    stacked = out / f"{number}_both.exr"
    exr.write(stacked, SIZE[0], 2 * SIZE[1], both)
    subprocess.run(
        [TOP / "build/release/bin/tempolux-info", "--png", out / f"{number}.png", stacked],
        check=True,
        capture_output=True,
    )


def report(out, numbers, names):
    worst = {}
    for number in numbers:
        ours, theirs = (exr.read(out / name) for name in (f"ours/frames/{number:04d}.exr", f"{number}_cycles.exr"))
        preview(out, number, ours, theirs)
        for group, name, pixels, a, b, brightest in rows(ours, theirs, names):
            worst.setdefault((group, name), []).append((number, pixels, a, b, brightest))
    for group in ("object", "tile"):
        print(f"{group}: ours / Cycles by channel, in frames {', '.join(map(str, numbers))}")
        lines = []
        for (kind, name), found in worst.items():
            if kind == group:
                ratios = [[x / y if y > 1e-4 else float("nan") for x, y in zip(a, b)] for _, _, a, b, _ in found]
                far = (
                    max(abs(r - 1) for row in ratios for r in row if r == r)
                    if any(r == r for row in ratios for r in row)
                    else 0
                )
                lines.append(
                    (
                        far,
                        name,
                        found[0][1],
                        ratios,
                        [(n, s) for n, pixels, _, _, s in found if s > max(0.2, 4 / pixels)],
                    )
                )
        lines.sort(reverse=True, key=lambda l: l[0])
        inside = sum(l[0] <= .1 for l in lines)
        print(f"  within 10 %: {inside} of {len(lines)}; within 3 %: {sum(l[0] <= .03 for l in lines)}")
        for far, name, pixels, ratios, single in lines:
            print(f"  {str(name):34} {pixels:6}  " + "   ".join(" ".join(f"{r:5.2f}" for r in row) for row in ratios)
                  + "".join(f"   one pixel is {s:.0%} of frame {n}" for n, s in single))


if __name__ == "__main__":
    main()

"""A room from Blender rendered by Cycles and by us, where Blender is installed: `make -f Makefile.example evidence PARTS=walls`."""
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "stress"))
import exr
from measure import Missing, figure

def blender():
    """The program, if it renders glTF: its importer wants numpy."""
    program = shutil.which("blender")
    if not program:
        raise Missing("Blender is not installed (Debian: apt-get install --no-install-recommends blender python3-numpy)")
    return program


def environment():
    """Debian's Python, which has numpy, before others."""
    return {**os.environ, "PATH": "/usr/bin:" + os.environ["PATH"]}


def render(program, image, scene, frame, size, samples, seed, sky="0,0,0", lights="COMPAT", smoke=(), threads=0):
    """(picture, CPU seconds), Blender's start and its reading of the file counted, as ours are. `image`: where; other words as cycles_render.py has them."""
    image.unlink(missing_ok=True)
    before = os.times()
    done = subprocess.run([program, "-b", "--factory-startup", "-noaudio", "-t", str(threads), "--python-use-system-env", "--python",
                           str(Path(__file__).with_name("cycles_render.py")), "--",
                           *map(str, (scene, frame, size, samples, seed, sky, lights, image, *smoke))], capture_output=True, text=True,
                          env=environment())
    after = os.times()
    if not image.exists():
        lines = [line for line in (done.stdout + done.stderr).splitlines() if "Error" in line]
        raise Missing(f"Blender rendered nothing: {lines[-1] if lines else 'no message'}")
    return exr.read(image), after.children_user - before.children_user + after.children_system - before.children_system


def inner_pixels(ids, width):
    """{object: indices of the pixels whose four neighbours show the same object}"""
    found = {}
    for n in range(width, len(ids) - width):
        if all(ids[n + step] == ids[n] for step in (-1, 1, -width, width)):
            found.setdefault(int(ids[n]), []).append(n)
    return found


def object_names(image):
    """{number as text: name} of the objects in our picture."""
    text = image.attributes.get("tempolux:objects", b"").decode(errors="replace")
    return dict(line.split(" ", 1) for line in text.splitlines() if " " in line)


def inner_means(ours, theirs, width):
    """{object: (pixels, our mean, theirs, error of the ratio of both by their scatter)} of pixels whose four neighbours show the same object."""
    grey = [[sum(v) / 3 for v in zip(*(image.channels[c] for c in "RGB"))] for image in (ours, theirs)]
    means = {}
    for number, places in inner_pixels(ours.channels["id.object"], width).items():
        pairs = [(grey[0][n], grey[1][n]) for n in places]
        a, b = (math.fsum(pair[k] for pair in pairs) for k in (0, 1))
        if a > 0 and b > 0:
            scatter = math.sqrt(math.fsum((y - x * b / a) ** 2 for x, y in pairs)) / b
            means[number] = len(pairs), a / len(pairs), b / len(pairs), scatter
    return means


def walls(bench):
    """The room of spheres, matte, exported by tempolux_export.py: mean light of what is matte, Cycles of the .blend over path tracing of the export."""
    program, folder, size = blender(), bench.out / "tmp", "160x90"
    if bench.tiny:
        raise Missing("short form")
    blend, exported, image = (folder / f"spheres{end}" for end in (".blend", ".glb", "_paths.exr"))
    base = [program, "-b", "--factory-startup", "-noaudio", "--python-use-system-env"]
    for words in ([*base, "-P", Path(__file__).with_name("blender_rooms.py"), "--", "spheres", blend, "matte"],
                  [*base, blend, "-P", bench.project / "pipelines" / "blender" / "tempolux_export.py", "--", exported],
                  [bench.bin / "frame-render", exported, "--frame", "12", "--size", size, "--integrator", "path", "--spp", "144", "--channels", "RGBA", "id",
                   "-o", image]):
        done = subprocess.run([str(word) for word in words], capture_output=True, text=True, env=environment())
        if done.returncode != 0:
            raise Missing((done.stdout + done.stderr).strip().splitlines()[-1])
    theirs, _ = render(program, folder / "cycles.exr", blend, 12, size, 144, 1)
    ours = exr.read(image)
    names = object_names(ours)
    found = inner_means(ours, theirs, 160)
    rows, met = [], True
    for number, (pixels_seen, a, b, error) in sorted(found.items(), key=lambda item: -item[1][0])[:7]:
        rows.append([names.get(str(number), str(number)), str(pixels_seen), f"{100 * (b / a - 1):+.1f} %", f"{100 * error:.1f} %"])
        met = met and abs(b / a - 1) <= max(0.03, 2 * error)
    return figure("a room from Blender beside Cycles", "3 % (or twice the pictures' noise)", ["object", "pixels", "Cycles / ours - 1", "noise"], rows, met,
                  ["160x90, frame 12, 144 samples each; objects seen in most pixels: all of them matte."], measured=f"{rows[0][0]} {rows[0][2]}")


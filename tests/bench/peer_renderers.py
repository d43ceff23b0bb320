"""Other renderers, where `make peers` has put them: each is a process that gets jobs and says what they cost (peers/*.py)."""

import array
import json
import os
import struct
import subprocess
from pathlib import Path

import exr
from measure import Missing

HERE = Path(__file__).resolve().parent / "peers"


def folder_of(bench, name):
    """Where a renderer is."""
    folder = bench.project / "build" / "peers" / name
    if not (folder / "done").exists():
        raise Missing(f"{name} is not in build/peers: make -f Makefile.example peers")
    return folder


class Peer:
    """A renderer that has read a scene."""

    def __init__(self, bench, name, first):
        python = folder_of(bench, name) / "bin" / "python"
        self.name, self.log = name, open(bench.out / "tmp" / f"{name}.log", "w")
        self.process = subprocess.Popen(
            [python, HERE / f"{name}_frames.py"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.log,
            text=True,
        )
        self.preparation = self.ask(first)

    def ask(self, job):
        """CPU seconds of a job."""
        print(json.dumps(job), file=self.process.stdin, flush=True)
        answer = self.process.stdout.readline()
        if not answer:
            raise Missing(f"{self.name} ended: {Path(self.log.name).read_text()[-300:].strip()}")
        return json.loads(answer)["cpu_s"]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def read_pfm(path):
    """(width, height, R, G, B planes from the top)"""
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        file.readline()
        values = array.array("f", file.read())
    rows = [values[3 * width * y:3 * width * (y + 1)] for y in reversed(range(height))]
    return width, height, [[v for row in rows for v in row[c::3]] for c in range(3)]


def write_pfm(path, width, height, planes):
    flat = [v for pixel in zip(*planes) for v in pixel]
    with open(path, "wb") as out:
        out.write(b"PF\n%d %d\n-1\n" % (width, height))
        for y in reversed(range(height)):
            out.write(struct.pack(f"<{3 * width}f", *flat[3 * width * y:3 * width * (y + 1)]))


def planes_of(file):
    return (
        [list(image.channels[c]) for image in [exr.read(file)] for c in "RGB"]
        if str(file).endswith(".exr")
        else read_pfm(file)[2]
    )


def oidn_in(folder):
    """The program of Open Image Denoise where the Python package pyoidn is below a folder; None where it is not."""
    program = next(Path(folder).glob("lib/python*/site-packages/pyoidn/oidn/bin/oidnDenoise"), None)
    if program:
        program.chmod(0o755)
    return program


def denoise(run, program, stem, out):
    """Open Image Denoise writes OUT from STEM.pfm, STEM.albedo.pfm and STEM.normal.pfm; run(words, variables) runs it."""
    words = ["--hdr", f"{stem}.pfm", "--alb", f"{stem}.albedo.pfm", "--nrm", f"{stem}.normal.pfm", "-o", out]
    run([program, *words], {"LD_LIBRARY_PATH": str(program.parents[1] / "lib")})


def denoised(bench, stem):
    """(planes of STEM.pfm after denoise(), its CPU seconds)"""
    program, out = oidn_in(folder_of(bench, "oidn")), f"{stem}.clean.pfm"
    before = os.times()
    denoise(bench.run, program, stem, out)
    after = os.times()
    return read_pfm(out)[2], after.children_user + after.children_system - before.children_user - before.children_system


def for_denoising(stem, image):
    """Writes our picture with channels albedo and N as the three files of denoise()."""
    for end, names in (
        ("", "RGB"),
        (".albedo", ("albedo.R", "albedo.G", "albedo.B")),
        (".normal", ("N.X", "N.Y", "N.Z")),
    ):
        write_pfm(
            f"{stem}{end}.pfm",
            image.width,
            image.height,
            [[v if v == v else 0.0 for v in image.channels[c]] for c in names],
        )


def flip(bench, reference, tests, exposure, width, height):
    """Mean FLIP of pictures (planes) against a reference; [] where it is not installed."""
    try:
        python = folder_of(bench, "oidn") / "bin" / "python"
    except Missing:
        return []
    files = [bench.out / "tmp" / f"flip-{i}.pfm" for i in range(len(tests) + 1)]
    for file, planes in zip(files, [reference, *tests]):
        write_pfm(file, width, height, planes)
    return [float(line) for line in bench.run([python, HERE / "flip_of.py", exposure, *files]).stdout.split()]

#!/usr/bin/env python3
"""The chain on smoke, S6 at frame 12, 320x180, against Cycles' reference and our path tracer: error, bias, thick pixels, CPU seconds.

    python3 tests/bench/smoke_chain.py build/release/bin --make-vdb build/release/tests/make-vdb [--seeds 8]

Each seed is a whole chain: photons, points, records, frame, smoke. RMSE has the noise of references taken out (their two halves); biases are
given with the standard error of the seeds' mean. "Moved": the same with the voxels half an edge farther along each axis, which is where Cycles
3.4 looks them up. Pixels of opacity above .1 are those of which the smoke takes out a tenth.

--cycles N: instead, Blender's Cycles (its importer of glTF wants python3-numpy) and our path tracer with N samples on this machine, one thread
each, in turns, two seeds: CPU seconds, mean squared error, their product; and the chain's seconds. Each against a reference of its own voxels:
Cycles against its own, we against our paths of --paths samples.
"""
import argparse
import math
import resource
import struct
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "stress")]
import cycles    # noqa: E402
import exr       # noqa: E402
import pipeline  # noqa: E402
import pixels    # noqa: E402

FRAME, SIZE = 12, "320x180"
CHAIN = {"photons": ["--photons", "300k", "--kinds", "caustic,indirect,volume"], "points": [], "records": [],
         "frame": ["--spp", 8, "--pixel-error", 0.02, "--channels", "RGBA,layers,Z"], "smoke": ["--spp", 4]}


def moved(source, folder, make_vdb, tempolux_vdb, voxels):
    """The file's voxels at places that many edges farther: lib/volume/vdb_pipe.h says what is read."""
    data = subprocess.run([tempolux_vdb], input=f"{source}\n\n".encode(), capture_output=True, check=True).stdout
    matrix, (count, name) = struct.unpack_from("<12d", data, 8), struct.unpack_from("<2Q", data, 104)
    blocks = [struct.unpack_from("<3i512f", data, 120 + name + i * 2060) for i in range(count)]
    low = [min(b[a] for b in blocks) for a in range(3)]
    size = [max(b[a] for b in blocks) + 8 - low[a] for a in range(3)]
    values = [0.0] * math.prod(size)
    for x0, y0, z0, *block in blocks:
        for i, value in enumerate(block):
            x, y, z = x0 - low[0] + i // 64, y0 - low[1] + i // 8 % 8, z0 - low[2] + i % 8
            values[(x * size[1] + y) * size[2] + z] = value
    corner = [matrix[5 * a] * (low[a] + voxels) + matrix[4 * a + 3] for a in range(3)]
    out = folder / "moved.vdb"
    out.unlink(missing_ok=True)
    subprocess.run([make_vdb, out, *map(str, (*size, matrix[0], *corner))], input=struct.pack(f"<{len(values)}f", *values), check=True)
    return out


class Runner:
    def __init__(self, options):
        self.bin, self.folder = options.bin.resolve(), options.folder

    def run(self, tool, *arguments):
        """CPU seconds."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([self.bin / tool, *map(str, arguments), "-q"], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def chain(self, common, stem, seed):
        """Frame and CPU seconds."""
        common = [*common, "--seed", seed]
        clear, size = stem + ".clear", ["--size", SIZE]
        spent = sum(pipeline.chain(self.run, common, clear, CHAIN["photons"], CHAIN["points"], [*size, *CHAIN["records"]],
                                   [*size, *CHAIN["frame"]], map_beside=True))
        spent += self.run("volume-compose", *common, "--photons", clear + ".photons", "--points", clear + ".irradpoints", "--base", clear + ".exr",
                          *CHAIN["smoke"], "-o", stem + ".exr")
        return exr.read(stem + ".exr"), spent

    def opacity(self, common, stem):
        """By pixel: a picture of 1 everywhere that says nothing of itself is dimmed by volume-compose."""
        clear = exr.read(stem + ".clear.exr")
        one = [1.0] * (clear.width * clear.height)
        exr.write(stem + ".one.exr", clear.width, clear.height, {"R": one, "G": one, "B": one, "Z": clear.channels["Z"]})
        self.run("volume-compose", *common, "--photons", stem + ".clear.photons", "--base", stem + ".one.exr", "-o", stem + ".dimmed.exr")
        dimmed = exr.read(stem + ".dimmed.exr")
        return [1 - (r - v) for r, v in zip(dimmed.channels["R"], dimmed.channels["volume.R"])]


def spread(values):
    mean = sum(values) / len(values)
    return mean, math.sqrt(sum((v - mean) ** 2 for v in values) / max(1, len(values) - 1) / len(values))


def of_pixels(image, chosen):
    return sum(sum(plane[i] for i in chosen) for plane in pixels.planes(image)) / (3 * len(chosen))


def against(name, frames, halves, thick):
    """One line of the table."""
    errors, noise = zip(*(pixels.squared_error(f, *halves) for f in frames))
    whole, half = pixels.mean_of_halves(*halves)
    bias, seeds = spread([pixels.mean(f) / whole - 1 for f in frames])
    in_smoke = sum(of_pixels(h, thick) for h in halves) / 2
    in_smoke_error = abs(of_pixels(halves[0], thick) - of_pixels(halves[1], thick)) / 2 / in_smoke
    thick_bias, thick_seeds = spread([of_pixels(f, thick) / in_smoke - 1 for f in frames])
    line = [f"{math.sqrt(max(0, sum(errors) / len(errors))):.4f} ({math.sqrt(noise[0]):.4f})", f"{100 * bias:+.2f} ± {100 * math.hypot(seeds, half / whole):.2f} %",
            f"{100 * thick_bias:+.2f} ± {100 * math.hypot(thick_seeds, in_smoke_error):.2f} %"]
    if "volume.R" in halves[0].channels:
        volume, half = pixels.mean_of_halves(*halves, "volume")
        share, seeds = spread([pixels.mean(f, "volume") / volume - 1 for f in frames])
        line.append(f"{100 * share:+.2f} ± {100 * math.hypot(seeds, half / volume):.2f} %")
    else:
        line.append("")
    print(f"| {name} | " + " | ".join(line) + " |", flush=True)


def beside_cycles(options, runner, shared, common):
    """Table of both path tracers and the chain."""
    stem = str(options.folder / "beside")
    runner.run("frame-render", *common, "--size", SIZE, "--integrator", "path", "--spp", options.paths, "--seed", 1000, "--halves", "-o", stem + ".exr")
    ours = [exr.read(f"{stem}_{h}.exr") for h in "ab"]
    theirs = [exr.read(shared / f"ref/S6_smoke_f{FRAME:04d}_{h}.exr") for h in "ab"]
    sides = {"Cycles": [], "our path tracer": [], "our chain": []}
    smoke = (shared / f"made/S6_smoke_vdb/smoke_{FRAME:04d}.vdb", 10, ".85,.85,.88")
    program = cycles.blender()
    for seed in (1, 2):
        image, spent = cycles.render(program, options.folder.resolve() / "cycles.exr", common[0], FRAME, SIZE, options.cycles, seed, smoke=smoke, threads=1)
        sides["Cycles"].append((image, spent, theirs))
        spent = runner.run("frame-render", *common, "--size", SIZE, "--integrator", "path", "--spp", options.cycles, "--seed", seed, "--threads", 1, "-o", stem + ".exr")
        sides["our path tracer"].append((exr.read(stem + ".exr"), spent, ours))
        image, spent = runner.chain([*common, "--threads", 1], stem, seed)
        sides["our chain"].append((image, spent, ours))
    print("| | CPU s | RMSE | CPU s x MSE | mean to its reference |\n|---|---:|---:|---:|---:|")
    for name, runs in sides.items():
        spent = sum(cpu for _, cpu, _ in runs) / len(runs)
        mse = sum(pixels.squared_error(image, *halves)[0] for image, _, halves in runs) / len(runs)
        mean = sum(pixels.mean(image) / pixels.mean_of_halves(*halves)[0] for image, _, halves in runs) / len(runs)
        print(f"| {name} | {spent:.2f} | {math.sqrt(mse):.4f} | {spent * mse:.4g} | {100 * (mean - 1):+.2f} % |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path)
    parser.add_argument("--make-vdb", default="make-vdb")
    parser.add_argument("--folder", type=Path, default=Path("smoke_chain"))
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--paths", type=int, default=384, help="of a pixel of our own reference")
    parser.add_argument("--cycles", type=int, default=0, help="samples a pixel beside Cycles, instead of the table of errors")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    runner = Runner(options)
    shared = HERE.parents[2] / "shared/scenes"
    scene, source = shared / "made/S6_smoke.glb", shared / f"made/S6_smoke_vdb/smoke_{FRAME:04d}.vdb"
    if options.cycles:
        return beside_cycles(options, runner, shared, [scene, "--frame", FRAME, "--volume", source, "--sigma-t", 10, "--albedo", ".85,.85,.88"])
    of_cycles = [exr.read(shared / f"ref/S6_smoke_f{FRAME:04d}_{h}.exr") for h in "ab"]
    tempolux_vdb = options.bin.resolve().parent / "modules/tempolux-vdb"
    files = {"as it is": source, "moved": moved(source, options.folder, options.make_vdb, tempolux_vdb, 0.5)}
    print("| voxels | against | RMSE (floor) | image | opacity above .1 | layer volume |\n|---|---|---:|---:|---:|---:|")
    spent = []
    for name, file in files.items():
        common = [scene, "--frame", FRAME, "--volume", file, "--sigma-t", 10, "--albedo", ".85,.85,.88"]
        stem = str(options.folder / name.replace(" ", "_"))
        frames = []
        for seed in range(options.seeds):
            frame, seconds = runner.chain(common, stem, seed)
            frames.append(frame)
            spent.append(seconds)
        thick = [i for i, opacity in enumerate(runner.opacity(common, stem)) if opacity > 0.1]
        runner.run("frame-render", *common, "--size", SIZE, "--integrator", "path", "--spp", options.paths, "--seed", 1000, "--halves", "--channels", "RGBA,layers",
                   "-o", stem + ".path.exr")
        paths = [exr.read(f"{stem}.path_{h}.exr") for h in "ab"]
        against(f"{name} | Cycles", frames, of_cycles, thick)
        against(f"{name} | our paths", frames, paths, thick)
        mean_path = exr.read(stem + ".path.exr")
        against(f"{name}, our paths | Cycles", [mean_path], of_cycles, thick)
    print(f"\nCPU s of a chain: {sum(spent) / len(spent):.2f}; pixels of opacity above .1: {len(thick)}")


if __name__ == "__main__":
    sys.exit(main())

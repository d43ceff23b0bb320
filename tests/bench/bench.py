#!/usr/bin/env python3
"""Measures the figures of RESULTS.md.

    make -f Makefile.example bench                       everything, about a quarter of an hour on two idle cores
    python3 tests/bench/bench.py --only threads,start    some parts again; the page keeps the others
    python3 tests/bench/bench.py --page                  the page alone, from what was measured before
    python3 tests/bench/everyscene.py --quick            a dozen scenes in some minutes, to compare two programs
"""
import argparse
import json
import os
import time
from pathlib import Path

import results_page
from measure import Bench, Missing, machine, walk_speed
from required import FIGURES, PEERS


def usual():
    """The parts that want no other renderer."""
    return [name for name in FIGURES if name not in PEERS]


def options():
    project = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=project / "build" / "release", help="build folder [build/release]")
    parser.add_argument("--out", type=Path, default=project / "out" / "bench", help="raw results, references [out/bench]")
    parser.add_argument("--results", type=Path, default=project / "RESULTS.md", help="the page [RESULTS.md]")
    parser.add_argument("--docs", type=Path, default=project / "docs", help="folder of results/, a page for each part [docs]")
    parser.add_argument("--only", help=f"parts, by comma [{','.join(usual())}; {','.join(PEERS)} with --peers]")
    parser.add_argument("--peers", action="store_true", help="also beside Cycles on this machine; wants Blender and numpy")
    parser.add_argument("--reference-samples", type=int, default=2048,
                        help="per pixel, of each reference; 8192 for errors below 0.001 [2048]")
    parser.add_argument("--tiny", action="store_true", help="tiny sizes: does every script still run?")
    parser.add_argument("--page", action="store_true", help="measure nothing, write the page")
    return project, parser.parse_args()


def measure(bench, name, peers):
    """One required figure; kept as JSON."""
    load = os.getloadavg()[0]
    begin = time.monotonic()
    bench.walk = walk_speed(bench)
    found = FIGURES[name](bench, peers)
    found |= {"machine": machine(bench), "load": f"{load:.1f}", "seconds": round(time.monotonic() - begin, 1),
              "date": time.strftime("%Y-%m-%d %H:%M", time.gmtime())}
    (bench.out / f"{name}.json").write_text(json.dumps(found, indent=1))
    print(results_page.table(found["header"], found["rows"]) + "".join(note + "\n" for note in found["notes"])
          + f"asked: {found['asked']}: {results_page.verdict(found['met'])} ({found['seconds']} s)", flush=True)


def main():
    project, args = options()
    bench = Bench(args.build.resolve(), args.out.resolve(), project, args.tiny, args.reference_samples)
    peers = json.loads((Path(__file__).parent / "peers.json").read_text())
    left_out = {}
    parts = args.only.split(",") if args.only else [*FIGURES] if args.peers else usual()
    for name in [] if args.page else parts:
        print(f"== {name}", flush=True)
        try:
            if name not in FIGURES:
                raise SystemExit(f"--only: no part is called '{name}'; there are {','.join(FIGURES)}")
            measure(bench, name, peers["peers"])
        except Missing as reason:
            print(f"left out: {reason}", flush=True)
            left_out[name] = str(reason)
    page = args.results.resolve()
    results_page.write(bench, page, args.docs.resolve(), FIGURES, "python3 tests/bench/bench.py", left_out)
    print(f"wrote {args.results}")
    readme = page.with_name("README.md")
    if readme.exists():
        readme.write_text(results_page.readme(readme.read_text(), args.docs.resolve() / "results"))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Stiff and extreme cases: runs the tools over scenes it makes, and prints what was expected and what came out.

    stress.py --bin build/release/bin                  all families, some minutes
    stress.py --bin build/release/bin --short          the form for every build, below 90 s
    stress.py --bin build/release/bin --long           also 10^7 triangles, 10^8 photons
    stress.py --bin build/release/bin --family light --markdown light.md

Prints case, quantity, expected, got, error, seconds, verdict: ok, refused as it should, skipped or FAIL. Exit 1 if
anything failed. Expected values are closed forms or laws; the tolerance is derived where it is used (family_*.py).
"""
import argparse
import dataclasses
import json
import pathlib
import sys
import tempfile
import time

import family_bad
import family_caches
import family_camera
import family_energy
import family_environment
import family_faults
import family_geometry
import family_glass
import family_images
import family_lens
import family_light
import family_media
import family_media_forms
import family_movers
import family_numbers
import family_openings
import family_photons
import family_scale
import family_time
import family_tools
import family_vision
from session import CASES, FULL, LONG, SHORT, Failed, Session

ORDER = [m.__name__ for m in (family_scale, family_light, family_openings, family_environment, family_energy,
                              family_glass, family_geometry, family_photons, family_media, family_media_forms, family_movers, family_caches, family_images, family_numbers, family_time,
                              family_camera, family_lens, family_vision,
                              family_bad, family_faults, family_tools)]
CASES.sort(key=lambda case: ORDER.index(case[3].__module__))
COLUMNS = ["case", "quantity", "expected", "got", "error", "seconds", "verdict"]


def cells(row):
    return [f"{v:.2f}" if isinstance(v, float) else v for v in dataclasses.astuple(row)]


def print_row(row):
    case, quantity, expected, got, error, seconds, verdict = cells(row)
    print(f"{case:<34} {quantity:<58} {expected:>22} {got:>14} {error:>20} {seconds:>7}  {verdict}", flush=True)


def markdown(rows):
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join(c.replace("|", "\\|") for c in cells(row)) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def run_case(session, family, name, function):
    session.begin(f"{family}: {name}")
    done = len(session.rows)
    try:
        function(session)
    except Failed as failure:
        session.row(str(failure), "", "", "", "FAIL")
    for row in session.rows[done:]:
        print_row(row)
    for file in session.scratch.iterdir():
        if file.is_file():
            file.unlink()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    families = list(dict.fromkeys(family for family, *_ in CASES))
    parser.add_argument("--bin", default="build/release/bin", help="folder of the tools [%(default)s]")
    parser.add_argument("--family", action="append", choices=families, help="only this one; may be repeated")
    parser.add_argument("--list", action="store_true", help="names of the families, nothing more")
    parser.add_argument("--case", default="", help="only cases with this in their name")
    parser.add_argument("--short", action="store_true", help="fewer samples, wider tolerances, below 90 s")
    parser.add_argument("--long", action="store_true", help="also what takes gigabytes or many minutes")
    parser.add_argument("--sanitized", action="store_true", help="tools with run-time checks: costs are not judged")
    parser.add_argument("--json", help="write the rows as JSON")
    parser.add_argument("--markdown", help="write the rows as a Markdown table")
    options = parser.parse_args()
    if options.list:
        print(*families, sep="\n")
        return 0
    if not pathlib.Path(options.bin, "photon-trace").exists():
        parser.error(f"--bin {options.bin}: no photon-trace in it")
    level = LONG if options.long else SHORT if options.short else FULL
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="stress.") as scratch:
        session = Session(pathlib.Path(options.bin).resolve(), scratch, level, options.sanitized)
        for family, name, least, function in CASES:
            if least <= level and options.case in name and (not options.family or family in options.family):
                run_case(session, family, name, function)
    rows = session.rows
    if options.json:
        pathlib.Path(options.json).write_text(json.dumps([dataclasses.asdict(r) for r in rows], indent=1) + "\n",
                                              encoding="utf-8")
    if options.markdown:
        pathlib.Path(options.markdown).write_text(markdown(rows), encoding="utf-8")
    failed = [row for row in rows if row.verdict == "FAIL"]
    counts = ", ".join(f"{sum(r.verdict == v for r in rows)} {v}" for v in dict.fromkeys(r.verdict for r in rows))
    print(f"{len(rows)} rows in {time.monotonic() - start:.0f} s: {counts}")
    for row in failed:
        print(f"FAIL {row.case}: {row.quantity}: {row.got}", file=sys.stderr)
    return 1 if failed or not rows else 0


if __name__ == "__main__":
    sys.exit(main())

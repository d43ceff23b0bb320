#!/usr/bin/env python3
"""Each minor version that a container's page lists has a file in its accept/ folder: minor_versions.py, in
tests/formats.

The readers' tests read all files of accept/, so a reader that no longer reads an old version fails there.
A version without a file would be read by no test: this fails, and names it.
"""

import re
import struct
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGES = HERE.parents[1] / "formats"


def listed(page):
    """Minor versions in the page's list of versions, whose lines begin with the number."""
    return {int(minor) for minor in re.findall(r"^1\.(\d+)   ", page.read_text(), re.M)}


def held(folder):
    """Minor versions of the container files of a folder: uint16 major, minor after the magic of 8 bytes."""
    found = set()
    for file in folder.iterdir():
        major, minor = struct.unpack_from("<HH", file.read_bytes(), 8)
        if major == 1 and not file.name.startswith("later-minor"):
            found.add(minor)
    return found


def main():
    missing, count = [], 0
    for page in sorted(PAGES.glob("*/*.md")):
        versions = listed(page)
        if not versions:
            continue
        count += len(versions)
        have = held(HERE / page.parent.name / "accept")
        missing += [f"{page.parent.name} 1.{minor}" for minor in sorted(versions - have)]
    if count < 6:
        missing.append("the lists of versions were not found on the pages")
    for what in missing:
        print(f"FAILED: no file in accept/ has {what}")
    print(f"{count} minor versions")
    return bool(missing)


if __name__ == "__main__":
    sys.exit(main())

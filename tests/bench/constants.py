#!/usr/bin/env python3
"""The named constants of lib and tools, and what depends on each.

docs/constants.md puts every constant into one class: `pictures` (pictures depend on it), `rare` (only pictures of rare
input do), `effort` (speed, memory, limits of input and figures in reports only) or `names`. Text, enums and salts of
random streams are always `names`, so the page does not list them.

  constants.py              one line per constant: class, file, name, value, first line of the comment
  constants.py --check      exit 1 unless page and source name the same constants and few enough shape pictures
  constants.py --count      constants per room and class
"""
import argparse
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "constants.md"
MOST_PICTURES = 144  # a ratchet: lower it with each constant that goes; the aim is 120
CLASSES = ("pictures", "rare", "effort", "names")
BASES = ("paper", "derived", "measured", "none")

DECLARATION = re.compile(r"\b(?:constexpr|const)\s+(?P<type>(?:[\w:]+(?:<[^;=]*?>)?[\s*&]+)+)(?P<rest>k[A-Z]\w*\s*(?:\[\w*\]\s*)*[={][^;]*)", re.S)
DECLARATOR = re.compile(r"(k[A-Z]\w*)\s*(?:\[\w*\]\s*)*(=\s*|(?={))")


class Constant:
    def __init__(self, file, name, type_, value, comment):
        self.file, self.name, self.type, self.value, self.comment = file, name, " ".join(type_.split()), value, comment

    @property
    def is_plainly_a_name(self):
        """A value without a number of its own (text, types, other constants), or a long hexadecimal one (a salt, a
        magic number, an index that means none)."""
        return not re.search(r"(?<!\w)\d", self.value) or bool(re.match(r"0x[0-9a-f]{8,}u?l*\b", self.value))


def without_comments(text):
    """Comments and the text in quotes become blanks, so that places stay."""
    blank = lambda m: re.sub(r"[^\n]", " ", m[0])
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', blank, text, flags=re.S)
    return text


def declarators(rest):
    """Yields (offset, name, value) of `kA = 1, kB = 2`: commas inside brackets do not separate."""
    depth, start = 0, 0
    parts = []
    for i, c in enumerate(rest):
        depth += (c in "({[") - (c in ")}]")
        if c == "," and depth == 0:
            parts.append((start, i))
            start = i + 1
    parts.append((start, len(rest)))
    for begin, end in parts:
        found = DECLARATOR.search(rest[begin:end])
        if found and not rest[begin:begin + found.start()].strip():
            yield begin + found.start(), found[1], " ".join(rest[begin + found.end():end].split())


def comment_of(lines, first, last):
    """First line of the comment: behind the declaration, else above it."""
    behind = re.search(r"//[/<]*\s*(.*)", lines[last])
    if behind:
        return behind[1]
    above = first - 1
    while above >= 0 and re.match(r"\s*//", lines[above]):
        above -= 1
    return re.sub(r"^\s*//[/<]*\s*", "", lines[above + 1]) if above + 1 < first else ""


def constants():
    for file in sorted([*ROOT.glob("lib/**/*.h"), *ROOT.glob("lib/**/*.cpp"), *ROOT.glob("tools/**/*.h"),
                        *ROOT.glob("tools/**/*.cpp")]):
        text = file.read_text()
        lines, code = text.split("\n"), without_comments(text)
        for found in DECLARATION.finditer(code):
            for offset, name, value in declarators(found["rest"]):
                at = found.start("rest") + offset
                first = code.count("\n", 0, found.start())
                line = code.count("\n", 0, at)
                yield Constant(file.relative_to(ROOT).as_posix(), name, found["type"], value,
                               comment_of(lines, first, line))


def classes_on(page):
    """The page's entries: {(file, name): (class, basis)}."""
    entries, of = {}, None
    for number, line in enumerate(page.read_text().split("\n"), 1):
        if line.startswith("## "):
            of = line[3:].lower()
        elif line.startswith("- ") and of in CLASSES:
            file, words = line[2:].split(": ")
            for entry in words.split(", " if of == "pictures" else " "):
                name, _, basis = entry.partition(" ")
                if (file, name) in entries or (of == "pictures") != (basis in BASES):
                    sys.exit(f"{page.name}:{number}: {entry} of {file} stands twice or has no known basis")
                entries[file, name] = of, basis
    return entries


def differences(found, entries):
    """What page and source do not agree on, as lines of text."""
    listed = {(c.file, c.name) for c in found if not c.is_plainly_a_name}
    for c in found:
        if (c.file, c.name) in listed and (c.file, c.name) not in entries:
            yield f"{c.file}: {c.name} = {c.value} has no class"
    for file, name in entries:
        if (file, name) not in listed:
            yield f"{file}: {name} is no constant that needs a class"
    pictures = sum(of == "pictures" for of, _ in entries.values())
    if pictures > MOST_PICTURES:
        yield f"{pictures} constants shape pictures; {MOST_PICTURES} are allowed"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--count", action="store_true")
    arguments = parser.parse_args()
    found, entries = list(constants()), classes_on(PAGE)
    of = lambda c: entries.get((c.file, c.name), ("names" if c.is_plainly_a_name else "?", ""))
    if arguments.check:
        wrong = list(differences(found, entries))
        print(*(f"docs/constants.md: {line}" for line in wrong), sep="\n", end="\n" if wrong else "")
        return bool(wrong)
    if arguments.count:
        rooms = collections.Counter(("/".join(c.file.split("/")[:2]) if c.file.startswith("lib") else "tools", of(c)[0])
                                    for c in found)
        for room in [*sorted({room for room, _ in rooms}), "all"]:
            counts = [sum(n for (r, o), n in rooms.items() if o == cls and room in (r, "all")) for cls in CLASSES]
            print(f"{room:16}", *(f"{cls} {n:4}" for cls, n in zip(CLASSES, counts)))
        print("basis:", *(f"{basis} {n}" for basis, n in collections.Counter(
            of(c)[1] for c in found if of(c)[0] == "pictures").most_common()))
        return 0
    for c in found:
        print(*of(c), f"{c.file}: {c.name} = {c.value[:60]}  // {c.comment}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

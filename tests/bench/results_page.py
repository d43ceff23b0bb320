"""RESULTS.md, one page, and docs/results, a file for each part: from what the measurements left in the output folder, and where that
has nothing or something older, from those files as they were. Nothing is typed by hand."""
import json
import re

from judged_code import MOST_CHANGES, changes_since

LINES = 200            # of RESULTS.md at most
VERDICTS = {"not judged here": None, "met": True, "**missed**": False}
HEAD = re.compile(r"# (?P<title>.*)\n\n`.* --only \S+` · (?P<machine>.*) · load [^·\n]*(?: · (?P<date>\S+ \S+))?\n\n"
                  r"Asked: (?P<asked>.*)\. (?P<said>.*)\.(?: Measured: (?P<measured>.*)\.)?\n")


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def verdict(met):
    return "not judged here" if met is None else "met" if met else "**missed**"


# ---- a part's own file

def section(name, found, command):
    """Text of docs/results/NAME.md; HEAD reads its beginning."""
    if "text" in found:
        return found["text"]
    text = f"# {found['title']}\n\n`{command} --only {name}` · {found['machine']} · load {found['load']} · {found.get('date', '- -')}\n\n"
    measured = f" Measured: {found['measured']}." if found.get("measured") else ""
    text += f"Asked: {found['asked']}. {verdict(found['met']).capitalize()}.{measured}\n\n" + table(found["header"], found["rows"])
    for note in found["notes"]:
        text += f"\n{note}\n"
    return text + "\n"


def kept(file):
    """What an earlier run wrote of a part; None if nothing."""
    if not file.exists():
        return None
    text = file.read_text()
    head = HEAD.match(text)
    if not head:
        raise SystemExit(f"{file}: its head is not as section() writes it; measure the part again, or remove the file")
    said = head["said"].lower() if head["said"].lower() in VERDICTS else head["said"]
    return {**head.groupdict(), "met": VERDICTS[said], "text": text, "measured": head["measured"] or ""}


def latest(bench, docs, name):
    """The newer of the last measurement here and what the page's file has, good or bad."""
    file, before = bench.out / f"{name}.json", kept(docs / "results" / f"{name}.md")
    here = json.loads(file.read_text()) if file.exists() else None
    if not here or not before:
        return here or before
    return before if (before["date"] or "") > here.get("date", "") else here


# ---- the README

DEMO_MARKS = "<!-- written by tests/bench/bench.py, --only demo -->\n", "<!-- end of demo -->\n"


def readme(text, results):
    """The README's text with the cost of its demo; as it is if either lacks it."""
    begin, end = (text.find(mark) for mark in DEMO_MARKS)
    page = (results / "demo.md").read_text() if (results / "demo.md").exists() else ""
    found = {quality: re.search(rf"^\| {quality} \| (\S+) \| (\S+) \| (\S+) \|", page, re.M) for quality in ("final", "draft")}
    if begin < 0 or end < 0 or not all(found.values()):
        return text
    frame, whole, disk = found["final"].groups()
    return (text[:begin] + DEMO_MARKS[0] + f"They cost {float(whole) / 60:.1f} CPU minutes in all, {frame} CPU seconds a frame (`QUALITY=draft`: "
            f"{found['draft'].group(1)}), and {disk} GB of disk.\n" + text[end:])


# ---- the page

def said(bench, name, found):
    """(verdict, commit of the measurement and its age). A verdict on code that has changed too often since is expired."""
    commit = found["machine"].rsplit(" ", 1)[-1]
    newer = changes_since(bench.project, commit, name)
    if newer is None:
        return verdict(found["met"]), f"{commit}, age unknown"
    text = verdict(found["met"])
    if newer > MOST_CHANGES and found["met"] is not None:
        text = f"expired ({text})"
    return text, f"{commit}, {newer} changes ago" if newer else commit


def measured(found):
    """What was measured, as it says itself or as the first row of its table does: its name and its last two columns."""
    if found.get("measured"):
        return found["measured"]
    lines = [line[2:-2].split(" | ") for line in re.findall(r"^\|.*\|$", section("", found, ""), re.M)]
    if len(lines) < 3:
        return ""
    header, _, row = lines[:3]
    return f"{row[0]}: " + ", ".join(f"{name} {cell}" for name, cell in list(zip(header, row))[1:][-2:])


def summary(bench, found, left_out, link):
    """A row for each part whose verdict still holds."""
    rows = []
    for name, f in found.items():
        judged, when = said(bench, name, f) if f else ("expired", "")
        if not judged.startswith("expired"):
            rows.append([f"[{f['title']}]({link}/{name}.md)", f["asked"], measured(f), judged,
                         "; not again: ".join(filter(None, (when, left_out.get(name))))])
    return "## Required figures\n\n" + table(["what", "asked", "measured", "verdict", "at commit"], rows) + "\n"


def write(bench, page, docs, figures, command, left_out):
    """The page and all files beside it. `left_out`: why a part was not measured this time."""
    results = docs / "results"
    results.mkdir(parents=True, exist_ok=True)
    found = {name: latest(bench, docs, name) for name in figures}
    for name, f in found.items():
        if f:
            (results / f"{name}.md").write_text(section(name, f, command).rstrip("\n") + "\n")
    link = results.relative_to(page.parent) if results.is_relative_to(page.parent) else results
    quick = results / "every-scene-quick.md"  # everyscene.py --quick --report writes it
    beside = f"Seen error beside path tracing, scene by scene: [{quick.name}]({link}/{quick.name}).\n" if quick.is_file() else ""
    text = f"""# Results

`{command}` writes this page; `--only NAME` measures one part again. Each row is the last measurement of a part; its
page in {link} has all numbers. A row goes after {MOST_CHANGES} changes of the code that it judges.
{beside}
CPU seconds are user and system time of all threads and processes. Processors differ in speed, so limits in seconds are for normalised
CPU seconds: measured ones times the rate of the bare walk (Embree alone on S2, tests/bench/bare_walk, million photons per CPU second of
one thread, measured in the same run) divided by 5.

"""
    text += summary(bench, found, left_out, link)
    text = text.rstrip("\n") + "\n"
    if text.count("\n") > LINES:
        raise SystemExit(f"{page}: {text.count(chr(10))} lines, more than {LINES}: shorten what results_page.py puts there")
    page.write_text(text)

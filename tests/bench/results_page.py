"""RESULTS.md, one page, and docs/results, a file for each part: from what the measurements left in the output folder, and where that
has nothing or something older, from those files as they were. Nothing is typed by hand."""
import json
import re
import shutil

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
    if "more" in found:
        more = found["more"]
        text += f"\n<details><summary>{more['title']}</summary>\n\n{table(more['header'], more['rows'])}\n</details>\n"
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


# ---- curves

def curves(bench, docs, command):
    """Writes docs/results/curves.md and copies the plots, if the sweep has been measured here."""
    report, made = bench.out / "report", bench.out / "sweep.json"
    if not made.exists():
        return
    made = json.loads(made.read_text())
    text = (report / "report.md").read_text().split("\n", 1)[1]
    text = re.sub(r"\]\(([^)]*\.svg)\)", r"](../\1)", text)
    text = re.sub(r"^### (.*)\n\n((?:\|.*\n)+)", long_tables, text, flags=re.M)
    head = f"{made['machine']} · load {made['load']} · {made.get('date', '- -')}"
    page = docs / "results" / "curves.md"
    if made.get("only") and page.exists():
        text = merged(page.read_text(), text, f"`{command} --only sweep --scenes '{made['only']}'`, references of {made['reference_samples']} samples · {head}")
    else:
        text = f"""# Error against run time

`{command} --only sweep` · {head}

Each scene is swept over samples per pixel (path tracing), over photons that are looked up directly (photon-trace, then
frame-render with 16 samples per pixel), and over the parameters of final gathering with the irradiance cache
(photon-trace, irradcache-build, frame-render --irradcache): photons, gather rays, error bound of the cache, each alone
with the others as by default and `--pixel-error 0.005`, and all together in six steps, pixel samples with them. Error: RMSE of linear radiance at 320x180 against the two halves of a
path-traced reference of {made["reference_samples"]} samples per pixel, whose noise is taken out. Cost: CPU seconds of all
processes, loading and writing included. A Monte Carlo curve falls with slope -0.5; one that flattens has reached its bias,
or the noise of what is not swept (the 16 samples of direct light). With k fixed more photons shrink only the blur; with k
growing as their cube root (100 at 10^5) both noise and blur fall.
""" + text
    page.write_text(text)
    for plot in report.glob("*.svg"):
        shutil.copy(plot, docs / plot.name)
    for old in docs.glob("error-*.svg"):
        if f"](../{old.name})" not in text:
            old.unlink()


def merged(page, text, head):
    """The page with the scenes of `text` in place of those of the same name, or behind the others; each says how it was measured."""
    sections = {part.split("\n", 1)[0]: part for part in re.split(r"^(?=## )", page, flags=re.M)}
    for part in re.split(r"^(?=## )", text, flags=re.M)[1:]:
        title, rest = part.split("\n", 1)
        sections[title] = f"{title}\n\n{head}\n{rest}"
    return "\n".join(part.rstrip("\n") + "\n" for part in sections.values())


def long_tables(match):
    heading, rows = match.group(1), match.group(2)
    if rows.count("\n") <= 14:
        return f"### {heading}\n\n{rows}"
    return f"<details><summary>{heading}</summary>\n\n{rows}\n</details>\n"


def plots(docs, page):
    """The plots side by side, and where their numbers are."""
    found = sorted(docs.glob("error-*.svg"))
    if not found or not (docs / "results" / "curves.md").exists():
        return ""   # not measured: --only sweep
    folder = docs.relative_to(page.parent) if docs.is_relative_to(page.parent) else docs
    made = re.search(r"commit (\S+)", (docs / "results" / "curves.md").read_text())
    return (f"## Error against run time\n\nAll runs, slopes and floors: [curves.md]({folder}/results/curves.md), at commit "
            f"{made.group(1) if made else 'unknown'}.\n\n" + "\n".join(f"![{plot.stem}]({folder}/{plot.name})" for plot in found) + "\n\n")


# ---- the README

DEMO_MARKS = "<!-- written by tests/bench/bench.py, --only demo -->\n", "<!-- end of demo -->\n"
PEERS_NOISE = 0.002    # of the reference that the peers' errors are against


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


def beside_peers(results, peers):
    """Rows of the classic Cornell box, ours and others': CPU seconds, error with the noise of a reference such as theirs and without,
    bias. Others' errors without it are at least what taking off PEERS_NOISE leaves: their reference's noise is that or less."""
    file = results / "cornell.md"
    ours = re.findall(r"^\| PC \|(.*)\|$", file.read_text(), re.M) if file.exists() else []
    rows = []
    for line in ours:
        _asked, rmse, cpu, bias, _reached, settings = (cell.strip() for cell in line.split("|"))
        raw = (float(rmse) ** 2 + PEERS_NOISE ** 2) ** 0.5
        rows.append([f"tempolux, {settings}", cpu, f"{raw:.4f}"[1:], f"{float(rmse):.5f}"[1:], bias.split(" +-")[0]])
    for peer in peers:
        least = [max(0.0, float(v) ** 2 - PEERS_NOISE ** 2) ** 0.5 for v in peer["rmse"].split(" / ")]
        rows.append([peer["work"], peer["cpu_s"], peer["rmse"], "at least " + " / ".join(f"{v:.4f}"[1:] for v in least), peer["bias"]])
    return table(["", "CPU s", "RMSE, raw", "RMSE without the reference's noise", "bias"], rows) if ours else ""


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


def summary(bench, found, figures, left_out, command, link):
    """A row for each required figure whose verdict still holds; below the names of the others."""
    rows, others = [], []
    for name, f in found.items():
        judged, when = said(bench, name, f) if f else ("expired", "")
        if judged.startswith("expired"):
            others.append(f"{name} ({left_out[name]})" if name in left_out else name)
            continue
        rows.append([f"[{f['title']}]({link}/{name}.md)", f["asked"], measured(f), judged,
                     "; not again: ".join(filter(None, (when, left_out.get(name))))])
    text = "## Required figures\n\n" + table(["what", "asked", "measured", "verdict", "at commit"], rows) + "\n"
    return text + (f"No current figure: {', '.join(others)}. `{command} --only NAME` measures one.\n\n" if others else "")


def write(bench, page, docs, peers, figures, command, left_out):
    """The page and all files beside it. `left_out`: why a part was not measured this time. `peers`: of peers.json."""
    results = docs / "results"
    results.mkdir(parents=True, exist_ok=True)
    curves(bench, docs, command)
    found = {name: latest(bench, docs, name) for name in figures}
    for name, f in found.items():
        if f:
            (results / f"{name}.md").write_text(section(name, f, command).rstrip("\n") + "\n")
    link = results.relative_to(page.parent) if results.is_relative_to(page.parent) else results
    quick = results / "every-scene-quick.md"  # everyscene.py --quick --report writes it
    beside = f"Seen error beside path tracing, scene by scene: [{quick.name}]({link}/{quick.name}).\n" if quick.is_file() else ""
    text = f"""# Results

Written by `{command}` (tests/bench/bench.py); every number comes out of it, `--only NAME` measures one part again. Details: {link}, a file for each part.
{beside}
CPU seconds are user and system time of all threads and processes. Normalised: x (bare walk measured in the same run, million photons
per CPU second of one thread: tests/bench/bare_walk, Embree alone on S2) / 5; absolute limits are in these, comparisons are of one run. Rows called
preset are the shipped ones, the same for every scene; a row with settings of its own says so. A verdict is the latest run's; after {MOST_CHANGES} changes
of the code that it judges its row goes.

"""
    text += summary(bench, found, figures, left_out, command, link)
    every = bench_notes(found.get("everyscene"))
    if every:
        text += f"## Every scene, preset final against our path tracer\n\n{every}\n"
    rows = beside_peers(results, peers["cornell"])
    if rows:
        text += f"## Beside other renderers: classic Cornell box, 256x256\n\nOthers: {peers['source_cornell']}.\n\n{rows}\n"
    text += plots(docs, page)
    text = text.rstrip("\n") + "\n"
    if text.count("\n") > LINES:
        raise SystemExit(f"{page}: {text.count(chr(10))} lines, more than {LINES}: shorten what results_page.py puts there")
    page.write_text(text)


def bench_notes(found):
    """The sentences of part everyscene, as a list."""
    if not found:
        return ""
    notes = found["notes"] if "notes" in found else re.findall(r"^(?!\||#|`|Asked:|<)(\S.*)$", found["text"], re.M)
    return "".join(f"- {note}\n" for note in notes)

"""RESULTS.md and its figures, from what the measurements left in the output folder, and what is not there from the page as it
was. Nothing is typed by hand."""
import json
import re
import shutil
import subprocess


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def verdict(met):
    return "not judged here" if met is None else "met" if met else "**missed**"


def section(name, found, command):
    if "text" in found:
        return found["text"]
    text = f"### {found['title']}\n\n`{command} --only {name}` · {found['machine']} · load {found['load']}\n\n"
    text += f"Asked: {found['asked']}. {verdict(found['met']).capitalize()}.\n\n" + table(found["header"], found["rows"])
    for note in found["notes"]:
        text += f"\n{note}\n"
    if "more" in found:
        more = found["more"]
        text += f"\n<details><summary>{more['title']}</summary>\n\n{table(more['header'], more['rows'])}\n</details>\n"
    return text + "\n"


CURVES, FIGURES_IN_FULL = "## Error against run time\n", "## Figures in full\n"
VERDICTS = {"not judged here": None, "met": True, "**missed**": False}


def kept(page):
    """What an earlier page says of parts that the output folder does not know: {name: what section() was given, and its text}."""
    if not page.exists():
        return {}
    sections = re.split(r"^(?=### )", page.read_text().partition(FIGURES_IN_FULL)[2], flags=re.M)
    found = {}
    for text in sections[1:]:
        head = re.match(r"### (.*)\n\n`.* --only (\S+)` · (.*) · load .*\n\nAsked: (.*)\. (.*)\.\n", text)
        if not head:
            raise SystemExit(f"{page}: cannot keep '{text.splitlines()[0]}': its head is not as section() writes it")
        title, name, machine, asked, said = head.groups()
        found[name] = {"title": title, "machine": machine, "asked": asked, "text": text.rstrip("\n") + "\n\n",
                       "met": VERDICTS.get(said, VERDICTS.get(said.lower()))}
    return found


def kept_curves(page):
    """The curves of an earlier page; "" if it has none."""
    text = page.read_text() if page.exists() else ""
    begin, end = text.find(CURVES), text.find(FIGURES_IN_FULL)
    return text[begin:end] if 0 <= begin < end else ""


def curves(bench, docs, page, command):
    """error-report's tables, its plots copied to docs; as they were, if there are none."""
    report = bench.out / "report"
    if not (bench.out / "sweep.json").exists():
        return kept_curves(page)
    made = json.loads((bench.out / "sweep.json").read_text())
    docs.mkdir(parents=True, exist_ok=True)
    for old in docs.glob("error-*.svg"):
        old.unlink()
    for plot in report.glob("*.svg"):
        shutil.copy(plot, docs / plot.name)
    link = str(docs.relative_to(page.parent)) if docs.is_relative_to(page.parent) else str(docs)
    text = (report / "report.md").read_text().split("\n", 1)[1]
    text = re.sub(r"\]\(([^)]*\.svg)\)", rf"]({link}/\1)", text)
    text = re.sub(r"^### (.*)\n\n((?:\|.*\n)+)", long_tables, text, flags=re.M)
    return CURVES + f"""
`{command} --only sweep` · {made['machine']} · load {made['load']}; every run: report/report.csv in its output folder

Each scene is swept over samples per pixel (path tracing), over photons that are looked up directly (photon-trace, then
frame-render with 16 samples per pixel), and over the parameters of final gathering with the irradiance cache
(photon-trace, irradcache-build, frame-render --irradcache): photons, gather rays, error bound of the cache, each alone
with the others as by default and `--pixel-error 0.005`, and all together in six steps, pixel samples with them. Error: RMSE of linear radiance at 320x180 against the two halves of a
path-traced reference of {made["reference_samples"]} samples per pixel, whose noise is taken out. Cost: CPU seconds of all
processes, loading and writing included. A Monte Carlo curve falls with slope -0.5; one that flattens has reached its bias,
or the noise of what is not swept (the 16 samples of direct light). With k fixed more photons shrink only the blur; with k
growing as their cube root (100 at 10^5) both noise and blur fall.
""" + text + "\n"


MARKS = "<!-- written by tests/bench/bench.py from RESULTS.md and peers.json -->\n", "<!-- end -->\n"


DEMO_MARKS = "<!-- written by tests/bench/bench.py, --only demo -->\n", "<!-- end of demo -->\n"


def demo_cost(text, page):
    """The README's text with the cost of its demo as the page has it; as it is if either lacks it."""
    begin, end = (text.find(mark) for mark in DEMO_MARKS)
    found = {quality: re.search(rf"^### The demo\n(?:[^#|].*\n|\n|\| quality.*\n|\|---.*\n|\| final .*\n)*?\| {quality} \| (\S+) \| (\S+) \| (\S+) \|",
                                page, re.M) for quality in ("final", "draft")}
    if begin < 0 or end < 0 or not all(found.values()):
        return text
    frame, whole, disk = found["final"].groups()
    return (text[:begin] + DEMO_MARKS[0] + f"A frame costs {frame} CPU seconds (draft: {found['draft'].group(1)}), all 48 together "
            f"{whole} CPU seconds and {disk} GB of disk.\n" + text[end:])


def readme(text, page, peers):
    """The README's text with the cost of its demo and its rows of the Cornell box, which are those of the page `page`; as it is
    where either lacks them."""
    text = demo_cost(text, page)
    begin, end = (text.find(mark) for mark in MARKS)
    ours = re.search(r"^### Classic Cornell box.*\n(?:[^|#].*\n|\n)*\| scene.*\n\|---.*\n((?:\|.*\n)+)", page, re.M)
    if begin < 0 or end < 0 or not ours:
        return text
    rows = []
    for line in ours.group(1).splitlines():
        _scene, _asked, rmse, cpu, bias, _reached, settings = (cell.strip() for cell in line.strip("|").split("|"))
        rows.append([f"tempolux, {settings}", cpu, rmse.replace("0.", ".", 1), bias.split(" +-")[0]])
    rows += [[peer["work"], peer["cpu_s"], peer["rmse"], peer["bias"]] for peer in peers]
    return text[:begin] + MARKS[0] + table(["", "CPU s", "RMSE", "bias"], rows) + text[end:]


def long_tables(match):
    heading, rows = match.group(1), match.group(2)
    if rows.count("\n") <= 14:
        return f"### {heading}\n\n{rows}"
    return f"<details><summary>{heading}</summary>\n\n{rows}\n</details>\n"


def age(bench, machine):
    """The commit of a measurement, and how many since then have changed what is measured."""
    commit = machine.rsplit(" ", 1)[-1]
    log = subprocess.run(["git", "-C", str(bench.project), "log", "--oneline", f"{commit}..HEAD", "--", "formats", "lib", "tools",
                          "Makefile.example"], capture_output=True, text=True)
    if log.returncode != 0:
        return f"{commit}, age unknown"
    newer = len(log.stdout.splitlines())
    return f"{commit}, {newer} changes ago" if newer else commit


def summary(bench, found, figures, left_out, command):
    """A row for each required figure, those too that have not been measured."""
    rows = [[f["title"], f["asked"], verdict(f["met"]), "; not again: ".join(filter(None, (age(bench, f["machine"]), left_out.get(name))))] if f else
            [figures[name].__doc__.splitlines()[0].rstrip("."), f"`{command} --only {name}`", "**not measured**",
             left_out.get(name, "")] for name, f in found.items()]
    return "## Required figures\n\n" + table(["what", "asked", "verdict", "at commit"], rows) + "\n"


def write(bench, page, docs, peers_source, figures, command, left_out):
    """`left_out`: why a part was not measured this time."""
    text = f"""# Results

Written by `{command}` (tests/bench/bench.py); every number below comes out of it, `--only NAME` measures one part again.
CPU seconds are user and system time of all threads; bare walk: the processor's speed, photons that tests/bench/bare_walk, Embree alone, sends through S2 in a CPU second of one thread. Cycles' rows: {peers_source}.

"""
    files = {name: bench.out / f"{name}.json" for name in figures}
    before = kept(page)
    found = {name: json.loads(file.read_text()) if file.exists() else before.get(name) for name, file in files.items()}
    text += summary(bench, found, figures, left_out, command)
    text += curves(bench, docs, page, command) or f"{CURVES}\nNot measured: `{command} --only sweep`\n\n"
    text += FIGURES_IN_FULL + "\n" + "".join(section(name, f, command) for name, f in found.items() if f)
    page.write_text(text.rstrip("\n") + "\n")

"""RESULTS.md, one page, worst first, and docs/results/NAME.md with all numbers of a part: both from the JSON of the parts."""
import re

SECTIONS = {"papers": "The systems of the two papers", "curves": "Error against run time", "steady": "Steadiness",
            "stiff": "Stiff and extreme cases", "leaving": "Leaving out", "speed": "Speed and growth"}
LINES = 200            # of RESULTS.md at most
ORDER = {False: 0, None: 1, True: 2}


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def verdict(met):
    return "not judged" if met is None else "met" if met else "**missed**"


def told(row):
    return (table(row["header"], row["rows"]) + "".join(note + "\n" for note in row["notes"])
            + f"asked: {row['asked']}: {verdict(row['met'])}: {measured(row)} ({row['cpu_s']:.0f} CPU s)")


def measured(row):
    """What was measured, as it says itself or as the first row of its table does: its name and its last two columns."""
    if row.get("measured") or not row["rows"]:
        return row.get("measured", "")
    first = row["rows"][0]
    return f"{first[0]}: " + ", ".join(f"{name} {cell}" for name, cell in list(zip(row["header"], first))[1:][-2:])


def when(row):
    """Commit of the measurement, and whether it still holds."""
    text = row["commit"] + (f", accepted at {row['accepted']}" if row.get("accepted") else "")
    return text + (f"; stale since {row['stale']['since']}" if row.get("stale") else "")


def worst_first(row):
    """Missed before not judged before met; then by what was reached over what was asked."""
    return ORDER[row["met"]], row.get("worth") if row.get("worth") is not None else 1


def changes_of_chains(what):
    """A line of a list for each chain, from canaries.differences()."""
    chains = {}
    for change in what:
        chain, _, words = change.partition(": ")
        chains.setdefault(chain, []).append(words)
    for chain, changes in chains.items():
        files = [words.removesuffix(" differ") for words in changes if words.endswith(" differ")]
        other = [words for words in changes if not words.endswith(" differ")]
        made = [f"it makes other files ({', '.join(files)})"] if files else []
        yield f"- chain `{chain}`: {'; '.join(made + other)}\n"


def page_of(row):
    """docs/results/NAME.md"""
    text = (f"# {row['title']}\n\n`{row['command']}` · {row['machine']} · load {row['load']} · {row['date']}\n\n"
            f"- asked: {row['asked']}\n- measured: {measured(row)}\n- verdict: {verdict(row['met'])}\n\n")
    if row.get("paper"):
        text += f"The paper reports: {row['paper']}.\n\n"
    if row.get("stale"):
        text += ("This page is stale. The tree has changed since the measurement, first at commit "
                 f"{row['stale']['since']}.\n"
                 "A canary is a small chain of commands that stands for the whole measurement (tests/bench/canaries.py).\n"
                 "These canaries have changed since the measurement:\n\n"
                 f"{''.join(changes_of_chains(row['stale']['what']))}\n")
    return text + table(row["header"], row["rows"]) + "".join(f"\n{note}\n" for note in row["notes"])


def section(name, rows, parts, link, left_out):
    """A table of the page; parts that were never measured stand in it, too."""
    found = sorted((row for row in rows.values() if row["section"] == name), key=worst_first)
    lines = [[f"[{row['title']}]({link}/{row['name']}.md)", row.get("paper", ""), row["asked"], measured(row), verdict(row["met"]), when(row)] for row in found]
    lines += [[part.judges, "", "", f"not measured yet: `PARTS={part.name}`" + (f"; {left_out[part.name]}" if part.name in left_out else ""), "-", ""]
              for part in parts.values() if part.section == name and part.name not in rows]
    if not any(line[1] for line in lines):
        lines = [line[:1] + line[2:] for line in lines]
        return f"## {SECTIONS[name]}\n\n" + table(["what", "asked", "measured", "verdict", "at commit"], lines) + "\n"
    return f"## {SECTIONS[name]}\n\n" + table(["what", "the paper", "asked", "measured", "verdict", "at commit"], lines) + "\n"


def head(rows, parts, heads):
    stale = sum(bool(row.get("stale")) for row in rows.values())
    counts = {word: sum(row["met"] is met for row in rows.values()) for word, met in (("missed", False), ("not judged", None), ("met", True))}
    text = (f"{len(rows)} of {len(parts)} rows are measured: " + ", ".join(f"{n} {word}" for word, n in counts.items())
            + f"; {stale} of them are stale.\n")
    return text + "".join(f"{line}\n" for line in heads)


def medians(rows):
    """Sentences of the head that parts of a kind make together."""
    said = []
    for key, words in (("equal_error", "CPU of Cycles 5 with OIDN over ours at equal seen error"), ("steadier", "Cycles' noise from frame to frame over ours")):
        values = sorted(row[key] for row in rows.values() if row.get(key))
        if values:
            middle = len(values) // 2
            median = values[middle] if len(values) % 2 else (values[middle - 1] + values[middle]) / 2
            said.append(f"{words}: median {median:.2g} of {len(values)} scenes, {values[0]:.2g} to {values[-1]:.2g}.")
    return said


def write(rows, parts, page, folder, left_out):
    for name, row in rows.items():
        (folder / f"{name}.md").write_text(page_of(row).rstrip("\n") + "\n")
    link = folder.relative_to(page.parent) if folder.is_relative_to(page.parent) else folder
    text = f"""# Results

{head(rows, parts, medians(rows))}
`make -f Makefile.example evidence` writes this page; `PARTS=NAME` measures a row again. A row is current while its canary, a small chain
that is run by continuous integration, makes the same data with as many instructions; else it is marked as stale and stays. Missed rows
stand first. Each row's page in {link} has all numbers, its command and its machine.

**Words.** CPU seconds are user and system time of all threads and processes. Processors differ in speed, so limits in
seconds are for normalised CPU seconds: measured ones times the rate of the bare walk (Embree alone on S2,
tests/bench/bare_walk, million photons per CPU second of one thread, measured in the same run) divided by 5. A *code*
is a step of an 8-bit picture; *seen error* is the root mean square of the differences in codes (tests/bench/seen.py).
*Border over within*: noise between the last frame of a segment and the first frame of the next one, over the noise
between frames of one segment. ~: extrapolated beyond the measured points.

**Papers.** A: T. Tawara, "Efficient Global Illumination for Dynamic Scenes". B: J.-R. Jimenez, K. Myszkowski, X.
Pueyo, "Interactive Global Illumination in Dynamic Participating Media Using Selective Photon Tracing".

**Scenes.** S1: a Cornell box. S2: the same, a box slides and turns. S3: a room behind a partition, which indirect
light alone reaches. S4: an atrium with mirrors and glass, the camera walks. S5: a room with a window and a lamp that
moves. S6: a room with smoke. S8: a room with a window by day, a robot moves. furnished_day: a furnished room by day,
the camera stands. evening_shot: a house open to an evening sky. demo: the animation that `make -f Makefile.example`
renders.

"""
    text += "".join(section(name, rows, parts, link, left_out) for name in SECTIONS if any(part.section == name for part in parts.values()))
    text = text.rstrip("\n") + "\n"
    if text.count("\n") > LINES:
        raise SystemExit(f"{page}: {text.count(chr(10))} lines, more than {LINES}: shorten what results_page.py puts there")
    page.write_text(text)
    read_me = page.with_name("README.md")
    if read_me.exists() and "demo" in rows:
        read_me.write_text(readme(read_me.read_text(), rows["demo"]))


# ---- the README

DEMO_MARKS = "<!-- written by tests/bench/evidence.py, PARTS=demo -->\n", "<!-- end of demo -->\n"


def readme(text, row):
    """The README's text with the cost of its demo; as it is if either lacks it."""
    begin, end = (text.find(mark) for mark in DEMO_MARKS)
    found = {quality: cells for quality, *cells in row["rows"]}
    if begin < 0 or end < 0 or not {"final", "draft"} <= set(found):
        return text
    frame, whole, disk = found["final"]
    return (text[:begin] + DEMO_MARKS[0] + f"They cost {float(whole) / 60:.1f} CPU minutes in all, {frame} CPU seconds a frame (`QUALITY=draft`: "
            f"{found['draft'][0]}), and {disk} GB of disk.\n" + text[end:])

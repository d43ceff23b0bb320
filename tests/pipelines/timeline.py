#!/usr/bin/env python3
"""The trace of `make timeline`: timeline.py OUT SECONDS; SECONDS is how long the makes in OUT have taken.

Valid JSON; one event for each command that has statistics, with the length they say; all within the run; no two at once in one place.

Seen to fail: events that begin when the command ended; all in one row; without the statistics of one stage; a comma after the last.
"""
import json
import sys
from collections import defaultdict
from pathlib import Path

out, seconds = Path(sys.argv[1]), float(sys.argv[2])
events = json.loads((out / "timeline.json").read_text())["traceEvents"]
machines = {event["pid"]: event["args"]["name"] for event in events if event["ph"] == "M"}
commands = [event for event in events if event["ph"] == "X"]
made = [out / entry["file"].split(".")[0] for entry in json.loads((out / "plan.json").read_text())["files"]]
stats = {str(file.relative_to(out)): json.loads(file.read_text()) for stem in made
         for file in (stem.with_name(stem.name + ".json"), stem.with_name(stem.name + ".warp.json")) if file.exists()}
assert commands and sorted(event["args"]["file"] for event in commands) == sorted(stats), (len(commands), sorted(stats))
places = defaultdict(list)
for event in commands:
    of = stats[event["args"]["file"]]
    assert abs(event["dur"] - 1e6 * of["wall_s"]) <= 1, (event, of["wall_s"])   # whole microseconds
    assert event["args"]["tool"] == of["tool"] and machines[event["pid"]] == of["host"], event
    places[event["pid"], event["tid"]].append((event["ts"], event["ts"] + event["dur"]))
# A command ends when its statistics are written. Both times are rounded to microseconds.
zeros = [(out / event["args"]["file"]).stat().st_mtime - 1e-6 * (event["ts"] + event["dur"]) for event in commands]
assert max(zeros) - min(zeros) < 1e-5, ("ends differ from the times of the files", zeros)
assert min(event["ts"] for event in commands) == 0, "the first command begins at 0"
end = max(event["ts"] + event["dur"] for event in commands)
assert max(event["dur"] for event in commands) <= end <= 1e6 * seconds, (end, seconds)
for spans in places.values():
    spans.sort()
    assert all(a[1] <= b[0] + 1 for a, b in zip(spans, spans[1:])), spans
print(f"{len(commands)} commands in {end / 1e6:.2f} of {seconds:.2f} s")

"""What the scripts of the renderers share: jobs in, CPU seconds out, PFM files."""
import json
import os
import sys


answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)                          # what renderers say, also when they are imported, goes elsewhere


def spent():
    times = os.times()
    return times.user + times.system


def jobs(first, other):
    """Calls first(job) for the job with "scene" and other(job) for the rest; answers each by a line {"cpu_s": ...}. The first holds the start, too."""
    began = 0.0
    for line in sys.stdin:
        job = json.loads(line)
        (first if "scene" in job else other)(job)
        now = spent()
        print(json.dumps({"cpu_s": now - began}), file=answers, flush=True)
        began = now


def write_pfm(path, width, height, values, from_top=False):
    """`values`: array of floats, R G B by pixel, rows from the bottom."""
    data = memoryview(values).cast("B")
    with open(path, "wb") as out:
        out.write(b"PF\n%d %d\n-1\n" % (width, height))
        row = 12 * width
        for y in reversed(range(height)) if from_top else range(height):
            out.write(data[y * row:(y + 1) * row])

#!/usr/bin/env python3
"""A random walk over everything a user can change, in one OUT: random_walk.py BIN [--steps 40] [--scenes 5] [--seed 1]

Run at the top of the tree; BIN is the folder with the tools. Each step changes one or two of METHOD, FILTER, MOVING, SPLIT, QUALITY, FRAMES,
SIZE, CAMERA, POINTS, the length of a segment, or edits the scene, a texture, the environment, the smoke or a tool, or returns to an earlier
state, or loses files of OUT. Then make runs in the one OUT. Every wanted file (frames/F.exr and .png, sheet.png) must be what a new OUT gets for that state; a state
is made anew once. A frame must not depend on the other frames that are asked for.

What ran is compared, too. A command is too much if a new OUT has nothing of what it wrote, or if all of it was there with the same digest for that
frame, made by the same program with the same options from the same content. How often all of it was there, whatever made it, is printed beside.
A second make at once must run nothing but scene-plan. In walks of 100 steps and more at most 5 % of the commands may be too much; they are listed.

A failure prints the shortest list of states that shows it; --replay FILE walks such a list again. --known walks the lists that went wrong once.
"""
import argparse
import collections
import hashlib
import json
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import walk_scenes                                                                   # noqa: E402

# The makes started here are independent of the make that runs the tests.
for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
    os.environ.pop(name, None)

# What every run is given: so little of everything that a run takes half a processor second, and records, which pilots do not choose for so few pixels.
SMALL = {"PHOTONS": "4k", "CACHE": "--rays 30", "ERROR": "0.05", "INDIRECT": "records"}
# The values that a variable takes; the first is what a walk starts with. "" leaves the variable out.
VALUES = {
    "METHOD": ["", "", "frames", "walkthrough", "auto"],
    "FILTER": ["", "", "3", "5"],
    "MOVING": ["", "anew", "light", "records", "time", "auto"],
    "SPLIT": ["", "on", "off"],
    "QUALITY": ["draft", "final"],
    "FRAMES": ["0-3", "0-7", "2-5", "4-7", "1,6", "0-6x2", "5", "3-4", "2,4", "2-4"],
    "SIZE": ["48x27", "32x18"],
    "CAMERA": ["", "Side"],
    "POINTS": ["--point-count 500 --light-samples 1", "--point-count 400 --light-samples 1"],
    "TIME": ["--segment 4", "--segment 8"],
}
OF_SMOKE = {"MOVING": ["", "", "anew", "auto", "light"], "UPDATE": ["", "20%"]}
SEEDED = ["photon-trace", "irradcache-build", "frame-render"]        # replaced by one that takes another seed
# How a file that an edit changes is put in place.
WAYS = ["renamed", "in place", "older", "kept"]
TOOLS = ["scene-plan", "photon-trace", "photonmap-split", "irradcache-build", "gather-temporal", "frame-render", "ibr-warp", "st-filter",
         "volume-compose", "aqm-compare", "error-report", "tempolux-info"]


# ---- states ------------------------------------------------------------------------------------------

def first_state(scene):
    return {"variables": {name: values[0] for name, values in VALUES.items()}, "edits": {}, "tools": {}, "scene": scene}


def key(state):
    """Text that is equal for equal states; how edits were made is no part of it."""
    return json.dumps({"scene": state["scene"]} | {part: {name: value for name, value in state[part].items() if value}
                                                   for part in ("variables", "edits", "tools")}, sort_keys=True)


def lean(state):
    """A state without what it leaves out."""
    return json.loads(key(state)) | {name: state[name] for name in ("way", "lose") if state.get(name)}


def words(before, state):
    """What differs between two states, as a line to read."""
    if key(before) == key(state):
        return "nothing"
    return ", ".join(f"{name}={state[part].get(name) or '-'}" for part in ("variables", "edits", "tools")
                     for name in sorted(before[part].keys() | state[part].keys()) if (before[part].get(name) or "") != (state[part].get(name) or ""))


def changed(state, scene, rng):
    """A state one or two changes away."""
    new = json.loads(json.dumps(state))
    variables = VALUES | (OF_SMOKE if scene == "smoke" else {})
    for _ in range(rng.choice((1, 1, 2))):
        kind = rng.random()
        if kind < 0.65:
            name = rng.choice(sorted(variables))
            new["variables"][name] = rng.choice([v for v in variables[name] if v != new["variables"].get(name, "")])
            if name == "FILTER" and rng.random() < 0.9:                              # with another METHOD it is refused
                new["variables"]["METHOD"] = ""
            if name == "METHOD" and rng.random() < 0.9:
                new["variables"]["FILTER"] = ""
        elif kind < 0.95:
            edits = walk_scenes.EDITS[scene]
            name = rng.choice(sorted(edits))
            new["edits"][name] = rng.choice([n for n in range(edits[name]) if n != new["edits"].get(name, 0)])
        else:
            name = rng.choice(SEEDED)
            new["tools"][name] = 1 - new["tools"].get(name, 0)
    return new | {"way": rng.choice(WAYS), "lose": rng.choice((0, 0, 0, 0, 20))}


def walk(scene, steps, seed):
    """The states of a walk; a third of them were there before."""
    rng = random.Random(f"{seed} {scene}")
    states = [first_state(scene)]
    while len(states) < steps:
        new = changed(states[-1], scene, rng)
        if len(states) > 2 and rng.random() < 0.3:
            new = json.loads(json.dumps(rng.choice(states[:-1]))) | {"way": rng.choice(WAYS), "lose": 0}
        states.append(new)
    return states


def known_walks():
    """Lists of states that went wrong once."""
    def states(scene, *changes):
        start = first_state(scene)
        return [start | {"variables": start["variables"] | {k: v for k, v in change.items() if k.isupper()},
                         "edits": {k: v for k, v in change.items() if k in walk_scenes.EDITS[scene]}, "way": change.get("way", "renamed")}
                for change in changes]
    anew, light, plain = {"MOVING": "anew"}, {"MOVING": "light", "QUALITY": "final"}, {}
    return {
        "FILTER and without": states("box", {"FILTER": "3"}, plain, {"FILTER": "5"}, plain),
        "FILTER, then MOVING=time": states("box", {"FILTER": "5"}, {"MOVING": "time", "QUALITY": "final"}),
        "METHOD=auto, walkthrough, frames": states("lamp", {"METHOD": "auto", "FRAMES": "0-7"}, {"METHOD": "frames", "FRAMES": "0-7"},
                                                   {"METHOD": "walkthrough", "FRAMES": "0-7"}, {"METHOD": "frames", "FRAMES": "0-7"}),
        "MOVING=light, then anew, then other points": states("box", light, anew, anew | {"POINTS": VALUES["POINTS"][1]}, anew | {"SIZE": "32x18"}),
        "single frames, a range, single frames": states("lamp", {"FRAMES": "4,6"}, {"FRAMES": "4-6"}, {"FRAMES": "4,6"}),
        "exposure of another first frame": states("box", {"FRAMES": "0-3"}, {"FRAMES": "2-4"}, {"FRAMES": "0-3", "SIZE": "32x18"}),
        "a mirror comes in": states("late", {"FRAMES": "4-7"}, {"FRAMES": "0-7"}, {"FRAMES": "5"}),
        "a cache for fewer cameras": states("smoke", {"FRAMES": "0-6x2"}, {"FRAMES": "2"}, {"FRAMES": "0-6x2"}),
        "a texture replaced by an older one": states("open", {"texture": 0}, {"texture": 1, "way": "older"}, {"sky": 1, "texture": 1, "way": "older"},
                                                     {"way": "older"}),
        "smoke replaced by an older one": states("smoke", plain, {"smoke": 1, "way": "older"}, {"way": "kept"}),
    }


# ---- one run -----------------------------------------------------------------------------------------

class Workplace:
    """A folder with a copy of the tools and the files of one scene, and make run there."""

    def __init__(self, folder, tools, makefile, scene):
        self.folder, self.real, self.makefile, self.scene = folder, tools, makefile, scene
        self.bin, self.files, self.log = folder / "bin", folder / "scene", folder / "log"
        self.bin.mkdir(parents=True)
        self.files.mkdir()
        for tool in TOOLS:
            shutil.copy2(tools / tool, self.bin / tool)
        if (tools.parent / "modules").is_dir():
            (folder / "modules").symlink_to(tools.parent / "modules")
        self.tools_now = {}
        self.old_time = time.time() - 10**6
        self.record = folder / "record.sh"
        self.record.write_text('#!/bin/sh\nlog=$1; shift\nprintf "%s\\t" "$@" >> "$log"; echo >> "$log"\nexec "$@"\n')

    def content(self, what):
        if isinstance(what, bytes):
            return what
        path = self.folder / f"made_{what[1]}_{what[2] if what[1] == 2 else 0}.vdb"  # a .vdb holds an identity of its making: made once
        if not path.exists():
            walk_scenes.vdb(self.real.parent / "tests" / "make-vdb", path, *what[1:])
        return path.read_bytes()

    def put(self, path, content, way):
        """Writes a file if its content differs. `older` and `kept` give it a time before any file of OUT."""
        if path.exists() and path.read_bytes() == content:
            return
        target = path if way == "in place" else path.with_name(path.name + ".new")
        target.write_bytes(content)
        if way in ("older", "kept"):
            self.old_time -= 3600 if way == "older" else -1
            os.utime(target, (self.old_time, self.old_time))
        if target != path:
            target.replace(path)

    def edit(self, state):
        way = state.get("way", "renamed")
        for name, content in walk_scenes.files(self.scene, state["edits"]).items():
            self.put(self.files / name, self.content(content), way)
        for tool in SEEDED:
            wanted = state["tools"].get(tool, 0)
            if wanted != self.tools_now.get(tool, 0):
                path = self.bin / tool
                path.unlink()
                if wanted:
                    path.write_text(f'#!/bin/sh\nexec "{self.folder}/other/bin/{tool}" "$@" --seed 7\n')
                    path.chmod(0o755)
                    other = self.folder / "other" / "bin"
                    other.mkdir(parents=True, exist_ok=True)
                    if not (other / tool).exists():
                        shutil.copy2(self.real / tool, other / tool)
                        if not (other.parent / "modules").exists() and (self.real.parent / "modules").is_dir():
                            (other.parent / "modules").symlink_to(self.real.parent / "modules")
                else:
                    shutil.copy2(self.real / tool, path)
                self.tools_now[tool] = wanted

    def command(self, state, out):
        values = SMALL | {name: value for name, value in state["variables"].items() if value}
        if self.scene == "open":
            values["ENVIRONMENT"] = str(self.files / "sky.hdr")
        if self.scene == "smoke":
            values |= {"VOLUME": str(self.files / "smoke_####.vdb"), "VOLUME_OPTIONS": "--sigma-t 6 --albedo .8 --volume-frames 0-7"}
        values |= {"SCENE": str(self.files / walk_scenes.scene_file(self.scene)), "OUT": str(out), "BIN": str(self.bin),
                   "RUN": f"sh {self.record} {self.log}"}
        return ["make", "-f", self.makefile, "--no-print-directory", "demo", *(f"{name}={value}" for name, value in values.items())]

    def make(self, state, out):
        """(exit code, text, [[word, ...] of each command])"""
        self.log.write_text("")
        done = subprocess.run(["nice", *self.command(state, out)], capture_output=True, text=True, timeout=300, errors="replace")
        return done.returncode, done.stdout + done.stderr, [line.rstrip("\t").split("\t") for line in self.log.read_text().splitlines()]

    def digests(self, paths):
        """{path: digest}. Ours by tempolux-info, pictures by their bytes."""
        digests = {}
        ours = [p for p in paths if p.suffix in (".exr", ".photons", ".irradpoints", ".irradcache", ".radsamples", ".meshirrad", ".paths")]
        for start in range(0, len(ours), 200):
            part = ours[start:start + 200]
            done = subprocess.run([self.real / "tempolux-info", "--digest", *part], capture_output=True, text=True)
            lines = [line.split(None, 1) for line in done.stdout.splitlines()]
            named = {Path(rest): digest for digest, rest in (x for x in lines if len(x) == 2)} if len(part) > 1 else {part[0]: lines[0][0] if lines else ""}
            digests |= {p: named.get(p) or hashlib.sha1(p.read_bytes()).hexdigest() for p in part}
        return digests | {p: hashlib.sha1(p.read_bytes()).hexdigest() for p in paths if p not in digests}


def frame_numbers(frames):
    numbers = []
    for part in frames.split(","):
        span, _, step = part.partition("x")
        first, _, last = span.partition("-")
        numbers += range(int(first), int(last or first) + 1, int(step or 1))
    return numbers


def wanted(out, state):
    names = [f"{f:04d}" for f in frame_numbers(state["variables"]["FRAMES"])]
    return [out / "frames" / f"{n}.{end}" for n in names for end in ("exr", "png")] + [out / "sheet.png"]


def written(command, out):
    """Names in OUT that a command writes, patterns of frames filled in; statistics and plans are not among them."""
    names, frames = [], []
    for option, value in zip(command, command[1:]):
        if option in ("-o", "--png", "--sheet", "--low", "--high", "--cache", "--paths", "--mask", "--flow", "--output"):
            if not (option in ("--high", "--paths", "--mask", "--cache") and reads(command, option)):
                names.append(value)
        if option in ("--frames", "--frame"):
            frames = frame_numbers(value)
    if command[0] == "cp":
        names.append(command[-1])
    full = [re.sub("####", f"{f:04d}", name) for name in names for f in (frames if "####" in name else [0])]
    return [final(os.path.relpath(out / name, out)) for name in full if not name.endswith(".json")]


def final(name):
    """What a file becomes that a rule writes beside it first: frames/.0012.png.tmp.HOST.31, walk/K.done.try.31/w.exr, walked/K.part.31.warp.exr."""
    name = re.sub(r"[.]done[.]try[.].*", ".done", re.sub(r"[.]part[.].*", ".exr", name))
    return re.sub(r"(^|/)[.]([^/]*)[.]tmp[.][^/]*$", r"\1\2", name)


def reads(command, option):
    """Options that name an output in one tool and an input in another."""
    tool = os.path.basename(command[0])
    return (tool, option) not in (("photonmap-split", "--high"), ("photon-trace", "--paths"), ("ibr-warp", "--mask"), ("gather-temporal", "--cache"))


def place(name):
    """The folder, frame and kind of a file; its name may go on with a key of what it is made from."""
    folder, _, rest = name.rpartition("/")
    return folder, re.match(r"[-0-9+]*?(?=[-.]|$)|", rest)[0], rest.rpartition(".")[2]


class Walker:
    def __init__(self, folder, tools, makefile, scene, fresh):
        self.place = Workplace(folder / scene, tools, makefile, scene)
        self.out, self.fresh = self.place.folder / "out", fresh
        self.known, self.ranges, self.refused = {}, [], 0                            # of OUT: {path: (what stat says, digest)}
        self.ran = self.too_much = self.same = 0
        self.requests = set()                                                        # all that ran in OUT: program, options, content of inputs
        self.named, self.changes = collections.Counter(), collections.Counter()

    def restart(self):
        shutil.rmtree(self.out, ignore_errors=True)
        self.known, self.requests = {}, set()

    def lose(self, share):
        """Deletes some of the files, the same ones for the same names. What a file lacks is made again."""
        for path in sorted(self.known) if share else []:
            if zlib.crc32(path.name.encode()) % 100 < share:
                path.unlink(missing_ok=True)

    def look(self):
        """Digests of all files of OUT that a stage reads or a user looks at."""
        now = {}
        for path in self.out.rglob("*"):
            if path.is_file() and path.suffix not in (".json", ".mk", ".log", ".done", ".keys") and path.parent.name not in ("options", "plan", "state", "recipes"):
                info = path.stat()
                now[path] = (info.st_ino, info.st_size, info.st_mtime_ns)
        stale = [p for p, mark in now.items() if self.known.get(p, (None,))[0] != mark]
        digests = self.place.digests(stale)
        self.known = {p: (mark, digests[p] if p in digests else self.known[p][1]) for p, mark in now.items()}
        return {os.path.relpath(p, self.out): digest for p, (_, digest) in self.known.items()}

    def anew(self, state):
        """What a new OUT gets: (digests of wanted files, names of all files written), or None and the text where the state is refused."""
        if key(state) not in self.fresh:
            out = self.place.folder / "anew"
            shutil.rmtree(out, ignore_errors=True)
            code, text, commands = self.place.make(state, out)
            files = {name for command in commands for name in written(command, out)}
            if code:
                self.fresh[key(state)] = (None, text)
            else:
                digests = self.place.digests([p for p in wanted(out, state) if p.exists()])
                self.fresh[key(state)] = ({os.path.relpath(p, out): d for p, d in digests.items()}, files)
                self.compare_ranges(state, self.fresh[key(state)][0])
            shutil.rmtree(out, ignore_errors=True)
        return self.fresh[key(state)]

    def compare_ranges(self, state, digests):
        """A frame is the same whichever other frames are asked for."""
        rest = json.loads(key(state))
        frames = rest["variables"].pop("FRAMES")
        for name, digest in digests.items():
            if name.endswith(".exr"):
                first = self.fresh.setdefault((json.dumps(rest), name), (digest, frames))
                if first[0] != digest:
                    self.ranges.append(f"{name}: FRAMES={frames} and FRAMES={first[1]}, each in a new OUT, differ")

    def step(self, state, again=False, why=""):
        """Makes a state. Returns what is wrong, as lines. `why`: what has changed."""
        self.place.edit(state)
        self.lose(state.get("lose", 0))
        before = {os.path.relpath(p, self.out): d for p, (_, d) in self.known.items() if p.exists()}
        code, text, commands = self.place.make(state, self.out)
        expected, rest = self.anew(state)
        ranges, self.ranges = self.ranges, []
        if expected is None:
            self.refused += 1
            wrong = [] if code == 2 else [f"a new OUT refuses, this one ends with {code}"]
            said = [line for line in rest.splitlines() if "***" in line or re.match(r"[a-z-]+: ", line) and not line.startswith("make")]
            return wrong + ([] if said else ["refused without a word"])
        if code:
            return ranges + [f"make failed with {code}, a new OUT is made:", *("  " + line for line in text.splitlines()[-6:])]
        now = self.look()
        wrong = ranges + [f"{name}: {'missing' if name not in now else 'other than in a new OUT'}" for name, digest in sorted(expected.items()) if now.get(name) != digest]
        self.count(commands, before, now, rest, why)
        if again and not wrong:
            _, _, second = self.place.make(state, self.out)
            extra = [" ".join(os.path.relpath(w, self.out) if w.startswith(str(self.out)) else w for w in c[:1] + written(c, self.out))
                     for c in second if os.path.basename(c[0]) != "scene-plan"]
            wrong += [f"made again at once, it runs {x}" for x in extra[:3]]
        return wrong

    def count(self, commands, before, now, needed, changes):
        there, requests = {(place(name), digest) for name, digest in before.items()}, set()
        for command in commands:
            tool, names = os.path.basename(command[0]), [n for n in written(command, self.out) if not n.startswith("plan")]
            if tool == "scene-plan" or not names:
                continue
            self.ran += 1
            useless = [n for n in names if n in now and (place(n), now[n]) in there]
            unneeded = len([n for n in names if n not in needed]) == len(names)
            same = len(useless) == len([n for n in names if n in now]) > 0
            request = (self.place.tools_now.get(tool, 0), *(now.get(word) or re.sub("-[0-9a-f]{10}", "", final(word)) for word in command))
            self.same += same
            if unneeded or (same and request in self.requests):
                self.too_much += 1
                self.named[f"{tool} {names[0].split('/')[0]}: {'not needed' if unneeded else 'same result'}"] += 1
                self.changes[changes] += 1
            requests.add(request)
        self.requests |= requests


# ---- walks -------------------------------------------------------------------------------------------

def shell(walker, states):
    """A list of states as commands to type."""
    lines, edits, tools = [], {}, {}
    for state in states:
        if state["edits"] != edits:
            lines.append(f"edit the scene: {json.dumps(state['edits'])}, files {state.get('way', 'renamed')}")
        if state["tools"] != tools:
            lines.append(f"replace tools (1: --seed 7 added): {json.dumps(state['tools'])}")
        edits, tools = state["edits"], state["tools"]
        if state.get("lose"):
            lines.append(f"lose {state['lose']} % of the files in OUT")
        lines.append(" ".join(f"{w.partition('=')[0]}='{w.partition('=')[2]}'" if " " in w else w for w in walker.place.command(state, walker.out)[2:]
                              if not w.startswith(("RUN=", "demo"))).replace(str(walker.place.folder) + "/", ""))
    return lines


def shortest(walker, states):
    """A list of two states that goes wrong as the whole list did, if there is one."""
    for earlier in list({key(s): s for s in reversed(states[:-1])}.values())[:6]:
        walker.restart()
        walker.step(earlier)
        if walker.step(states[-1]):
            return [earlier, states[-1]]
    return states


def follow(walker, title, states, shorten):
    """Walks a list. After a failure OUT is emptied and the walk goes on. Returns the number of failures."""
    failures, since = 0, []
    walker.restart()
    for number, state in enumerate(states):
        since.append(state)
        wrong = walker.step(state, number % 5 == 4, words(since[-2] if len(since) > 1 else state, state))
        if wrong:
            failures += 1
            print(f"FAILED: {title}, step {number} ({words(since[-2] if len(since) > 1 else state, state)})")
            print("\n".join(f"  {line}" for line in wrong[:4] + ([f"... {len(wrong)} lines"] if len(wrong) > 4 else [])))
            short = shortest(walker, since) if shorten and len(since) > 2 else since
            print("\n".join(f"    {line}" for line in shell(walker, short)))
            print(f"    --replay: {json.dumps([lean(s) for s in short])}", flush=True)
            walker.restart()
            since = []
    return failures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=Path)
    parser.add_argument("--steps", type=int, default=40, help="of all scenes together")
    parser.add_argument("--scenes", type=int, default=5, help="how many of box, lamp, open, smoke, late; fewer than steps")
    parser.add_argument("--only", help="one scene, by name")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--known", action="store_true", help="walk the lists that went wrong once instead")
    parser.add_argument("--replay", type=Path, help="walk the list of states in this file instead")
    parser.add_argument("--makefile", default="Makefile.example")
    parser.add_argument("--whole", action="store_true", help="print the whole list of a failure, do not look for a shorter one")
    arguments = parser.parse_args()
    tools = arguments.bin.resolve()
    scenes = [arguments.only] if arguments.only else list(walk_scenes.SCENE)[:arguments.scenes]
    if not (tools.parent / "tests" / "make-vdb").exists():
        scenes = [s for s in scenes if s != "smoke"]
    if arguments.replay:
        states = json.loads(arguments.replay.read_text())
        lists = {f"replay of {arguments.replay.name}": states}
    elif arguments.known:
        lists = {title: states for title, states in known_walks().items() if states[0]["scene"] in scenes}
    else:
        lists = {scene: walk(scene, arguments.steps // len(scenes), arguments.seed) for scene in scenes}
    failures, started = 0, time.monotonic()
    ran = too_much = same = 0
    named, changes, fresh = collections.Counter(), collections.Counter(), {}
    with tempfile.TemporaryDirectory(prefix="walk") as folder:
        for number, (title, states) in enumerate(lists.items()):
            walker = Walker(Path(folder) / str(number), tools, arguments.makefile, states[0]["scene"], fresh)
            wrong = follow(walker, title, states, not arguments.whole)
            print(f"{'FAILED' if wrong else 'ok'}: {title}: {len(states)} states, {wrong} wrong, {walker.refused} refused; {walker.ran} commands, {walker.too_much} too much", flush=True)
            failures, ran, too_much, same = failures + wrong, ran + walker.ran, too_much + walker.too_much, same + walker.same
            named, changes = named + walker.named, changes + walker.changes
    share = 100 * too_much / max(ran, 1)
    # One change of the segments' length remakes 27 commands, 5 % of those of 40 steps: the share is that of a long walk.
    judged = sum(len(states) for states in lists.values()) >= 100
    print(f"{'not judged, too short' if not judged else 'ok' if share <= 5 else 'FAILED'}: {too_much} of {ran} commands ({share:.1f} %) were too much; "
          f"5 % are allowed. All that they wrote was there: {same} commands")
    for name, count in named.most_common(12) + changes.most_common(12):
        print(f"  {count:4d}  {name}")
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{spent.ru_utime + spent.ru_stime:.0f} CPU seconds, {time.monotonic() - started:.0f} s")
    return 1 if failures or (judged and share > 5) else 0


if __name__ == "__main__":
    sys.exit(main())

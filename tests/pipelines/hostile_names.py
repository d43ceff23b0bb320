#!/usr/bin/env python3
"""File names that mean something to make or to a shell: hostile_names.py BIN [--all] [--only WORD] [--makefile FILE]

Run at the top of the tree; BIN is the folder with the tools. Each name is that of a scene, a texture, a buffer, a map of the environment, a
volume or OUT. Make runs in a folder that holds the scene alone. It makes the frame that plain names give, or says in one line what is wrong
and ends with make's 2. Then the file's content changes, and the frame must change with it: a name that make cannot follow is noticed here.

No command may run: the program `canary`, which many of the names call, leaves a file, and so would a redirection. Without --all each name
takes one role, and those that would run something that of a texture too, as strangers' scenes bring these; with it, every role.
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import walk_scenes                                                                   # noqa: E402

# The makes started here are independent of the make that runs the tests.
for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
    os.environ.pop(name, None)

NAMES = {
    # plain names with what a keyboard has
    "a blank": "oak tree", "two blanks": "oak  tree", "a blank first": " oak", "a blank last": "oak ", "a quote": "it's", "double quotes": 'a"b"c',
    "one double quote": 'a"b', "a dollar": "a$b", "two dollars": "a$$b", "a dollar last": "oak$", "a hash": "a#b", "a hash first": "#oak",
    "percent": "grey50%", "percent alone": "%", "an escape": "a%20b", "printf": "a%04d", "a semicolon": "a;b", "a pipe": "a|b", "equals": "oak=2",
    "colon equals": "a:=b", "a colon": "a:b", "a drive": "C:oak", "an ampersand": "a&b", "less and more": "a<b>c", "parentheses": "oak (2)",
    "one parenthesis": "a)b", "brackets": "a[0-9]b", "braces": "a{b,c}d", "a star": "a*b", "a question mark": "a?b", "a tilde first": "~oak",
    "an exclamation mark": "a!b", "a caret": "a^b", "a comma": "a,b", "plus and at": "a+b@c", "a backtick": "a`b", "a backslash": "a\\b",
    "a backslash last": "oak\\", "backslash n": "a\\nb", "a dot first": ".oak", "two dots": "..oak", "a minus first": "-oak", "a long option": "--help",
    "an umlaut": "b\u00e4um", "an umlaut in two parts": "ba\u0308um", "an emoji": "\U0001f332", "not UTF-8": b"a\xffb", "a control character": "a\x01b",
    "a carriage return": "a\rb", "as many bytes as a name may have": "long",
}
RUNS = {                                                               # what make or a shell would run
    "TAB": "a\tb", "a line feed": "a\nb", "a function of make": "$(shell canary)", "a function with a TAB": "$(shell\tcanary)",
    "a function, twice expanded": "$$(shell canary)", "a variable's setting": "a\nRUN := canary;", "a recipe": "a\nall:\n\tcanary", "eval": "$(eval RUN=canary;)",
    "commands in backticks": "`canary`", "commands in parentheses": "$$(canary)", "a command after a semicolon": "x;canary;", "a command after a pipe": "x|canary|",
    "a command in the background": "x&canary&", "a redirection": "x;canary>F;", "a quote that ends": "x';canary;'", "double quotes that end": 'x";canary;"',
    "a line feed and a command": "x\ncanary\n", "an include": "a\ninclude b\n", "braces of a variable": "${canary}", "a comment": "x # canary",
}
# Complaints of make and of shells about what they took a name for; a refusal comes from a tool or a rule of ours.
ACCIDENT = re.compile(r"sh: |missing separator|No rule to make target|target pattern|commands commence|unterminated|Is a directory")
ROLES = ["scene", "texture", "buffer", "OUT", "environment", "volume"]
ENDS = {"scene": ".gltf", "texture": ".png", "buffer": ".bin", "OUT": "", "environment": ".hdr", "volume": "_0000.vdb"}
PLAIN = {"scene": "scene.gltf", "texture": "floor.png", "buffer": "scene.bin", "OUT": "out", "environment": "sky.hdr", "volume": "smoke_0000.vdb"}
SMALL = ["FRAMES=0", "TIME=--segment 1", "SIZE=16x9", "QUALITY=draft", "PHOTONS=2k", "ERROR=0.1", "POINTS=--point-count 200 --light-samples 1"]
# The edit that changes the content of a role's file.
EDIT = {"scene": "lamp", "texture": "texture", "buffer": "object", "OUT": "lamp", "environment": "sky", "volume": "smoke"}


def file_name(name, role):
    end = ENDS[role].encode()
    stem = name if isinstance(name, bytes) else name.encode()
    return os.fsdecode(b"n" * (255 - len(end)) + end if stem == b"long" else stem + end)


def out_folder(names):
    return names["OUT"].lstrip(" ")                                                  # make leaves out blanks between = and a value


class Trial:
    def __init__(self, folder, tools, makefile):
        self.folder, self.tools, self.makefile = folder, tools, makefile
        self.sentinel = folder / "somebody_was_here"
        (folder / "path").mkdir()
        program = folder / "path" / "canary"
        program.write_text(f'#!/bin/sh\ntouch "{self.sentinel}"\n')
        program.chmod(0o755)
        self.vdb = {}

    def smoke(self, number):
        if number not in self.vdb:
            path = self.folder / f"smoke{number}.vdb"
            walk_scenes.vdb(self.tools.parent / "tests" / "make-vdb", path, 2, number)
            self.vdb[number] = path.read_bytes()
        return self.vdb[number]

    def write(self, work, role, name, edited):
        """The scene with one name replaced, edited or not; files that stay the same are left alone."""
        names = PLAIN | {role: name}
        edit = EDIT[role] if edited else ""
        files = walk_scenes.files("open", {edit: 1} if edit in ("lamp", "texture", "sky") else {})
        gltf = json.loads(files["scene.gltf"])
        gltf["images"][0]["uri"] = urllib.parse.quote(os.fsencode(names["texture"]))
        gltf["buffers"][0]["uri"] = urllib.parse.quote(os.fsencode(names["buffer"]))
        buffer = bytearray(files["scene.bin"])
        if edit == "object":                                                         # the lowest corner of the first wall: half a metre down
            buffer[4:8] = b"\0\0\0\xbf"
        content = {names["scene"]: json.dumps(gltf).encode(), names["texture"]: files["floor.png"], names["buffer"]: bytes(buffer)}
        if role == "environment":
            content[name] = files["sky.hdr"]
        if role == "volume":
            content[name] = self.smoke(1 if edited else 0)
        for file, data in content.items():
            path = work / file
            if not path.exists() or path.read_bytes() != data:
                path.write_bytes(data)

    def make(self, work, role, name):
        """(exit code or None after 30 s, what it said on standard error, digest of the frame or None)"""
        names = PLAIN | {role: name}
        variables = [f"SCENE={names['scene']}", f"OUT={names['OUT']}", f"BIN={self.tools}", *SMALL]
        if role == "environment":
            variables.append(f"ENVIRONMENT={name}")
        if role == "volume":
            variables += [f"VOLUME={name.replace('_0000.vdb', '_####.vdb')}", "VOLUME_OPTIONS=--sigma-t 3 --albedo .8"]
        environment = os.environ | {"PATH": f"{self.folder / 'path'}:{os.environ['PATH']}"}
        command = ["nice", "make", "-f", self.makefile, "--no-print-directory", "demo", *variables]
        try:
            done = subprocess.run([os.fsencode(str(x)) for x in command], cwd=work, env=environment, capture_output=True, timeout=30)
            code, said = done.returncode, done.stderr.decode(errors="replace")
        except subprocess.TimeoutExpired:
            return None, "no end after 30 s", None
        frame = work / out_folder(names) / "frames" / "0000.exr"
        digest = subprocess.run([self.tools / "tempolux-info", "--digest", frame], capture_output=True, text=True, errors="replace").stdout.split()
        return code, said, digest[0] if digest else None

    def run(self, role, name, expected):
        """What is wrong, as a line, or nothing; expected: digests of the frame before and after the edit."""
        work = self.folder / "work"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        self.sentinel.unlink(missing_ok=True)
        works = True
        for edited in (False, True):
            try:
                self.write(work, role, name, edited)
            except OSError:
                return "", "the file system refuses the name"
            before = {os.fsencode(p) for p in os.listdir(work)}
            code, said, digest = self.make(work, role, name)
            if self.sentinel.exists():
                return "A COMMAND RAN", said
            new = {os.fsencode(p) for p in os.listdir(work)} - before - {os.fsencode(out_folder(PLAIN | {role: name}))}
            if new:
                return f"other files were made: {sorted(new)}", said
            if code == 2:
                lines = [x for x in said.splitlines() if x.strip() and not x.startswith(("make: *** [", "make[1]: *** ["))]
                if len(lines) != 1:
                    return f"refused in {len(lines)} lines", said
                if ACCIDENT.search(said):
                    return "make or the shell stumbles", said
                works = False
                break
            if code != 0:
                return f"exit {code}", said
            if digest != expected[edited]:
                return ("an edit of the file goes unnoticed" if edited and digest == expected[0] else "another frame than by a plain name"), said
        return "", "works" if works else f"refused: {lines[0]}"

    def expected(self, role):
        work = self.folder / "plain"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        digests = []
        for edited in (False, True):
            self.write(work, role, PLAIN[role], edited)
            code, said, digest = self.make(work, role, PLAIN[role])
            if code != 0:
                sys.exit(f"FAILED: plain names, {role}: {said}")
            digests.append(digest)
        if digests[0] == digests[1]:
            sys.exit(f"FAILED: plain names, {role}: an edit changes nothing")
        return digests


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=Path)
    parser.add_argument("--all", action="store_true", help="every name in every role")
    parser.add_argument("--only", default="", help="names and roles with this word")
    parser.add_argument("--makefile", default="Makefile.example", type=Path)
    parser.add_argument("-v", "--verbose", action="store_true")
    arguments = parser.parse_args()
    tools = arguments.bin.resolve()
    roles = ROLES if (tools.parent / "tests" / "make-vdb").exists() else ROLES[:-1]
    failures = counted = refused = 0
    with tempfile.TemporaryDirectory(prefix="names") as folder:
        trial = Trial(Path(folder), tools, arguments.makefile.resolve())
        expected = {}
        for number, (title, name) in enumerate((NAMES | RUNS).items()):
            once = dict.fromkeys([roles[number % len(roles)]] + (["texture"] if title in RUNS else []))
            for role in roles if arguments.all or arguments.only else once:
                if arguments.only not in f"{title}, {role}":
                    continue
                if role not in expected:
                    expected[role] = trial.expected(role)
                wrong, said = trial.run(role, file_name(name, role), expected[role])
                counted, failures, refused = counted + 1, failures + bool(wrong), refused + said.startswith("refused")
                if wrong:
                    first = [x for x in said.splitlines() if x.strip()][:2]
                    print(f"FAILED: {title} {file_name(name, role)[:40]!r} as {role}: {wrong}", *(f"\n    {x[:160]}" for x in first), flush=True)
                elif arguments.verbose:
                    print(f"ok: {title} as {role}: {said[:160]}", flush=True)
    print(f"{'FAILED' if failures else 'ok'}: {counted} names, {failures} wrong, {refused} refused in one line")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

"""Tools: killed at any moment, full disks, closed folders, numbers of threads. The scripts of tests/cli, all rounds."""
import os
import pathlib
import subprocess

from session import FULL, case

CLI = pathlib.Path(__file__).resolve().parents[1] / "cli"


def script(s, name, **environment):
    """Rows: what the script says of each command; FAIL of the last if it fails."""
    build = s.scratch / "build"
    build.mkdir(exist_ok=True)
    if not (build / "bin").exists():
        (build / "bin").symlink_to(s.tools)
    done = subprocess.run(["sh", CLI / "run.sh", build, name], env=os.environ | environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=3600)
    for line in done.stdout.splitlines():
        s.row(line[:120], "", "", "", "ok" if done.returncode == 0 else "see below")
    s.true(f"tests/cli/{name}_check.sh", done.returncode == 0, f"exit {done.returncode}", "exit 0")


@case("tools", "kill -9 at 50 moments, full disk, closed folder", FULL)
def killed(s):
    script(s, "kill", ROUNDS="50")


@case("tools", "EIO and ENOSPC at each call that writes", FULL)
def write_errors(s):
    (s.scratch / "build" / "tests").mkdir(parents=True, exist_ok=True)
    preload = s.tools.parent / "tests" / "libfail-write.so"
    if not preload.exists():
        return s.skipped("tests/libfail-write.so is not built")
    (s.scratch / "build" / "tests" / "libfail-write.so").symlink_to(preload)
    script(s, "write_errors", PLACES="1000")


@case("tools", "threads 1, 2, 3, 7", FULL)
def threads(s):
    script(s, "threads")

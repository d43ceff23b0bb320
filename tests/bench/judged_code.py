"""Which code a part of the bench judges, and how often that has changed since: verdicts expire."""
import subprocess

MOST_CHANGES = 30     # of the code that a verdict judges: after more it is expired

SCENE = ["lib/core", "lib/image", "lib/scene", "lib/trace"]
PHOTONS = [*SCENE, "lib/material", "lib/light", "lib/photon", "formats/photons", "tools/stages/trace_photons.cpp"]
PATHS = [*SCENE, "lib/material", "lib/light", "lib/render", "tools/stages/render_frame.cpp"]
ALL = ["formats", "lib", "tools", "Makefile.example", "pipelines"]     # of parts that are not listed: whole frames
JUDGES = {
    "path-tracer": PATHS, "photon-rate": PHOTONS, "nearest": ["lib/core", "lib/density"],
    "start": ["tools", "modules", "cmake", "CMakeLists.txt", "lib/CMakeLists.txt"],
    "reading": ["lib/core", "formats/photons", "formats/CMakeLists.txt"]}


def changes_since(project, commit, name):
    """Commits after `commit` that touch what the part judges; None if git does not know."""
    log = subprocess.run(["git", "-C", str(project), "log", "--oneline", f"{commit}..HEAD", "--", *JUDGES.get(name, ALL)],
                         capture_output=True, text=True)
    return None if log.returncode else len(log.stdout.splitlines())

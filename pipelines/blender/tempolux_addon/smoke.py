"""Smoke: OpenVDB files for VOLUME= of the make line."""
import os
import re

import bpy
import numpy

from .notes import Damage


class Smoke:
    """The part of Shot that finds the files of smoke."""

    def add_smoke(self, name, original):
        pattern = (
            pattern_of(bpy.path.abspath(original.data.filepath, library=original.library))
            if original.data.filepath
            else None
        )
        self.take_smoke(name, pattern)
        place = numpy.array(original.matrix_world)
        if pattern and abs(place - numpy.eye(4)).max() > 1e-6:
            self.notes.lost(Damage.LIGHT, name, "the place of the volume object is left out: apply it to the files")

    def take_smoke(self, name, pattern):
        if pattern is None:
            self.notes.lost(
                Damage.OBJECT,
                name,
                "smoke is left out: there is no .vdb file; bake the simulation, or name files by VOLUME=",
            )
        elif self.smoke is None:
            self.smoke = pattern
            self.notes.lost(
                Damage.LIGHT,
                name,
                "smoke is in the make line as VOLUME, where its files place it; its density and colour: --sigma-t and "
                "--albedo in VOLUME_OPTIONS",
            )
        else:
            self.notes.lost(Damage.OBJECT, name, "smoke is left out: VOLUME names one series of files")


def pattern_of(path):
    """The file with its last number as ####, if it or a file of its series exists; None without."""
    folder, name = os.path.split(path)
    found = list(re.finditer(r"\d+", os.path.splitext(name)[0]))
    if not os.path.isdir(folder):
        return None
    if found:
        a, b = found[-1].span()
        shape = re.compile(re.escape(name[:a]) + r"\d+" + re.escape(name[b:]) + "$")
        if any(shape.match(other) for other in os.listdir(folder)):
            return os.path.join(folder, name[:a] + "#" * (b - a) + name[b:])
    return path if os.path.isfile(path) else None

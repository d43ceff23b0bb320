"""What the user reads: one line for each thing that was baked or lost, the worst first, and three lines of summary."""
import contextlib
import enum


class Damage(enum.IntEnum):
    """How much a loss changes the picture; lines are sorted by it."""
    OBJECT = 0      # something is missing, or stands where nothing should be
    LIGHT = 1       # the light of the scene is another
    MATERIAL = 2    # a surface looks different
    MOTION = 3      # something stands still, or moves differently
    CAMERA = 4
    DETAIL = 5      # seen by those who look for it
    BAKED = 6       # nothing is lost but size or sharpness
    HINT = 7        # nothing is lost


MANY = 3                 # as many names with one text have a line each


class Notes:
    """Lines about objects, materials, lamps. `shares`: {name: share of the picture that it covers}."""

    def __init__(self):
        self.lines, self.shares, self.kept = {}, {}, {}

    def lost(self, damage, name, text):
        self.lines.setdefault((name, text), damage)

    def baked(self, name, text):
        self.lines.setdefault((name, text), Damage.BAKED)

    def keep(self, kind, count=1):
        self.kept[kind] = self.kept.get(kind, 0) + count

    @contextlib.contextmanager
    def guard(self, damage, name, consequence):
        """Whatever is raised inside becomes one line, and the export goes on."""
        try:
            yield
        except Exception as trouble:  # noqa: BLE001: any failure of Blender's API is named, never silent
            cause = " ".join(str(trouble).split()) or "no reason given"
            self.lost(damage, name, f"{consequence} ({type(trouble).__name__}: {cause[:200]})")

    def text(self):
        """All lines in order of damage, larger shares of the picture first, then the summary. Many with one text are one line."""
        groups = {}
        for (name, text), damage in self.lines.items():
            groups.setdefault((damage, text), []).append(name)
        order = []
        for (damage, text), names in groups.items():
            names.sort(key=lambda name: -self.shares.get(name, 0))
            parts = [names] if len(names) > MANY else [[name] for name in names]
            order += [(damage, -sum(self.shares.get(n, 0) for n in part), few(part), text) for part in parts]
        order.sort(key=lambda line: line[:2])
        lines = [f"{names}: {text}{share(-minus)}" for _, minus, names, text in order]
        kept = (
            ", ".join(f"{n} {kind if n > 1 else kind.removesuffix('s')}" for kind, n in self.kept.items() if n)
            or "nothing"
        )
        baked = self.names(lambda damage: damage == Damage.BAKED)
        lost = self.names(lambda damage: damage < Damage.BAKED)
        return [
            *lines,
            f"kept: {kept}",
            f"baked: {few(baked) or 'nothing'}",
            f"lost or changed: {few(lost) or 'nothing'}",
        ]

    def names(self, wanted):
        chosen = sorted(
            (damage, -self.shares.get(name, 0), name) for (name, _), damage in self.lines.items() if wanted(damage)
        )
        return list(dict.fromkeys(name for _, _, name in chosen))


def share(part):
    return f" [{100 * min(1, part):.0f} % of the picture]" if part >= 0.005 else ""



def few(names, most=6):
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")

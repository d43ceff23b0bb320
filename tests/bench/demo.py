"""What the demo costs, as Makefile.example renders it: the README's sentence."""
import shutil
import tempfile

from estimate import spent
from measure import figure

FRAMES = 48


def demo(bench, _):
    """What a frame of the demo costs."""
    frames, count, size = ("0-1", 2, "48x28") if bench.tiny else ("0-47x8", 6, None)
    rows, seconds = [], {}
    for quality in ("final", "draft"):
        out = tempfile.mkdtemp()
        try:
            cpu, disk = spent(bench, out, FRAMES=frames, QUALITY=quality, SIZE=size)
        finally:
            shutil.rmtree(out)
        cpu = bench.normalised(cpu)
        seconds[quality] = cpu / count
        rows.append([quality, f"{cpu / count:.1f}", f"{cpu / count * FRAMES:.0f}", f"{disk / count * FRAMES / 1e9:.1f}"])
    return figure("The demo", "final at most 4 normalised CPU s per frame, draft a third of that",
                  ["quality", "CPU s per frame, normalised", f"CPU s, {FRAMES} frames", f"GB, {FRAMES} frames"], rows,
                  None if bench.tiny else seconds["final"] <= 4 and seconds["draft"] <= 4 / 3,
                  [f"Frames {frames}, each with light of its own; all processes of make. {FRAMES} frames: as many times what these cost."])


FIGURES = {"demo": demo}

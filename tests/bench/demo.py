"""What the demo costs, as Makefile.example renders it: the README's sentence."""
import shutil
import tempfile

from estimate import spent
from measure import figure

FRAMES = 48


def demo(bench):
    """What the demo costs."""
    frames, count, size = ("0-1", 2, "48x28") if bench.tiny else (f"0-{FRAMES - 1}", FRAMES, None)
    rows, seconds = [], {}
    for quality in ("final", "draft"):
        out = tempfile.mkdtemp()
        try:
            cpu, disk = spent(bench, out, FRAMES=frames, QUALITY=quality, SIZE=size)
        finally:
            shutil.rmtree(out)
        seconds[quality] = bench.normalised(cpu)
        rows.append([quality, f"{seconds[quality] / count:.1f}", f"{seconds[quality]:.0f}", f"{disk / 1e9:.1f}"])
    return figure("The demo", f"{FRAMES} final frames in 300 normalised CPU s, draft frames in half of that",
                  ["quality", "CPU s per frame, normalised", "CPU s, all frames", "GB, all frames"], rows,
                  None if bench.tiny else seconds["final"] <= 300 and seconds["draft"] <= 150,
                  [f"Frames {frames} of pipelines/scenes/evening.glb, 640x360; all processes of make."])

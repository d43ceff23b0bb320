"""Two runs of everyscene.py, scene by scene: what a change to the programs has brought."""
import math

from measure import quantity


def compared(old, new):
    """Text. CPU seconds of the two runs are made comparable by the bare walk measured in each (unknown: as they are). Efficiency is
    CPU x squared seen error of the old run over that of the new; above 1: the new one is better."""
    speed = new["walk"] / old["walk"] if old.get("walk") and new.get("walk") else 1
    before = {f"{row['scene']} {row['size']}": row for row in old["rows"]}
    lines, gains = [f"{'scene':34} {'CPU new/old':>12} {'seen error':>16} {'efficiency':>11} {'speed-up':>16} {'blobs %':>14}"], []
    for row in new["rows"]:
        name = f"{row['scene']} {row['size']}"
        was = before.get(name)
        if not was or was.get("refused") or row.get("refused"):
            if was and bool(was.get("refused")) != bool(row.get("refused")):
                lines.append(f"{name:34} {was.get('refused') or 'rendered'} -> {row.get('refused') or 'rendered'}")
            continue
        cpu, error = row["cpu_s"] * speed / was["cpu_s"], row["seen"] / max(1e-9, was["seen"])
        gains.append(1 / max(1e-9, cpu * error ** 2))
        lines.append(f"{name:34} {cpu:12.2f} {was['seen']:6.2f} -> {row['seen']:6.2f} {gains[-1]:11.2f} {quantity(was['speed_up']):>7} -> {quantity(row['speed_up']):<6}"
                     f" {100 * was['blobs']:6.2f} ->{100 * row['blobs']:6.2f}")
    if gains:
        gains.sort()
        lines.append(f"efficiency: median {gains[len(gains) // 2]:.2f}, geometric mean {math.exp(sum(map(math.log, gains)) / len(gains)):.2f}, "
                     f"least {gains[0]:.2f}, most {gains[-1]:.2f}; processor's speed new/old {speed:.2f}")
    return "\n".join(lines)

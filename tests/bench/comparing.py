"""Two runs of everyscene.py, scene by scene: what a change to the programs has brought."""
import math

from measure import quantity


def efficiency(old, new, speed=1):
    """CPU x MSE of one row of everyscene over that of another; `speed`: the processor's at the time of the new, over the old."""
    return (old["cpu_s"] * old["mse"]) / (new["cpu_s"] * speed * new["mse"])


def compared(old, new):
    """Text. CPU seconds of the two runs are made comparable by the bare walk measured in each (unknown: as they are). Efficiency is
    CPU x MSE of the old run over that of the new; above 1: the new one is better."""
    speed = new["walk"] / old["walk"] if old.get("walk") and new.get("walk") else 1
    before = {f"{row['scene']} {row['size']}": row for row in old["rows"]}
    lines, gains = [f"{'scene':34} {'CPU new/old':>12} {'MSE new/old':>12} {'efficiency':>11} {'speed-up':>16} {'bias %':>14} {'dots':>9}"], []
    for row in new["rows"]:
        name = f"{row['scene']} {row['size']}"
        was = before.get(name)
        if not was or was.get("refused") or row.get("refused"):
            if was and bool(was.get("refused")) != bool(row.get("refused")):
                lines.append(f"{name:34} {was.get('refused') or 'rendered'} -> {row.get('refused') or 'rendered'}")
            continue
        cpu, mse = row["cpu_s"] * speed / was["cpu_s"], row["mse"] / was["mse"]
        gains.append(efficiency(was, row, speed))
        biases = [100 * r["bias"]["picture"]["difference"] for r in (was, row)]
        lines.append(f"{name:34} {cpu:12.2f} {mse:12.2f} {gains[-1]:11.2f} {quantity(was['speed_up']):>7} -> {quantity(row['speed_up']):<6}"
                     f" {biases[0]:+6.2f} ->{biases[1]:+6.2f} {was['dots']:4.0f} ->{row['dots']:4.0f}")
    if gains:
        gains.sort()
        lines.append(f"efficiency: median {gains[len(gains) // 2]:.2f}, geometric mean {math.exp(sum(map(math.log, gains)) / len(gains)):.2f}, "
                     f"least {gains[0]:.2f}, most {gains[-1]:.2f}; processor's speed new/old {speed:.2f}")
    return "\n".join(lines)

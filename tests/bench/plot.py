"""Line and bar charts as SVG text, with axes in round numbers; no library."""
import math

COLOURS = ("#1f5fa8", "#c2571a", "#3a8a3a", "#8a3a8a", "#666666", "#a8860b", "#0b8b8b")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 360, 70, 20, 52, 44


def ticks(low, high):
    """Round numbers from low to high, about five."""
    step = 10 ** math.floor(math.log10((high - low) / 5))
    step *= next(m for m in (1, 2, 5, 10) if (high - low) / (m * step) <= 6)
    return [i * step for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def chart(title, across, up, series, bars=False, from_zero=True):
    """series: [(name, [(x, y), ...])]; SVG text."""
    xs, ys = [x for _, points in series for x, _ in points], [y for _, points in series for _, y in points]
    x0, x1 = min(xs) - 0.5 * bars, max(xs) + 0.5 * bars
    y0, y1 = (0 if from_zero else min(ys)), max(ys)
    x1, y1 = x1 + (x1 == x0), y1 + (y1 == y0)
    y0, y1 = y0 - (0 if from_zero else 0.05 * (y1 - y0)), y1 + 0.05 * (y1 - y0)

    def at(x, y):
        return LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - (y - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>', f'<text x="{LEFT}" y="20" font-size="14">{title}</text>']

    def text(x, y, words, anchor="middle", more=""):
        out.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" {more}>{words}</text>')
    for x in ticks(x0, x1):
        text(at(x, y0)[0], HEIGHT - BOTTOM + 16, f"{x:g}")
    for y in ticks(y0, y1):
        px, py = at(x0, y)
        out.append(f'<line x1="{px:.1f}" y1="{py:.1f}" x2="{WIDTH - RIGHT}" y2="{py:.1f}" stroke="#dddddd"/>')
        text(px - 6, py + 4, f"{y:.6g}", "end")
    text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 10, across)
    text(16, (TOP + HEIGHT - BOTTOM) / 2, up, more=f'transform="rotate(-90 16 {(TOP + HEIGHT - BOTTOM) / 2})"')
    room = (WIDTH - LEFT - RIGHT) / len(series)
    for i, (name, points) in enumerate(series):
        colour = COLOURS[i % len(COLOURS)]
        if bars:
            width = (at(1, 0)[0] - at(0, 0)[0]) * 0.8 / len(series)
            for x, y in points:
                px, py = at(x, y)
                out.append(f'<rect x="{px + (i - len(series) / 2) * width:.1f}" y="{py:.1f}" width="{width:.1f}" height="{at(x, y0)[1] - py:.1f}" fill="{colour}"/>')
        else:
            path = " ".join(f"{px:.1f},{py:.1f}" for px, py in (at(x, y) for x, y in points))
            out.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
        text(LEFT + i * room, 40, name, "start", f'fill="{colour}"')
    return "\n".join(out + ["</svg>\n"])

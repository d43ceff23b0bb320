"""Line and bar charts and hemispheres as SVG text, with axes in round numbers; no library."""
import math

COLOURS = ("#1f5fa8", "#c2571a", "#3a8a3a", "#8a3a8a", "#666666", "#a8860b", "#0b8b8b")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 360, 70, 20, 52, 44


def ticks(low, high):
    """Round numbers from low to high, about five."""
    step = 10 ** math.floor(math.log10((high - low) / 5))
    step *= next(m for m in (1, 2, 5, 10) if (high - low) / (m * step) <= 6)
    return [i * step for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def powers(low, high):
    """1, 2, 5 times powers of ten from low to high."""
    return [m * 10.0 ** e for e in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1) for m in (1, 2, 5) if low <= m * 10.0 ** e * 1.0000001 and m * 10.0 ** e <= high * 1.0000001]


def opened(title):
    return [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">',
            f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>', f'<text x="{LEFT}" y="20" font-size="14">{title}</text>']


def chart(title, across, up, series, bars=False, from_zero=True, log=False):
    """series: [(name, [(x, y), ...])]; SVG text. log: both axes, with a mark at each point."""
    if log:
        series = [(name, [(math.log10(x), math.log10(y)) for x, y in points]) for name, points in series]
        from_zero = False
    xs, ys = [x for _, points in series for x, _ in points], [y for _, points in series for _, y in points]
    x0, x1 = min(xs) - 0.5 * bars, max(xs) + 0.5 * bars
    y0, y1 = (0 if from_zero else min(ys)), max(ys)
    x1, y1 = x1 + (x1 == x0), y1 + (y1 == y0)
    y0, y1 = y0 - (0 if from_zero else 0.05 * (y1 - y0)), y1 + 0.05 * (y1 - y0)

    def at(x, y):
        return LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - (y - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)
    out = opened(title)

    def text(x, y, words, anchor="middle", more=""):
        out.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" {more}>{words}</text>')
    def marks(low, high):
        """(place on the axis, what it says)"""
        if log:
            return [(math.log10(v), f"{v:g}") for v in powers(10 ** low, 10 ** high)]
        return [(v, f"{v:.6g}") for v in ticks(low, high)]
    for x, words in marks(x0, x1):
        text(at(x, y0)[0], HEIGHT - BOTTOM + 16, words)
    for y, words in marks(y0, y1):
        px, py = at(x0, y)
        out.append(f'<line x1="{px:.1f}" y1="{py:.1f}" x2="{WIDTH - RIGHT}" y2="{py:.1f}" stroke="#dddddd"/>')
        text(px - 6, py + 4, words, "end")
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
            places = [at(x, y) for x, y in points]
            path = "L".join(f"{px:.1f} {py:.1f}" for px, py in places)
            out.append(f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
            out += [f'<circle cx="{px:.1f}" cy="{py:.1f}" r="2.5" fill="{colour}"/>' for px, py in places if log]
        out.append(f'<rect x="{LEFT + i * room:.1f}" y="31" width="10" height="10" fill="{colour}"/>')
        text(LEFT + i * room + 14, 40, name, "start")
    return "\n".join(out + ["</svg>\n"])


def hemispheres(title, discs, oldest):
    """discs: [(words, [ring][sector] ages)]: each hemisphere seen from above, its rings of equal area; the darker a cell, the older its sample."""
    out = opened(title)
    size = (WIDTH - 2 * RIGHT) / len(discs)
    radius = min(size - 30, HEIGHT - TOP - BOTTOM) / 2
    out.append('<g stroke="white" stroke-width="0.3">')
    for i, (words, rings) in enumerate(discs):
        cx, cy = RIGHT + (i + 0.5) * size, TOP + radius
        for j, ages in enumerate(rings):
            inner, outer = (radius * math.sqrt(k / len(rings)) for k in (j, j + 1))
            for k, age in enumerate(ages):
                a, b = (2 * math.pi * m / len(ages) for m in (k, k + 1))
                (x0, y0), (x1, y1), (x2, y2), (x3, y3) = ((cx + r * math.cos(t), cy + r * math.sin(t)) for r, t in ((inner, a), (outer, a), (outer, b), (inner, b)))
                light = round(245 - 225 * (min(age, oldest) - 1) / max(1, oldest - 1))
                out.append(f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}A{outer:.1f} {outer:.1f} 0 0 1 {x2:.1f} {y2:.1f}L{x3:.1f} {y3:.1f}'
                           + (f'A{inner:.1f} {inner:.1f} 0 0 0 {x0:.1f} {y0:.1f}' if inner else '') + f'Z" fill="#{light:02x}{light:02x}{min(255, light + 20):02x}"/>')
    out.append("</g>")
    out += [f'<text x="{RIGHT + (i + 0.5) * size:.1f}" y="{HEIGHT - 14}" text-anchor="middle">{words}</text>' for i, (words, _) in enumerate(discs)]
    return "\n".join(out + ["</svg>\n"])

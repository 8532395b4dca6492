"""Draws columns of a table over time as an SVG file."""

COLORS = ["#1f77b4", "#d62728", "#2ca02c", "#9467bd"]
WIDTH, HEIGHT, MARGIN = 900, 180, 60


def plot(path, rows, panels):
    """`panels`: pairs of a title and the names of the columns drawn in it."""
    times = [float(row["time_s"]) / 3600 for row in rows]
    parts = []
    for number, (title, columns) in enumerate(panels):
        top = number * (HEIGHT + 50) + 40
        values = [[float(row[c] or 0) for row in rows] for c in columns]
        low, high = min(map(min, values)), max(map(max, values))
        span = high - low or 1.0
        end = times[-1] or 1.0

        def place(time, value, top=top, low=low, span=span, end=end):
            x = MARGIN + time / end * (WIDTH - 2 * MARGIN)
            return f"{x:.1f},{top + HEIGHT - (value - low) / span * HEIGHT:.1f}"

        parts.append(f'<rect x="{MARGIN}" y="{top}" width="{WIDTH - 2 * MARGIN}" height="{HEIGHT}" '
                     'fill="none" stroke="#999"/>')
        parts.append(f'<text x="{MARGIN}" y="{top - 8}">{title}: {low:g} to {high:g}</text>')
        for index, (column, series) in enumerate(zip(columns, values)):
            points = " ".join(place(t, v) for t, v in zip(times, series))
            parts.append(f'<polyline points="{points}" fill="none" stroke="{COLORS[index]}"/>')
            parts.append(f'<text x="{WIDTH - MARGIN}" y="{top + 14 * (index + 1)}" '
                         f'text-anchor="end" fill="{COLORS[index]}">{column}</text>')
    height = len(panels) * (HEIGHT + 50) + 60
    parts.append(f'<text x="{WIDTH / 2}" y="{height - 10}" text-anchor="middle">'
                 f'0 to {times[-1]:.2f} h</text>')
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" '
                    'font-family="sans-serif" font-size="12" style="background:white">\n'
                    + "\n".join(parts) + "\n</svg>\n")

"""A list of values drawn as a small curve without axes: its shape beside its range in words."""

from collections.abc import Sequence

WIDTH, HEIGHT = 100.0, 18.0
INSET = 2.0
"""Distance of the extremes from the edges."""


def draw_spark_line(values: Sequence[float]) -> str:
    """SVG of at least two values at equal distances, from the lowest to the highest over the height of the drawing."""
    low, high = min(values), max(values)
    size = (HEIGHT - 2 * INSET) / (high - low) if high > low else 0.0
    step = (WIDTH - 2 * INSET) / (len(values) - 1)
    points = " ".join(f"{INSET + n * step:.2f},{HEIGHT - INSET - (y - low) * size:.2f}" for n, y in enumerate(values))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}" '
        f'height="{HEIGHT:g}"><polyline points="{points}" fill="none" stroke="#1a1d21" stroke-width="1.2"/></svg>'
    )

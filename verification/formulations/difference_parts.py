"""Ends of the droppers and clamps of the stitch wires, as interpolated displacements."""

from verification.formulations.difference_line import Line
from verification.formulations.difference_statics import join
from verification.formulations.difference_strands import Strands, Weights


def dropper_ends(line: Line, strands: Strands, axis: str) -> tuple[list[Weights], list[Weights]]:
    """Interpolation at the lower and at the upper ends of the droppers."""
    below = [strands["contact", axis].weights(d.position) for d in line.droppers]
    return below, [strands[d.upper, axis].weights(d.position) for d in line.droppers]


def ties(line: Line, strands: Strands, axis: str) -> list[Weights]:
    """Stitch wire minus messenger at every clamp."""
    return [
        join((1.0, strands[name, axis].weights(x)), (-1.0, strands["messenger", axis].weights(x)))
        for x, name in line.clamps
    ]

"""Curves of the track: its curvature, and the lateral position of a pantograph head on a canted track."""

from dataclasses import dataclass

import numpy as np

from pantocheck.model.description.arrays import Array


@dataclass(frozen=True)
class TrackCurve:
    """Curve of the track. Lateral positions count from the centre line of the track, which curves with it."""

    start: float
    end: float
    """Ends of the curve, with its transitions [m]."""
    radius: float
    """Radius; positive: the centre of the curve lies at positive y [m]."""
    transition: float = 0.0
    """Length at either end over which curvature and cant rise in proportion to the distance [m]."""
    cant: float = 0.0
    """Height of the outer rail above the inner rail [m]."""

    def share(self, position: Array) -> Array:
        """Curvature and cant as a share of those of the full curve; 0 outside of the curve.

        Args:
            position: Positions along the track, (n,) [m].
        """
        inside = (self.start < position) & (position < self.end)
        to_end = np.minimum(position - self.start, self.end - position)
        return np.where(inside, np.minimum(to_end / max(self.transition, 1e-9), 1.0), 0.0)


def curvature(curves: tuple[TrackCurve, ...], position: Array) -> Array:
    """Curvature of the track at positions [m], positive towards positive y [1/m]."""
    return np.asarray(sum((curve.share(position) / curve.radius for curve in curves), np.zeros_like(position)))


def head_shift(curves: tuple[TrackCurve, ...], position: Array, rail_distance: float, wire_height: float) -> Array:
    """Lateral position of the centre of a pantograph head: a canted vehicle leans towards the centre of the curve.

    The head is shifted by the height of the wire times cant over rail distance. Suspension and wind are left out.

    Args:
        curves: Curves of the track.
        position: Positions along the track, (n,) [m].
        rail_distance: Distance between the centre lines of both rails [m].
        wire_height: Height of the contact wire above the rails [m].

    Returns:
        Lateral position from the vertical plane of the centre line, (n,) [m].
    """
    leaning = (np.copysign(curve.cant, curve.radius) * curve.share(position) for curve in curves)
    return np.asarray(wire_height / rail_distance * sum(leaning, np.zeros_like(position)))

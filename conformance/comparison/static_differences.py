"""Differences between measured static values and those of a model: outliers, gaps, and refusal of wrong units."""

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import IntegerArray, RealArray
from pantocheck.conformance.comparison.static_record import StaticRecord, StaticValue
from pantocheck.conformance.input_files.input_error import InputError

OUTLIER_SCALES = 5.0
"""Distance of an outlier from the median difference in standard deviations."""
SMALLEST_SCATTER = 0.01
"""Smallest standard deviation of a search for outliers, relative to the median elasticity."""
SMALLEST_HEIGHT_SCATTER_M = 0.001
"""The same of contact wire heights [m]."""
LARGEST_RATIO = 5.0
"""Largest ratio between median elasticities of measurement and model; the smallest ratio of two units is 10."""
LARGEST_HEIGHT_DIFFERENCE_M = 0.5
"""Largest median difference of contact wire heights [m]."""
SAME_POSITION_M = 1e-6
"""Distance between equal positions [m]."""

NORMAL_SCALE = 1.4826
"""Standard deviation over median absolute deviation of a normal distribution."""


def find_static_outliers(name: StaticValue, difference: RealArray, model: RealArray) -> IntegerArray:
    """Find differences that lie far from the median difference.

    The standard deviation follows from the median absolute deviation, which outliers do not change. It is at least the
    rounding of a good measurement, so that exact data have no outliers.

    Parameters
    ----------
    name : StaticValue
        Kind of the values.
    difference : (n,) ndarray
        Differences [m/N or m].
    model : (n,) ndarray
        Values of the model [m/N or m].

    Returns
    -------
    (k,) ndarray of int
        Indices of the outliers.
    """
    floor = SMALLEST_SCATTER * np.median(model) if name == "elasticity" else SMALLEST_HEIGHT_SCATTER_M
    distance = np.abs(difference - np.median(difference))
    scale = max(NORMAL_SCALE * float(np.median(distance)), float(floor))
    return np.flatnonzero(distance > OUTLIER_SCALES * scale)


def find_static_gaps(position: RealArray, section: tuple[float, float], largest: float) -> list[tuple[float, float]]:
    """Find the parts of a section in which neighbouring measured positions are too far apart.

    Parameters
    ----------
    position : (n,) ndarray
        Positions with a measured value, increasing [m].
    section : tuple of float
        Start and end of the evaluated section [m].
    largest : float
        Largest permitted distance [m], also from the ends of the section.

    Returns
    -------
    list of tuple of float
        Start and end of each gap [m].
    """
    inside = position[select_section(position, section)]
    limits = np.concatenate([section[:1], inside, section[1:]])
    wide = np.flatnonzero(np.diff(limits) > largest + SAME_POSITION_M)
    return [(float(limits[i]), float(limits[i + 1])) for i in wide]


def select_section(position: RealArray, section: tuple[float, float]) -> NDArray[np.bool_]:
    """Whether each position lies in a section, ends included."""
    start, end = section
    return np.asarray((position >= start - SAME_POSITION_M) & (position <= end + SAME_POSITION_M))


def refuse_other_unit(record: StaticRecord, name: StaticValue, measured: RealArray, model: RealArray) -> None:
    """Refuse values whose unit or datum is evidently not that of the column or of the sidecar.

    Parameters
    ----------
    record : StaticRecord
        Record of the values.
    name : StaticValue
        Kind of the values.
    measured, model : (n,) ndarray
        Measured values, and those of the model [m/N or m].

    Raises
    ------
    InputError
        The median elasticity is several times that of the model, or the median height differs by decimetres.
    """
    where = f"record '{record.source}', {name.replace('_', ' ')}"
    if name == "elasticity":
        ratio = float(np.median(measured) / np.median(model))
        if not 1 / LARGEST_RATIO <= ratio <= LARGEST_RATIO:
            raise InputError(
                where,
                f"the median is {ratio:.3g} times that of the model",
                "Check the unit at the end of the column name: elasticity_mm_N, elasticity_mm_kN, elasticity_mm_daN.",
            )
        return
    difference = float(np.median(measured - model))
    datum = record.sidecar.datum_m + difference
    if abs(difference) > LARGEST_HEIGHT_DIFFERENCE_M:
        raise InputError(
            where,
            f"the median is {difference:.4g} m above that of the model",
            f"Check the unit of the column, or give datum_m = {datum:.4g} in the sidecar if the table counts "
            "heights from the rail.",
        )

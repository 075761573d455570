"""Measured values beside those of a model."""

from dataclasses import dataclass

from pantocheck.conformance.array_types import IntegerArray, RealArray


@dataclass(frozen=True)
class ValuePair:
    """Measured values of one kind beside those of the model, by increasing position.

    Parameters
    ----------
    position : (n,) ndarray
        Positions along the line [m].
    measured, model, fine_model : (n,) ndarray
        Measured values; values of the model; those with elements of half the length [m/N or m].
    row : (n,) ndarray of int
        Rows of the table, from 1.
    missing_row : (k,) ndarray of int
        Rows without a value.
    """

    position: RealArray
    measured: RealArray
    model: RealArray
    fine_model: RealArray
    row: IntegerArray
    missing_row: IntegerArray

"""Simulated and measured run beside each other in results.json: curves, spectra, and statistics span by span."""

from pantocheck.conformance.core.figure_data import Spectrum
from pantocheck.conformance.core.results_part import FiniteNumber, Number, Owner, ResultsPart


class ForceStatistics(ResultsPart):
    """Statistics of the filtered contact force over one span [N]."""

    mean_N: FiniteNumber
    std_N: FiniteNumber
    max_N: FiniteNumber
    min_N: FiniteNumber


class SpanStatistics(ResultsPart):
    """Statistics of both runs over one span."""

    start_m: FiniteNumber
    end_m: FiniteNumber
    simulated: ForceStatistics
    measured: ForceStatistics


class MeasuredPantograph(ResultsPart):
    """Filtered contact force of one pantograph in both runs, at the same positions of their common track."""

    position_m: list[float]
    simulated_N: list[float]
    measured_N: list[float]
    simulated_spectrum: Spectrum
    measured_spectrum: Spectrum
    spans: list[SpanStatistics]


class MeasuredRun(ResultsPart):
    """Measured run beside the simulated one of its case."""

    name: str
    """Name of the measured record."""
    cutoff_Hz: float
    """Cut-off of the filter of the drawn forces [Hz]."""
    quantities: dict[Owner, dict[str, Number]]
    """Quantities of the measured run, as those of the case."""
    uncertainty: dict[Owner, dict[str, Number]]
    """Half-widths of their 95 % intervals, as in `quantities`."""
    pantographs: dict[Owner, MeasuredPantograph]

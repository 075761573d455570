"""Measured run beside a simulated one: filtered forces at the same positions, spectra, and statistics by span."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from pantocheck.conformance.comparison.force_difference import pair_forces
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.grading.assessed_record import AssessedRecord
from pantocheck.conformance.grading.results_building import key_by_owner, select_finite
from pantocheck.conformance.quantities.line_signals import supports_inside
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.traces import build_spectrum, thin_series
from pantocheck.conformance.results.case_facts_format import (
    ForceStatistics,
    MeasuredPantograph,
    MeasuredRun,
    SpanStatistics,
)


def list_run_supports(record: AssessedRecord) -> tuple[float, ...]:
    """Positions of the supports that a record states or implies [m]; empty if it does neither."""
    if record.prepared is None:
        return ()
    return record.prepared.line.line_supports or tuple(getattr(record.header, "support_position_m", None) or ())


def compare_measured_run(
    simulated: AssessedRecord, measured: AssessedRecord, supports: Sequence[float]
) -> MeasuredRun | None:
    """Compare a measured run with a simulated one at the same positions.

    Args:
        simulated: Record of the simulated passage.
        measured: Record of the same passage.
        supports: Positions of the supports, for the statistics span by span [m].

    Returns:
        The measured run; None if one of the records is a summary.
    """
    if simulated.prepared is None or measured.prepared is None:
        return None
    others = measured.prepared.pantographs
    pairs = {number: (own, others[number]) for number, own in simulated.prepared.pantographs.items()}
    compared = {str(number): _compare_forces(*pair, supports) for number, pair in pairs.items()}
    return MeasuredRun(
        name=measured.name,
        cutoff_Hz=pairs[1][0].force.low_pass.cutoff_Hz,
        quantities=key_by_owner(select_finite(measured.values.values)),
        uncertainty=key_by_owner(select_finite(measured.uncertainty.combined)),
        pantographs={number: part for number, part in compared.items() if part is not None},
    )


def _compare_forces(
    simulated: PantographSignals, measured: PantographSignals, supports: Sequence[float]
) -> MeasuredPantograph | None:
    """Forces of one pantograph; None if the runs share no track that is long enough for the filter."""
    try:
        forces = pair_forces(measured, simulated, simulated.force.low_pass.cutoff_Hz)
        spectra = (build_spectrum(simulated), build_spectrum(measured))
    except QuantityUnavailable:
        return None
    limits = np.asarray(supports, dtype=np.float64)
    within = np.unique(limits[supports_inside(limits, (forces.position[0], forces.position[-1]))])
    return MeasuredPantograph(
        position_m=thin_series(forces.position),
        simulated_N=thin_series(forces.second),
        measured_N=thin_series(forces.first),
        simulated_spectrum=spectra[0],
        measured_spectrum=spectra[1],
        spans=[
            SpanStatistics(
                start_m=float(start),
                end_m=float(end),
                simulated=_describe_force(span.second),
                measured=_describe_force(span.first),
            )
            for start, end in pairwise(within)
            for span in [forces.select(start, end)]
        ],
    )


def _describe_force(force: RealArray) -> ForceStatistics:
    return ForceStatistics(
        mean_N=float(force.mean()), std_N=float(force.std()), max_N=float(force.max()), min_N=float(force.min())
    )

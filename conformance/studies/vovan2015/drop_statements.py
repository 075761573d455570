"""Single statements of Vo Van, Balmes and Lorang (2015) on mass drops: repeats, record length, groups, modes."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DropStatements
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import TextTable
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.decay_preparation import prepare_decay
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_simulation import require_mass_drop, simulate_drop
from pantocheck.conformance.drops.mode_groups import number_groups, required_duration
from pantocheck.conformance.drops.population import Population
from pantocheck.conformance.drops.population_analysis import rank_correlation
from pantocheck.conformance.drops.repeatability import compare_records
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import discretise
from pantocheck.model.modal.modes import Modes, compute_modes_below

SEPARATE_SHARE = 0.1
"""Smallest gap between two groups of lateral modes, over the lowest lateral frequency [-]."""


MERGED_GAPS = (0.5, 1.0, 2.0)
"""Gaps of the table that shows how the merging of groups depends on its definition, over their mean width [-]."""


def compute_statements(case: Case, inputs: DropStatements, first: DropRecord, frequency: RealArray) -> dict[str, Value]:
    """Quantities of the statements that need more than the drops of a case.

    Args:
        case: Case with mass drops.
        inputs: Numbers of the statements.
        first: Record of the first drop.
        frequency: Frequencies of the computed vertical modes, ascending, (n,) [Hz].
    """
    findings: dict[str, Value] = {
        "half_power_record_s": required_duration(
            inputs.half_power_points, inputs.half_power_frequency_Hz, inputs.half_power_damping_ratio
        ),
        "repeat_correlation": correlate_repeat(case, first, inputs.repeat_release_s),
        "lateral_modes_in_group": count_lateral_modes(case, inputs.stagger_m),
    }
    merging = find_merging(frequency, number_groups(frequency, frequency, case.line.geometry.spans))
    return findings if merging is None else findings | {"group_merging_Hz": merging}


def correlate_repeat(case: Case, first: DropRecord, release_s: float) -> tuple[float, ...]:
    """Smallest correlation of the first drop of a case with its repeat, at the start and a minute later [-].

    The repeat has another release [s] and other noise.
    """
    mass_drop = require_mass_drop(case)
    drop = mass_drop.drop[0].model_copy(update={"release_s": release_s})
    changed = mass_drop.model_copy(update={"drop": (drop,)})
    repeat = simulate_drop(replace(case, file=case.file.model_copy(update={"mass_drop": changed})), 1).record
    band = FrequencyBand.up_to(mass_drop.highest_Hz, first.rate)
    rows = compare_records((prepare_decay(first, band), prepare_decay(repeat, band))).comparisons
    later = [row.correlation_later for row in rows if row.correlation_later is not None]
    return (min(row.correlation_at_start for row in rows), *([min(later)] if later else []))


def count_lateral_modes(case: Case, stagger_m: float) -> tuple[float, ...]:
    """Number of lateral modes in each group of the line with a stagger [m], up to the highest identified frequency.

    A lateral mode has more than half of its squared deflection in the lateral direction.
    """
    geometry = case.line.geometry.model_copy(update={"stagger_contact_wire_m": stagger_m})
    line = build_catenary(case.line.model_copy(update={"geometry": geometry}))
    # Half the range is enough for the lowest groups, and keeps the number of modes small.
    modes = compute_modes_below(
        discretise(line, case.file.discretisation.element_m), require_mass_drop(case).highest_Hz / 2
    )
    frequency = select_lateral(modes)
    if frequency.size == 0:
        return ()
    ends = np.flatnonzero(np.diff(frequency) > SEPARATE_SHARE * frequency[0]) + 1
    return tuple(float(group.size) for group in np.split(frequency, ends))


def select_lateral(modes: Modes) -> RealArray:
    """Frequencies of the lateral modes, ascending, (m,) [Hz]; the second half of the rows of a shape is lateral."""
    energy = np.sum(modes.shape[..., 0] ** 2, axis=2)
    share = energy[:, energy.shape[1] // 2 :].sum(axis=1) / energy.sum(axis=1)
    return np.asarray(modes.frequency[share > 0.5])


def find_merging(frequency: RealArray, groups: Sequence[int] | np.ndarray, gap: float = 1.0) -> float | None:
    """Middle of the lowest gap between groups that is smaller than the mean of their widths [Hz]; None: none is.

    Args:
        frequency: Frequencies of the modes, ascending, (n,) [Hz].
        groups: Number of the group of each mode, from 1, (n,).
        gap: Largest gap of merged groups over the mean of their widths [-].
    """
    numbers = np.asarray(groups)
    members = [frequency[numbers == number] for number in range(1, int(numbers.max(initial=0)) + 1)]
    for low, high in pairwise([group for group in members if group.size]):
        if high[0] - low[-1] < gap * (np.ptp(low) + np.ptp(high)) / 2:
            return float((low[-1] + high[0]) / 2)
    return None


def tabulate_merging(case: Case, frequency: RealArray) -> TextTable:
    """Merging of the groups of computed modes [Hz] at several levels of its definition."""
    groups = number_groups(frequency, frequency, case.line.geometry.spans)
    found = {gap: find_merging(frequency, groups, gap) for gap in MERGED_GAPS}
    return TextTable(
        caption="Groups that are no longer separate, by the level of the definition",
        columns=["Gap over the mean width of its groups", "From"],
        rows=[[f"{gap:g}", "-" if place is None else f"{place:.3g} Hz"] for gap, place in found.items()],
    )


def describe_identification(modes: Sequence[Mode], population: Population | None) -> dict[str, Value]:
    """Complexity of the certain modes, and scatter of the identification against the group over all tests."""
    collinearity = [mode.phase_collinearity for mode in modes if mode.certain and not mode.lateral]
    known = [value for value in collinearity if value is not None]
    findings: dict[str, Value] = {"smallest_phase_collinearity": min(known)} if known else {}
    tests = [mode for test in population.tests for mode in test.single.modes] if population else []
    groups: dict[int, list[float]] = {}
    for mode in tests:
        if mode.certain and mode.group is not None and not mode.lateral:
            groups.setdefault(mode.group, []).append(mode.damping_ratio_std)
    correlation = rank_correlation(np.array([np.median(groups[number]) for number in sorted(groups)]))
    return findings if correlation is None else findings | {"identification_scatter_correlation": correlation}

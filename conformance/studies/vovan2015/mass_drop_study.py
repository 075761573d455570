"""Damping model fitted to identified modes, compared with the damping of the simulation.

The observability of the coefficients is drawn as in Vo Van, Balmes and Lorang (2015), Figure 6.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DropStatements
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Mark, Series, TextTable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.damping_model import MATRICES, WIRES
from pantocheck.conformance.drops.damping_results import FitOptions, build_damping_results
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.decay_preparation import prepare_decay
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_simulation import require_mass_drop, simulate_drop
from pantocheck.conformance.drops.identify import Identification
from pantocheck.conformance.drops.mode_groups import number_groups, required_duration
from pantocheck.conformance.drops.population import Population
from pantocheck.conformance.drops.population_analysis import analyse_population, rank_correlation
from pantocheck.conformance.drops.repeatability import compare_records
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.results.damping_format import DampingResults, Observability
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.runs.system import Delivered, StudyResult
from pantocheck.conformance.studies.vovan2015.line_damping import (
    IdentifiedDrops,
    build_drop_run_table,
    build_lines,
    compare_reference,
    compute_group_findings,
    compute_population_findings,
    computed_damping_ratios,
    draw_damping_ratios,
    identify_drops,
    identify_tests,
    select_certain,
)
from pantocheck.conformance.studies.vovan2015.study_report import build_provenance_table, draw_curve
from pantocheck.model import Catenary, Kind, discretise
from pantocheck.model.modal.modes import Modes, compute_modes_below

# Single statements of Vo Van, Balmes and Lorang (2015) on mass drops: repeats, record length, groups, modes.
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


# Damping model fitted to identified modes, compared with the damping of the simulation.
EXACT = FitOptions(free=())
"""Fit on a line that is exact, because the drops are simulated on it."""

SMALLEST_DRAWN_RATIO = 1e-3
"""Smaller ratios, and zero, are drawn at this value on the logarithmic scale [-]."""


def build_fit_report(case: Case, identification: Identification) -> StudyResult:
    """Fit coefficients of each wire to the modes of simulated drops, and report them with their observability.

    Without enough modes, the report is a table with the reason.
    """
    line, element = build_catenary(case.line), case.file.discretisation.element_m
    try:
        results = build_damping_results(identification.modes, line, element, f"the modes of {case.id}", EXACT)
    except InputError as error:
        return StudyResult(tables=(TextTable(caption="Fitted damping: none", columns=["Reason"], rows=[[str(error)]]),))
    return StudyResult(
        findings={LINE: count_observable(results.observability)},
        charts=(_draw_observability(results),),
        tables=(_coefficient_table(results, line),),
    )


def count_observable(rows: Sequence[Observability]) -> dict[str, Value]:
    """Numbers of observable coefficients of the wires and of the other components, by name of quantity."""
    observable = [row.kind in WIRES for row in rows if row.observable]
    return {
        "observable_wire_coefficients": float(sum(observable)),
        "observable_other_coefficients": float(len(observable) - sum(observable)),
    }


def _coefficient_table(results: DampingResults, line: Catenary) -> TextTable:
    rows = []
    for c in results.coefficients:
        rayleigh = line.damping.get(Kind(c.kind))
        simulated = 0.0 if rayleigh is None else getattr(rayleigh, f"{c.matrix}_coefficient")
        difference = f"{100 * (c.value / simulated - 1):+.1f} %" if simulated else "-"
        name = f"{c.kind.replace('_', ' ')}, {c.matrix} [{MATRICES[c.matrix].unit}]"
        rows.append([name, f"{simulated:.4g}", f"{c.value:.4g}", f"{c.low_95:.3g} to {c.high_95:.3g}", difference])
    modal = " The case has modal damping; the fit describes it by Rayleigh damping." if line.modal_damping else ""
    return TextTable(
        caption="Rayleigh damping of the wires: simulated, and fitted to the identified modes." + modal,
        columns=["Coefficient", "Simulated", "Fitted", "Nominal 95 % interval", "Difference"],
        rows=rows,
    )


def _draw_observability(results: DampingResults) -> Chart:
    rows = results.observability
    return Chart(
        caption="Observability of every coefficient: its plausible value divided by its standard deviation from the "
        "modes. An observable coefficient reaches the dashed line and contributes at least "
        f"{100 * results.thresholds.largest_share:g} % of the damping of some mode. "
        f"Values below {SMALLEST_DRAWN_RATIO:g} are drawn at {SMALLEST_DRAWN_RATIO:g}.",
        alternative="; ".join(
            f"{row.kind} {row.matrix}: {row.plausible_over_std:.3g}, "
            f"{'observable' if row.observable else 'not observable'}"
            for row in rows
        ),
        x_label="coefficient",
        y_label="plausible value / std [-]",
        y_scale="log",
        ticks=[f"{row.kind.replace('_', ' ')} {row.matrix}" for row in rows],
        series=[
            Series(
                label="all modes together",
                style="bars",
                x=[float(i) for i in range(len(rows))],
                y=[max(row.plausible_over_std, SMALLEST_DRAWN_RATIO) for row in rows],
            )
        ],
        marks=[Mark(label="needed", axis="y", low=results.thresholds.plausible_over_std)],
    )


# Mass drops of Vo Van, Balmes and Lorang (2015): simulated, identified, and compared with their damping models.
#
# The first of the compared models of a case is the reference model of the paper.
def run_mass_drop_study(case: Case) -> Delivered:
    """Simulate the drops of a case, identify the modes, and report groups of modes, damping models and fit."""
    begin = time.perf_counter()
    identified = identify_drops(case)
    modes = identified.identification.modes
    frequency, ratios = _compute_ratios(case)
    findings = compute_group_findings(modes)
    tests = [identified.identification]
    if case.dampings:
        findings["reference_over_identified_damping"] = compare_reference(modes, frequency, ratios[next(iter(ratios))])
        population = identify_tests(identified, require_mass_drop(case).highest_Hz)
        findings |= compute_population_findings(analyse_population(population))
        findings |= describe_identification(modes, population)
        tests = [test.single for test in population.tests]
    statements = require_mass_drop(case).statements
    if statements is not None:
        findings |= compute_statements(case, statements, identified.drops[0].record, frequency)
    bound = [
        Mark(label=f"printed: all below {100 * limit.upper:g} %", axis="y", low=100 * limit.upper)
        for limit in case.limits
        if limit.quantity == "largest_damping_ratio" and limit.upper is not None
    ][:1]
    fit = build_fit_report(case, identified.identification)
    return Delivered(
        run=build_drop_run_table(case, len(identified.drops), begin),
        notes=_describe_drops(case, identified),
        warnings=identified.identification.warnings,
        study=StudyResult(
            findings={LINE: findings | fit.findings.get(LINE, {})},
            charts=(
                _draw_frequencies(case, identified, (frequency, ratios), bound),
                _draw_groups([mode for test in tests for mode in select_certain(test)], bound),
                *fit.charts,
            ),
            tables=(
                build_provenance_table(case),
                *([] if statements is None else [tabulate_merging(case, frequency)]),
                *fit.tables,
            ),
        ),
    )


def _describe_drops(case: Case, identified: IdentifiedDrops) -> tuple[str, ...]:
    notes = []
    for i, (test, drop) in enumerate(zip(require_mass_drop(case).drop, identified.drops, strict=True), 1):
        last = drop.decay.last_slack
        slack = "no dropper is slack" if last is None else f"droppers are slack until {last:.2f} s"
        wire = test.wire.replace("_", " ")
        notes.append(f"Drop {i}: {test.mass_kg:g} kg on the {wire} at {test.x_m:g} m; {slack} after the release.")
    return tuple(notes)


ComputedRatios = tuple[RealArray, dict[str, RealArray]]
"""Frequencies of the undamped modes [Hz], and their damping ratios by name of the damping model [-]."""


def _compute_ratios(case: Case) -> ComputedRatios:
    """Damping ratios of the computed modes under each compared model, or else under the damping of the case."""
    line = build_catenary(case.line)
    mesh = discretise(line, case.file.discretisation.element_m)
    shapes = compute_modes_below(mesh, require_mass_drop(case).highest_Hz)
    models = build_lines(case) or {"damping of the case": line}
    return shapes.frequency, {name: computed_damping_ratios(mesh, shapes, model) for name, model in models.items()}


def _draw_frequencies(case: Case, identified: IdentifiedDrops, computed: ComputedRatios, bound: list[Mark]) -> Chart:
    """Damping ratio against frequency, identified and computed from each damping model (Figure 7 of the paper)."""
    frequency, ratios = computed
    curves = [draw_curve(name, frequency, 100 * ratio) for name, ratio in ratios.items()]
    groups = [
        Mark(label=f"printed: group {limit.item}", axis="x", low=limit.lower, high=limit.upper)
        for limit in case.limits
        if limit.quantity == "mode_frequency_Hz" and limit.lower is not None and limit.upper is not None
    ]
    return Chart(
        caption="Damping ratio against frequency: identified from the drops with nominal 95 % intervals, and computed "
        "from each damping model.",
        alternative="Damping ratio over frequency; the medians of the groups are in the table of quantities.",
        x_label="frequency [Hz]",
        y_label="damping ratio [%]",
        series=[draw_damping_ratios("identified", identified.certain_modes), *curves],
        marks=[*bound, *groups],
    )


def _draw_groups(modes: Sequence[Mode], bound: list[Mark]) -> Chart:
    """Damping ratios of all tests by group of modes (Figure 5 of the paper)."""
    grouped = [mode for mode in modes if mode.group is not None]
    ratios = draw_damping_ratios("identified", grouped).y
    return Chart(
        caption="Identified damping ratios by group of span modes: quartiles and median.",
        alternative="Box plot of damping ratios by group; the medians are in the table of quantities.",
        x_label="group of span modes",
        y_label="damping ratio [%]",
        series=[Series(label="identified", style="boxes", x=[float(mode.group or 0) for mode in grouped], y=ratios)],
        marks=bound,
    )

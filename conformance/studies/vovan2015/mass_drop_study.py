"""Mass drops of Vo Van, Balmes and Lorang (2015): simulated, identified, and compared with their damping models."""

import time

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.outcome import Delivered, StudyResult
from pantocheck.conformance.results.results_format import Chart, Mark, Series
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.simulation.case_run import build_run_table
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.drop_simulation import require_mass_drop
from pantocheck.conformance.studies.vovan2015.damping_models import build_lines, computed_damping_ratios
from pantocheck.conformance.studies.vovan2015.drop_identification import (
    IdentifiedDrops,
    damping_series,
    identify_drops,
)
from pantocheck.conformance.studies.vovan2015.fit_comparison import build_fit_report
from pantocheck.conformance.studies.vovan2015.group_findings import compute_group_findings
from pantocheck.conformance.studies.vovan2015.provenance_table import build_provenance_table
from pantocheck.model import discretise
from pantocheck.model.modal.modes import compute_modes_below


def run_mass_drop_study(case: Case) -> Delivered:
    """Simulate the drops of a case, identify the modes, and report groups of modes, damping models and fit.

    Parameters
    ----------
    case : Case
        Case with a mass drop.
    """
    begin, mass_drop = time.perf_counter(), require_mass_drop(case)
    identified = identify_drops(case)
    bound = next((limit.upper for limit in case.limits if limit.quantity == "largest_damping_ratio"), None)
    fit_tables, fit_charts = build_fit_report(case, identified.identification)
    simulated_s = len(identified.drops) * (mass_drop.hanging_s + mass_drop.record_s)
    return Delivered(
        run=build_run_table(case.file.discretisation, simulated_s, begin),
        notes=_drop_notes(case, identified),
        warnings=identified.identification.warnings,
        study=StudyResult(
            findings={LINE: compute_group_findings(identified.identification.modes)},
            charts=(_chart_frequencies(case, identified, bound), _chart_groups(identified, bound), *fit_charts),
            tables=(build_provenance_table(case), *fit_tables),
        ),
    )


def _drop_notes(case: Case, identified: IdentifiedDrops) -> tuple[str, ...]:
    tests = zip(require_mass_drop(case).drop, identified.drops, strict=True)
    return tuple(
        f"Drop {i}: {test.mass_kg:g} kg on the {test.wire.replace('_', ' ')} at {test.x_m:g} m; "
        + (
            "no dropper slack after the release."
            if drop.decay.last_slack is None
            else f"droppers slack until {drop.decay.last_slack:.2f} s after it."
        )
        for i, (test, drop) in enumerate(tests, 1)
    )


def _chart_frequencies(case: Case, identified: IdentifiedDrops, bound: float | None) -> Chart:
    """Damping ratio against frequency, identified and computed from each damping model (Figure 7 of the paper)."""
    line = build_catenary(case.line)
    mesh = discretise(line, case.file.discretisation.element_m)
    shapes = compute_modes_below(mesh, require_mass_drop(case).highest_Hz)
    models = build_lines(case) or {"damping of the case": line}
    return Chart(
        caption="Damping ratio against frequency: identified from the drops with 95 % intervals, and computed from "
        "each damping model.",
        alternative="Damping ratio over frequency; the medians of the groups are in the table of quantities.",
        x_label="frequency [Hz]",
        y_label="damping ratio [%]",
        series=[
            damping_series("identified", identified.certain_modes),
            *(
                Series(
                    label=name,
                    style="line",
                    x=thin_series(shapes.frequency),
                    y=thin_series(100 * computed_damping_ratios(mesh, shapes, model)),
                )
                for name, model in models.items()
            ),
        ],
        marks=[*_mark_bound(bound), *_mark_groups(case)],
    )


def _mark_groups(case: Case) -> list[Mark]:
    """Frequency range that the limits give for each group of modes."""
    return [
        Mark(label=f"printed: group {limit.item}", axis="x", low=limit.lower, high=limit.upper)
        for limit in case.limits
        if limit.quantity == "mode_frequency_Hz" and limit.lower is not None and limit.upper is not None
    ]


def _chart_groups(identified: IdentifiedDrops, bound: float | None) -> Chart:
    """Damping ratios by group of modes (Figure 5 of the paper)."""
    grouped = [mode for mode in identified.certain_modes if mode.group is not None]
    return Chart(
        caption="Identified damping ratios by group of span modes: quartiles and median.",
        alternative="Box plot of damping ratios by group; the medians are in the table of quantities.",
        x_label="group of span modes",
        y_label="damping ratio [%]",
        series=[
            Series(
                label="identified",
                style="boxes",
                x=[float(mode.group or 0) for mode in grouped],
                y=damping_series("identified", grouped).y,
            )
        ],
        marks=_mark_bound(bound),
    )


def _mark_bound(bound: float | None) -> list[Mark]:
    return [] if bound is None else [Mark(label=f"printed: all below {100 * bound:g} %", axis="y", low=100 * bound)]

"""A case's mass drops: simulated, identified, and what the groups of modes show."""

import time

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.identification.identify import Identification, identify_modes
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.outcome import Delivered, StudyResult
from pantocheck.conformance.results.results_format import Chart, Mark, Series
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.drop_simulation import require_mass_drop, simulate_drop
from pantocheck.conformance.studies.vovan2015.damping_models import build_lines, computed_damping_ratios
from pantocheck.conformance.studies.vovan2015.fit_comparison import build_fit_report
from pantocheck.conformance.studies.vovan2015.group_findings import compute_group_findings
from pantocheck.conformance.studies.vovan2015.provenance_table import build_provenance_table
from pantocheck.model import discretise
from pantocheck.model.modal.modes import compute_modes_below


def run_mass_drop_study(case: Case) -> Delivered:
    """Simulate a case's drops, identify the modes from their records, and report on groups, models and fit.

    Parameters
    ----------
    case : Case
        With a mass drop.
    """
    begin = time.perf_counter()
    told, steps = require_mass_drop(case), case.file.discretisation
    drops = [simulate_drop(case, number) for number in range(1, len(told.drop) + 1)]
    (found,) = identify_modes(tuple(one.record for one in drops), told.highest_Hz)
    bound = next((limit.upper for limit in case.limits if limit.quantity == "largest_damping_ratio"), None)
    fit_tables, fit_charts = build_fit_report(case, found)
    slack = [one.decay.last_slack for one in drops]
    notes = [
        f"Drop {i}: {test.mass_kg:g} kg on the {test.wire.replace('_', ' ')} at {test.x_m:g} m; "
        + ("no dropper slack after the release." if last is None else f"droppers slack until {last:.2f} s after it.")
        for i, (test, last) in enumerate(zip(told.drop, slack, strict=True), 1)
    ]
    return Delivered(
        run=RunTable(
            simulated_s=len(drops) * (told.hanging_s + told.record_s),
            wall_s=time.perf_counter() - begin,
            dt_s=steps.time_step_s,
            element_m=steps.element_m,
        ),
        notes=tuple(notes),
        warnings=found.warnings,
        study=StudyResult(
            findings={LINE: compute_group_findings(found.modes)},
            charts=(_against_frequency(case, found, bound), _boxes(found, bound), *fit_charts),
            tables=(build_provenance_table(case), *fit_tables),
        ),
    )


def _against_frequency(case: Case, found: Identification, bound: float | None) -> Chart:
    """Identified damping, and that of the models computed from the line (the study's Figure 7)."""
    told = require_mass_drop(case)
    own = build_catenary(case.line)
    mesh = discretise(own, case.file.discretisation.element_m)
    shapes = compute_modes_below(mesh, told.highest_Hz)
    models = build_lines(case) or {"damping of the case": own}
    certain = [mode for mode in found.modes if mode.certain and not mode.lateral]
    return Chart(
        caption="Damping ratio against frequency: identified from the drops with 95 % intervals, and computed from "
        "each damping model.",
        alternative="Damping ratio over frequency; the medians of the groups are in the table of quantities.",
        x_label="frequency [Hz]",
        y_label="damping ratio [%]",
        series=[
            Series(
                label="identified",
                style="points",
                x=thin_series(np.array([mode.frequency_Hz for mode in certain])),
                y=thin_series(np.array([100 * mode.damping_ratio for mode in certain])),
                error=thin_series(np.array([196 * mode.damping_ratio_std for mode in certain])),
            ),
            *(
                Series(
                    label=name,
                    style="line",
                    x=thin_series(shapes.frequency),
                    y=thin_series(100 * computed_damping_ratios(mesh, shapes, line)),
                )
                for name, line in models.items()
            ),
        ],
        marks=[*_bound(bound), *_printed_groups(case)],
    )


def _printed_groups(case: Case) -> list[Mark]:
    """Where the limits put the groups of modes."""
    return [
        Mark(label=f"printed: group {limit.item}", axis="x", low=limit.lower, high=limit.upper)
        for limit in case.limits
        if limit.quantity == "mode_frequency_Hz" and limit.lower is not None and limit.upper is not None
    ]


def _boxes(found: Identification, bound: float | None) -> Chart:
    """Damping by group (the study's Figure 5)."""
    grouped = [mode for mode in found.modes if mode.certain and not mode.lateral and mode.group is not None]
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
                y=thin_series(np.array([100 * mode.damping_ratio for mode in grouped])),
            )
        ],
        marks=_bound(bound),
    )


def _bound(bound: float | None) -> list[Mark]:
    if bound is None:
        return []
    return [Mark(label=f"printed: all below {100 * bound:g} %", axis="y", low=100 * bound)]

"""Damping model fitted to identified modes, compared with the damping of the simulation.

The observability of the coefficients is drawn as in Vo Van, Balmes and Lorang (2015), Figure 6.
"""

from collections.abc import Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.identification.damping.damping_format import DampingResults, Observability
from pantocheck.conformance.identification.damping.damping_results import build_damping_results
from pantocheck.conformance.identification.damping.damping_terms import MATRICES, WIRES
from pantocheck.conformance.identification.identify import Identification
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.results.figure_data import Chart, Mark, Series, TextTable
from pantocheck.conformance.results.outcome import StudyResult
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import Catenary, Kind

SMALLEST_DRAWN_RATIO = 1e-3
"""Smaller ratios, and zero, are drawn at this value on the logarithmic scale [-]."""


def build_fit_report(case: Case, identification: Identification) -> StudyResult:
    """Fit a damping model with coefficients of each wire, and report coefficients and their observability.

    Args:
        case: Case with the simulated drops.
        identification: Modes identified from the drops.

    Returns:
        Numbers of observable coefficients by name of quantity, table and chart; without enough modes, a table with the
        reason.
    """
    line, element = build_catenary(case.line), case.file.discretisation.element_m
    try:
        results = build_damping_results(identification.modes, line, element, f"the modes of {case.id}")
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
        columns=["Coefficient", "Simulated", "Fitted", "95 % interval", "Difference"],
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

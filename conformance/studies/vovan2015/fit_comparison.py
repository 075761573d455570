"""What a damping model fitted to identified modes says beside the one that was put into the simulation."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.identification.damping.damping_format import DampingResults
from pantocheck.conformance.identification.damping.damping_results import build_damping_results
from pantocheck.conformance.identification.damping.damping_terms import MATRICES
from pantocheck.conformance.identification.identify import Identification
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.results.results_format import Chart, Mark, Series, TextTable
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import Catenary, Kind

LEAST_DRAWN_SHARE = 1e-3
"""Ratio at which smaller ones, nought among them, are drawn on a logarithmic scale [-]."""


def build_fit_report(case: Case, found: Identification) -> tuple[tuple[TextTable, ...], tuple[Chart, ...]]:
    """Table of the coefficients put in and fitted, and the observability of every coefficient (the study's Figure 6).

    Parameters
    ----------
    case : Case
        Whose line was simulated.
    found : Identification
        Modes identified from its drops.
    """
    line = build_catenary(case.line)
    try:
        results = fit_identified_damping(case, found)
    except InputError as error:
        return (TextTable(caption="Fitted damping", columns=["Why there is none"], rows=[[str(error)]]),), ()
    return (_coefficients(results, line),), (_observability(results),)


def fit_identified_damping(case: Case, found: Identification) -> DampingResults:
    """Damping model fitted to the modes identified from a case's drops, as `pantocheck fit-damping` has it.

    Raises
    ------
    InputError
        Too few modes.
    """
    element = case.file.discretisation.element_m
    return build_damping_results(found.modes, build_catenary(case.line), element, f"the modes of {case.id}")


def _coefficients(results: DampingResults, line: Catenary) -> TextTable:
    rows = []
    for c in results.coefficients:
        rayleigh = line.damping.get(Kind(c.kind))
        put_in = 0.0 if rayleigh is None else getattr(rayleigh, f"{c.matrix}_coefficient")
        difference = f"{100 * (c.value / put_in - 1):+.1f} %" if put_in else "-"
        name = f"{c.kind.replace('_', ' ')}, {c.matrix} [{MATRICES[c.matrix].unit}]"
        rows.append([name, f"{put_in:.4g}", f"{c.value:.4g}", f"{c.low_95:.3g} to {c.high_95:.3g}", difference])
    modal = (
        " Modal bands of the case are not Rayleigh damping: the fit takes them for it." if line.modal_damping else ""
    )
    return TextTable(
        caption="Rayleigh damping of the wires: put into the simulation, and fitted to the identified modes." + modal,
        columns=["Coefficient", "Put in", "Fitted", "95 % interval", "Off by"],
        rows=rows,
    )


def _observability(results: DampingResults) -> Chart:
    rows = results.observability
    return Chart(
        caption="Observability of every coefficient: its plausible value over the standard deviation with which the "
        "modes determine it. An observable coefficient reaches the dashed line and makes up at least "
        f"{100 * results.thresholds.largest_share:g} % of the damping of some mode. "
        f"Values below {LEAST_DRAWN_SHARE:g} are drawn at {LEAST_DRAWN_SHARE:g}.",
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
                y=[max(row.plausible_over_std, LEAST_DRAWN_SHARE) for row in rows],
            )
        ],
        marks=[Mark(label="needed", axis="y", low=results.thresholds.plausible_over_std)],
    )

"""Damping model of a line from its identified modes: the content of damping.json and of damping.toml."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import tomli_w

from pantocheck.conformance.array_types import ComplexArray
from pantocheck.conformance.identification.damping.damping_format import (
    Coefficient,
    DampingResults,
    Matching,
    MeasuredBand,
    MeasuredRatios,
    ModelComparison,
    PairedMode,
)
from pantocheck.conformance.identification.damping.damping_model import (
    MeasuredModes,
    fit_damping_model,
    fit_modal_bands,
)
from pantocheck.conformance.identification.damping.damping_terms import MATRICES, TABLE_OF_KIND, build_damping_basis
from pantocheck.conformance.identification.damping.line_comparison import compare_line, warn_about_line
from pantocheck.conformance.identification.damping.mode_pairing import (
    ModePair,
    compute_sensor_shapes,
    find_sensor_positions,
    pair_modes,
)
from pantocheck.conformance.identification.damping.observability import (
    THRESHOLDS,
    compute_observability,
    judge_coefficients,
)
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.model import Catenary, Kind, discretise
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.modes import component_energies, compute_modes_below, damping_ratios

MAX_NOTE = 4000
"""Largest length of a note in a line file [characters]."""

MIN_PAIRS = 6
"""Smallest number of identified modes with a computed counterpart for a fit."""


def select_usable(modes: Sequence[Mode], source: str) -> list[Mode]:
    """Select the modes for a fit: certain, vertical and in a group.

    Parameters
    ----------
    modes : sequence of Mode
        Identified modes.
    source : str
        Name of their file, for messages.

    Returns
    -------
    list of Mode
        Usable modes.

    Raises
    ------
    InputError
        None of the modes is usable.
    """
    usable = [mode.rounded() for mode in modes if mode.certain and not mode.lateral and mode.group is not None]
    if not usable:
        raise InputError(source, "holds no certain vertical mode in a group", "Identify longer or more records.")
    return usable


def build_damping_results(modes: Sequence[Mode], line: Catenary, element: float, source: str) -> DampingResults:
    """Fit a damping model to identified modes.

    Parameters
    ----------
    modes : sequence of Mode
        Identified modes; lateral, uncertain and ungrouped ones are left out.
    line : Catenary
        Line of the record; its present damping is the reference of the comparison.
    element : float
        Element length [m].
    source : str
        Name of the file of the modes, for messages.

    Returns
    -------
    DampingResults
        Content of damping.json.

    Raises
    ------
    InputError
        There are too few modes, or too few of them have a computed counterpart.
    """
    usable = select_usable(modes, source)
    comparison = compare_line(usable, line)
    positions = find_sensor_positions(usable, line, source)
    mesh = discretise(line, element, tuple(sorted(x for _, x in positions)))
    shapes = compute_modes_below(mesh, 1.1 * max(mode.frequency_Hz for mode in usable))
    frequency = np.array([mode.frequency_Hz for mode in usable])
    measured_shapes, computed_shapes = compute_sensor_shapes(usable, mesh, shapes, positions)
    pairs = pair_modes(frequency, measured_shapes, shapes.frequency, computed_shapes)
    if len(pairs) < MIN_PAIRS:
        raise InputError(
            source,
            f"only {len(pairs)} of {len(usable)} modes have a computed counterpart, {MIN_PAIRS} are needed",
            "Name the line of the record with --line; spans and tensions determine the frequencies.",
        )
    paired = [usable[pair.measured] for pair in pairs]
    measured = MeasuredModes(
        np.array([mode.frequency_Hz for mode in paired]),
        np.array([mode.damping_ratio for mode in paired]),
        np.array([mode.damping_ratio_std for mode in paired]),
        np.array([mode.group or 0 for mode in paired], dtype=np.int64),
    )
    basis = build_damping_basis(shapes.frequency, component_energies(mesh, shapes))
    paired_basis = basis.select_modes(np.array([pair.computed for pair in pairs], dtype=np.int64))
    fit = fit_damping_model(paired_basis, measured)
    observability = tuple(row for row in compute_observability(paired_basis, measured, fit) if row.largest_share > 0)
    matching = _summarise_matching(len(usable), pairs, measured_shapes)
    coefficients = judge_coefficients(fit.coefficients, observability, matching)
    bands = fit_modal_bands(measured)
    rayleigh = basis.ratios @ np.array([fit.values.get(term, 0.0) for term in basis.terms])
    return DampingResults(
        modes_file=source,
        warnings=(*warn_about_line(comparison), *_warn_about_coefficients(coefficients)),
        line=comparison,
        matching=matching,
        residual=fit.residual,
        coefficients=coefficients,
        modal=tuple(
            MeasuredBand(from_Hz=b.from_frequency, to_Hz=b.to_frequency, damping_ratio=b.damping_ratio) for b in bands
        ),
        observability=observability,
        thresholds=THRESHOLDS,
        pairs=tuple(
            PairedMode(
                measured_Hz=mode.frequency_Hz,
                computed_Hz=shapes.frequency[pair.computed],
                mac=pair.mac,
                group=mode.group,
                measured=mode.damping_ratio,
                fitted=predicted,
                used=bool(used),
            )
            for pair, mode, predicted, used in zip(pairs, paired, fit.predicted, fit.used, strict=True)
        ),
        comparison=ModelComparison(
            measured=MeasuredRatios(
                frequency_Hz=tuple(measured.frequency),
                damping_ratio=tuple(measured.damping_ratio),
                std=tuple(measured.std),
            ),
            frequency_Hz=tuple(shapes.frequency),
            models={
                "line as it is": tuple(damping_ratios(mesh, shapes)),
                "Rayleigh": tuple(rayleigh),
                "Rayleigh + modal": tuple(apply_modal_bands(rayleigh, shapes.frequency, bands)),
            },
        ),
        unpaired=tuple(
            mode.frequency_Hz for i, mode in enumerate(usable) if i not in {pair.measured for pair in pairs}
        ),
    ).rounded()


def _summarise_matching(modes: int, pairs: Sequence[ModePair], shapes: Sequence[ComplexArray]) -> Matching:
    # At a single sensor, all shapes agree.
    mac = [pair.mac for pair in pairs if shapes[pair.measured].size > 1]
    return Matching(
        modes=modes,
        matched=len(pairs),
        matched_share=len(pairs) / modes,
        median_mac=float(np.median(mac)) if mac else None,
        lowest_mac=min(mac, default=None),
    )


def _warn_about_coefficients(coefficients: Sequence[Coefficient]) -> list[str]:
    """Warnings about coefficients that are not determined, one per reason."""
    names: dict[str, list[str]] = {}
    for c in coefficients:
        if not c.determined:
            names.setdefault(c.reason, []).append(f"{c.kind.replace('_', ' ')} {c.matrix}")
    return [f"Not determined: {', '.join(terms)} ({reason})." for reason, terms in names.items()]


def write_damping_toml(results: DampingResults, modal: Sequence[MeasuredBand] = ()) -> str:
    """Text of the table `damping` of a line file, with the warnings as comments.

    A coefficient that is not determined is also a comment, so that no simulation uses it.

    Parameters
    ----------
    results : DampingResults
        The fit.
    modal : sequence of MeasuredBand
        Frequency bands of modal damping: `results.modal`, or none for Rayleigh damping alone.

    Returns
    -------
    str
        Content of damping.toml.
    """
    tables: dict[str, Any] = {
        "trust": "provisional",
        "source": f"fitted to {results.modes_file} by pantocheck fit-damping"[:500],
        "note": f"residual {100 * results.residual:.2g} % of the measured damping ratios",
    }
    comments = [f"warning: {text}" for text in results.warnings]
    for c in results.coefficients:
        table, key = TABLE_OF_KIND[Kind(c.kind)], MATRICES[c.matrix].key
        if c.determined:
            tables.setdefault(table, {})[key] = c.value
        else:
            comments.append(f"not determined, left out: {table}.{key} = {c.value:g}")
    if any(not c.determined for c in results.coefficients):
        comments.append("In a simulation, a coefficient that is left out counts as 0.")
    if results.warnings:
        tables["note"] = " ".join((tables["note"] + ".", *results.warnings))[:MAX_NOTE]
    if modal:
        tables["modal"] = [band.model_dump() for band in modal]
    lines = "".join(f"# {_join_lines(text)}\n" for text in comments)
    return lines + tomli_w.dumps({"damping": tables}, multiline_strings=False)


def _join_lines(text: str) -> str:
    """Text in one line, without characters that are not possible in a TOML comment."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())

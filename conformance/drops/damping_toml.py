"""Table `damping` of a line file from a fitted damping model."""

from collections.abc import Sequence
from typing import Any

import tomli_w

from pantocheck.conformance.drops.damping_terms import JOINED_WIRES, MATRICES, TABLE_OF_KIND, WIRES
from pantocheck.conformance.results.damping_format import DampingResults, MeasuredBand
from pantocheck.model import Kind

MAX_NOTE = 4000
"""Largest length of a note in a line file [characters]."""


def write_damping_toml(results: DampingResults, modal: Sequence[MeasuredBand] = ()) -> str:
    """Text of the table `damping` of a line file, with the warnings as comments.

    A coefficient that is not determined is also a comment, so that no simulation uses it.

    Args:
        results: The fit.
        modal: Frequency bands of modal damping: `results.modal`, or none for Rayleigh damping alone.
    """
    tables: dict[str, Any] = {
        "trust": "provisional",
        "source": f"fitted to {results.modes_file} by pantocheck drop fit"[:500],
        "note": f"residual {100 * results.residual:.2g} % of the measured damping ratios",
    }
    comments = [f"warning: {text}" for text in results.warnings]
    for c in results.coefficients:
        key = MATRICES[c.matrix].key
        for kind in WIRES if c.kind == JOINED_WIRES else (c.kind,):
            table = TABLE_OF_KIND[Kind(kind)]
            if c.determined:
                tables.setdefault(table, {})[key] = c.value
                comments.append(f"{table}.{key}: 95 % interval {c.low_95:.3g} to {c.high_95:.3g}")
            else:
                comments.append(f"not determined, left out: {table}.{key} = {c.value:g}")
    for other in results.stated:
        tables[TABLE_OF_KIND[Kind(other.kind)]] = {
            MATRICES[matrix].key: value
            for matrix, value in (("stiffness", other.stiffness_coefficient_s), ("mass", other.mass_coefficient_1_s))
        }
        comments.append(f"{TABLE_OF_KIND[Kind(other.kind)]}: as the line states it, not fitted")
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

"""Tables of the stored studies of the inputs: resolving power, and conditions of the values."""

from collections.abc import Sequence

from pantocheck.conformance.cases.case_source import list_library
from pantocheck.conformance.cases.input_studies import ErrorBound, find_conditions, find_resolving_power
from pantocheck.conformance.line.library_folder import library_folder
from site_pages.markdown_table import build_markdown_table

SHOWN = {"std_force_N": "0-20 Hz", "rms_0_5_N": "0-5 Hz", "rms_5_20_N": "5-20 Hz", "rms_20_50_N": "20-50 Hz"}
"""Quantities of the conditions, with their headings."""


def build_power_table() -> str:
    """Smallest noticed error of every input, smaller and larger values, by case and verdict."""
    found = map(find_resolving_power, sorted(list_library(library_folder())))
    files = [file for file in found if file is not None]
    names = [(row.name, row.unit) for row in files[0].input]
    headings, columns = ["input", "unit"], []
    for file in files:
        rows = {row.name: row for row in file.input}
        short = file.case.removeprefix("en50318-")
        kinds = {f"{short}, both verdicts": ("down", "up"), f"{short}, criteria": ("down_criteria", "up_criteria")}
        for heading, keys in kinds.items():
            found_rows = [rows.get(name) for name, _ in names]
            cells = [_join([getattr(row, key, None) for key in keys]) for row in found_rows]
            if any(cells):
                headings.append(heading)
                columns.append(cells)
    cells_by_row = zip(names, zip(*columns, strict=True), strict=True)
    return build_markdown_table(headings, [(name, unit, *cells) for (name, unit), cells in cells_by_row]) + "\n"


def _join(bounds: Sequence[ErrorBound | None]) -> str:
    """Smallest noticed errors of both directions; `>`: none up to this error."""
    if not any(bounds):
        return ""
    texts = []
    for sign, bound in zip("−+", bounds, strict=True):
        if bound is None:
            texts.append("–")
        else:
            texts.append(f"{sign}{bound.noticed:.3g}" if bound.noticed is not None else f">{sign}{bound.passed:.3g}")
    return " / ".join(texts)


def build_condition_table() -> str:
    """Changes of the bands by every condition, of every case; values of several pantographs are joined."""
    rows = []
    for name in sorted(list_library(library_folder())):
        if (file := find_conditions(name)) is None:
            continue
        for condition in file.condition:
            changes = {(row.pantograph, row.quantity): f"{row.change_pct:+.1f}" for row in condition.change}
            owners = sorted({owner for owner, _ in changes if owner})
            cells = [" / ".join(changes[owner, quantity] for owner in owners) for quantity in SHOWN]
            reason = f": not applicable, {condition.not_applicable}" if condition.not_applicable else ""
            rows.append((f"`{name}`", f"{condition.name}{reason}", *cells))
    return build_markdown_table(("case", "other input", *(f"{head} [%]" for head in SHOWN.values())), rows) + "\n"

"""Inputs of a case: values of every group with their trust and source; groups of an earlier case are named only."""

from collections import defaultdict
from collections.abc import Sequence

from pantocheck.conformance.input_files.units import UNIT_FAMILIES, find_unit, key_suffix
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.page_text import format_plain
from pantocheck.conformance.results.case_facts_format import StoredRange, StoredValue
from pantocheck.conformance.results.results_format import CaseResult, InputGroup

INPUT_COLUMNS = (
    doc.Column("Group", share=1.5),
    doc.Column("Values", share=5),
    doc.Column("Trust"),
    doc.Column("Source"),
)
PROVISIONAL = "○"
"""Mark of a single value that is not traced to a printed source."""

PROVISIONAL_KEY = f"{PROVISIONAL}: value not traced to a printed source."

KEY_UNITS = {"1_s": "1/s", "1_m": "1/m", "pct": "%", "C": "°C", "K": "K", "1_K": "1/K", "m3": "m3", "deg": "°"} | {
    key_suffix(symbol): symbol for family in UNIT_FAMILIES for symbol in family.factors
}
"""Units by the end of a key."""


def input_blocks(case: CaseResult, earlier: tuple[CaseResult, ...], anchor: str) -> tuple[doc.Block, ...]:
    """Table of the inputs of a case with its sources, and the groups that are those of an earlier case.

    Args:
        case: The case.
        earlier: Cases that stand before it in the report.
        anchor: Anchor of the sources, before their number.
    """
    single, groups = _split_single_values(case.inputs)
    repeated: dict[str, list[str]] = defaultdict(list)
    shown = []
    for group in groups:
        other = next((other.id for other in earlier if group in other.inputs), None)
        if other is None:
            shown.append(group)
        else:
            repeated[other].append(group.group)
    sources = list(dict.fromkeys(group.source for group in shown))
    rows = tuple(_row(group, single, sources, anchor) for group in shown)
    marked = PROVISIONAL_KEY if any(PROVISIONAL in str(row[1]) for row in rows) else ""
    texts = [*filter(None, [marked]), *(f"As in {name}: {', '.join(names)}." for name, names in repeated.items())]
    return (
        *((doc.Table(INPUT_COLUMNS, rows),) if rows else ()),
        *((doc.NumberedList("Sources of the inputs", tuple(sources), anchor),) if sources else ()),
        *((doc.SmallPrint(" ".join(texts)),) if texts else ()),
    )


def _split_single_values(inputs: Sequence[InputGroup]) -> tuple[set[str], list[InputGroup]]:
    """Dotted names of single provisional values whose group shows them, and all other groups."""
    stated = {f"{group.group}.{key}".split("[")[0] for group in inputs for key in group.values}
    tops = {name for name in (group.group for group in inputs if not group.values) if _is_stated(name, stated)}
    return tops, [group for group in inputs if group.group not in tops]


def _is_stated(name: str, stated: set[str]) -> bool:
    return any(key == name or key.startswith(f"{name}.") for key in stated)


def _row(group: InputGroup, single: set[str], sources: list[str], anchor: str) -> tuple[doc.RichText, ...]:
    number = sources.index(group.source) + 1
    values = [
        f"{_describe_value(key, value)}{f' {PROVISIONAL}' if _is_single(group.group, key, single) else ''}"
        for key, value in group.values.items()
    ]
    source = doc.Link(f"[{number}]", f"{anchor}-{number}")
    return doc.Code(group.group), "; ".join(values) or "–", doc.TrustMark(group.trust), source


def _is_single(group: str, key: str, single: set[str]) -> bool:
    parts = key.split(".")
    return any(".".join((group, *parts[:n])) in single for n in range(1, len(parts) + 1))


def _describe_value(key: str, value: StoredValue) -> str:
    """Name, value and unit of an input: `tension 20000 N`."""
    suffix = next((unit for unit in ("1_s", "1_m", "1_K") if key.endswith(f"_{unit}")), None) or find_unit(key)
    suffix = suffix or next((unit for unit in KEY_UNITS if key.endswith(f"_{unit}")), None)
    name = key.removesuffix(f"_{suffix}").replace("_", " ").replace(".", ", ")
    return f"{name} {_format_input(value)} {KEY_UNITS[suffix] if suffix else ''}".rstrip()


def _format_input(value: StoredValue) -> str:
    if isinstance(value, StoredRange):
        lowest, highest = format_plain(value.lowest), format_plain(value.highest)
        return f"{value.count} values, {lowest} to {highest}"
    if isinstance(value, list):
        return ", ".join(map(_format_input, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return format_plain(value) if isinstance(value, int | float) else str(value).replace("_", " ")

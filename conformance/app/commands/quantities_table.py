"""Table of the values of quantities with their uncertainty, for results without limits."""

from collections.abc import Collection, Mapping, Sequence

from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text, format_number
from pantocheck.conformance.quantities.registry import unit_of
from pantocheck.conformance.results.incomplete_uncertainty import describe_half_width

MAIN_VALUES = (
    *("mean_force_N", "std_force_N", "statistical_max_N", "statistical_min_N"),
    *("max_force_N", "min_force_N", "contact_loss_pct", "max_uplift_at_support_mm"),
)
"""Values of a passage that are printed without `-v`."""

NamedValues = Mapping[str, Mapping[str, object]]
"""Values or uncertainties by pantograph ("0": the line) and quantity."""


def build_quantities_table(
    values: NamedValues, uncertainty: NamedValues, names: Collection[str], missing: Sequence[str] = ()
) -> FittedTable:
    """Table of quantities that are single numbers; those of the line come last.

    `names` chooses and orders the quantities; `missing` are the components that the uncertainties lack.
    """
    numbers = ("value", "+-") if uncertainty else ("value",)
    headings = ("quantity", *numbers, "unit")
    table = build_table(*headings, unbroken=headings, right=numbers)
    for owner, quantities in sorted(values.items(), key=lambda item: (item[0] == "0", item[0])):
        for name in names:
            value, width = quantities.get(name), uncertainty.get(owner, {}).get(name)
            if isinstance(value, float):
                text = name + (f", pantograph {owner}" if int(owner) > 1 else "")
                errors = (
                    [format_width(width if isinstance(width, float) else None, missing, name)] if uncertainty else []
                )
                table.add_row(escape_text(text), format_number(value), *errors, unit_of(name))
    return table


def format_width(width: float | None, missing: Sequence[str], quantity: str) -> str:
    """Half-width of a quantity with two digits; a dash for None."""
    return "-" if width is None else describe_half_width(width, format_number(width, 2), missing, quantity)


def list_names(values: NamedValues) -> tuple[str, ...]:
    """Names of all quantities of a result, in their order."""
    return tuple(dict.fromkeys(name for quantities in values.values() for name in quantities))


def select_main(values: NamedValues) -> tuple[str, ...]:
    """Names of the main quantities of a result: those of a passage, or all of a line at rest."""
    names = list_names(values)
    return tuple(name for name in MAIN_VALUES if name in names) or names

"""Tables of a changed damping: computed and printed values, and the changes with their range."""

from collections.abc import Mapping

from pantocheck.conformance.quantities.evaluation import LINE, ValuesByOwner
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.figure_data import TextTable
from pantocheck.conformance.studies.band_charts import PrintedValues, list_pantographs
from pantocheck.conformance.studies.vovan2015.force_changes import COMPARED_QUANTITIES, ForceChanges


def build_values_table(values: Mapping[str, ValuesByOwner], printed: PrintedValues) -> TextTable:
    """Build a table of the computed and printed values under each damping model.

    Args:
        values: Computed values by damping model.
        printed: Printed values by damping model and pantograph.
    """
    pantographs = list_pantographs(values)
    rows = []
    for quantity in ("mean_force_N", *COMPARED_QUANTITIES, "contact_loss_pct"):
        for model, computed in values.items():
            sources = [source for p in pantographs for source in (computed.get(p, {}), printed.get((model, p), {}))]
            numbers = [source.get(quantity) for source in sources]
            cells = [f"{number:.3g}" if isinstance(number, int | float) else "-" for number in numbers]
            rows.append([quantity, model, *cells])
    heads = [f"{origin}, pantograph {p}" for p in pantographs for origin in ("computed", "printed")]
    return TextTable(
        caption="Computed and printed values. Line and pantograph are assumed: absolute values are informative.",
        columns=["Quantity", "Damping", *heads],
        rows=rows,
    )


def build_changes_table(changes: ForceChanges, printed: ValuesByOwner) -> TextTable:
    """Build a table of the changes: printed, computed, and smallest and largest value over shifted sections.

    Args:
        changes: Computed changes.
        printed: Changes of the printed values.
    """
    rows = []
    for owner, values in sorted(changes.values.items(), key=lambda item: (item[0] == LINE, item[0])):
        for name, value in values.items():
            shifted = changes.list_shifted(owner, name)
            numbers = [printed.get(owner, {}).get(name), value, min(shifted, default=None), max(shifted, default=None)]
            cells = [f"{number:.3g}" if isinstance(number, float) else "-" for number in numbers]
            rows.append([QUANTITIES[name].label, "both" if owner == LINE else str(owner), *cells])
    sections = len(changes.shifted)
    return TextTable(
        caption="Changes by the damping [%], comparison of the two pantographs, and their range over "
        f"{sections} positions of the analysis section.",
        columns=["Quantity", "Pantograph", "Printed", "Computed", "Smallest", "Largest"],
        rows=rows,
    )

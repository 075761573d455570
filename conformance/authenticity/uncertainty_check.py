"""Check of the stated uncertainties: they must follow from their components."""

import math
from collections.abc import Collection, Iterator

from pantocheck.conformance.authenticity.reported_numbers import same_number
from pantocheck.conformance.results.criterion_format import ComponentName, Criterion
from pantocheck.conformance.results.results_format import CaseResult, UncertaintyComponents
from pantocheck.conformance.results.results_part import select_item


def check_components(
    row: Criterion, components: UncertaintyComponents, names: Collection[ComponentName]
) -> Iterator[str]:
    """The components of a criterion must be those of its quantity; a drift and a missing limit have none.

    Args:
        row: Criterion.
        components: Components of all quantities of the case.
        names: Components that count for the criterion.

    Yields:
        One line if they differ.
    """
    if row.is_drift or (row.lower is None and row.upper is None):
        return
    reported = components.get(str(row.pantograph), {}).get(row.quantity, {})
    listed = {name: select_item(width, row.item) for name, width in reported.items() if name in names}
    if row.value is not None and row.components != listed:
        yield "components of the uncertainty differ from those reported with the quantities"


def check_combination(case: CaseResult) -> Iterator[str]:
    """Every combined uncertainty must be the root of the sum of the squares of its components."""
    for key, quantities in case.uncertainty_components.items():
        for name, parts in quantities.items():
            columns = [width if isinstance(width, list) else [width] for width in parts.values()]
            expected = [math.hypot(*items) for items in zip(*columns, strict=False)]
            stated = case.uncertainty.get(key, {}).get(name)
            numbers = stated if isinstance(stated, list) else [stated]
            if len(numbers) != len(expected) or not all(map(same_number, numbers, expected)):
                yield f"pantograph {key}: uncertainty of {name} does not follow from its components"

"""Tolerances of a line: how far its stated values can be from those of the built line."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.features import NO_FEATURE
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.line.elements.element import Element

Share = Annotated[
    float | None,
    Field(gt=0, le=200, exclude_if=is_absent, description="standard deviation [% of the value]"),
    NO_FEATURE,
]


class CorrelationTable(InputTable):
    """Correlation of the tolerances; a property that is not named is independent of the others."""

    names: Annotated[tuple[str, ...], Field(strict=False, min_length=2, max_length=20)]
    """Properties: keys of the tolerances without `_pct`."""
    rows: Annotated[tuple[Annotated[tuple[float, ...], Field(strict=False)], ...], Field(strict=False)]
    """Symmetric matrix of correlations [-]."""

    @cross_check
    def _check_matrix(self) -> Problems:
        size = len(self.names)
        if len(self.rows) != size or any(len(row) != size for row in self.rows):
            yield validation_problem("rows", f"not {size} rows of {size} numbers", "Give one row for each name.")
            return
        matrix = np.array(self.rows)
        if np.abs(matrix - matrix.T).max() > 1e-6 or np.abs(np.diag(matrix) - 1).max() > 1e-6:
            yield validation_problem("rows", "not symmetric with ones on the diagonal", "Give correlations.")
        elif np.linalg.eigvalsh(matrix)[0] < -1e-6:
            yield validation_problem("rows", "has a negative eigenvalue", "Give the correlations of one covariance.")


class ToleranceTable(SourcedTable):
    """Standard deviations of the properties of the built line from the stated values; they change no simulation."""

    contact_wire_tension_pct: Share = None
    messenger_wire_tension_pct: Share = None
    dropper_stiffness_pct: Share = None
    messenger_support_stiffness_pct: Share = None
    steady_arm_stiffness_pct: Share = None
    steady_arm_moving_mass_pct: Share = None
    contact_wire_mass_coefficient_pct: Share = None
    contact_wire_stiffness_coefficient_pct: Share = None
    messenger_wire_mass_coefficient_pct: Share = None
    messenger_wire_stiffness_coefficient_pct: Share = None
    correlation: Annotated[CorrelationTable | None, Field(exclude_if=is_absent), NO_FEATURE] = None

    @cross_check
    def _check_names(self) -> Problems:
        for name in () if self.correlation is None else self.correlation.names:
            if getattr(self, f"{name}_pct", None) is None:
                yield validation_problem(
                    "correlation.names", f"{name[:80]!r} has no tolerance", f"Give {name[:80]}_pct as well."
                )


class Tolerances(Element):
    """Tolerances of the properties of the line."""

    tolerance: Annotated[ToleranceTable | None, Field(exclude_if=is_absent), NO_FEATURE] = None
    """Standard deviations of the built line from the stated values."""

    def covariance_of(self, names: Sequence[str], defaults: Sequence[float]) -> RealArray:
        """Covariance of properties as shares of their values, (p, p) [-].

        Args:
            names: Properties, as the keys of the tolerances without `_pct`.
            defaults: Standard deviation of each without a stated tolerance [-].
        """
        stated = [None if self.tolerance is None else getattr(self.tolerance, f"{name}_pct") for name in names]
        std = np.array([share if pct is None else pct / 100 for pct, share in zip(stated, defaults, strict=True)])
        correlation = np.eye(len(names))
        table = None if self.tolerance is None else self.tolerance.correlation
        if table is not None:
            place = {name: number for number, name in enumerate(table.names)}
            known = [(i, place[name]) for i, name in enumerate(names) if name in place]
            for i, k in known:
                for j, m in known:
                    correlation[i, j] = table.rows[k][m]
        return np.asarray(correlation * np.outer(std, std))

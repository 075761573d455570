"""Mean forces that the rows of Table 1 of Vo Van, Balmes and Lorang (2015) imply.

python -m verification.tables.printed_table

The bands partition the variance: the standard deviation up to 20 Hz (50 Hz) is the root of the sum of the squares of
two (three) bands. Divided by the coefficient of variation, it is the mean force. A printed coefficient has two digits.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from verification.tables.table_scenarios import load_study

ROUNDING = 0.005
"""Half a unit of the last digit of a coefficient of variation [-]."""
VARIATIONS = {"cov_20": 2, "cov_50": 3}
"""Number of bands below the cut-off of each coefficient of variation."""


class ImpliedMean(NamedTuple):
    """Smallest and largest mean force [N] that one coefficient of variation allows."""

    low: float
    high: float

    def meets(self, other: "ImpliedMean") -> bool:
        """Whether a mean force lies in both ranges."""
        return max(self.low, other.low) <= min(self.high, other.high)


def standard_deviation(row: Mapping[str, float], bands: int) -> float:
    """Standard deviation of the force in the lowest bands [N]."""
    return float(sum(row[band] ** 2 for band in BAND_QUANTITIES[:bands]) ** 0.5)


def imply_mean(row: Mapping[str, float], variation: str) -> ImpliedMean:
    """Mean force of a row of the table by one coefficient of variation, with its rounding."""
    deviation = standard_deviation(row, VARIATIONS[variation])
    return ImpliedMean(*(deviation / (row[variation] + rounding) for rounding in (ROUNDING, -ROUNDING)))


def list_means() -> Iterator[tuple[int, str, ImpliedMean, ImpliedMean]]:
    """Pantograph, damping model, and mean force by the two coefficients of variation, for every printed row."""
    for table in sorted(load_study().file.study.printed, key=lambda table: (table.pantograph, table.model)):
        yield table.pantograph, table.model, *(imply_mean(table.values, name) for name in VARIATIONS)


def change_at_equal_mean(pantograph: int, variation: str) -> float:
    """Change of a coefficient of variation that the printed bands give if the mean force stays the same [%]."""
    rows = {table.model: table.values for table in load_study().file.study.printed if table.pantograph == pantograph}
    before, after = (standard_deviation(rows[model], VARIATIONS[variation]) for model in ("initial", "updated"))
    return 100 * (after / before - 1)


def main() -> None:
    """Print both tables."""
    print("| row | mean force from 20 Hz [N] | mean force from 50 Hz [N] | one mean force |\n|---|---|---|---|")
    for pantograph, model, low, high in list_means():
        ranges = " | ".join(f"{mean.low:.1f} to {mean.high:.1f}" for mean in (low, high))
        print(f"| {('front', 'rear')[pantograph - 1]}, {model} | {ranges} | {'yes' if low.meets(high) else 'no'} |")


if __name__ == "__main__":
    main()

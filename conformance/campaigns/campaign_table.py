"""Tables of a campaign: one row per run with all inputs, verdicts and quantities."""

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.campaigns.campaign_store import CampaignStore
from pantocheck.conformance.core.extras import is_installed
from pantocheck.conformance.core.files import produce_atomically

RUN_COLUMNS = ("run", "design", "case", "system")
UNCERTAINTY = ".uncertainty"
"""End of the name of a column that holds the half-width of the 95 % interval of a quantity."""

VERDICT_COLUMNS = ("verdict", "criteria_verdict", "verification_verdict", "reason")


def write_campaign_table(store: CampaignStore, path: Path) -> None:
    """Write the finished runs as CSV, by their numbers; the same runs give the same bytes."""
    produce_atomically(path, lambda temporary: _write(store, temporary))


def _write(store: CampaignStore, path: Path) -> None:
    inputs: dict[str, None] = {}
    values: dict[str, None] = {}
    for row in store.rows():
        inputs |= dict.fromkeys(row.run.inputs)
        values |= dict.fromkeys(list_values(row))
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow((*RUN_COLUMNS, *inputs, *VERDICT_COLUMNS, *values))
        for row in store.rows():
            cells = list_values(row)
            writer.writerow([*_list_cells(row, list(inputs)), *(cells.get(name, "") for name in values)])


def list_values(row: RunRow) -> dict[str, float]:
    """Quantities of a run, each with the half-width of its interval of uncertainty behind it, if that is known."""
    values: dict[str, float] = {}
    for name, value in row.quantities.items():
        values[name] = value
        if name in row.uncertainties:
            values[f"{name}{UNCERTAINTY}"] = row.uncertainties[name]
    return values


def write_parquet(table: Path) -> Path | None:
    """Write a CSV table as Parquet beside it; None if the package pyarrow is not installed."""
    if not is_installed("pyarrow"):
        return None
    import pyarrow.csv
    import pyarrow.parquet

    path = table.with_suffix(".parquet")
    content = pyarrow.csv.read_csv(table)
    produce_atomically(path, lambda temporary: pyarrow.parquet.write_table(content, temporary))
    return path


def collect_columns(store: CampaignStore) -> dict[str, list[Any]]:
    """Columns of the CSV table; None: a missing cell."""
    columns: dict[str, list[Any]] = {}
    for place, row in enumerate(store.rows()):
        run = row.run
        plan = zip(RUN_COLUMNS, (run.number, run.design, run.case_id, run.system), strict=True)
        facts = {**run.inputs, **row.verdicts, "reason": row.reason}
        for name, value in {**dict(plan), **facts, **list_values(row)}.items():
            column = columns.setdefault(name, [])
            column += [None] * (place - len(column))  # cells of earlier runs without this value
            column.append(value)
    length = len(columns.get("run", ()))
    return {name: [*column, *[None] * (length - len(column))] for name, column in columns.items()}


def _list_cells(row: RunRow, inputs: list[str]) -> Iterator[object]:
    """Cells of a run before its quantities; a list of values is JSON."""
    run = row.run
    yield from (run.number, run.design, run.case_id, run.system)
    for key in inputs:
        value = run.inputs.get(key, "")
        yield value if isinstance(value, int | float | str) and not isinstance(value, bool) else json.dumps(value)
    yield from (row.verdicts[name] or "" for name in VERDICT_COLUMNS[:-1])
    yield row.reason or ""

"""Tables of a campaign: one row per run with all inputs, verdicts and quantities."""

import csv
import json
from collections.abc import Iterator
from pathlib import Path

from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.campaigns.campaign_store import CampaignStore
from pantocheck.conformance.input_files.atomic_writing import produce_atomically

RUN_COLUMNS = ("run", "design", "case", "system")
VERDICT_COLUMNS = ("verdict", "criteria_verdict", "verification_verdict", "reason")


def write_campaign_table(store: CampaignStore, path: Path) -> None:
    """Write the finished runs as CSV, by their numbers; the same runs give the same bytes.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    produce_atomically(path, lambda temporary: _write(store, temporary))


def _write(store: CampaignStore, path: Path) -> None:
    inputs: dict[str, None] = {}
    quantities: dict[str, None] = {}
    for row in store.rows():
        inputs |= dict.fromkeys(row.run.inputs)
        quantities |= dict.fromkeys(row.quantities)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow((*RUN_COLUMNS, *inputs, *VERDICT_COLUMNS, *quantities))
        for row in store.rows():
            writer.writerow([*_list_cells(row, list(inputs)), *(row.quantities.get(name, "") for name in quantities)])


def _list_cells(row: RunRow, inputs: list[str]) -> Iterator[object]:
    """Cells of a run before its quantities; a list of values is JSON."""
    run = row.run
    yield from (run.number, run.design, run.case_id, run.system)
    for key in inputs:
        value = run.inputs.get(key, "")
        yield value if isinstance(value, int | float | str) and not isinstance(value, bool) else json.dumps(value)
    yield from (row.verdicts[name] or "" for name in VERDICT_COLUMNS[:-1])
    yield row.reason or ""

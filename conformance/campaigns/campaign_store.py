"""Store of a campaign: an SQLite file to which each finished run is written within a second."""

import json
import sqlite3
import threading
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_run import FAILED, RunRow
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError

STORE_NAME = "campaign.sqlite"

_TABLES = """
CREATE TABLE IF NOT EXISTS campaign (name TEXT PRIMARY KEY, content TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS run (
  number INTEGER PRIMARY KEY,
  design INTEGER NOT NULL,
  case_id TEXT NOT NULL,
  system TEXT NOT NULL,
  inputs TEXT NOT NULL,
  verdict TEXT NOT NULL,
  verdicts TEXT NOT NULL,
  reason TEXT,
  quantities TEXT NOT NULL,
  wall_s REAL NOT NULL,
  uncertainties TEXT NOT NULL,
  balance_forces TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS trace (number INTEGER PRIMARY KEY, content BLOB NOT NULL);
"""


COMMIT_S = 1.0
"""Time from a finished run to the commit that writes it [s]. A commit waits for the disk, longer than a short run."""


class CampaignStore:
    """Rows of the finished runs of one campaign in an open database. One process at a time writes them."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._connection = connection
        self._lock = threading.Lock()
        self._timer: threading.Timer | None = None

    def add(self, row: RunRow) -> None:
        """Write a finished run with its traces.

        The end of this process or of the machine loses the runs that were finished in the last `COMMIT_S`, and no
        others. The next session repeats them.
        """
        run = row.run
        values = (
            *(run.number, run.design, run.case_id, run.system, json.dumps(run.inputs, default=str)),
            *(row.verdicts["verdict"], json.dumps(row.verdicts), row.reason, json.dumps(row.quantities), row.wall_s),
            json.dumps(row.uncertainties),
            json.dumps(row.balance_forces),
        )
        with self._lock:
            if row.traces:  # before the run: a run in the store then has its traces
                self._connection.execute("INSERT OR REPLACE INTO trace VALUES (?, ?)", (run.number, row.traces))
            self._connection.execute(f"INSERT INTO run VALUES ({', '.join('?' * len(values))})", values)
            if self._timer is None:
                self._timer = threading.Timer(COMMIT_S, self._commit_later)
                self._timer.daemon = True
                self._timer.start()

    def commit(self) -> None:
        """Write the runs that are not written yet."""
        with self._lock:
            self._timer = None
            self._connection.commit()

    def _commit_later(self) -> None:
        with suppress(sqlite3.Error):  # a full disk: the next commit of this session raises the error
            self.commit()

    def holds(self, number: int) -> bool:
        """Whether a run is finished."""
        return self._connection.execute("SELECT 1 FROM run WHERE number = ?", (number,)).fetchone() is not None

    def count(self) -> tuple[int, int]:
        """Number of the finished runs, and of the failed ones among them."""
        finished, failed = self._connection.execute(
            "SELECT COUNT(*), COALESCE(SUM(verdict = ?), 0) FROM run", (FAILED,)
        ).fetchone()
        return finished, failed

    def forget_failed(self) -> None:
        """Remove the failed runs, so that they are repeated."""
        with self._connection:
            self._connection.execute("DELETE FROM run WHERE verdict = ?", (FAILED,))
            self._connection.execute("DELETE FROM trace WHERE number NOT IN (SELECT number FROM run)")

    def find_traces(self, number: int) -> bytes | None:
        """Compressed traces of a run; None if they are not stored."""
        found = self._connection.execute("SELECT content FROM trace WHERE number = ?", (number,)).fetchone()
        return None if found is None else bytes(found[0])

    def rows(self) -> Iterator[RunRow]:
        """Finished runs by their numbers, one at a time."""
        query = (
            "SELECT number, design, case_id, system, inputs, verdicts, reason, quantities, wall_s, uncertainties,"
            " balance_forces FROM run ORDER BY number"
        )
        for number, design, case_id, system, *row in self._connection.execute(query):
            inputs, verdicts, reason, quantities, wall_s, widths, forces = row
            run = PlannedRun(number, design, case_id, system, json.loads(inputs))
            values = (json.loads(quantities), wall_s, json.loads(widths))
            yield RunRow(run, json.loads(verdicts), reason, *values, balance_forces=tuple(json.loads(forces)))

    def outcomes(self) -> Iterator[tuple[str, str | None]]:
        """Verdict and reason of the finished runs by their numbers, without their values."""
        yield from self._connection.execute("SELECT verdict, reason FROM run ORDER BY number")

    def check_identity(self, identity: Mapping[str, Any], folder: Path) -> None:
        """Refuse a store with the runs of another campaign; write the identity into a new store."""
        stored = dict(self._connection.execute("SELECT name, content FROM campaign").fetchall())
        contents = {name: json.dumps(content, sort_keys=True, default=str) for name, content in identity.items()}
        if not stored:
            with self._connection:
                self._connection.executemany("INSERT INTO campaign VALUES (?, ?)", contents.items())
            return
        changed = [name for name in {**stored, **contents} if stored.get(name) != contents.get(name)]
        if changed:
            raise InputError(
                f"folder '{folder}'",
                f"holds the runs of another campaign (changed: {', '.join(changed)})",
                "Name another folder with --out, or restore the campaign.",
            )


@contextmanager
def read_store(folder: Path) -> Iterator[CampaignStore]:
    """Open the store of another campaign for reading."""
    where = f"folder '{folder}'"
    path = folder / STORE_NAME
    if not path.is_file():
        raise InputError(where, f"has no {STORE_NAME}", "Name the folder of a campaign.")
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)) as connection:
            yield CampaignStore(connection)
    except sqlite3.Error as error:
        raise InputError(f"{where}, {STORE_NAME}", f"cannot be read ({error})", "Run the campaign again.") from None


@contextmanager
def open_store(folder: Path, identity: Mapping[str, Any]) -> Iterator[CampaignStore]:
    """Open the store of a campaign, or create it; no other process can write it meanwhile.

    `identity` has the parts of the campaign on which its results depend.

    Raises:
        InputError: The folder cannot be written, another process runs the campaign, or the store is damaged or that of
            another campaign.
    """
    check_writable(folder)
    folder.mkdir(parents=True, exist_ok=True)
    where = f"folder '{folder}'"
    try:
        with (
            FileLock(folder / "campaign.lock", timeout=0),
            closing(sqlite3.connect(folder / STORE_NAME, check_same_thread=False)) as connection,
        ):
            connection.executescript(_TABLES)
            store = CampaignStore(connection)
            store.check_identity(identity, folder)
            try:
                yield store
            finally:
                store.commit()
    except Timeout:
        raise InputError(where, "another process runs this campaign", "Wait for its end, or stop it.") from None
    except sqlite3.Error as error:
        hint = f"Free space on the device, or name another folder with --out. A damaged {STORE_NAME} must be removed."
        raise InputError(f"{where}, {STORE_NAME}", f"cannot be used ({error})", hint) from None

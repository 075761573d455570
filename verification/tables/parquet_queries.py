"""Cost of the reads and sums of a collection: DuckDB beside pyarrow.

python -m verification.tables.parquet_queries

Needs the package duckdb. Sixty runs of 200,000 samples with four columns, and a table of 200,000 passages. Processor
time of all threads, the least of five. DuckDB may use 200 MB.
"""

import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import duckdb
import numpy as np
import pyarrow
import pyarrow.csv
import pyarrow.dataset
import pyarrow.parquet

RUNS, SAMPLES, PASSAGES = 60, 200_000, 200_000
MEANS = "line, track, from_km, direction, pantograph"


def main() -> None:
    """Print the table."""
    print("| task | DuckDB [ms] | pyarrow [ms] |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for task, *programs in list_tasks(Path(folder)):
            print(f"| {task} | {' | '.join(f'{1000 * measure(program):.0f}' for program in programs)} |")


def list_tasks(folder: Path) -> Iterable[tuple[str, Callable[[], object], Callable[[], object]]]:
    """Names of the tasks with the program of each package."""
    random = np.random.default_rng(1)
    for run in range(RUNS):
        path = folder / f"runs/line={run % 4}/track=1/date=2026-05-{1 + run % 28:02d}/run={run}/samples.parquet"
        path.parent.mkdir(parents=True)
        names = ("time_s", "position_1_m", "force_1_N", "contact_height_1_m")
        pyarrow.parquet.write_table(pyarrow.table({name: random.normal(size=SAMPLES) for name in names}), path)
    keys = {"line": 20, "track": 2, "from_km": 1000, "direction": 2, "pantograph": 4}
    columns = {name: random.integers(count, size=PASSAGES) for name, count in keys.items()}
    passages = folder / "passages.csv"
    pyarrow.csv.write_csv(pyarrow.table(columns | {"mean_force_N": random.normal(size=PASSAGES)}), passages)
    database = duckdb.connect(config={"memory_limit": "200MB"})
    samples, partitioning = f"'{folder}/runs/*/*/*/*/samples.parquet'", pyarrow.dataset.partitioning(flavor="hive")

    def ask(query: str) -> Callable[[], object]:
        return lambda: database.sql(query).fetchnumpy()

    def sum_samples() -> object:
        data = pyarrow.dataset.dataset(folder / "runs", partitioning=partitioning)
        table = data.to_table(columns=["line", "date", "force_1_N"])
        return table.group_by(["line", "date"]).aggregate([("force_1_N", "mean"), ("force_1_N", "stddev")])

    def sum_passages() -> object:
        groups = pyarrow.csv.read_csv(passages).group_by(list(keys))
        return groups.aggregate([("mean_force_N", name) for name in ("mean", "min", "max", "stddev")])

    def read_run() -> object:
        return {name: values.to_numpy() for name, values in zip(names, pyarrow.parquet.read_table(path), strict=True)}

    force = "avg(force_1_N), stddev(force_1_N)"
    yield "a run as arrays", ask(f"FROM '{path}'"), read_run
    yield (
        f"mean and sigma of {RUNS} runs by line and date",
        ask(f"SELECT line, date, {force} FROM read_parquet({samples}, hive_partitioning = true) GROUP BY ALL"),
        sum_samples,
    )
    sums = "avg(mean_force_N), min(mean_force_N), max(mean_force_N), stddev(mean_force_N)"
    yield f"{PASSAGES} passages by section", ask(f"SELECT {MEANS}, {sums} FROM '{passages}' GROUP BY ALL"), sum_passages


def measure(program: Callable[[], object]) -> float:
    """Least processor time of five runs, after one that is not counted [s]."""
    program()
    times = []
    for _ in range(5):
        begin = time.process_time()
        program()
        times.append(time.process_time() - begin)
    return min(times)


if __name__ == "__main__":
    main()

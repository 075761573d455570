"""Tables of a campaign: CSV, Parquet and columns of Python; the call from Python."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from helpers.cheap_campaign import compute_row, fail_even, fill_store, speed_design
from helpers.example_results import passing_case
from pantocheck.conformance.app.notebook.campaign_session import read_traces, run_campaign
from pantocheck.conformance.app.notebook.display import build_column
from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.campaigns.campaign_store import open_store
from pantocheck.conformance.campaigns.campaign_table import collect_columns, write_campaign_table, write_parquet
from pantocheck.conformance.campaigns.run_traces import StoredTraces, pack_traces, unpack_traces
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.results.results_format import CaseResult


def test_columns_have_numbers_texts_and_gaps(tmp_path: Path) -> None:
    with open_store(tmp_path, {}) as store:
        fill_store(store, speed_design(4), fail_even)
        columns = collect_columns(store)
        write_campaign_table(store, tmp_path / "campaign.csv")
    head = (tmp_path / "campaign.csv").read_text().splitlines()[0].split(",")
    assert head == list(columns)
    assert columns["run"] == [1, 2, 3, 4]
    assert columns["speed_km_h"] == [200.0, 200.1, 200.2, 200.3]
    assert columns["reason"] == [None, "even", None, "even"]
    assert [value is None for value in columns["1.mean_force_N"]] == [False, True, False, True]
    assert np.isnan(build_column(columns["1.mean_force_N"])).tolist() == [False, True, False, True]
    assert build_column([[85, 200], [85, 200], None]).tolist() == [[85, 200], [85, 200], None]


@pytest.mark.skipif(importlib.util.find_spec("pyarrow") is None, reason="pyarrow is optional")
def test_parquet_has_the_columns_of_the_table(tmp_path: Path) -> None:
    import pyarrow.parquet

    with open_store(tmp_path, {}) as store:
        fill_store(store, speed_design(3))
        write_campaign_table(store, tmp_path / "campaign.csv")
        expected = collect_columns(store)["1.mean_force_N"]
    path = write_parquet(tmp_path / "campaign.csv")
    assert path == tmp_path / "campaign.parquet"
    assert pyarrow.parquet.read_table(path)["1.mean_force_N"].to_pylist() == expected


def test_list_of_values_is_a_json_cell(tmp_path: Path) -> None:
    def deliver(run: PlannedRun) -> RunRow:
        row = compute_row(run)
        return RunRow(PlannedRun(1, 1, "cheap", "builtin", {"spacing_m": [85, 200]}), row.verdicts, None, {}, 0.0)

    with open_store(tmp_path, {}) as store:
        fill_store(store, speed_design(1), deliver)
        write_campaign_table(store, tmp_path / "campaign.csv")
    assert (tmp_path / "campaign.csv").read_text().splitlines()[1] == '1,1,cheap,builtin,"[85, 200]",pass,pass,,'


def test_campaign_from_python_gives_a_table_and_traces_of_failing_runs(tmp_path: Path) -> None:
    """The mean of the stored force is the mean force of the row; the curves have six digits and all samples."""
    (tmp_path / "limits.toml").write_text(
        '[[limit]]\ncase = "*"\nquantity = "mean_force_N"\nupper = 120.0\ntrust = "primary"\nsource = "test"\n'
    )
    content = {
        "cases": ["en50318-2002/250"],
        "set": ["discretisation.element_m=3", "discretisation.time_step_s=0.005"],
        "vary": [{"key": "pantograph.uplift_force_N", "values": [110.0, 130.0]}],
        "limits": str(tmp_path / "limits.toml"),
        "execution": {"workers": 1, "traces": "failing"},
    }
    table = run_campaign(content, tmp_path)
    assert list(table["pantograph.uplift_force_N"]) == [110.0, 130.0]
    # The mean force of a passage is the uplift force within some newtons.
    assert list(table["1.mean_force_N"]) == pytest.approx([110, 130], abs=5)
    traces = read_traces(tmp_path, 2)
    assert float(np.mean(traces.traces["1"].force_N)) == pytest.approx(table["1.mean_force_N"][1], rel=1e-4)
    assert len(traces.uplift) >= 1
    with pytest.raises(InputError, match="has no traces of run 1"):
        read_traces(tmp_path, 1)


@pytest.mark.parametrize(
    ("stored", "verdict", "is_stored"),
    [("none", "fail", False), ("failing", "pass", False), ("failing", "fail", True), ("all", "pass", True)],
)
def test_verdict_decides_which_traces_are_packed(stored: StoredTraces, verdict: Verdict, is_stored: bool) -> None:
    result = CaseResult.model_validate(passing_case())
    content = pack_traces(result, verdict, stored)
    assert bool(content) is is_stored
    if is_stored:
        assert unpack_traces(content).traces == result.traces

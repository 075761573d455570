"""Executor on a cluster of Dask: worker processes on this machine, and a batch system with a mocked command."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from helpers.cheap_campaign import build_table
from pantocheck.conformance.campaigns.campaign_file import Execution
from pantocheck.conformance.campaigns.run_executors import choose_executor
from pantocheck.conformance.core.input_error import InputError

RUNS = 80

SUBMIT = """#!/bin/sh
# Stands in for the command of Slurm: it starts the job script on this machine.
echo $$ >> "$0.jobs"
sh "$1" > "$0.log" 2>&1 &
echo "Submitted batch job 7"
"""

LONGEST_S = 600
"""Longest duration of a helper [s]: it ends one that hangs. On a loaded machine, 120 s were too short for a cluster."""


def run_helper(module: str, *arguments: str, **environment: str) -> None:
    """Run a helper in its own process: the threads of Dask would outlive a test."""
    settings = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **environment}
    command = [sys.executable, "-m", f"helpers.{module}", *arguments]
    result = subprocess.run(command, env=settings, timeout=LONGEST_S, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr[-2000:]


@pytest.mark.thorough
def test_table_of_a_cluster_with_lost_and_added_workers_is_that_of_one_process(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    run_helper("dask_campaign", str(tmp_path / "cluster"), str(RUNS))
    assert (tmp_path / "cluster" / "campaign.csv").read_bytes() == build_table(tmp_path / "one", RUNS)


@pytest.mark.thorough
def test_jobs_are_submitted_to_a_batch_system(tmp_path: Path) -> None:
    """Slurm is not installed here: a mocked `sbatch` starts the job script on this machine."""
    pytest.importorskip("dask_jobqueue")
    commands = tmp_path / "bin"
    commands.mkdir()
    for name, text in (("sbatch", SUBMIT), ("scancel", "#!/bin/sh\n")):
        (commands / name).write_text(text)
        (commands / name).chmod(0o755)
    path = os.pathsep.join([str(commands), os.environ["PATH"]])
    run_helper("batch_campaign", str(tmp_path / "batch"), "20", PATH=path)
    assert (commands / "sbatch.jobs").read_text().count("\n") == 2
    assert (tmp_path / "batch" / "campaign.csv").read_bytes() == build_table(tmp_path / "one", 20)


def test_scheduler_that_cannot_be_reached_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a long reason, 200 characters are kept."""
    distributed = pytest.importorskip("distributed")
    wrong = Execution(scheduler="nowhere://host")
    with pytest.raises(InputError, match="scheduler 'nowhere://host': cannot be reached"), choose_executor(wrong):
        pass

    def refuse(*_: object, **__: object) -> None:
        raise OSError("x" * 300)

    monkeypatch.setattr(distributed, "Client", refuse)
    with pytest.raises(InputError, match=r"cannot be reached \(x{200}\)"), choose_executor(wrong):
        pass


def test_job_has_one_core_unless_the_campaign_states_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cluster refuses every option, so no job is submitted."""
    pytest.importorskip("distributed")

    def refuse(**options: object) -> None:
        raise ValueError(f"{options['cores']} core, {options['processes']} process, queue {options['queue']}")

    monkeypatch.setitem(sys.modules, "dask_jobqueue", SimpleNamespace(PBSCluster=refuse))
    execution = Execution(cluster="pbs", cluster_options={"queue": "long"})
    refused = pytest.raises(InputError, match=r"cannot be used \(1 core, 1 process, queue long\)")
    with refused, choose_executor(execution):
        pass


def test_runs_without_a_scheduler_or_cluster_stay_on_this_machine() -> None:
    places = (Execution(), Execution(scheduler="tcp://host:8786"), Execution(cluster="pbs"))
    assert [execution.is_local for execution in places] == [True, False, False]


def test_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "dask_jobqueue", None)
    missing = pytest.raises(InputError, match=r"pip install 'pantocheck\[cluster\]'")
    with missing, choose_executor(Execution(cluster="pbs")):
        pass

"""Command `campaign`: a real campaign on a coarse mesh, its table, exit codes and messages."""

import csv
import signal
from pathlib import Path
from typing import NoReturn

import pytest

from helpers.cheap_campaign import fill_store
from helpers.command_line import pantocheck
from pantocheck.conformance.app.commands.campaign_command import describe_progress
from pantocheck.conformance.campaigns import campaign_preparation
from pantocheck.conformance.campaigns.campaign_driver import CampaignProgress
from pantocheck.conformance.campaigns.campaign_preparation import read_campaign
from pantocheck.conformance.campaigns.campaign_store import open_store
from pantocheck.conformance.campaigns.campaign_table import write_campaign_table

COARSE = ("--set", "discretisation.element_m=3", "--set", "discretisation.time_step_s=0.005")
"""Mesh on which a passage takes some hundredths of a second; the numbers do not matter here."""

CAMPAIGN = """
cases = ["en50318-2002/250"]
set = ["discretisation.element_m=3", "discretisation.time_step_s=0.005"]
limits = "limits.toml"
[[vary]]
key = "pantograph.uplift_force_N"
values = [116.0, 130.0, -1.0]
"""

LIMITS = """
[[limit]]
case = "en50318-2002/250"
quantity = "mean_force_N"
pantograph = 1
lower = 110.0
upper = 120.0
trust = "primary"
source = "test"
"""


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    (tmp_path / "limits.toml").write_text(LIMITS)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    return tmp_path / "campaign.toml"


def test_campaign_in_processes_equals_that_in_one_process(campaign: Path, tmp_path: Path) -> None:
    """The mean force of a passage is its uplift force within a few newtons, so the limit of 120 N divides them."""
    out, folder = tmp_path / "out", tmp_path / "one"
    result = pantocheck("campaign", campaign, "--out", out, "--workers", 2)
    assert result.exit_code == 1, result.output
    assert "3 of 3 runs finished, 1 failed\n  1 run: " in result.output
    assert "must be greater than 0" in " ".join(result.output.split())
    assert {path.suffix for path in out.iterdir()} >= {".csv", ".json", ".html", ".pdf", ".sqlite"}
    rows = list(csv.DictReader((out / "campaign.csv").read_text().splitlines()))
    assert [row["verdict"] for row in rows] == ["pass", "fail", "error"]
    assert [row["pantograph.uplift_force_N"] for row in rows] == ["116.0", "130.0", "-1.0"]
    assert float(rows[0]["1.mean_force_N"]) == pytest.approx(116, abs=5)
    assert "must be greater than 0" in rows[2]["reason"]
    assert 0 < float(rows[0]["1.mean_force_N.uncertainty"]) < 5

    prepared = read_campaign(campaign)
    with open_store(folder, prepared.identity) as store:
        fill_store(store, prepared.design, prepared.execute)
        write_campaign_table(store, folder / "campaign.csv")
    assert (folder / "campaign.csv").read_bytes() == (out / "campaign.csv").read_bytes()

    campaign.write_text(CAMPAIGN.replace("130.0", "131.0"))
    result = pantocheck("campaign", campaign, "--out", out)
    assert result.exit_code == 2
    assert "holds the runs of another campaign (changed: campaign, designs)" in result.output


def test_interrupted_campaign_writes_its_finished_runs(
    campaign: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SIGTERM arrives as KeyboardInterrupt with its number."""

    def interrupt(*_: object) -> NoReturn:
        raise KeyboardInterrupt(signal.SIGTERM)

    monkeypatch.setattr(campaign_preparation, "drive_campaign", interrupt)
    result = pantocheck("campaign", campaign, "--out", tmp_path / "out")
    assert result.exit_code == 143
    output = " ".join(result.output.split())
    assert "Interrupted: the same command resumes the campaign. 0 of 3 runs finished, 0 failed" in output
    assert (tmp_path / "out" / "campaign.csv").is_file()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["campaign.toml", "--vary", "speed_km_h=200"], "option --vary: is given together with a campaign file"),
        (["en50318-2002/251"], "there is no case with this id"),
        (["en50318-2002/250", "--vary", "speed_km_h"], "is not a variation"),
        (["en50318-2002/250", "--workers", "0"], "command line, key execution.workers: 0 must be at least 1"),
        (["campaign.toml", "--workers", "0"], "command line, key workers: 0 must be at least 1"),
    ],
)
def test_wrong_options_end_with_a_message(
    campaign: Path, arguments: list[str], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(campaign.parent)
    result = pantocheck("campaign", *arguments, "--out", "out")
    assert result.exit_code == 2
    assert message in result.output
    assert not Path("out").exists()


def test_remaining_time_is_shown_from_a_tenth_of_the_runs_on() -> None:
    """At 2 runs per second, 30 of 300 runs leave 135 s; before, no time is extrapolated."""
    assert describe_progress(CampaignProgress(300, 29, 0, 2.0)) == "29 of 300 runs finished, 0 failed, 2.0 per second"
    assert describe_progress(CampaignProgress(300, 30, 0, 2.0)).endswith("2.0 per second, 0:02:15 remaining")

"""Rules of a profile as limits of the runs of a campaign."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.campaigns.campaign_preparation import prepare_campaign
from pantocheck.conformance.campaigns.campaign_run import ProfileLimits
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.filters import Filter

PROFILE = load_profile("acceptance-ac")


def test_rules_become_limits_at_the_speed_for_every_pantograph(two_pantograph_case: Case) -> None:
    """Mean force at most 0.00097 v^2 + 70 N, which is 130.6 N at 250 km/h."""
    limits, missing = ProfileLimits(PROFILE, 100.0).resolve(two_pantograph_case)
    bounds = {limit.target: (limit.lower, limit.upper) for limit in limits}
    assert bounds["mean_force_N", 1, None] == bounds["mean_force_N", 2, None] == (None, pytest.approx(130.625))
    assert bounds["cov_20", 2, None] == (None, 0.3)
    assert bounds["max_uplift_at_support_mm", 0, None] == (None, 100.0)
    assert missing == ()


def test_rule_without_a_bound_is_named_and_another_kind_of_profile_refused(case_250: Case) -> None:
    slow = replace(case_250, file=case_250.file.model_copy(update={"speed_km_h": 190.0}))
    limits, missing = ProfileLimits(PROFILE, None).resolve(slow)
    assert [limit.quantity for limit in limits] == ["cov_20", "statistical_min_N", "speed_over_wave_speed"]
    assert missing[0].startswith("mean_force_N: the speed of the record is 190 km/h")
    assert missing[1].startswith("max_uplift_at_support_mm: the record does not state uplift_space_mm")
    other = replace(case_250, file=case_250.file.model_copy(update={"filter": Filter(cutoff_Hz=50.0)}))
    with pytest.raises(InputError, match="has another filter"):
        ProfileLimits(PROFILE, None).resolve(other)
    with pytest.raises(InputError, match="needs a measured record; a campaign has none"):
        ProfileLimits(load_profile("line-test"), None).resolve(case_250)


def test_profile_file_stands_beside_the_campaign(tmp_path: Path) -> None:
    shutil.copy(library_folder() / "profiles" / "acceptance-ac.toml", tmp_path / "own.toml")
    for profile in ("own.toml", "acceptance-ac"):
        content = {"cases": ["en50318-2002/250"], "profile": profile}
        assert prepare_campaign(CampaignFile.model_validate(content), tmp_path).design.count_runs() == 1


def test_run_with_a_rule_without_a_bound_cannot_pass() -> None:
    """At 250 km/h all criteria pass on this mesh but the uplift, whose space is not stated; with it, the run passes."""
    content = {
        "cases": ["en50318-2002/250"],
        "set": ["discretisation.element_m=3", "discretisation.time_step_s=0.005"],
        "profile": "acceptance-ac",
        "uplift_space_mm": 120.0,
    }
    verdicts = []
    for removed in ((), ("uplift_space_mm",)):
        kept = {key: value for key, value in content.items() if key not in removed}
        prepared = prepare_campaign(CampaignFile.model_validate(kept), Path())
        row = prepared.execute(next(prepared.design.list_runs()))
        verdicts.append((row.verdicts["verdict"], row.reason))
    assert verdicts[0] == ("pass", None)
    assert verdicts[1][0] == "skip"
    assert str(verdicts[1][1]).startswith("max_uplift_at_support_mm: the record does not state uplift_space_mm")

"""Campaigns of the library: their runs, the sources of their variations, and the spacings of a regulation."""

import pytest

from pantocheck.conformance.campaigns.campaign_preparation import PreparedCampaign, find_campaign_file, read_campaign
from pantocheck.conformance.cases.library import read_bibliography
from pantocheck.conformance.line.library_folder import library_folder

RUNS = {
    "ac-simple-damping": 12,
    "ac-simple-damping-uncertainty": 64,
    "ac-simple-irregularity": 48,
    "ac-simple-spacing": 133,
    "ac-simple-speed": 32,
    "ac-simple-tolerances": 128,
    "ac-simple-tsi-spacing": 17,
}


def read(name: str) -> PreparedCampaign:
    path = find_campaign_file(f"campaigns/{name}")
    assert path is not None
    return read_campaign(path)


def test_all_campaigns_of_the_library_are_tested() -> None:
    assert sorted(path.stem for path in (library_folder() / "campaigns").glob("*.toml")) == sorted(RUNS)


@pytest.mark.parametrize(("name", "runs"), RUNS.items())
def test_campaign_of_the_library_is_valid_and_states_its_sources(name: str, runs: int) -> None:
    """Reading it also reads the cases of its first designs."""
    prepared = read(name)
    assert prepared.design.count_runs() == runs
    sampling = prepared.file.sampling
    for table in (*prepared.file.vary, *(() if sampling is None else sampling.input)):
        assert {"trust", "source"} <= table.model_fields_set
        sources = [table.source] if isinstance(table.source, str) else table.source
        assert set(sources) <= set(read_bibliography())


def test_spacings_belong_to_the_speeds_of_the_regulation() -> None:
    """TSI ENE table 4.2.13, column B, as another document prints it: the trust is that of a secondary source."""
    prepared = read("ac-simple-tsi-spacing")
    assert prepared.file.vary[0].trust == "secondary"
    for run in prepared.design.list_runs():
        speed, spacing = run.inputs["speed_km_h"], run.inputs["spacing_m"]
        assert spacing == (200 if speed >= 250 else 85 if speed > 120 else 15 if speed > 80 else 8)


def test_designs_of_the_tolerances_differ_in_their_seeds() -> None:
    """Seeds are whole numbers; 128 of them from 2^31 numbers are equal with a probability of 4e-6."""
    keys = ("line.variation.droppers.seed", "line.variation.supports.seed")
    for key in keys:
        seeds = [run.inputs[key] for run in read("ac-simple-tolerances").design.list_runs()]
        assert all(isinstance(seed, int) for seed in seeds)
        assert len(set(seeds)) == 128

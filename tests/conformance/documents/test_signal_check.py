"""Embedded signals: packed without loss, they give every quantity and curve again, and any other number is found."""

import base64
import zlib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.packed_samples import PackedDamaged, PackedSamples, pack_samples
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.documents.signal_check import check_signals, find_signal_gaps
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.evaluated_signals import settling_samples
from pantocheck.conformance.results.results_format import CaseResult, Results

Tree = dict[str, Any]


@pytest.mark.parametrize(
    "samples",
    [
        120 + 30 * np.sin(np.arange(5000) / 40) + np.random.default_rng(1).normal(size=5000),
        np.array([1.0, np.nan, -3.0, 0.0, -0.0, 5e-324, -1e300, 1e9]),
        np.array([]),
    ],
)
def test_packing_keeps_every_bit(samples: np.ndarray) -> None:
    packed = pack_samples(samples)
    assert packed.unpack().tobytes() == samples.tobytes()
    assert packed == pack_samples(samples)


def test_smooth_signal_needs_fewer_bytes_than_float64() -> None:
    smooth = pack_samples(np.sin(np.arange(5000) / 40))
    assert smooth.packed_bytes < 0.75 * 8 * smooth.samples


@pytest.mark.parametrize(
    ("damage", "text"),
    [
        ({"data": "?"}, "cannot be unpacked"),
        ({"data": base64.b64encode(b"no zlib").decode()}, "cannot be unpacked"),
        ({"data": base64.b64encode(zlib.compress(bytes(16))).decode()}, "stated, but the data have others"),
        ({"data": base64.b64encode(zlib.compress(bytes(10**7))).decode()}, "stated, but the data have others"),
        ({"samples": 2}, "stated, but the data have others"),
        ({"packed_bytes": 2}, "stated, but the data have others"),
        ({"sha256": "sha256:0"}, "do not have the stated SHA-256"),
    ],
)
def test_damaged_samples_are_refused(damage: Tree, text: str) -> None:
    packed = PackedSamples(**{**pack_samples(np.arange(3.0)).model_dump(), **damage})
    with pytest.raises(PackedDamaged, match=text):
        packed.unpack()


def test_transient_of_each_filter_has_decayed_at_the_section() -> None:
    """A step at the edge of the window: the filtered force behind the settling time differs by less than 1e-12."""
    for low_pass in (Filter(), Filter(order=8, attenuation_dB=6), Filter(order=12, cutoff_Hz=10.0), Filter(order=2)):
        settling = settling_samples(low_pass, 1000.0)
        force = 120 + 30 * np.sin(np.arange(12_000) / 30)
        force[: 6000 - settling] += 100.0
        cut = low_pass(force[6000 - settling :], 1000.0)
        whole = low_pass(force, 1000.0)[6000 - settling :]
        assert np.abs(cut - whole)[settling:].max() < 1e-10
    assert settling_samples(Filter(bands="band-pass"), 1000.0) > 3 * settling_samples(Filter(), 1000.0)


RUNS: dict[str, Results] = {}
"""Runs of the fixture, which no test changes."""


@pytest.fixture(params=["one", "two", "readings"])
def results(request: pytest.FixtureRequest, wave: Any, case_250: Case, two_pantograph_case: Case) -> Results:
    """Runs of a case with one pantograph, one with two, and one with a further reading."""
    reading = load_case(library_folder() / "en50318-2018" / "ac-simple" / "275.toml").file.reading[0]
    wider = reading.model_copy(update={"id": "wider", "evaluated_m": (240.0, 400.0)})
    file = case_250.file.model_copy(update={"reading": (reading, wider)})
    cases = {"one": case_250, "two": two_pantograph_case, "readings": replace(case_250, file=file)}
    if request.param not in RUNS:
        RUNS[request.param] = run_cases([cases[request.param]], wave(), "provisional")
    return RUNS[request.param]


def change_case(results: Results, change: Callable[[Tree], object]) -> CaseResult:
    tree = results.to_dict()
    change(tree["cases"][0])
    return Results.model_validate(tree).cases[0]


def test_quantities_and_curves_follow_from_the_signals(results: Results) -> None:
    case = results.cases[0]
    assert case.signals is not None
    assert set(case.signals.pantographs) == set(case.traces)
    assert list(check_signals(case)) == []
    assert list(find_signal_gaps(case)) == []
    assert find_discrepancies(results) == []


def test_every_changed_quantity_is_found(results: Results) -> None:
    """By 1e-8 of its value: a hundred thousandth of what thinned curves show."""
    case = results.cases[0]
    for table in ("quantities", *(["readings"] if case.readings else [])):
        for owner, values in case.quantities.items():
            for name, value in values.items():
                if not isinstance(value, float):
                    continue

                def change(tree: Tree, table: str = table, owner: str = owner, name: str = name) -> None:
                    place = (tree if table == "quantities" else tree["readings"][1])["quantities"]
                    place[owner][name] = place[owner][name] * (1 + 1e-8) or 1e-8

                texts = list(check_signals(change_case(results, change)))
                static = owner == "0" and name != "max_uplift_at_support_mm"
                assert len(texts) == (0 if static else 1), (table, owner, name, texts)
                assert static or f"{name}: " in texts[0]


LOSS = {"position_m": 250.0, "time_s": 0.1, "duration_s": 0.1, "lowest_force_N": 0.0}

CHANGES: dict[str, tuple[Callable[[Tree], object], str]] = {
    "quantity gone": (lambda c: c["quantities"]["1"].pop("std_force_N"), "std_force_N: missing in the document"),
    "filtered curve": (lambda c: _scale(c["traces"]["1"]["force_20_N"], 7), "curves of pantograph, 1, force_20_N"),
    "force curve": (lambda c: _scale(c["traces"]["1"]["force_N"], 7), "curves of pantograph, 1, force_N"),
    "spectrum": (lambda c: _scale(c["traces"]["1"]["spectrum"]["amplitude_N"], 0), "spectrum, amplitude_N"),
    "histogram": (lambda c: _scale(c["traces"]["1"]["histogram"]["share_pct"], 9), "histogram, share_pct"),
    "drawn mean": (lambda c: c["traces"]["1"].update(mean_N=1.0), "drawn levels of pantograph 1"),
    "uplift": (lambda c: _scale(c["uplift"][0]["uplift_mm"], 600), "uplift at 240 m: "),
    "place": (lambda c: c["places"]["1"]["max_force_N"].update(position_m=241.0), "place of an extreme, 1, max_"),
    "section": (lambda c: c["signals"].update(evaluated_m=[240.0, 359.0]), "analysis section, value 2"),
    "left out": (lambda c: c["signals"].update(excluded_m=[[241.0, 250.0]]), "which only a profile can state"),
    "rate": (lambda c: c["signals"].update(rate_Hz=999.0), "sampling rate"),
    "filter": (lambda c: c["run"]["filter"].update(cutoff_Hz=15.0), "std_force_N"),
    "filter before delivery": (
        lambda c: c["signals"]["pantographs"]["1"].update(filter_applied_Hz=20.0), "rms_20_50_N: missing in the comput",
    ),
    "samples": (lambda c: c["signals"]["pantographs"]["1"]["force_N"].update(data="AAAA"), "cannot be unpacked"),
    "contact loss": (
        lambda c: c.update(contact_losses={"1": [LOSS]}),
        "contact losses",
    ),
}  # fmt: skip


def _scale(numbers: list[float], index: int) -> None:
    numbers[index] = numbers[index] * 1.1 + 1.0


@pytest.mark.parametrize("kind", CHANGES)
def test_changed_part_is_found(results: Results, kind: str) -> None:
    change, text = CHANGES[kind]
    found = list(check_signals(change_case(results, change)))
    assert any(text in line for line in found), found


GAPS: dict[str, tuple[Callable[[Tree], object], str]] = {
    "signals": (lambda c: c.pop("signals"), "the evaluated signals are missing"),
    "signals without curves": (lambda c: (c.pop("signals"), c.update(traces={})), "the evaluated signals are missing"),
    "signals without a rate": (
        lambda c: (c.pop("signals"), c["run"].update(rate_Hz=None)), "the evaluated signals are missing",
    ),
    "nothing but a state": (
        lambda c: (c.pop("signals"), c["run"].update(rate_Hz=None), c.update(traces={}), _confirm(c)),
        "the sampling rate is missing",
    ),
    "pantograph": (lambda c: c["signals"]["pantographs"].pop("1"), "the signals of pantograph 1 are missing"),
    "uplift": (lambda c: c["signals"].update(uplift=[]), "the signals of the uplift are missing"),
}  # fmt: skip


def _confirm(case: Tree) -> None:
    case["record"] |= {"state": "consistent"}


@pytest.mark.parametrize("kind", GAPS)
def test_removed_signals_are_a_gap(results: Results, kind: str) -> None:
    change, text = GAPS[kind]
    assert any(text in gap for gap in find_signal_gaps(change_case(results, change)))


def test_long_record_embeds_no_signals(wave: Any, case_250: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bound of 1000 samples in place of 500,000: the check of the thinned curves remains."""
    for module in ("records.evaluated_signals", "documents.signal_check"):
        monkeypatch.setattr(f"pantocheck.conformance.{module}.MOST_SAMPLES", 1000)
    results = run_cases([case_250], wave(), "secondary")
    case = results.cases[0]
    assert case.signals is None
    assert list(find_signal_gaps(case)) == []
    case = case.model_copy(update={"quantities": case.quantities | {"1": case.quantities["1"] | {"std_force_N": 1.0}}})
    assert find_discrepancies(results.model_copy(update={"cases": [case]}))

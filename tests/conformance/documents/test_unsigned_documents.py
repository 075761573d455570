"""Unsigned documents of every kind, format and language: none has the exit code 0 without a record or a new run."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from helpers.command_line import pantocheck
from helpers.example_identification import build_example_line
from helpers.wave_system import SIGMA, Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.identification_page import build_identification_document
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.identification_format import IdentifiedLine
from pantocheck.conformance.results.report_files import LANGUAGES, Language
from pantocheck.conformance.results.results_format import Results

UNSIGNED = "UNSIGNED: the numbers are consistent, anyone can have written this document; "


def assert_unsigned(path: Path) -> None:
    """Exit code 1 whatever the verdict; with `--numbers-only`, the same document is accepted."""
    for options in ((), ("--any-verdict",)):
        done = pantocheck("verify", path, *options)
        assert done.exit_code == 1, done.output
        assert " ".join(done.stdout.split()).startswith(UNSIGNED)
    accepted = pantocheck("verify", path, "--numbers-only", "--any-verdict")
    assert accepted.exit_code == 0, accepted.output


@pytest.mark.parametrize(
    ("language", "suffix"),
    [("en", "pdf"), *(pytest.param(*pair, marks=pytest.mark.thorough) for pair in product(LANGUAGES, ("html", "pdf")))],
)
def test_certificate_that_passes(accepted_wave: Results, tmp_path: Path, language: Language, suffix: str) -> None:
    certificate = replace(build_certificate(accepted_wave), language=language)
    path = tmp_path / f"certificate.{suffix}"
    path.write_bytes(render_pdf(certificate) if suffix == "pdf" else render_html(certificate).encode())
    assert_unsigned(path)


def test_results_that_pass(accepted_wave: Results, tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    path.write_bytes(accepted_wave.to_json())
    assert_unsigned(path)
    assert pantocheck("verify", path, "--numbers-only").exit_code == 0


@pytest.mark.parametrize("suffix", ["html", "pdf"])
def test_drop_page_is_refused(tmp_path: Path, suffix: str) -> None:
    document = build_identification_document([IdentifiedLine.model_validate(build_example_line())])
    path = tmp_path / f"identification.{suffix}"
    path.write_bytes(render_pdf(document) if suffix == "pdf" else render_html(document).encode())
    assert_refused(path)


def assert_refused(path: Path) -> None:
    for options in ((), ("--numbers-only", "--any-verdict")):
        assert pantocheck("verify", path, *options).exit_code == 2


def test_comparison_is_refused(case_250: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, sigma in (("first", SIGMA), ("other", 1.1 * SIGMA)):
        record = Wave(sigma=sigma).record(case_250)
        write_record(Path(f"{name}.csv"), record, case=case_250.id, system={"name": name, "version": "1"})
    assert pantocheck("compare", "first.csv", "other.csv", "--out", "out").exit_code == 0
    pages = [path for path in Path("out").iterdir() if path.stem == "comparison"]
    assert {path.suffix for path in pages} >= {".html", ".json"}
    for path in pages:
        assert_refused(path)

"""Genuine documents of this version: the run of a system that is known by hand, and its certificate in every format."""

from dataclasses import replace
from typing import Any

import pytest

from helpers.wave_system import Wave
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.cases.limits import own_limits
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.results.results_format import Results


def render_document(results: dict[str, Any], name: str) -> bytes:
    """Content of a document with these results; `name` is that of the file."""
    match name.rpartition(".")[2]:
        case "pdf":
            return render_pdf(build_certificate(Results.model_validate(results)))
        case "html":
            return render_html(build_certificate(Results.model_validate(results))).encode()
        case _:
            return Results.model_validate(results).to_json()


@pytest.fixture(scope="session")
def wave_results() -> Results:
    """Results of the wave on the case at 250 km/h: six criteria pass, two fail."""
    return run_cases([load_case(library_folder() / "en50318-2002" / "250.toml")], Wave())


@pytest.fixture(scope="session")
def accepted_wave() -> Results:
    """The same as an own case with own limits, two of which are wider: a PASS of a case that is none of the library."""
    case = load_case(library_folder() / "en50318-2002" / "250.toml")
    bounds = {"max_force_N": {"lower": 150.0}, "min_force_N": {"upper": 85.0}}
    own = [limit.model_copy(update=bounds[limit.quantity]) for limit in case.limits if limit.quantity in bounds]
    file = case.file.model_copy(update={"id": "own/250"})
    return run_cases([replace(case, file=file, limits=own_limits(case.with_limits(tuple(own)).limits))], Wave())

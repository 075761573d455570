"""Identity and scope on page 1: modified copies, weakened limits, editions, steps of the procedure."""

from io import BytesIO
from typing import Any
from xml.etree import ElementTree

import pytest
from pypdf import PdfReader

from helpers.shown_page import certify, print_certificate, shown_certificate, summarise
from pantocheck.conformance.app.commands.command_output import print_output
from pantocheck.conformance.app.commands.results_output import build_results_output
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.pages.document import WarningBox
from pantocheck.conformance.pages.scope_page import (
    CHANGES_SHOWN,
    describe_origin,
    list_identity_warnings,
    list_scope,
    summarise_identity,
)
from pantocheck.conformance.pages.verdict_reasons import build_headline
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.results.scope import build_scope

COPY = "modified copy of en50318-2002/250"
CHANGE = "std_force_N of pantograph 2: the trust of the limit is lowered from secondary to provisional"


def describe(results: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """Results whose first case, of two pantographs, has other facts, with the scope of these cases."""
    facts = {"library": "identical", "edition": "EN 50318:2002", "superseded_by": "EN 50318:2018"}
    first = results["cases"][0] | facts | {"steps": ["reference_models"]} | changes
    model = Results.model_validate(results | {"cases": [first, *results["cases"][1:]]})
    return model.model_copy(update={"scope": build_scope(model.cases)}).to_dict()


@pytest.fixture
def copied(results: dict[str, Any]) -> dict[str, Any]:
    return describe(results, library="modified", limit_changes=[CHANGE])


def test_modified_copy_is_named_in_every_format(copied: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    """No format shows the id of the library case alone."""
    suites = ElementTree.fromstring(render_junit(Results.model_validate(copied)))
    assert suites[0].attrib["name"] == suites[0].findall("testcase")[0].attrib["classname"] == COPY
    print_output(build_results_output(Results.model_validate(copied), [], 0), "run")
    for text in (shown_certificate(copied), summarise(copied), capsys.readouterr().out):
        assert text.count("en50318-2002/250") == text.count(COPY) > 0
    assert copied["cases"][0]["library"] == "modified"
    assert "Modified copies of the library: 1." in build_headline(Results.model_validate(copied))


def test_page_1_names_modified_copy_weakened_limits_and_scope(copied: dict[str, Any], results: dict[str, Any]) -> None:
    page = " ".join(PdfReader(BytesIO(print_certificate(copied))).pages[0].extract_text().split())
    assert f"The {COPY} has other inputs, limits or sources than the library case." in page
    assert f"The limits file changes limits of {COPY}." in page
    assert "lowered from secondary to provisional" in page
    page = PdfReader(BytesIO(print_certificate(describe(results)))).pages[0].extract_text()
    assert "self-declared conformance report, in the style of EN 50318" in page
    steps = ("Pantograph model", "Static check", "Reference models", "Line test", "Limits of validity")
    assert all(step in " ".join(page.split()) for step in steps)
    assert "superseded by EN 50318:2018" in " ".join(page.split())


def test_weakened_limit_is_named_in_every_format(results: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    changed = describe(results, limit_changes=[CHANGE])
    print_output(build_results_output(Results.model_validate(changed), [], 0), "run")
    weakened = "The limits file weakens limits or changes their trust in 1 case."
    assert build_headline(Results.model_validate(changed)).endswith(weakened)
    change = "std_force_N: the trust of the limit is raised from secondary to primary"
    headline = build_headline(Results.model_validate(describe(results, limit_changes=[change])))
    assert headline.endswith("The limits file raises the trust of limits in 1 case.")
    junit, summary = render_junit(Results.model_validate(changed)).decode(), summarise(changed).replace("\\_", "_")
    for text in (shown_certificate(changed), capsys.readouterr().out, junit, summary):
        assert CHANGE in " ".join(text.split())


def test_page_1_shows_a_few_weakened_limits_and_their_number(results: dict[str, Any]) -> None:
    changes = [f"dropper_length_m[{item}]: the limit 1 to 2 is removed" for item in range(1, 10)]
    [warning] = list_identity_warnings(Results.model_validate(describe(results, limit_changes=changes)))
    assert f"dropper_length_m[{CHANGES_SHOWN}]" in warning
    assert warning.endswith(f"and {9 - CHANGES_SHOWN} more.")
    document = certify(describe(results))
    assert not summarise_identity(Results.model_validate(describe(results)))
    assert not [block for block in document.blocks if isinstance(block, WarningBox)]


@pytest.mark.parametrize(
    ("facts", "text"),
    [
        (("identical", "EN 50318:2002", "EN 50318:2018"), "library case of EN 50318:2002, superseded by EN 50318:2018"),
        (("identical", "EN 50318:2018", None), "library case of EN 50318:2018"),
        (("identical", None, None), "library case"),
        (("modified", "EN 50318:2018", None), "modified copy"),
        (("own", "EN 50318:2018", None), "own case"),
    ],
)
def test_origin_states_the_edition_of_library_cases_only(
    results: dict[str, Any], facts: tuple[str | None, ...], text: str
) -> None:
    """An own file can claim any edition."""
    changes = dict(zip(("library", "edition", "superseded_by"), facts, strict=True))
    assert describe_origin(CaseResult.model_validate(results["cases"][0] | changes)) == text


def test_certificate_states_all_digests_and_the_origin_of_a_profile(results: dict[str, Any]) -> None:
    facts = {"library": "identical", "edition": None, "superseded_by": None, "profile": "line-test"}
    case = CaseResult.model_validate(results["cases"][0] | facts)
    assert describe_origin(case) == "library profile"
    assert describe_origin(case.model_copy(update={"library": "own"})) == "own profile"
    changed = describe(results, limits_digest="sha256:" + "a" * 64, stated_limits_digest="sha256:" + "b" * 64)
    changed["suite"]["digest"] = "sha256:" + "c" * 64
    page = shown_certificate(changed)
    assert all(f"sha256:{letter * 64}" in page for letter in "abc")
    assert changed["cases"][0]["input_digest"] in page


def test_page_1_lists_every_step_with_its_cases_once(results: dict[str, Any]) -> None:
    model = Results.model_validate(describe(results))
    case, *others = [case.id for case in model.cases]
    missing = "Pantograph model; Static check of the line model; Line test; Limits of validity"
    outside = {"Cases outside these steps": ", ".join(others)}
    assert list_scope(model) == {"Steps done": f"Reference models: {case}", "Steps not done": missing} | outside
    page = shown_certificate(describe(results))
    assert page.count("Steps not done") == 2  # page 1 and the explanations
    assert page.count("Limits of validity") == 1
    assert results["scope"] == []
    assert list_scope(Results.model_validate(results)) == {}
    assert "Limits of validity" not in shown_certificate(results)
    # The static case passes by its dropper lengths; its apparent mass has no limit.
    static = Results.model_validate(describe(results, steps=["pantograph_model", "static_check"]))
    states = list_scope(static)
    assert states["Steps informative"] == f"Pantograph model: {case}"
    assert states["Steps done"] == f"Static check of the line model: {case}"

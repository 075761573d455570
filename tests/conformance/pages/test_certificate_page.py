"""Content of a certificate: criteria, reasons, bands, facts and figures."""

import json
from typing import Any

from helpers.shown_page import certify, shown_certificate, summarise
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.case_figures import draw_case_figures
from pantocheck.conformance.pages.criteria_table import criteria_blocks, describe_close, describe_criterion
from pantocheck.conformance.pages.document_facts import list_case_facts
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.quantity_tables import list_definitions
from pantocheck.conformance.pages.verdict_reasons import list_reasons
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.results_format import CaseResult, Results


def case_section(document: doc.Document, number: int) -> dict[str, doc.Section]:
    """Sections of a case by their headings."""
    [case] = [block for block in document.blocks if isinstance(block, doc.Section) and block.anchor == f"case-{number}"]
    return {block.heading: block for block in case.blocks if isinstance(block, doc.Section)}


def sentences(section: doc.Section) -> tuple[str, ...]:
    [items] = section.blocks
    assert isinstance(items, doc.BulletList)
    return tuple(map(str, items.items))


def test_example_and_labels_are_complete(results: dict[str, Any]) -> None:
    content = json.loads(Results.model_validate(results).to_json())
    assert content == results
    assert all(quantity.label for quantity in QUANTITIES.values())


def test_criterion_shows_all_its_values(passing: dict[str, Any]) -> None:
    case = passing["cases"][0]
    row = case["criteria"][0] | {"value": 118.2, "margin": 0.36, "uncertainty": 0.1234}
    case["criteria"] = [row | {"source": "another"}, row]
    texts = describe_criterion(Criterion.model_validate(row))
    assert (texts.value, texts.error, texts.limits) == ("118.2 N", "± 0.12", "110 to 120")
    assert (texts.margin, texts.pantograph) == ("+0.36", "1")
    result = CaseResult.model_validate(case)
    table, sources = criteria_blocks(result.criteria, "case-1", "case-1-source", result)
    assert isinstance(table, doc.Table)
    assert table.rows[1][-3:] == (
        doc.VerdictMark("pass"),
        doc.TrustMark("secondary"),
        doc.Link("[2]", "case-1-source-2"),
    )
    assert sources == doc.NumberedList("Sources of the limits", ("another", row["source"]), "case-1-source")
    table, origin = criteria_blocks(result.criteria[1:], "case-1", "case-1-source", result)
    assert isinstance(table, doc.Table)
    assert table.columns[-1].heading == "Verdict"
    assert origin == doc.SmallPrint(("All limits: ", doc.TrustMark("secondary"), f" {row['source']}"))
    line = describe_criterion(
        Criterion.model_validate(row | {"pantograph": 0, "item": 3, "discretisation_error": None, "uncertainty": None})
    )
    assert (line.pantograph, line.error) == ("line, no. 3", "–")


def test_criterion_close_to_its_limit_is_marked_in_row_and_reasons(passing: dict[str, Any]) -> None:
    remark = "lies 0.1 N from a limit, less than its uncertainty of 0.2 N"
    row = passing["cases"][0]["criteria"][0]
    row |= {"value": 119.9, "uncertainty": 0.2, "margin": 0.02, "close": [remark], "conformity": 0.8}
    [reasons] = list_reasons(Results.model_validate(passing))
    assert reasons.heading == "Closer to a limit than the uncertainty"
    assert sentences(reasons) == (f"{passing['cases'][0]['id']}: Mean contact force.",)
    assert describe_close([Criterion.model_validate(row)], lambda close: close.quantity) == [
        "Closer to a limit than the uncertainty (mostly start): mean_force_N (0.8 inside the limits). Another start or "
        "run-in could reverse the verdict."
    ]
    assert describe_criterion(Criterion.model_validate(row | {"verdict": "info"})).remarks == ()


def test_incomplete_uncertainty_is_marked_and_counted_on_page_1(passing: dict[str, Any]) -> None:
    """A half-width of zero without a component that is not known is no half-width; its lack is said once."""
    case = passing["cases"][0]
    row, unknown = case["criteria"][0] | {"uncertainty": 0.1234}, case["uncertainty_basis"]
    known = dict.fromkeys(unknown, "known")
    assert describe_criterion(Criterion.model_validate(row), unknown).error == "± 0.12"
    assert describe_criterion(Criterion.model_validate(row | {"uncertainty": 0.0}), unknown).error == "not known"
    assert describe_criterion(Criterion.model_validate(row | {"uncertainty": 0.0}), known).error == "± 0"
    assert describe_criterion(Criterion.model_validate(row | {"trust": "computed"}), unknown).error == "± 0.12"
    assert describe_criterion(Criterion.model_validate(row | {"uncertainty": None}), unknown).error.startswith("± ")
    case["criteria"][0]["verdict"] = "fail"
    marked = shown_certificate(passing)
    page_1 = marked[: marked.index('id="case-1"')]
    counted = sum(row["verdict"] in ("pass", "fail") for case in passing["cases"] for row in case["criteria"])
    assert f"The uncertainty of {counted} values is incomplete (section or length not known)" in page_1
    for text in (summarise(passing), render_markdown(certify(passing))):
        assert "section or length not known" in text
    for other in passing["cases"]:
        other["uncertainty_basis"] = dict.fromkeys(unknown, "known")
    text = shown_certificate(passing)
    assert "is incomplete" not in text


def test_certificate_states_a_close_criterion_once(passing: dict[str, Any]) -> None:
    """Its numbers stand in the table of page 1 alone, and its cause and probability in the section of the case."""
    remark = "lies 0.1 N from a limit, less than its uncertainty of 0.2 N"
    passing["cases"][0]["criteria"][0] |= {"value": 119.91, "margin": 0.018, "close": [remark]}
    text = shown_certificate(passing)
    assert text.count("119.9 N") == 1
    assert "119.9 N" in text[: text.index('id="case-1"')]


def test_margin_beside_a_limit_of_zero_is_a_distance(passing: dict[str, Any]) -> None:
    """A distance in newtons is no relative margin."""
    row = passing["cases"][0]["criteria"][0]
    row |= {"value": 0.004, "lower": 0.0, "upper": None, "margin": 0.004, "close": [], "unit": "N"}
    assert describe_criterion(Criterion.model_validate(row)).margin == "+0.004 N"
    assert list_reasons(Results.model_validate(passing)) == ()
    assert "No value with a limit that counts is close to it." in shown_certificate(passing)


def test_reasons_begin_with_the_worst(results: dict[str, Any]) -> None:
    groups = {section.heading: sentences(section) for section in list_reasons(Results.model_validate(results))}
    assert list(groups) == ["Failed", "Not evaluated"]
    assert len(groups["Failed"]) == 1
    assert "31.68 N, limits 32 to 34, margin −0.32" in groups["Failed"][0]
    assert len(groups["Not evaluated"]) == 2


def test_definitions_state_the_worth_of_filter_and_band(results: dict[str, Any]) -> None:
    """Of the shown quantities only."""
    case = results["cases"][0]
    texts = {name.text: text for name, text in list_definitions([CaseResult.model_validate(case)])}
    assert texts["min_force_N"] == (
        ": smallest contact force, 0-20 Hz; a causal filter of the same order changes it by up to 15 %."
    )
    assert "mean_force_N" not in texts
    without = CaseResult.model_validate(case | {"quantities": {"1": {"mean_force_N": 118.0}}})
    assert list_definitions([without]) == ()


def test_case_facts_show_wall_time_filter_and_force_laws(passing: dict[str, Any]) -> None:
    facts = list_case_facts(CaseResult.model_validate(passing["cases"][0]))
    assert dict(facts.times)["Wall time / simulated time"] == format_value(0.412 / 7.0, 3)
    assert dict(facts.pairs)["Analysis section"] == "240 m to 360 m"
    assert dict(facts.pairs)["Filter"] == "Butterworth, order 6, −3 dB at 20 Hz, zero phase"
    # Without a law, results.json has no key for it.
    case = passing["cases"][0]
    assert "law_forces" not in case["run"]
    forces = {
        "1": {"kind": "applied_forces", "static_force_N": 70.0, "aerodynamic_force_N": 85.81},
        "2": {"kind": "mean_force", "mean_force_N": 157.3},
    }
    case = Results.model_validate(
        passing | {"cases": [case | {"run": case["run"] | {"law_forces": forces}}]}
    ).to_dict()["cases"][0]
    facts = dict(list_case_facts(CaseResult.model_validate(case)).pairs)
    assert facts["Force law of pantograph 1"] == (
        "applied forces of 155.81 N: static force 70.00 N, aerodynamic force 85.81 N; not tuned, the mean contact "
        "force is a result"
    )
    assert facts["Force law of pantograph 2"] == "mean contact force of 157.30 N; the uplift force is tuned to it"


def test_certificate_of_a_record_with_gaps(passing: dict[str, Any]) -> None:
    """A filtered or measured record lacks some traces and facts; null is not drawn."""
    case = passing["cases"][0]
    case["traces"]["1"] |= {"force_20_N": None, "std_N": None, "histogram": None, "supports_m": []}
    case["quantities"]["0"] = {"dropper_length_m": [1.017, 0.896]}
    case["run"] |= dict.fromkeys(("simulated_s", "wall_s", "dt_s", "element_m"))
    Results.model_validate(passing)
    sections = case_section(certify(passing), 1)
    [figures] = sections["Figures"].blocks
    assert isinstance(figures, doc.Figures)
    assert [figure.caption.split(":")[0] for figure in figures.figures] == [
        "Force by frequency",
        *2 * ["Pantograph 1"],
        *3 * ["Pantograph 2"],
        "Uplift at the supports. Largest",
    ]
    _, table = sections["All quantities, with uncertainty by component"].blocks
    assert isinstance(table, doc.Table)
    assert "1.0170, 0.89600" in [row[3] for row in table.rows]


def test_caption_of_many_supports_has_their_number_ends_and_largest_uplift(passing: dict[str, Any]) -> None:
    """The alternative text keeps every support."""
    case = passing["cases"][0]
    support = case["uplift"][0]
    case["uplift"] = [support | {"support_m": 60.0 * n, "uplift_mm": [0.0, 40.0 + n]} for n in range(5)]
    case["uplift"] = [item | {"time_s": [0.0, 1.0]} for item in case["uplift"]]
    *_, figure = draw_case_figures(CaseResult.model_validate(case), 0, "case")
    assert figure.caption == "Uplift at 5 supports from 0 m to 240 m. Largest: 44 mm at 240 m."
    assert figure.alternative.count(" mm at ") == 5

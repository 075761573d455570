"""Text, numbers, rows and bars."""

import math
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.reports import page_text as text
from pantocheck.conformance.reports.certificate.case_facts import list_case_facts
from pantocheck.conformance.reports.certificate.certificate_page import build_certificate
from pantocheck.conformance.reports.certificate.criteria_rows import build_criterion_row, format_signed
from pantocheck.conformance.reports.certificate.quantity_tables import bands
from pantocheck.conformance.reports.certificate.verdict_reasons import build_reasons
from pantocheck.conformance.reports.figures import force_figures as figures
from pantocheck.conformance.reports.figures.margin_bar import WIDTH, draw_margin_bar
from pantocheck.conformance.results.results_format import Results

numbers = st.floats(-1e6, 1e6)


def test_example_has_the_format_of_results(results):
    Results.model_validate(results)


def test_every_quantity_has_a_name():
    assert all(quantity.label for quantity in QUANTITIES.values())


@given(st.text(st.characters()))
def test_clean_text_fits_any_format(raw):
    shown = text.clean_text(raw)
    assert text.clean_text(shown) == shown
    shown.encode("utf-8")
    ElementTree.fromstring(f"<a>{shown.replace('&', '').replace('<', '')}</a>")
    assert len(shown) <= text.LONGEST


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (119.71234, "119.7"),
        (-0.000123456, "−0.0001235"),
        (0.0, "0"),
        (1234.5, "1234"),
        (8e-9, "8.000e−09"),
        (None, "–"),
    ],
)
def test_number(value, shown):
    assert text.format_value(value) == shown


@given(numbers, numbers)
def test_a_shown_value_lies_on_the_same_side_of_its_limit(value, limit):
    shown = float(text.format_beside_limits(value, limit, None).replace("−", "-"))
    assert (shown >= limit) == (value >= limit)


@pytest.mark.parametrize(
    ("margin", "shown"), [(0.0, "0.00"), (0.4812, "+0.48"), (-0.0004, "−0.0004"), (1e-20, "+1.0e−20")]
)
def test_a_margin_shows_its_sign(margin, shown):
    assert format_signed(margin) == shown


@given(numbers, st.none() | numbers, st.none() | numbers, st.none() | st.floats(0, 1e3))
def test_margin_bar_stays_inside_its_drawing(value, lower, upper, error):
    if lower is not None and upper is not None and lower > upper:
        lower, upper = upper, lower
    root = ElementTree.fromstring(draw_margin_bar(value, lower, upper, error, "pass"))
    for circle in root.iter("{http://www.w3.org/2000/svg}circle"):
        assert 0 <= float(circle.get("cx")) <= WIDTH
    assert "nan" not in ElementTree.tostring(root).decode()


def test_margin_bar_marks_are_told_apart_without_colour():
    inside, outside, uncounted, beyond = (
        draw_margin_bar(value, 26, 31, None, verdict)
        for value, verdict in ((28, "pass"), (32, "fail"), (28, "info"), (99, "fail"))
    )
    assert 'r="4.5" fill="#1b5e3a"' in inside
    assert "<circle" not in outside
    assert 'r="4.5" fill="#ffffff"' in uncounted
    assert "l-9 -6v12z" in beyond


def test_a_row_says_all_there_is(passing):
    row = passing["cases"][0]["criteria"][0] | {"value": 118.2, "margin": 0.36, "discretisation_error": 0.1234}
    sources = ["another"]
    shown = build_criterion_row(row, sources)
    assert (shown.value, shown.unit, shown.error, shown.limits) == ("118.2", "N", "± 0.12", "110 to 120")
    assert (shown.margin, shown.verdict, shown.trust, shown.pantograph) == ("+0.36", "pass", "secondary", "1")
    assert sources[shown.source - 1] == row["source"]
    of_line = build_criterion_row(row | {"pantograph": 0, "item": 3, "discretisation_error": None}, sources)
    assert (of_line.pantograph, of_line.error) == ("line, no. 3", "–")


def test_a_value_within_its_discretisation_error_is_named(passing):
    row = passing["cases"][0]["criteria"][0]
    row |= {"value": 119.9, "discretisation_error": 0.2, "margin": 0.02}
    assert build_criterion_row(row, []).remarks == ("closer to its limit than its discretisation error",)
    headings = [group.heading for group in build_reasons(passing)]
    assert headings == ["Closer to a limit than the discretisation error", "Closest margins"]


def test_reasons_lead_with_the_gravest(results):
    groups = {group.heading: group.sentences for group in build_reasons(results)}
    assert list(groups) == ["What failed", "What could not be evaluated", "Closest margins"]
    assert len(groups["What failed"]) == 1
    assert "31.68 N, limits 32 to 34, margin −0.32" in groups["What failed"][0]
    assert len(groups["What could not be evaluated"]) == 2
    # Between two equal limits a margin is 0 at best: it says nothing about closeness.
    assert "Contact loss" not in "".join(groups["Closest margins"])


def test_bands_say_what_is_graded(results):
    front, rear = (bands(case).rows for case in results["cases"][:2])
    assert front[0][3][0].endswith("(PASS)")
    assert front[6][3][0].endswith("(informative)")
    assert rear[0][3][0].endswith("(FAIL)")
    assert rear[5][3][0].endswith("(informative)")  # its limit is provisional
    assert rear[6][3][0] == "not available"


def test_wall_time_per_simulated_time(passing):
    facts = dict(list_case_facts(passing["cases"][0]))
    assert facts["Wall time / simulated time"] == text.format_value(0.412 / 7.0, 3)
    assert facts["Filter"] == "Butterworth, order 6, −3 dB at 20 Hz, zero phase"


def test_a_record_with_gaps_still_makes_a_page(passing):
    """A filtered or measured record lacks what cannot be known; null is not a number to be drawn."""
    case = passing["cases"][0]
    case["traces"]["1"] |= {"force_20_N": None, "std_N": None, "histogram": None, "supports_m": []}
    case["quantities"]["0"] = {"dropper_length_m": [1.017, 0.896]}
    case["run"] |= dict.fromkeys(("simulated_s", "wall_s", "dt_s", "element_m"))
    Results.model_validate(passing)
    made = build_certificate(passing).cases[0]
    assert [figure.caption.split(":")[0] for figure in made.figures] == 2 * ["Pantograph 1"] + 3 * ["Pantograph 2"] + [
        "Uplift at the supports. Largest"
    ]
    assert ("1.0170, 0.89600") in [cells[-1] for *_, cells in made.quantities.rows]


def test_figures_are_the_same_whatever_the_users_settings(passing):
    import matplotlib

    case = passing["cases"][0]
    expected = figures.draw_uplift(case["uplift"], case["criteria"])
    with matplotlib.rc_context({"font.family": "monospace", "axes.grid": False, "svg.fonttype": "none"}):
        assert figures.draw_uplift(case["uplift"], case["criteria"]) == expected
        assert matplotlib.rcParams["svg.fonttype"] == "none"
    assert "<text" not in expected
    assert "dc:date" not in expected


def test_spectrum_agrees_with_the_signal(passing):
    """The example's own line, 0.98 x 24 N at the span-passing frequency; two spans hold two periods: no leakage."""
    trace = passing["cases"][0]["traces"]["1"]["spectrum"]
    peak = max(zip(trace["amplitude_N"], trace["frequency_Hz"], strict=True))
    assert peak[1] == pytest.approx(250 / 3.6 / 60, rel=0.01)
    assert math.isclose(peak[0], 24 * 0.98, rel_tol=0.02)

"""Whose a limit of a study is: the paper's, another publication's, or assumed."""

from dataclasses import replace

import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.studies.vovan2015.provenance_table import build_provenance_table


@pytest.mark.parametrize(
    ("source", "trust", "whose"),
    [
        ("vovan2015", "primary", "the paper's"),
        (["vovan2015", "assumed"], "primary", "the paper's"),
        ("own", "primary", "published elsewhere"),
        (["wang2016"], "primary", "published elsewhere"),
        ("wang2016", "secondary", "published elsewhere"),
        ("vovan2015 as I read it", "primary", "published elsewhere"),
        ("own", "provisional", "assumed"),
        ("vovan2015", "provisional", "assumed"),
    ],
)
def test_a_limit_is_the_papers_if_its_source_names_the_paper(source, trust, whose):
    """Own limits laid over a study may well be primary, without being printed in its paper."""
    (case,) = select_cases(["vovan2015/contact-force"])
    limit = Limit(quantity="change_rms_0_5_pct", upper=0.0, trust=trust, source=source)
    (row,) = (
        row for row in build_provenance_table(replace(case, limits=(limit,))).rows if row[0].startswith("limit of")
    )
    assert row[:2] == ["limit of change_rms_0_5_pct", whose]


@pytest.mark.parametrize("pattern", ["vovan2015/contact-force", "vovan2015/mass-drop/printed"])
def test_primary_limits_of_the_library_are_the_papers(pattern):
    (case,) = select_cases([pattern])
    rows = [row for row in build_provenance_table(case).rows if row[0].startswith("limit of")]
    assert [row[1] for row in rows] == ["the paper's" if one.trust == "primary" else "assumed" for one in case.limits]

"""Every verdict that a comparison can have, has a headline."""

from typing import get_args

from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.pages.comparison_page import PAGES
from pantocheck.conformance.results.comparison_format import ModelComparison
from pantocheck.conformance.results.drop_comparison_format import DropComparison


def test_every_verdict_has_a_headline() -> None:
    """No comparison is an error or has a decision rule; a drop whose line is not fully known is unconfirmed at best."""
    assert len(PAGES) == len(ModelComparison.__subclasses__())
    for kind, page in PAGES.items():
        impossible = {"error", "undecided"} | (set() if kind is DropComparison else {"unconfirmed"})
        possible = set(get_args(Verdict)) - impossible
        assert set(page.headlines) == possible
        assert all(page.headlines.values())

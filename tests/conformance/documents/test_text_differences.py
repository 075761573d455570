"""Quotations of two different texts show their first difference."""

from pantocheck.conformance.documents.authenticity_check import shorten_details
from pantocheck.conformance.documents.number_comparison import QUOTED_CHARACTERS, compare_lines, quote_difference

LONG = (
    "This is a self-declared conformance report, in the style of EN 50318. It is not a certification by a third party."
)


def test_long_texts_are_quoted_around_their_difference() -> None:
    """The difference lies behind the longest quotation from the beginning."""
    forged = LONG.replace("not a certification", "a certification")
    [sentence] = compare_lines([LONG[:40], forged], [LONG[:40], LONG])
    assert sentence == (
        "'… the style of EN 50318. It is a certification by a third party.' is printed, "
        "'… the style of EN 50318. It is not a certification by a third party.' follows from the results"
    )


def test_short_and_missing_texts_are_quoted_whole() -> None:
    assert quote_difference("26.57 N", "26.37 N") == ("'26.57 N'", "'26.37 N'")
    assert quote_difference(None, "26.37 N") == ("nothing", "'26.37 N'")


def test_a_longer_text_is_cut_behind_its_difference() -> None:
    first, second = quote_difference("a" * 200 + "b" * 200, "a" * 200 + "c" * 200)
    assert first != second
    assert max(map(len, (first, second))) <= QUOTED_CHARACTERS + len("'…'…")


def test_rest_of_a_long_list_is_counted() -> None:
    for count, last in ((12, "11"), (15, "and 3 more")):
        assert shorten_details([*map(str, range(count))])[-1] == last

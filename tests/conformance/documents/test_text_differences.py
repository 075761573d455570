"""Quotations of two different texts show their first difference."""

from pantocheck.conformance.documents.authenticity_check import (
    QUOTED_CHARACTERS,
    compare_lines,
    quote_difference,
    shorten_details,
)

LONG = (
    "This is a self-declared conformance report, in the style of EN 50318. It is not a certification by a third party."
)


def test_texts_are_quoted_around_their_difference() -> None:
    """The difference lies behind the longest quotation from the beginning."""
    forged = LONG.replace("not a certification", "a certification")
    [sentence] = compare_lines([LONG[:40], forged], [LONG[:40], LONG])
    assert sentence == (
        "'… the style of EN 50318. It is a certification by a third party.' is printed, "
        "'… the style of EN 50318. It is not a certification by a third party.' follows from the results"
    )
    assert quote_difference("26.57 N", "26.37 N") == ("'26.57 N'", "'26.37 N'")
    longest = "a" * (QUOTED_CHARACTERS - 1)
    assert quote_difference(f"{longest}b", f"{longest}c") == (f"'{longest}b'", f"'{longest}c'")
    assert quote_difference(None, "26.37 N") == ("nothing", "'26.37 N'")
    first, second = quote_difference("a" * 200 + "b" * 200, "a" * 200 + "c" * 200)
    assert first != second
    assert max(map(len, (first, second))) <= QUOTED_CHARACTERS + len("'…'…")


def test_missing_or_additional_line_is_named_alone() -> None:
    """Lines after it are equal, and no difference of the two texts."""
    short, whole = ["mean", "std"], ["mean", "warning", "std"]
    assert list(compare_lines(short, whole)) == ["nothing is printed, 'warning' follows from the results"]
    assert list(compare_lines(whole, short)) == ["'warning' is printed, nothing follows from the results"]
    assert list(compare_lines(whole, [*whole, "end"])) == ["nothing is printed, 'end' follows from the results"]
    assert list(compare_lines(whole, whole)) == []


def test_rest_of_a_long_list_is_counted() -> None:
    for count, last in ((12, "11"), (15, "and 3 more")):
        assert shorten_details([*map(str, range(count))])[-1] == last

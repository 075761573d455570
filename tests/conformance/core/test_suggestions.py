"""Suggestions: one near match, up to three weak matches, or the list of the known names."""

import pytest

from pantocheck.conformance.core.input_error import suggest_names

NAMES = [f"name_{number}" for number in range(14)]


@pytest.mark.parametrize(
    ("name", "known", "hint"),
    [
        ("tensionN", ["tension_N", "tension_kN", "mass_kg"], "Did you mean tension_N ?"),
        ("TENSION_N", ["tension_N"], "Did you mean tension_N ?"),
        # One of four letters differs: similarity 0.75, weaker than a typing error.
        ("abcx", ["abcd", "abce", "abcf", "abcg"], 3),
        # Half of the letters: similarity 0.5, the weakest match.
        ("abyz", ["abcd"], "Did you mean abcd ?"),
        ("axyz", ["abcd"], "Known are: abcd"),
        ("250", ["en50318-2002/250", "en50318-2002/300"], "Did you mean en50318-2002/250 ?"),
        ("q", [], "None are known."),
        ("q", NAMES[:12], f"Known are: {', '.join(NAMES[:12])}"),
        ("q", NAMES[:13], f"Known are: {', '.join(NAMES[:12])}, ..."),
    ],
)
def test_unknown_name_has_a_hint(name: str, known: list[str], hint: str | int) -> None:
    found = suggest_names(name, known)
    if isinstance(hint, int):
        assert found.count(" or ") == hint - 1
    else:
        assert found == hint


def test_typing_error_has_one_match() -> None:
    """Two names with a similarity above 0.9: the nearest alone is suggested."""
    assert suggest_names("statistical_max_N", ["statistical_max_NN", "statistical_max_NNN"]) == (
        "Did you mean statistical_max_NN ?"
    )

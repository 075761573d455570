"""What the figures of a certificate show."""

from pantocheck.conformance.reports.figures import uplift


def test_of_many_supports_only_the_largest_uplift_is_named():
    """Eleven names squeezed the figure to half its width."""
    supports = [{"support_m": 55.0 * i, "time_s": [0, 1, 2], "uplift_mm": [0, 40 + i % 7, 0]} for i in range(11)]
    named = uplift.__wrapped__(supports, []).axes[0].get_legend().get_texts()
    assert [text.get_text() for text in named] == ["other supports", "largest: support at 330 m"]

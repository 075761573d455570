"""What the figures of a certificate show."""

from pantocheck.conformance.reports.figures.force_figures import draw_uplift, limited_rows


def test_of_many_supports_only_the_largest_uplift_is_named():
    """Eleven names squeezed the figure to half its width."""
    supports = [{"support_m": 55.0 * i, "time_s": [0, 1, 2], "uplift_mm": [0, 40 + i % 7, 0]} for i in range(11)]
    named = draw_uplift.__wrapped__(supports, []).axes[0].get_legend().get_texts()
    assert [text.get_text() for text in named] == ["other supports", "largest: support at 330 m"]


def test_only_limits_of_the_force_are_drawn_beside_it():
    rows = [
        {"quantity": "std_force_N", "lower": 26.0, "upper": 31.0},
        {"quantity": "mean_force_N", "lower": None, "upper": 120.0},
        {"quantity": "max_force_N", "lower": None, "upper": None},
        {"quantity": "change_rms_20_50_pct", "lower": 0.0, "upper": None},
    ]
    assert [row["quantity"] for row in limited_rows(rows)] == ["mean_force_N"]

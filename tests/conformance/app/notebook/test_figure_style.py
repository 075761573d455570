"""Figures of the Python interface: new ones have the look of the reports, given axes that of the user."""

from typing import Any

import matplotlib as mpl
import pytest
from matplotlib import pyplot

from pantocheck.conformance import open_line
from pantocheck.conformance.core.figure_style import INK


@pytest.fixture
def line(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setenv("MPLBACKEND", "agg")
    return open_line("en50318-2002/line.toml")


def test_new_figure_has_the_look_and_leaves_the_settings_of_the_user(line: Any) -> None:
    before = mpl.rcParams["axes.spines.top"], mpl.rcParams["font.size"]
    axes = line.plot(4, 5)
    assert not axes.spines["top"].get_visible()
    assert axes.xaxis.label.get_fontsize() == 8
    assert axes.xaxis.label.get_color() == INK
    assert (mpl.rcParams["axes.spines.top"], mpl.rcParams["font.size"]) == before
    pyplot.close(axes.figure)


def test_given_axes_keep_the_look_of_the_user(line: Any) -> None:
    with mpl.rc_context({"font.size": 13, "axes.spines.top": True}):
        figure, axes = pyplot.subplots()
    assert line.plot(4, 5, axes=axes) is axes
    assert axes.spines["top"].get_visible()
    pyplot.close(figure)

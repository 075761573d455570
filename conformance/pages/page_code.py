"""Styles and scripts of a page, and the security policy that admits them by their digests and nothing else."""

from base64 import b64encode
from dataclasses import dataclass
from functools import cache
from hashlib import sha256

from pantocheck.conformance.core.look import insert_look
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.translation import translate_marked
from pantocheck.conformance.results.report_files import LANGUAGES

PAGE_STYLE, PLOT_STYLE = "page.css", "uplot/uPlot.min.css"

EXPLORER_STYLE = "explorer.css"

PLOT_LIBRARY = "uplot/uPlot.iife.min.js"
"""Unmodified file of the release 1.6.32 of uPlot, from its package of the npm registry; licence in the same folder."""

PLOT_LICENCE = "uplot/LICENSE"

TABLE_SCRIPTS = ("elements", "folding", "tables", "figure_files")
"""Parts of the script of every page."""

CHOICE_SCRIPTS = ("pole_choice",)
"""Further parts of the script of a page without results; each acts on the tables that it knows."""

SCENE_SCRIPTS = ("results", "plot_style", "motion_data", "passage_signals", "passage_scene", "passage_view", "views")
"""Further parts of the script of a page with moving pictures and without results."""

PLOT_SCRIPTS = (
    *("results", "download", "spectrum", "spans"),
    *("plot_style", "legend", "plot_lines", "plot_keys", "touch", "plot"),
    *("force_view", "curves_view", "uplift_view"),
)
"""Parts that draw curves with the library for plots."""

CURVE_SCRIPTS = (*PLOT_SCRIPTS, "quantities_file", "measured_view", *SCENE_SCRIPTS[2:])
"""Further parts of the script of a page with results, in the order of their use."""

EXPLORE_SCRIPTS = (
    *PLOT_SCRIPTS,
    *SCENE_SCRIPTS[2:-1],
    *("explore_controls", "explore_results", "explore_saving"),
)
"""Further parts of the script of an explorer."""


@dataclass(frozen=True)
class PageCode:
    """Style sheets and scripts of a page."""

    styles: tuple[str, ...]
    scripts: tuple[str, ...]
    notice: str = ""
    """Licence of the scripts of others, which has to stand in every copy of them."""
    asks_server: bool = False
    """Whether the page sends requests to the server that it comes from."""

    @property
    def policy(self) -> str:
        """Content security policy: no request, no code but these texts; `data:` admits images inside figures."""
        sources = {"script-src": self.scripts, "style-src": self.styles}
        admitted = (f"{name} {' '.join(map(_digest, texts))}" for name, texts in sources.items())
        others = ("img-src data:", *(("connect-src 'self'",) if self.asks_server else ()))
        return "; ".join(("default-src 'none'", *admitted, *others, "base-uri 'none'", "form-action 'none'"))


@cache
def read_plain_code(language: str = LANGUAGES[0], scripts: tuple[str, ...] = ()) -> PageCode:
    """Styles and scripts of a page without results; `scripts` are those of its moving pictures."""
    script = join_scripts(name_scripts((*TABLE_SCRIPTS, *CHOICE_SCRIPTS, *scripts)), language)
    return PageCode((translate_marked(_read(PAGE_STYLE), language),), (script,))


@cache
def read_results_code(language: str = LANGUAGES[0]) -> PageCode:
    """Styles and scripts of a page with results, whose curves the library for plots draws."""
    scripts = (_read(PLOT_LIBRARY), join_scripts(name_scripts((*TABLE_SCRIPTS, *CURVE_SCRIPTS)), language))
    styles = (_read(PLOT_STYLE), translate_marked(_read(PAGE_STYLE), language))
    return PageCode(styles, scripts, f"uPlot: {_read(PLOT_LICENCE)}")


@cache
def read_explorer_code() -> PageCode:
    """Styles and scripts of an explorer, in English."""
    code = read_results_code()
    script = join_scripts(name_scripts(("elements", "figure_files", *EXPLORE_SCRIPTS)))
    return PageCode((*code.styles, _read(EXPLORER_STYLE)), (code.scripts[0], script), code.notice, asks_server=True)


def _read(name: str) -> str:
    return insert_look((TEMPLATES / name).read_text("utf-8"))


def name_scripts(parts: tuple[str, ...]) -> tuple[str, ...]:
    """Files of the parts of a page script."""
    return tuple(f"scripts/{part}.js" for part in parts)


def join_scripts(names: tuple[str, ...], language: str = LANGUAGES[0]) -> str:
    """Files of templates as one script in one scope, so that their names do not reach the page."""
    parts = (translate_marked(_read(name), language) for name in names)
    return "\n".join(("(() => {", '"use strict";', *parts, "})();"))


def _digest(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"

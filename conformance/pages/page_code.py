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

PLOT_LIBRARY = "uplot/uPlot.iife.min.js"
"""Unmodified file of the release 1.6.32 of uPlot, from its package of the npm registry; licence in the same folder."""

PLOT_LICENCE = "uplot/LICENSE"

TABLE_SCRIPTS = ("elements", "folding", "tables")
"""Parts of the script of every page."""

CHOICE_SCRIPTS = ("pole_choice",)
"""Further parts of the script of a page without results; each acts on the tables that it knows."""

SCENE_SCRIPTS = ("results", "plot_style", "motion_data", "passage_signals", "passage_scene", "passage_view", "views")
"""Further parts of the script of a page with moving pictures and without results."""

CURVE_SCRIPTS = (
    *("results", "download", "spectrum", "spans"),
    *("plot_style", "legend", "plot_lines", "plot_keys", "touch", "plot"),
    *("force_view", "curves_view", "uplift_view", "measured_view"),
    *SCENE_SCRIPTS[2:],
)
"""Further parts of the script of a page with results, in the order of their use."""


@dataclass(frozen=True)
class PageCode:
    """Style sheets and scripts of a page."""

    styles: tuple[str, ...]
    scripts: tuple[str, ...]
    notice: str = ""
    """Licence of the scripts of others, which has to stand in every copy of them."""

    @property
    def policy(self) -> str:
        """Content security policy: no request, no code but these texts; `data:` admits images inside figures."""
        sources = {"script-src": self.scripts, "style-src": self.styles}
        admitted = (f"{name} {' '.join(map(_digest, texts))}" for name, texts in sources.items())
        return "; ".join(("default-src 'none'", *admitted, "img-src data:", "base-uri 'none'", "form-action 'none'"))


@cache
def read_plain_code(language: str = LANGUAGES[0]) -> PageCode:
    """Styles and scripts of a page without results."""
    script = join_scripts(name_scripts((*TABLE_SCRIPTS, *CHOICE_SCRIPTS)), language)
    return PageCode((translate_marked(_read(PAGE_STYLE), language),), (script,))


@cache
def read_scene_code(language: str = LANGUAGES[0]) -> PageCode:
    """Styles and scripts of a page with moving pictures and without results."""
    script = join_scripts(name_scripts((*TABLE_SCRIPTS, *CHOICE_SCRIPTS, *SCENE_SCRIPTS)), language)
    return PageCode((translate_marked(_read(PAGE_STYLE), language),), (script,))


@cache
def read_results_code(language: str = LANGUAGES[0]) -> PageCode:
    """Styles and scripts of a page with results, whose curves the library for plots draws."""
    scripts = (_read(PLOT_LIBRARY), join_scripts(name_scripts((*TABLE_SCRIPTS, *CURVE_SCRIPTS)), language))
    styles = (_read(PLOT_STYLE), translate_marked(_read(PAGE_STYLE), language))
    return PageCode(styles, scripts, f"uPlot: {_read(PLOT_LICENCE)}")


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

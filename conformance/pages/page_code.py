"""Styles and scripts of a page, the security policy that admits them by their digests alone, and the verifier."""

import json
from base64 import b64encode
from dataclasses import dataclass
from functools import cache
from hashlib import sha256

from pantocheck.conformance.core.look import insert_look
from pantocheck.conformance.core.results_part import Suite
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.translation import read_sections, translate, translate_marked
from pantocheck.conformance.pages.words import read_words
from pantocheck.conformance.quantities.registry import QUANTITIES
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


# Verifier for a browser: one HTML file that checks certificates without a network and without an installation.
VERIFIER_NAME = "pantocheck-verifier.html"

VERIFIER_FOLDER = TEMPLATES / "verifier"

SIGNATURE_LIBRARY = TEMPLATES / "pkijs"
"""PKI.js with the packages that it needs in one file; its versions, licences and making are beside it."""

VERIFIER_SCRIPTS = (
    *("numbers", "signals", "grading", "dossier_steps", "checks", "revisions", "signatures"),
    *("translations", "documents", "document_report", "show"),
)
"""Parts of its script, in the order of their use."""


READ_WORDS = ("Case", "Digest of the results", "Pantograph", "Value", "Verdict")
"""Labels that it reads on a page, besides the verdicts."""

SHOWN_WORDS = (
    *(*READ_WORDS, "Quantity", "Uncertainty", "Limits", "Margin", "line", "line, no. {n}", "exact", "not known"),
    *("Step", "Role", "Cases", "Dossier", "decides the verdict", "for information", "Check of this document"),
)
"""Words that it shows as the pages do, besides those of verdicts, steps, claims and quantities."""


@cache
def build_verifier(version: str, digest: str) -> bytes:
    """The verifier of a version of the suite with the digest of its files; equal ones give equal bytes."""
    script = join_scripts(tuple(f"verifier/{name}.js" for name in VERIFIER_SCRIPTS))
    labels = read_words()["label"] | {name: quantity.label for name, quantity in QUANTITIES.items()}
    words = {name: part for name, part in read_words().items() if name in ("verdict", "procedure", "claim")}
    texts = {language: _list_texts(language) for language in LANGUAGES[1:]}
    suite = {"version": version, "digest": digest}
    tables = {"languages": _list_read_words(), "labels": labels, "words": words, "texts": texts, "suite": suite}
    for name, table in tables.items():
        script = script.replace(f'"@{name}@"', json.dumps(table, sort_keys=True))
    style = insert_look((VERIFIER_FOLDER / "verifier.css").read_text("utf-8"))
    page = (VERIFIER_FOLDER / "verifier.html").read_text("utf-8")
    library = (SIGNATURE_LIBRARY / "pkijs.min.js").read_text("utf-8")
    licence = (SIGNATURE_LIBRARY / "LICENSE").read_text("utf-8")
    policy = PageCode((style,), (library, script)).policy
    parts = {"policy": policy, "version": version, "style": style, "script": script, "notice": f"<!--\n{licence}-->\n"}
    for name, text in (parts | {"library": library}).items():
        page = page.replace(f"@{name}@", text)
    return page.encode()


def _list_read_words() -> dict[str, dict[str, str]]:
    """English words that the verifier reads on a page, by language and by their translations."""
    words = (*READ_WORDS, *(verdict["word"] for verdict in read_words()["verdict"].values()))
    return {name: {translate(word, name).text: word for word in words} for name in LANGUAGES[1:]}


def _list_texts(language: str) -> dict[str, str]:
    """Texts that the verifier shows, and their translations."""
    own, words = read_sections(language)["verifier"], read_words()
    shared = (*SHOWN_WORDS, *(verdict["word"] for verdict in words["verdict"].values()))
    labels = (quantity.label for quantity in QUANTITIES.values())
    terms = (*(text for part in ("procedure", "claim", "label") for text in words[part].values()), *labels)
    return {**own, **{text: translate(text, language).text for text in (*shared, *terms)}}


def describe_verifier(suite: Suite) -> str:
    """Line of page 1: the file that checks this document in a browser, and its digest."""
    digest = sha256(build_verifier(suite.version, suite.digest)).hexdigest()
    return f"{VERIFIER_NAME} in a browser, SHA-256 {digest} (pantocheck verify --write-verifier FILE)"

"""Verifier for a browser: one HTML file that checks certificates without a network and without an installation."""

import json
from functools import cache
from hashlib import sha256

from pantocheck.conformance.core.look import insert_look
from pantocheck.conformance.core.results_part import Suite
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.page_code import PageCode, join_scripts
from pantocheck.conformance.pages.translation import read_sections, translate
from pantocheck.conformance.pages.words import read_words
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.report_files import LANGUAGES

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

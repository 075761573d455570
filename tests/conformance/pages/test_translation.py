"""Certificates and summaries in every language: complete catalogues, the same numbers, verified byte by byte."""

import ast
import re
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any

import pytest

from helpers.example_results import example, with_measured_run, with_reference
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.documents.document_reading import parse_html_certificate, parse_pdf_certificate
from pantocheck.conformance.documents.page_check import check_pages
from pantocheck.conformance.pages import translation
from pantocheck.conformance.pages.certificate_page import build_certificate, build_summary
from pantocheck.conformance.pages.document import Document
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.report_files import LANGUAGES, Language
from pantocheck.conformance.results.results_format import Results

ROOT = Path(__file__).parents[3]
OTHERS = LANGUAGES[1:]
NUMBER = re.compile(r"\d+(?:\.\d+)*")
EXAMPLES = (example, with_measured_run, with_reference)

DATA_KEYS = frozenset(
    (
        *("id", "title", "name", "version", "kind", "notes", "source", "edition", "superseded_by", "origin", "text"),
        *("sentence", "printed", "tolerance", "sensitivity", "statement", "started", "schema", "digest", "values"),
        *("system", "label"),
    )
)
"""Keys of results whose texts belong to a case, a user or a record, and stay as they are."""


def build_pages(results: dict[str, Any], language: Language) -> tuple[Document, Document]:
    read = Results.model_validate(results)
    certificate, summary = build_certificate(read), build_summary(read, ["certificate.html"])
    return replace(certificate, language=language), replace(summary, language=language)


def list_data(value: Any, key: str = "") -> Iterator[str]:
    """Texts of results that belong to a case, a user or a record."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield from list_data(part, name if key not in DATA_KEYS else key)
            yield name
    elif isinstance(value, list):
        for part in value:
            yield from list_data(part, key)
    elif isinstance(value, str) and key in DATA_KEYS:
        yield value


@pytest.mark.parametrize("language", OTHERS)
def test_catalogues_have_the_same_entries_arguments_and_numbers(language: Language) -> None:
    entries, first = translation.read_catalogue(language), translation.read_catalogue(OTHERS[0])
    assert entries.keys() == first.keys()
    for key, text in entries.items():
        assert text.strip(), key
        assert Counter(translation.ARGUMENT.findall(text)) == Counter(translation.ARGUMENT.findall(key)), key
        names = [sorted(set(re.findall(r"\{\w+\}", part))) for part in (key, text)]
        assert names[0] == names[1], key
        plain = [translation.ARGUMENT.sub("", part) for part in (key, text)]
        assert Counter(NUMBER.findall(plain[0])) == Counter(NUMBER.findall(plain[1])), key
        assert key.endswith(":") == text.endswith(":") or text.endswith(" :"), key


@pytest.mark.parametrize("results", [build() for build in EXAMPLES], ids=[build.__name__ for build in EXAMPLES])
def test_every_text_of_certificate_and_summary_has_an_entry(results: dict[str, Any]) -> None:
    """What stays English belongs to the data of a case, and is no text of the suite."""
    data = "\n".join(list_data(results))
    missing: set[str] = set()

    def collect(text: str) -> str:
        missing.update(translation.translate(text, "de").missing)
        return text

    for page in build_pages(results, "de"):
        translation._change_parts(page, collect)
    versions = re.compile(r"Pantocheck ([\d.]+|reference simulator)|python [\d.]+|\d+-\d+-\d+ [\d:]+ UTC")
    assert [text for text in missing if text not in data and not versions.search(text)] == []


def list_marked() -> set[str]:
    files = [path for folder in ("", "scripts") for path in Path(str(TEMPLATES / folder)).glob("*.*")]
    sources = [path.read_text("utf-8") for path in files if path.suffix in (".js", ".css", ".html", ".typ")]
    return {found for source in sources for found in translation.MARKED.findall(source)}


@pytest.mark.parametrize("language", OTHERS)
def test_texts_of_templates_and_labels_of_quantities_have_entries(language: Language) -> None:
    marked = list_marked()
    assert len(marked) > 40
    labels = [quantity.label for quantity in QUANTITIES.values()]
    for text in (*marked, *labels):
        found = translation.translate(text, language)
        assert found.missing == (), text
        assert not {'"', "\\"} & set(found.text)  # it becomes a literal of a script


def list_words() -> set[str]:
    """Words of all literals of the sources and of the templates, in small letters."""
    texts: list[str] = []
    for path in (*(ROOT / "conformance").rglob("*.py"), *(ROOT / "model").rglob("*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        texts += [
            node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)
        ]
    folders = (ROOT / "templates", ROOT / "reference_cases", ROOT / "tests" / "helpers")
    kept = {".js", ".html", ".typ", ".css", ".toml", ".py"}
    files = (path for folder in folders for path in folder.rglob("*") if path.suffix in kept)
    texts += [path.read_text("utf-8") for path in files if "languages" not in path.parts]
    return {word for text in texts for word in re.split(r"[^\w]+|_", text.lower())}


def test_no_entry_is_unused() -> None:
    """Every word of an entry stands in a source: an entry for a text that was changed is found by its old words."""
    words = list_words()
    for key in translation.read_catalogue("de"):
        own = re.split(r"[^\w]+|_", translation.ARGUMENT.sub(" ", key).lower())
        assert [word for word in own if word not in words] == [], key


def read_numbers(page: str) -> Counter[str]:
    """Numbers of the texts of a page, without its scripts, styles and figures."""
    text = re.sub(r"<(script|style|svg)\b.*?</\1>", " ", page, flags=re.DOTALL)
    return Counter(NUMBER.findall(unescape(re.sub(r"<[^>]*>", " ", text))))


@pytest.mark.parametrize("language", OTHERS)
def test_numbers_do_not_differ_between_languages(language: Language) -> None:
    for build in EXAMPLES:
        certificate, summary = build_pages(build(), "en")
        translated = replace(certificate, language=language), replace(summary, language=language)
        numbers = read_numbers(render_html(certificate))
        assert numbers == read_numbers(render_html(translated[0]))
        assert sum(numbers.values()) > 200
        assert Counter(NUMBER.findall(render_markdown(summary))) == Counter(
            NUMBER.findall(render_markdown(translated[1]))
        )


@pytest.mark.parametrize("language", OTHERS)
def test_document_is_verified_in_its_language(language: Language) -> None:
    """Pages are made again in the stated language; another language, or a word of another one, is a contradiction."""
    certificate, _ = build_pages(example(), language)
    page = render_html(certificate)
    assert f'<html lang="{language}">' in page
    assert check_pages(parse_html_certificate(page.encode(), "page")).outcome == "proved"
    pdf = parse_pdf_certificate(render_pdf(certificate), "pdf")
    assert check_pages(pdf).outcome == "proved"
    other = page.replace(f'<html lang="{language}">', '<html lang="en">')
    assert check_pages(parse_html_certificate(other.encode(), "page")).outcome == "contradicted"
    word = translation.translate("FAIL", language).text
    forged = page.replace(word, translation.translate("PASS", language).text)
    assert check_pages(parse_html_certificate(forged.encode(), "page")).outcome == "contradicted"


def test_arguments_are_kept_or_translated() -> None:
    def german(text: str) -> str:
        return translation.translate(text, "de").text

    assert german("2 of 3 cases pass.") == "2 von 3 Fällen bestanden."
    assert german("own/Cases, pantograph 2, Contact loss: 1.5 N above the upper limit") == (
        "own/Cases, Stromabnehmer 2, Kontaktverlust: 1.5 N über dem oberen Grenzwert"
    )
    assert translation.translate("A text of a user.", "de").missing == ("A text of a user",)
    assert translation.translate("119.7 N", "fr") == translation.Translation("119.7 N")


def test_glossary_names_a_source_for_each_term_or_says_that_it_has_none() -> None:
    glossary = tomllib.loads((TEMPLATES / "languages" / "glossary.toml").read_text("utf-8"))
    sources = glossary["source"]
    assert len(glossary["term"]) >= 25
    for term, row in glossary["term"].items():
        assert row.keys() == {*OTHERS, "source"}, term
        assert set(row["source"].values()) <= sources.keys(), term
        for language in OTHERS:
            entries = translation.read_catalogue(language)
            entry = entries.get(term, entries.get(term.capitalize(), row[language]))
            assert entry.lower() == row[language].lower(), term

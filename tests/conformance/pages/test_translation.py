"""Certificates and summaries in every language: complete catalogues, the same numbers, verified byte by byte."""

import ast
import builtins
import re
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any

import pytest

from helpers.example_passage import with_passage
from helpers.example_results import example, with_measured_run, with_reference
from helpers.untranslated import build_pages, find_untranslated, list_kept_words
from pantocheck.conformance.cases.library import find_entries, load_entry, read_bibliography, source_text
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.documents.document_reading import parse_html_certificate, parse_pdf_certificate
from pantocheck.conformance.documents.page_check import check_pages
from pantocheck.conformance.grading.input_sensitivity import describe_studies, list_conditions
from pantocheck.conformance.pages import translation
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.report_files import LANGUAGES, Language

ROOT = Path(__file__).parents[3]
OTHERS = LANGUAGES[1:]
NUMBER = re.compile(r"\d+(?:\.\d+)*")
EXAMPLES = (example, with_measured_run, with_reference, with_passage)


@pytest.mark.parametrize("language", OTHERS)
def test_catalogues_have_the_same_entries_arguments_and_numbers(language: Language) -> None:
    entries, first = translation.read_catalogue(language), translation.read_catalogue(OTHERS[0])
    file = (TEMPLATES / "languages" / f"{language}.toml").read_text("utf-8")
    assert translation.read_sections(language) == tomllib.loads(file)
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
    assert find_untranslated(results) == []


@pytest.mark.parametrize("language", OTHERS)
def test_texts_of_the_library_have_entries(language: Language) -> None:
    """Notes, titles, sources, conditions and resolving power of every library case; citations keep their language."""
    texts: dict[str, None] = {}
    for case in map(load_entry, find_entries(["*"])):
        pantographs = [pantograph.title for pantograph in case.pantograph_files]
        sources = [source for group in case.inputs for source in source_text(group.source).split("; ")]
        texts |= dict.fromkeys([case.file.title, case.line.title, *pantographs, *case.notes, *sources])
        texts |= dict.fromkeys([*(condition.name for condition in list_conditions(case)), *describe_studies(case)])
    citations = {read_bibliography()[key] for key in ("wang2016", "massat2007", "vovan2015")}
    assert len(texts) > 120
    missing = {text: found for text in texts if (found := translation.translate(text, language).missing)}
    assert missing.keys() <= citations
    assert [text for text in texts.keys() - citations if list_kept_words(text, language)] == []


ELSEWHERE = (
    *("app/", "campaigns/", "documents/", "drops/", "line/", "pantograph/", "studies/"),
    *("dossier/dossier_file", "dossier/dossier_reading", "core/", "cases/", "comparison/pantograph_fit"),
    *("comparison/drop_", "comparison/recorded_drop", "comparison/line_update", "comparison/comparison_limits"),
    *("comparison/static_record", "comparison/run_comparison", "comparison/compared_run", "pages/campaign"),
    *("pages/ci_reports", "pages/comparison_page", "pages/damping_page", "pages/identification", "pages/population"),
    *("pages/pantograph_pages", "pages/record_figures", "pages/run_comparison_page", "pages/site_pages"),
    *("pages/view_page", "pages/explore_page"),
    *("network/", "pages/network_", "runs/line_fmu", "runs/rig_"),
    *("pages/static_sections", "pages/translation", "pages/report_writers", "quantities/registry"),
    *("quantities/quantity.py", "records/record.py", "records/record_reading", "records/record_sidecar"),
    *("records/record_summary", "records/sidecar_tables", "records/channel_facts", "records/track_position"),
    *("records/source_reading", "records/source_tables", "records/table_rows"),
    *("records/column_values", "records/samples", "results/", "runs/program", "runs/command_system"),
    *(
        "runs/protocol_messages",
        "runs/reference_simulator",
        "runs/core_requirement",
        "pages/html",
        "pages/page_code",
        "__init__",
    ),
)
"""Modules whose texts no certificate shows: messages on input, the terminal, and other reports."""
SHOWN = (
    *("core/near_limit", "core/decision", "core/check_row", "core/criterion", "cases/case.py", "cases/input_studies"),
    *("results/incomplete_uncertainty", "results/supported_frequency"),
)
"""Modules of these folders whose texts it shows."""
MESSAGES = {name for name in dir(builtins) if name.endswith("Error")} | {
    *("InputError", "RecordInvalid", "Need", "Field", "compile", "refuse_missing_package", "read_model"),
    *("validation_problem", "PackedDamaged", "TooManyEvents", "parse_decision"),
}
"""Calls whose texts are messages on input, descriptions of keys or names of places."""
UNSHOWN_KEYWORDS = {"must_hold", "purpose", "needs", "definition", "source"}
PART = "\0"
"""Place of a part that is known at run time."""


def list_literals(node: ast.AST) -> Iterator[str]:
    """Texts below a node, with `PART` for each part of a formatted one; neither messages nor docstrings."""
    if isinstance(node, ast.JoinedStr):
        yield "".join(str(part.value) if isinstance(part, ast.Constant) else PART for part in node.values)
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    called = getattr(node, "func", None)
    called = called.value if isinstance(called, ast.Subscript) else called
    if getattr(called, "id", getattr(called, "attr", "")) in MESSAGES or getattr(node, "arg", "") in UNSHOWN_KEYWORDS:
        return
    for name, part in ast.iter_fields(node):
        for child in part if isinstance(part, list) else [part]:
            docstring = isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)
            plain = isinstance(node, ast.JoinedStr) and isinstance(child, ast.Constant)
            if isinstance(child, ast.AST) and name not in ("annotation", "returns") and not docstring and not plain:
                yield from list_literals(child)


def has_entry(text: str, keys: str) -> bool:
    """Whether a text with some parts has a translation, or each of its pieces stands in the keys of the catalogue."""
    fillings = (
        " ".join(text.replace(PART, part).split()).strip(" ;,") for part in ("7", "x", "", " 7 N", "20-50 Hz: ")
    )
    if any(not translation.translate(filled, "de").missing for filled in fillings):
        return True
    pieces = (piece.strip(" .,;:()").lower() for piece in re.split(f"{PART}|(?<=[.!?;:]) ", text))
    return all(piece in keys for piece in pieces if translation.WORD.search(piece))


def test_rarely_built_texts_have_entries() -> None:
    """States, refusals, warnings and reasons, as the sources write them: most of them no example builds."""
    keys = "\n".join(translation.ARGUMENT.sub(PART, key) for key in translation.read_catalogue("de")).lower()
    missing: list[str] = []
    count = 0
    for path in sorted((ROOT / "conformance").rglob("*.py")):
        name = path.relative_to(ROOT / "conformance").as_posix()
        if name.startswith(ELSEWHERE) and not name.startswith(SHOWN):
            continue
        for text in list_literals(ast.parse(path.read_text("utf-8"))):
            words = [word for word in translation.WORD.findall(text) if len(word) > 1]
            if len(words) > 2 and " " in text.strip() and not re.search(r"[<>{}\\^$|]|et al\. 2", text):
                count += 1
                missing += [] if has_entry(text, keys) else [f"{name}: {text.replace(PART, '{}')}"]
    assert count > 500
    assert missing == [], "\n".join(missing)
    assert not has_entry("a text of three words without an entry", keys)


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
    return set(re.findall(r"[^\W_]+", "\n".join(texts).lower()))


def test_no_entry_is_unused() -> None:
    """Every word of an entry stands in a source: an entry for a text that was changed is found by its old words."""
    words = list_words()
    for key in translation.read_catalogue("de"):
        own = re.findall(r"[^\W_]+", translation.ARGUMENT.sub(" ", key).lower())
        assert [word for word in own if word not in words] == [], key


def read_numbers(page: str) -> Counter[str]:
    """Numbers of the texts of a page, without its scripts, styles and figures."""
    text = re.sub(r"<(script|style|svg)\b.*?</\1>", " ", page, flags=re.DOTALL)
    return Counter(NUMBER.findall(unescape(re.sub(r"<[^>]*>", " ", text))))


def test_numbers_do_not_differ_between_languages() -> None:
    for build in EXAMPLES:
        pages = build_pages(build(), "en")
        certificate, summary = read_numbers(render_html(pages[0])), Counter(NUMBER.findall(render_markdown(pages[1])))
        assert sum(certificate.values()) > 200
        for language in OTHERS:
            translated = [replace(page, language=language) for page in pages]
            assert read_numbers(render_html(translated[0])) == certificate, language
            assert Counter(NUMBER.findall(render_markdown(translated[1]))) == summary, language


@pytest.mark.parametrize(
    "language", [OTHERS[0], *(pytest.param(name, marks=pytest.mark.thorough) for name in OTHERS[1:])]
)
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
    rows = {term: row["source"].values() for term, row in glossary["term"].items()}
    assert len(rows) >= 25
    assert {term for term in rows if {*rows[term]} == {"none"}} == {"analysis section", "apparent mass"}
    assert {source for row in rows.values() for source in row} == sources.keys()
    assert sources["none"] == "no printed source found"
    for term, row in glossary["term"].items():
        assert row.keys() == {*OTHERS, "source"}, term
        assert row["source"].keys() == set(OTHERS), term
        assert set(row["source"].values()) <= sources.keys(), term
        for language in OTHERS:
            entries = translation.read_catalogue(language)
            entry = entries.get(term, entries.get(term.capitalize(), row[language]))
            assert entry.lower() == row[language].lower(), term

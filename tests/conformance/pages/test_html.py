"""HTML writer: self-contained, escaped, accessible, the same every time."""

import json
import re
from base64 import b64encode
from hashlib import sha256
from html.parser import HTMLParser
from itertools import pairwise
from typing import Any

import pytest

from helpers.shown_page import show_certificate
from pantocheck.conformance.core.look import insert_look
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.document import Document, PlainHeader
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.results.results_format import Results

VOID = {"meta", "img", "line", "rect", "path", "circle", "link", "br", "use"}


class Outline(HTMLParser):
    """Tags, attributes and text of a page, and whether every tag is closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)

    def values(self, attribute: str) -> list[str | None]:
        return [attrs[attribute] for _, attrs in self.tags if attribute in attrs]


@pytest.mark.usefixtures("fresh_figures")
def test_html_is_deterministic(results: dict[str, Any], page_text: str) -> None:
    assert show_certificate(results) == page_text


@pytest.mark.parametrize("name", ["page_text", "hostile_text"])
def test_html_fetches_and_runs_nothing(name: str, request: pytest.FixtureRequest) -> None:
    text = request.getfixturevalue(name)
    outline = Outline(text)
    assert {tag for tag, _ in outline.tags} & {"link", "iframe", "object", "embed", "base", "form"} == set()
    assert outline.values("src") == []
    assert all(address.startswith("#") for address in outline.values("href"))
    assert not [attribute for _, attrs in outline.tags for attribute in attrs if attribute.startswith("on")]
    assert outline.values("style") == []  # the policy refuses them
    for style in re.findall("<style>(.*?)</style>", text, re.S):
        assert "url(" not in style
        assert "@import" not in style
    [policy] = [attrs["content"] for tag, attrs in Outline(text).tags if tag == "meta" and "http-equiv" in attrs]
    admitted = {words[0]: set(words[1:]) for words in map(str.split, str(policy).split(";"))}
    assert admitted["default-src"] == {"'none'"}
    for directive, tag in {"script-src": "script", "style-src": "style"}.items():
        contents = re.findall(f"<{tag}>(.*?)</{tag}>", text, re.S)
        digests = {f"'sha256-{b64encode(sha256(content.encode()).digest()).decode()}'" for content in contents}
        assert admitted[directive] == digests
    own = {"type": "application/json", "id": "pantocheck-results"}  # data, which no browser executes
    assert [attrs for tag, attrs in Outline(text).tags if tag == "script" and attrs] == [own]
    outline = Outline(request.getfixturevalue(name))
    assert outline.open == []
    identities = outline.values("id")
    assert len(identities) == len(set(identities))
    targets = {address.removeprefix("#") for address in outline.values("href")}
    assert targets <= set(identities)
    levels = [int(tag[1]) for tag, _ in outline.tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))
    assert all(attrs.get("alt") for tag, attrs in outline.tags if tag == "img")
    assert dict(outline.tags)["html"]["lang"] == "en"
    assert all(attrs.get("aria-label") for _, attrs in outline.tags if attrs.get("role") == "img")


def test_figures_of_a_page_keep_their_text_and_share_no_id(page_text: str) -> None:
    """Two figures have equal tick marks; a repeated id would draw those of the first figure in all others."""
    figures = re.findall(r"<figure.*?</figure>", page_text, re.S)
    captions = ("contact force", "uplift", "amplitude", "force up to", "Line at rest", "Force by frequency")
    assert all(any(caption in figure for caption in captions) for figure in figures)
    for figure in figures:
        outline = Outline(figure)
        owned = {name for tag, attrs in outline.tags if tag != "figure" for name in [attrs.get("id")] if name}
        assert owned or "Force by frequency" in figure
        assert set(re.findall(r'href="#([^"]+)|url\(#([^)]+)', figure)) == {
            (name, "") if f'href="#{name}"' in figure else ("", name) for name in owned
        }


def test_criteria_show_trust_verdict_bar_and_the_places_of_their_extremes(
    results: dict[str, Any], page_text: str
) -> None:
    outline = Outline(page_text)
    place = results["cases"][0]["places"]["1"]["max_force_N"]["position_m"]
    link = f'<a href="#case-1-force-1">at {round(place, 1):g}\N{NO-BREAK SPACE}m</a>'
    assert f"</code>, pantograph 1 {link}" in page_text
    assert '<a href="#case-1-uplift">at 300\N{NO-BREAK SPACE}m</a>' in page_text
    figures = [attrs for tag, attrs in outline.tags if tag == "figure" and "data-curves" in attrs]
    assert [(attrs["id"], attrs["data-curves"], attrs["data-case"], attrs["data-owner"]) for attrs in figures] == [
        ("case-1-force-1", "force", "0", "1"),
        ("case-1-force-2", "force", "0", "2"),
        ("case-1-uplift", "uplift", "0", "0"),
        ("case-2-force-1", "force", "1", "1"),
    ]
    tables = re.findall(r'<table class="(?:cards|values)".*?</table>', page_text, re.S)
    rows = re.findall(r'<tr role="row">\n<th role="rowheader".*?</tr>', "".join(tables), re.S)
    criteria = [row for case in results["cases"] for row in case["criteria"]]
    assert len(rows) == len(criteria)
    for text, row in zip(rows, criteria, strict=True):
        assert f"<code>{row['quantity']}</code>" in text
        assert f'class="verdict {row["verdict"]}"' in text
        assert text.count("<svg") == (row["value"] is not None)
    assert 'data-label="Trust"><span class="trust provisional"' in "".join(rows)


@pytest.mark.parametrize("name", ["results", "hostile"])
def test_html_embeds_its_complete_results(name: str, request: pytest.FixtureRequest) -> None:
    """The data block has every key in the order of the results; hostile text cannot end it."""
    results = request.getfixturevalue(name)
    page = show_certificate(results)
    [block] = re.findall('<script type="application/json" id="pantocheck-results">(.*?)</script>', page)
    assert not set("<>&") & set(block)
    assert block.isascii()
    assert json.dumps(json.loads(block)) == json.dumps(Results.model_validate(results).to_dict())


def test_html_escapes_hostile_text_and_has_data_with_results_only(hostile_text: str) -> None:
    page = render_html(Document("Title", PlainHeader("Heading", "Headline"), ()))
    assert "application/json" not in page
    assert "<script>alert" not in hostile_text
    assert ">&lt;script&gt;alert(1)&lt;/script&gt;</text>" in hostile_text  # in a figure
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in hostile_text
    assert "{{ 7*7 }} {% raw %}" in hostile_text
    assert not set(hostile_text) & set("\x00\x1b\u202e\ufffe\ue000")
    hostile_text.encode("utf-8")


def test_html_begins_with_the_verdict_and_states_the_self_declaration(page_text: str) -> None:
    seen = " ".join(Outline(page_text).texts)
    seen = seen[seen.index("self-declared") :]  # after the style sheet
    order = ["FAIL", "1 of 21 values", "Tested item", "Cases and limits", "Decision rule", "Failed", "Not evaluated"]
    order += ["Margin", "Issued by", "Check of this document", "All quantities"]
    places = [seen.index(text) for text in order]
    assert places == sorted(places)
    assert "self-declared conformance report, in the style of EN 50318" in page_text
    assert "not a certification" in page_text


def test_tables_become_cards_on_a_narrow_screen(page_text: str) -> None:
    """Tables are wider than 390 px; only a dense grid scrolls. Without headings every cell names its column."""
    narrow = page_text[page_text.index("@media screen and (max-width: 44rem)") : page_text.index("@page")]
    stacked = re.search(r":is\((.+?)\), :is\(.+?\) :is\(caption, tbody, tr, th, td\) { display: block", narrow)
    assert stacked is not None
    layouts = {str(attrs["class"]) for tag, attrs in Outline(page_text).tags if tag == "table"}
    assert {f".{layout}" for layout in layouts - {"grid"}} == set(stacked[1].split(", "))
    cells = [attrs for tag, attrs in Outline(page_text).tags if tag == "td"]
    assert len(cells) > 100
    assert all("data-label" in attrs for attrs in cells)


def test_style_sheet_states_no_colour_and_no_size_of_its_own() -> None:
    """They stand in the look, which `core/test_look.py` checks; sizes in `em` are relative to it."""
    style = (TEMPLATES / "page.css").read_text("utf-8")
    assert not re.search(r"#[0-9a-f]{3,6}\b", style)
    assert not re.findall(r"font-size: [\d.]+rem", style.replace("font-size: 1rem", ""))
    shown = insert_look(style)
    assert "@look" not in shown
    assert set(re.findall(r"var\((--[\w-]+)", shown)) <= set(re.findall(r"(--[\w-]+):", shown))

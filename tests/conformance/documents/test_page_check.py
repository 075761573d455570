"""Parts of an HTML page that run, fetch or hide content, and that the page of its results does not have."""

import pytest

from pantocheck.conformance.documents.page_check import POLICY, list_active_parts, list_foreign_elements

PAGE = f'<html><head><meta http-equiv="Content-Security-Policy" content="{POLICY}"></head><body>FAIL</body></html>'


@pytest.mark.parametrize(
    ("added", "part"),
    [
        ("<script>alert(1)</script>", "a script"),
        ("<style>p{display:none}</style>", "a style sheet"),
        ('<p onclick="x()">a</p>', "an event handler onclick of <p>"),
        ('<a href="https://example.org">a</a>', "an address in href of <a>"),
    ],
)
def test_additional_and_missing_parts_are_named(added: str, part: str) -> None:
    page = PAGE.replace("FAIL", f"FAIL{added}")
    assert list(list_active_parts(PAGE, PAGE)) == list(list_active_parts(page, page)) == []
    assert any(f"the page has {part} that the results do not give" in text for text in list_active_parts(page, PAGE))
    assert any(f"the page lacks {part}" in text for text in list_active_parts(PAGE, page))


def test_content_of_a_part_is_quoted() -> None:
    (text,) = (text for text in list_active_parts(PAGE + "<script> a()\n b() </script>", PAGE) if "a()" in text)
    assert text == "the page has a script that the results do not give: a() b()"
    assert "the page lacks an element <script>" in list(list_active_parts(PAGE, PAGE + "<script></script>"))


def test_page_needs_one_policy_in_its_metadata() -> None:
    assert list(list_foreign_elements(PAGE)) == []
    for page in (PAGE.replace("<meta", "<p"), PAGE.replace("none", "self"), PAGE.replace("<body>", PAGE)):
        assert "the page lacks the content security policy that fetches nothing" in list_foreign_elements(page)
    assert "the page has an element <iframe>" in list_foreign_elements(PAGE + "<iframe></iframe>")

"""Tables of the pages: rows that no table holds are shown as raw text."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"
PAGES = [*sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("tutorials/*.md"))]


def test_every_block_of_rows_begins_with_head_and_rule() -> None:
    wrong = []
    for page in PAGES:
        text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        lines = text.splitlines()
        begins = [i for i, line in enumerate(lines) if line.startswith("|") and not lines[i - 1].startswith("|")]
        wrong += [(page.name, lines[i]) for i in begins if not re.match(r"\|[\s:]*-", "".join(lines[i + 1 : i + 2]))]
    assert wrong == []

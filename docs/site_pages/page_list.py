"""List of all pages: title and purpose of each, from its first heading and its first sentence."""

import re
from pathlib import Path

from site_pages.markdown_table import build_markdown_table

DOCS = Path(__file__).parents[1]
TOCTREE = re.compile(r"```\{toctree\}\n(?P<options>(?::.*\n)*)\n(?P<entries>(?:[^`\n]+\n)*)```")
SENTENCE = re.compile(r".*?\.(?=\s|$)", re.DOTALL)


def build_page_list() -> str:
    """Page with a table for each caption of the navigation."""
    parts = ["# All pages", "Every page with its purpose, in the order of the navigation."]
    for caption, names in read_navigation().items():
        pages = [name for name in names if (DOCS / f"{name}.md").is_file() and not name.startswith("generated/")]
        rows = [(f"[{read_title(name)}](../{name}.md)", read_purpose(name)) for name in pages]
        if rows:
            parts += [f"## {caption}", build_markdown_table(("page", "purpose"), rows)]
    return "\n\n".join(parts) + "\n"


def read_navigation() -> dict[str, list[str]]:
    """Pages below each caption of the navigation, which the start page holds."""
    trees = TOCTREE.finditer((DOCS / "index.md").read_text("utf-8"))
    return {re.findall(r":caption: (.*)", tree["options"])[0]: tree["entries"].split() for tree in trees}


def read_title(name: str) -> str:
    """First heading of a page."""
    return (DOCS / f"{name}.md").read_text("utf-8").split("\n", 1)[0].removeprefix("# ")


def read_purpose(name: str) -> str:
    """First sentence of a page, without links."""
    body = (DOCS / f"{name}.md").read_text("utf-8").split("\n", 1)[1].strip()
    found = SENTENCE.match(body)
    if found is None:
        raise ValueError(f"docs/{name}.md does not begin with a sentence")
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", " ".join(found[0].split()))

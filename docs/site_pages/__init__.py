"""Pages of the documentation site that are generated from the code: commands, formats, quantities and interface."""

from pathlib import Path

from site_pages.command_pages import build_command_page
from site_pages.format_pages import build_format_page
from site_pages.interface_pages import build_interface_page
from site_pages.quantity_pages import build_quantity_page

PAGES = {
    "commands": build_command_page,
    "formats": build_format_page,
    "quantity-reference": build_quantity_page,
    "interface": build_interface_page,
}
"""Builder of each page by its name."""


def write_generated_pages(folder: Path) -> None:
    """Write every generated page; a page that did not change keeps its date, so that it is not built again."""
    folder.mkdir(exist_ok=True)
    for name, build in PAGES.items():
        path, content = folder / f"{name}.md", build()
        if not path.exists() or path.read_text("utf-8") != content:
            path.write_text(content, "utf-8")

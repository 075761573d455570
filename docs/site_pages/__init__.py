"""Pages and pictures of the documentation site that are generated from the code, the pages and their examples."""

from functools import partial
from pathlib import Path

from site_pages.check_table import build_check_table
from site_pages.command_pages import build_command_page
from site_pages.contributing_page import build_contributing_page
from site_pages.converged_pages import build_converged_page
from site_pages.element_pictures import write_element_pictures
from site_pages.feature_table import build_feature_table
from site_pages.format_pages import build_format_page
from site_pages.guide_tables import build_guide_counts
from site_pages.input_tables import build_condition_table, build_power_table
from site_pages.interface_pages import build_interface_page
from site_pages.look_pictures import write_look_pictures
from site_pages.moving_passages import write_passages
from site_pages.page_list import build_page_list
from site_pages.page_pictures import write_page_pictures
from site_pages.picture_folder import keep_pictures
from site_pages.quantity_pages import build_quantity_page
from site_pages.start_pictures import write_start_pictures
from site_pages.threshold_pages import build_threshold_page
from site_pages.trust_table import build_trust_table
from site_pages.tutorial_pages import write_tutorial_pictures

DOCS = Path(__file__).parents[1]

PAGES = {
    "commands": build_command_page,
    "formats": build_format_page,
    "quantity-reference": build_quantity_page,
    "thresholds": build_threshold_page,
    "interface": build_interface_page,
    "converged-values": build_converged_page,
    "contributing": build_contributing_page,
    "all-pages": build_page_list,
}
"""Builder of each page by its name."""

TABLES = {
    "conditions": build_condition_table,
    "features": build_feature_table,
    "guide-counts": build_guide_counts,
    "limit-trust": build_trust_table,
    "record-checks": build_check_table,
    "resolving-power": build_power_table,
}
"""Builder of each table that a written page includes."""

TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))
"""Pages of the tutorials, one per role."""


def write_generated_pages(folder: Path) -> None:
    """Write every generated page; a page that did not change keeps its date, so that it is not built again."""
    (folder / "tables").mkdir(parents=True, exist_ok=True)
    tables = {f"tables/{name}": build for name, build in TABLES.items()}
    for name, build in (PAGES | tables).items():
        path, content = folder / f"{name}.md", build()
        if not path.exists() or path.read_text("utf-8") != content:
            path.write_text(content, "utf-8")


def write_pictures(folder: Path) -> None:
    """Write the pictures of all pages, and the moving passages, unless nothing has changed since the last time."""
    writers = {
        "start": write_start_pictures,
        "look": write_look_pictures,
        "elements": write_element_pictures,
        "pages": write_page_pictures,
        "../moving": write_passages,
    }
    for name, write in writers.items():
        keep_pictures(folder / name, "", write)
    for page in TUTORIALS:
        keep_pictures(folder / page.stem, page.read_text("utf-8"), partial(write_tutorial_pictures, page))

"""Configuration of the documentation site: `sphinx-build -W docs OUT`."""

import re
import sys
from importlib.metadata import version as installed_version
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS))

from site_pages import write_generated_pages, write_pictures  # noqa: E402
from site_pages.equations import add_equations  # noqa: E402

from pantocheck.conformance.core.look import read_look  # noqa: E402

write_generated_pages(DOCS / "generated")
write_pictures(DOCS / "generated" / "pictures")

project = "Pantocheck"
author = "The Pantocheck authors"
copyright = "2026, The Pantocheck authors"
version = release = installed_version("pantocheck")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_gallery.gen_gallery"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["_build", "generated/moving", "generated/tables", "site_pages"]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
napoleon_numpy_docstring = False
napoleon_use_rtype = False
autosummary_generate = False
html_theme = "furo"
html_theme_options = {
    f"{scheme}_css_variables": {
        "color-brand-primary": colours["link"],
        "color-brand-content": colours["link"],
        "color-foreground-primary": colours["ink"],
        "color-foreground-secondary": colours["soft"],
        "color-background-primary": colours["paper"],
        "color-background-secondary": colours["pale"],
        "color-background-border": colours["line"],
    }
    for scheme, colours in read_look().items()
    if scheme in ("light", "dark")
}
html_title = f"Pantocheck {version}"
html_static_path = ["_static"]
html_extra_path = ["generated/moving"]
html_css_files = ["site.css"]
html_logo = html_favicon = "_static/logo.svg"
add_module_names = False
html_math_renderer = "mathml"

# Every example of the gallery runs when the site is built; a failed assertion ends the build.
sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "abort_on_example_error": True,
    "plot_gallery": "True",
    "within_subsection_order": "site_pages.gallery_order.GalleryOrder",
    "show_memory": False,
    "capture_repr": (),
    "remove_config_comments": True,
    "reset_modules": ("matplotlib", "site_pages.look_pictures.use_look"),
    "write_computation_times": False,
}


def link_repository_files(app: Any, page: str, source: list[str]) -> None:
    """Turn links to files that the site builds as pages, as the repository has them, into links to these pages."""
    source[0] = re.sub(r"\(((?:\.\./)*)\.\./examples/gallery/(\w+)\.py\)", r"(\1gallery/\2.rst)", source[0])
    source[0] = re.sub(r"\(((?:\.\./)*)\.\./CONTRIBUTING\.md", r"(\1generated/contributing.md", source[0])


def setup(app: Any) -> None:
    """Connect the events of Sphinx."""
    add_equations(app)
    app.connect("source-read", link_repository_files)

"""The table of mutants as a page of the documentation."""

from importlib.resources import files

from jinja2 import Environment, StrictUndefined

from pantocheck.conformance.consistency.record_checks import RECORD_CHECKS
from pantocheck.conformance.self_test.bench import SelfTest


def build_self_test_page(test: SelfTest) -> str:
    """Markdown of `docs/self-test.md`."""
    environment = Environment(undefined=StrictUndefined, autoescape=False, trim_blocks=True, keep_trailing_newline=True)
    template = (files("pantocheck.templates") / "self-test.md").read_text(encoding="utf-8")
    return environment.from_string(template).render(test=test, checks=RECORD_CHECKS)

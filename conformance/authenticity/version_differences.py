"""Versions of the software that wrote a document, against those that are installed.

Only the same versions lay out the same pages. Their differences are named, because then the bytes of pages cannot be
compared.
"""

from pantocheck.conformance.results.renderer_identity import identify_renderer
from pantocheck.conformance.results.results_building import build_suite
from pantocheck.conformance.results.results_format import Renderer, Results


def list_suite_differences(results: Results) -> list[str]:
    """Differences of the suite that graded the system from the installed suite; none if their digests agree."""
    stated, installed = results.suite, build_suite()
    if stated.digest == installed.digest:
        return []  # `find_false_version` compares the versions
    if stated.digest is None:
        return [f"Pantocheck {stated.version} stated no digest of its files; installed is {installed.version}"]
    if stated.version != installed.version:
        return [f"Pantocheck {stated.version}; installed is {installed.version}"]
    return [
        f"Pantocheck {stated.version} with the digest {stated.digest[:19]}; installed is {str(installed.digest)[:19]}"
    ]


def find_false_version(results: Results) -> list[str]:
    """Contradiction of a stated version with the digest of the installed files; none if the digests differ."""
    stated, installed = results.suite, build_suite()
    if stated.digest != installed.digest or stated.version == installed.version:
        return []
    return [f"Pantocheck {stated.version} stated; the stated digest is that of Pantocheck {installed.version}"]


def list_version_differences(results: Results) -> list[str]:
    """All differences of the software that made a document from the installed one, as sentences."""
    return [*list_suite_differences(results), *list_renderer_differences(results)]


def list_renderer_differences(results: Results) -> list[str]:
    """Differences of the software that made the pages from the installed one."""
    stated, installed = results.renderer, identify_renderer()
    if stated is None:
        return ["the versions of Typst, matplotlib and the fonts are not stated"]
    return [
        f"{name} {getattr(stated, name)}; installed is {getattr(installed, name)}"
        for name in Renderer.model_fields
        if getattr(stated, name) != getattr(installed, name)
    ]

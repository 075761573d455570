"""The verifier for a browser, opened from a file without a network, and its reports on documents."""

import base64
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Protocol

import pytest

Report = dict[str, Any]

CALL = """([data, name, signature, roots]) => {
  const decode = (text) => text && Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const given = roots && { name: "roots.pem", content: decode(roots) };
  return verifyDocument(decode(data), name, decode(signature), given).then(
    ({results, evaluated, ...report}) => report,
    (error) => ({state: "refused", conclusion: error.message, checks: []}));
}"""


class Verify(Protocol):
    """Report of the verifier on a document, with its signature file and trust roots."""

    def __call__(self, content: bytes, name: str, signature: bytes | None = None, roots: bytes | None = None) -> Report:
        """The report, or the state `refused` with the reason."""


@pytest.fixture(scope="session")
def verifier_page(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """The verifier in a browser without a network."""
    from pantocheck.conformance.grading.results_building import build_suite
    from pantocheck.conformance.pages.page_code import build_verifier

    path = tmp_path_factory.mktemp("verifier") / "verifier.html"
    path.write_bytes(build_verifier(build_suite().version, build_suite().digest))
    context = browser.new_context(offline=True)
    shown = context.new_page()
    shown.goto(path.as_uri())
    yield shown
    context.close()


@pytest.fixture(scope="session")
def verify(verifier_page: Any) -> Verify:
    """Function that gives the report of the verifier."""

    def call(content: bytes, name: str, signature: bytes | None = None, roots: bytes | None = None) -> Report:
        files = [None if part is None else base64.b64encode(part).decode() for part in (content, signature, roots)]
        report: Report = verifier_page.evaluate(CALL, [files[0], name, *files[1:]])
        return report

    return call


@pytest.fixture(scope="session")
def genuine() -> Any:
    """Documents (`Genuine`) of a run whose statistical maximum fails, with criteria close to their limits."""
    from helpers.wave_system import Wave
    from pantocheck.conformance.cases.library import load_case
    from pantocheck.conformance.execution.runner import run_cases
    from pantocheck.conformance.line.library_folder import library_folder
    from verification.attacks.forgeries import build_genuine

    case = load_case(library_folder() / "en50318-2002" / "250.toml")
    return build_genuine(run_cases([case], Wave(mean=119.9, sigma=30.9)).to_dict())


@pytest.fixture(scope="session")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Documents (`Genuine`) of the same run without contact height, whose record is unconfirmed."""
    from helpers.wave_system import Wave
    from pantocheck.conformance.cases.library import load_case
    from pantocheck.conformance.line.library_folder import library_folder
    from verification.attacks.forgeries import build_genuine, grade_record

    case = load_case(library_folder() / "en50318-2002" / "250.toml")
    record = replace(Wave(mean=119.9, sigma=30.9).record(case), contact_height=None)
    return build_genuine(grade_record(record, tmp_path_factory.mktemp("bare")))

"""Two verdicts: EN 50318 criteria, and verification against the converged solution."""

from collections import Counter
from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.certificate.criteria_table import criteria_blocks
from pantocheck.conformance.reports.words import read_words

NAMES = {
    "criteria": "EN 50318 criteria",
    "verification": "Verification against the converged solution, up to 50 Hz",
}
"""Title of each verdict."""

SHORT_TITLES = {"criteria": "EN 50318 criteria", "verification": "Verification up to 50 Hz"}

MEANING = (
    "The verdict of the report is the worse of those that decide. Verification compares with the solution of the same "
    "equations, on which two formulations without common code agree. It is no criterion of EN 50318 and never improves "
    "the verdict by the criteria."
)


def case_verdict(case: dict[str, Any], name: str) -> str | None:
    """One of the two verdicts of a case; None if the case has no converged values."""
    if name == "criteria":
        return str(case["criteria_verdict"] or case["verdict"])
    return None if case["verification"] is None else str(case["verification"]["verdict"])


def list_criteria(case: dict[str, Any], name: str) -> list[dict[str, Any]]:
    """Criteria of one of the two verdicts of a case."""
    table = case if name == "criteria" else case["verification"] or {"criteria": []}
    criteria: list[dict[str, Any]] = table["criteria"]
    return criteria


def select_criteria(results: dict[str, Any], case: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Criteria of the verdicts that decide on a case; its drift from a baseline always belongs to them."""
    for name in NAMES:
        left_out = name == "criteria" and case["id"] in results["verification_only"]
        decides = name in results["requested"] and not left_out
        yield from (row for row in list_criteria(case, name) if decides or row["baseline"] is not None)


def build_verdict_section(results: dict[str, Any]) -> tuple[doc.Section, ...]:
    """The two verdicts of a run side by side; empty if no case has converged values and none was requested."""
    if results["verification_verdict"] is None and "verification" not in results["requested"]:
        return ()
    rows = tuple(_verdict_row(results, name) for name in NAMES)
    columns = (doc.Column("Verdict on", 2), doc.Column("Verdict"), doc.Column("Part"), doc.Column("Cases and basis", 3))
    return (doc.Section("Two verdicts", (doc.Table(columns, rows), doc.SmallPrint(MEANING)), anchor="verdicts"),)


def _verdict_row(results: dict[str, Any], name: str) -> tuple[doc.RichText, ...]:
    verdict = results[f"{name}_verdict"] or "info"
    part = "decides" if name in results["requested"] else "for information"
    return NAMES[name], doc.VerdictMark(verdict), part, " ".join(_describe_basis(results, name))


def _describe_basis(results: dict[str, Any], name: str) -> Iterator[str]:
    shown = {*results["information"], *(results["verification_only"] if name == "criteria" else ())}
    cases = [case for case in results["cases"] if case["id"] not in shown and case_verdict(case, name) is not None]
    verdicts = Counter(case_verdict(case, name) for case in cases)
    passed = f"{verdicts['pass']} of {len(cases)} {'case' if len(cases) == 1 else 'cases'}"
    yield f"{passed} {'passes' if verdicts['pass'] == 1 else 'pass'}." if cases else "No case takes part."
    rows = Counter(row["verdict"] for case in cases for row in list_criteria(case, name))
    counted = sum(rows[verdict] for verdict in ("pass", "fail", "skip"))
    if counted:
        yield f"{rows['pass']} of {counted} counted criteria are inside their limits."
    if name == "verification":
        for text in dict.fromkeys(case["verification"]["confirmed_by"] for case in cases):
            yield f"Confirmed by {text}."


def verdict_sentences(results: dict[str, Any]) -> list[str]:
    """Sentence for the headline on the two verdicts; none if there is no verification."""
    if results["verification_verdict"] is None and "verification" not in results["requested"]:
        return []
    words = read_words()["verdict"]
    parts = []
    for name, title in SHORT_TITLES.items():
        note = "" if name in results["requested"] else " (for information)"
        parts.append(f"{title}: {words[results[f'{name}_verdict'] or 'info']['word']}{note}")
    return [f"{'; '.join(parts)}."]


def verification_blocks(case: dict[str, Any], anchor: str) -> tuple[doc.Block, ...]:
    """Section on the verification of a case; empty if the case has no converged values."""
    verification = case["verification"]
    if verification is None:
        return ()
    basis = f"\N{EN SPACE}Converged values of the reference simulator, confirmed by {verification['confirmed_by']}."
    blocks: list[doc.Block] = [doc.Paragraph((doc.VerdictMark(verification["verdict"]), basis))]
    if verification["reason"] and verification["reason"] != case["reason"]:
        blocks.append(doc.Paragraph(str(verification["reason"])))
    if verification["criteria"]:
        rows = case | {"criteria": verification["criteria"]}
        blocks += criteria_blocks(rows, anchor, f"{anchor}-verification-source")
    if verification["omitted"]:
        blocks.append(doc.Section("Without a confirmed value", (doc.BulletList(tuple(verification["omitted"])),)))
    return (doc.Section(NAMES["verification"], tuple(blocks)),)

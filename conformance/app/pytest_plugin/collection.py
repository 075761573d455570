"""Plan in pytest: file, cases, pantographs, criteria. A case runs with the first of its criteria."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn

import pytest

from pantocheck.conformance.app.pytest_plugin.session import PlanSession, list_registered
from pantocheck.conformance.app.pytest_plugin.shared_folder import shared_folder
from pantocheck.conformance.app.pytest_plugin.user_fixtures import (
    describe_unconfirmed,
    describe_unmet_criterion,
    is_unconfirmed,
    list_verdict_criteria,
)
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.core.criterion import LimitTarget
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.execution.plan import locate_plan, prepare_plan, read_plan, split_names
from pantocheck.conformance.grading.case_verification import build_requirements, find_obstacle
from pantocheck.conformance.grading.criterion_grading import criterion_name
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_all
from pantocheck.conformance.pages.verdict_reasons import build_headline
from pantocheck.conformance.quantities.limit_text import name_value
from pantocheck.conformance.results.report_files import FILES
from pantocheck.conformance.results.results_format import CaseResult, VerdictName


class CriterionNotMet(Exception):
    """A criterion is not met, or its case ended in error: reported in one line without a traceback."""


def _open_session(config: pytest.Config, path: Path, folder: Path) -> PlanSession:
    """Read and prepare a plan; the options of the session replace those of the plan."""
    stated = {name: config.getoption(f"pantocheck_{name}") for name in ("out", "formats", "trust", "verdicts")}
    options: dict[str, object] = {name: value for name, value in stated.items() if value is not None}
    if stated["out"] is not None:
        options["out"] = str(config.invocation_params.dir / stated["out"])
    if stated["formats"] is not None:
        options["formats"] = split_names(stated["formats"])
    plan = read_plan(path)
    further = [str(config.invocation_params.dir / name) for name in config.getoption("pantocheck_cases")]
    options["case_folders"] = (*plan.case_folders, *further)
    return PlanSession(path, prepare_plan(plan.model_copy(update=options)), folder)


class PlanFile(pytest.File):
    """Collector of pytest for a plan (TOML file): one node per case."""

    def collect(self) -> "Iterator[CaseNode]":
        """Cases of the plan."""
        try:
            session = _open_session(self.config, self.path, shared_folder(self.config))
        except InputError as error:
            raise self.CollectError(str(error)) from None
        for case in session.cases:
            yield CaseNode.from_parent(self, name=case.id, campaign=session, case=case)


class CaseNode(pytest.Collector):
    """Case of a plan."""

    def __init__(self, campaign: PlanSession, case: Case, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.campaign, self.case = campaign, case
        if self.config.pluginmanager.hasplugin("xdist"):
            # With --dist loadgroup one worker takes all criteria of a case, so no worker waits for another.
            self.add_marker(pytest.mark.xdist_group(case.id))

    def collect(self) -> "Iterator[VerdictNode | PantographNode | CaseItem | BaselineItem]":
        """Pantographs of the criteria, and the line if a quantity of the line has a limit; then the verification."""
        targets: dict[VerdictName, list[LimitTarget]] = {
            "criteria": [limit.target for limit in self.case.limits],
            "verification": list_targets(self.case),
        }
        requested = [name for name in self.campaign.prepared.participation.requested if targets[name]]
        if "criteria" in requested:
            yield from group_by_owner(self, "criteria", targets["criteria"])
        if "verification" in requested:
            yield VerdictNode.from_parent(self, name="verification", targets=targets["verification"])
        if not requested:
            yield CaseItem.from_parent(self, name="run")
        if self.campaign.prepared.baseline is not None:
            yield BaselineItem.from_parent(self, name="baseline")

    def result(self) -> CaseResult:
        """Result of the case, computed once per session. An error fails the test; a case with a reason is skipped."""
        result = self.campaign.result(self.case)
        if result.verdict == "error":
            self.report(f"error: {result.reason}")
        if result.reason:
            pytest.skip(result.reason)
        return result

    def report(self, reason: str) -> NoReturn:
        """Fail the test; skip it if the case is shown for information."""
        if self.case.id in self.campaign.prepared.participation.information:
            pytest.skip(f"for information: {reason}")
        raise CriterionNotMet(reason)


class VerdictNode(pytest.Collector):
    """Verification of a case."""

    def __init__(self, targets: list[LimitTarget], **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.targets = targets

    def collect(self) -> "Iterator[PantographNode]":
        """Pantographs of the case, and the line."""
        return group_by_owner(self, "verification", self.targets)


class PantographNode(pytest.Collector):
    """Pantograph of a case, or its line (number 0)."""

    def __init__(self, verdict_name: VerdictName, targets: list[LimitTarget], **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.verdict_name, self.targets = verdict_name, targets

    def collect(self) -> "Iterator[CriterionItem]":
        """Criteria of the pantograph."""
        if (case_node := self.getparent(CaseNode)) is None:
            raise TypeError("a pantograph belongs to a case")
        for target in self.targets:
            quantity, _, item = target
            name = name_value(quantity, item)
            yield CriterionItem.from_parent(
                self, name=name, case_node=case_node, verdict_name=self.verdict_name, target=target
            )


def group_by_owner(
    parent: pytest.Collector, name: VerdictName, targets: Sequence[LimitTarget]
) -> Iterator[PantographNode]:
    """Targets by pantograph."""
    for number in dict.fromkeys(owner for _, owner, _ in targets):
        owned = [target for target in targets if target[1] == number]
        yield PantographNode.from_parent(
            parent, name=str(number) if number else "line", verdict_name=name, targets=owned
        )


def list_targets(case: Case) -> list[LimitTarget]:
    """Quantities of a case that are verified."""
    converged = find_converged(case.id)
    if converged is None or find_obstacle(case, converged) is not None:
        return []
    return [entry.target for entry in build_requirements(converged, case.is_static)]


class OneLineItem(pytest.Item):
    """Test whose failure is reported in one line."""

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """One line for a verdict or an invalid input; another exception is a defect and keeps its traceback."""
        if isinstance(excinfo.value, CriterionNotMet | InputError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """File and id of the test."""
        return self.path, None, self.nodeid.partition("::")[2]


class CaseItem(OneLineItem):
    """Test of a case without limits: passed if the case runs."""

    def runtest(self) -> None:
        """Run the case."""
        if isinstance(self.parent, CaseNode):
            self.parent.result()


class BaselineItem(OneLineItem):
    """Test of the drift of a case from the baseline of the plan."""

    def runtest(self) -> None:
        """Run the case if necessary; a value that has drifted fails."""
        if not isinstance(self.parent, CaseNode):
            raise TypeError("a test of a baseline belongs to a case")
        self.parent.result()
        compared = self.parent.campaign.compare(self.parent.case)
        lines = "\n".join(list_drifts(compared))
        verdict = compared.baseline.verdict if compared.baseline is not None else "skip"
        if verdict == "fail":
            self.parent.report(lines)
        if verdict != "pass":
            pytest.skip(lines or "no value is compared with the baseline")


def list_drifts(case: CaseResult) -> list[str]:
    """Lines of the values of a case that drifted from its baseline or are missing, and of an impossible comparison."""
    return [f"{criterion_name(row)}: {row.reason}" for row in case.criteria if row.is_drift and row.verdict != "pass"]


class CriterionItem(OneLineItem):
    """Test of one criterion of a case."""

    def __init__(self, case_node: CaseNode, verdict_name: VerdictName, target: LimitTarget, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.case_node, self.verdict_name, self.target = case_node, verdict_name, target

    def runtest(self) -> None:
        """Run the case if necessary and report the verdict of the criterion."""
        campaign, result = self.case_node.campaign, self.case_node.result()
        criteria = list_verdict_criteria(result, self.verdict_name)
        criterion = next(c for c in criteria if (c.quantity, c.pantograph, c.item) == self.target)
        if criterion.verdict in {"skip", "info"}:
            pytest.skip(criterion.reason or criterion.verdict)
        if criterion.verdict == "fail":
            self.case_node.report(describe_unmet_criterion(criterion))
        if is_unconfirmed(result) and not campaign.accepts_unconfirmed:
            self.case_node.report(describe_unconfirmed(result))


def write_certificates(config: pytest.Config, folder: Path) -> tuple[list[str], bool]:
    """Write the certificates of all plans of a session.

    Returns:
        Lines for the summary of the session.
        Whether the cases of a plan that ran in this session do not pass.
    """
    lines, not_passed = [], False
    accepted = {"pass", "info"} if config.getoption("pantocheck_no_verdict") == "accept" else {"pass"}
    for path in list_registered(folder):
        session = _open_session(config, path, folder)
        if (session_results := session.results()) is None:
            continue
        (results, verdict), prepared = session_results, session.prepared
        not_passed |= verdict not in accepted
        write_all(results, prepared.out, prepared.formats, locate_plan(prepared.plan, path), prepared.plan.language)
        shown = next((FILES[name] for name in ("html", "pdf", "md") if name in prepared.formats), FILES["json"])
        lines.append(f"{path.name}: {results.verdict.upper()}: {build_headline(results)} {prepared.out / shown}")
        lines += (f"{path.name}: {remark}" for remark in remark_missing_formats(prepared.plan.formats))
        lines += (f"{path.name}: {case.id}: {line}" for case in results.cases for line in list_drifts(case))
    return lines, not_passed

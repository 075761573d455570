"""A plan as pytest sees it: file, cases, pantographs, criteria. A case is run when the first of its criteria is due."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.pytest_plugin import shared_folder
from pantocheck.conformance.pytest_plugin.campaign import PlanSession, list_registered
from pantocheck.conformance.pytest_plugin.user_fixtures import criterion_line
from pantocheck.conformance.reports.formats.report_writers import FILES, write_all
from pantocheck.conformance.results.results_format import CaseResult


class CriterionNotMet(Exception):
    """A criterion is not met, or its case did not get that far: shown as its one line, without a traceback."""


def open_session(config: pytest.Config, path: Path, folder: Path) -> PlanSession:
    """The campaign of a plan under the options of a session."""
    out = config.getoption("pantocheck_out")
    formats = config.getoption("pantocheck_formats")
    return PlanSession.of_plan(
        path,
        folder,
        out=None if out is None else str(config.invocation_params.dir / out),
        formats=None if formats is None else tuple(name.strip() for name in formats.split(",") if name.strip()),
        trust=config.getoption("pantocheck_trust"),
    )


class PlanFile(pytest.File):
    """A plan."""

    def collect(self) -> "Iterator[CaseNode]":
        """Its cases."""
        try:
            planned = open_session(self.config, self.path, shared_folder(self.config))
        except InputError as error:
            raise self.CollectError(str(error)) from None
        for case in planned.cases:
            yield CaseNode.from_parent(self, name=case.id, campaign=planned, case=case)


class CaseNode(pytest.Collector):
    """A case of a plan."""

    def __init__(self, campaign: PlanSession, case: Case, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.campaign, self.case = campaign, case
        if self.config.pluginmanager.hasplugin("xdist"):
            # With --dist loadgroup one worker gets the whole case, and none waits for another.
            self.add_marker(pytest.mark.xdist_group(case.id))

    def collect(self) -> "Iterator[PantographNode | WholeCase]":
        """Its pantographs and, for quantities that belong to none, its line."""
        for of in dict.fromkeys(limit.owner for limit in self.case.limits):
            yield PantographNode.from_parent(self, name=str(of) if of else "line", of=of)
        if not self.case.limits:
            yield WholeCase.from_parent(self, name="run")

    def result(self) -> CaseResult:
        """Of this case; computed once in a session.

        Raises
        ------
        NotMet
            The case ended in error.
        """
        result = self.campaign.result(self.case)
        if result.verdict == "error":
            raise CriterionNotMet(f"error: {result.reason}")
        if result.reason:
            pytest.skip(result.reason)
        return result


class PantographNode(pytest.Collector):
    """A pantograph of a case, or its line."""

    def __init__(self, of: int, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.of = of

    def collect(self) -> "Iterator[CriterionItem]":
        """Its criteria."""
        if not isinstance(self.parent, CaseNode):
            raise TypeError("a pantograph belongs to a case")
        for limit in self.parent.case.limits:
            if limit.owner == self.of:
                name = f"{limit.quantity}[{limit.item}]" if limit.item else limit.quantity
                yield CriterionItem.from_parent(self, name=name, case_node=self.parent, limit=limit)


class OneLine(pytest.Item):
    """A test that fails with one line."""

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The line, if it is a verdict or an error of input; anything else is a defect and keeps its traceback."""
        told = isinstance(excinfo.value, CriterionNotMet | InputError)
        return str(excinfo.value) if told else super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """Where it stands."""
        return self.path, None, self.nodeid.partition("::")[2]


class WholeCase(OneLine):
    """A case without limits: it shall run."""

    def runtest(self) -> None:
        """Run it."""
        if isinstance(self.parent, CaseNode):
            self.parent.result()


class CriterionItem(OneLine):
    """A criterion of a case."""

    def __init__(self, case_node: CaseNode, limit: Limit, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.case_node, self.limit = case_node, limit

    def runtest(self) -> None:
        """Look up its verdict."""
        criteria = self.case_node.result().criteria
        item = next(c for c in criteria if (c.quantity, c.pantograph, c.item) == self.limit.target)
        if item.verdict == "fail":
            raise CriterionNotMet(criterion_line(item))
        if item.verdict in {"skip", "info"}:
            pytest.skip(item.reason or item.verdict)


def write_certificates(config: pytest.Config, folder: Path) -> tuple[list[str], bool]:
    """Write the certificates of all plans of a session; a line for each, and whether a value drifted from a baseline.

    Raises
    ------
    InputError
        a file cannot be written.
    """
    lines, drifted_anywhere = [], False
    for path in list_registered(folder):
        finished = open_session(config, path, folder)
        if (found := finished.results()) is None:
            continue
        results, drifted = found
        drifted_anywhere |= drifted > 0
        write_all(results, finished.out, finished.formats)
        counted = [c for case in results.cases for c in case.criteria if c.verdict != "info"]
        passed = sum(c.verdict == "pass" for c in counted)
        shown = next((FILES[name] for name in ("html", "pdf", "md") if name in finished.formats), FILES["json"])
        lines.append(
            f"{path.name}: {results.verdict.upper()}, {passed} of {len(counted)} graded criteria within limits, "
            f"{finished.out / shown}"
        )
        if drifted:
            lines.append(f"{path.name}: {drifted} values drifted from the baseline {finished.plan.baseline}")
    return lines, drifted_anywhere

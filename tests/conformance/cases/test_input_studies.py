"""Stored studies of the inputs: files of the library belong to the present cases."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_studies import (
    ConditionsFile,
    ResolvingPowerFile,
    find_conditions,
    find_resolving_power,
    read_study,
)
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.grading.case_identity import limits_digest
from pantocheck.conformance.line.library_folder import library_folder

ON_REQUEST = ("force-law/300", "vovan2015/contact-force")


def test_stored_files_belong_to_the_present_cases() -> None:
    """A changed case needs a new computation: the command of the file makes it."""
    cases = {case.id: case for case in select_cases(["en50318-*", *ON_REQUEST])}
    powers = [read_study(path, ResolvingPowerFile) for path in (library_folder() / "resolving-power").rglob("*.toml")]
    conditions = [read_study(path, ConditionsFile) for path in (library_folder() / "conditions").rglob("*.toml")]
    assert {"en50318-2002/250", "en50318-2002/300"} <= {file.case for file in powers}
    for file in (*powers, *conditions):
        assert file.case_digest == cases[file.case].digest, file.command
    for name, folder in (("resolving-power", find_resolving_power), ("conditions", find_conditions)):
        paths = [path.relative_to(library_folder() / name) for path in (library_folder() / name).rglob("*.toml")]
        assert all(folder(str(path.with_suffix(""))).case == str(path.with_suffix("")) for path in paths)
    for file in powers:
        assert file.limits_digest == limits_digest(cases[file.case].limits), file.command


def test_every_case_of_a_train_with_converged_values_has_conditions(case_250: Case) -> None:
    trains = [case for case in select_cases(["en50318-*", *ON_REQUEST]) if not case.is_static]
    for case in trains:
        rows = {condition.name: condition for condition in find_conditions(case.id).condition}
        assert {"contact by the law of Hertz", "contact by a constraint"} < set(rows)
        assert len(rows) == 11
        assert all(bool(row.change) != bool(row.not_applicable) for row in rows.values())
        owners = {change.pantograph for change in rows["contact stiffness +100 %"].change}
        assert owners == set(range(len(case.pantographs) + 1))
    # The arms of EN 50318:2002 have no mass, so that none can be taken away.
    row = next(
        row for row in find_conditions(case_250.id).condition if row.name == "moving mass of the steady arm -0.1 kg"
    )
    assert row.not_applicable == "the value cannot be below 0 kg"


def test_case_without_a_study_has_none() -> None:
    assert find_conditions("own/case") is None
    assert find_resolving_power("own/case") is None

"""Plans: reading, preparation, and the messages for wrong options."""

from pathlib import Path

import pytest

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.plan import Plan, prepare_plan, read_plan


def test_damping_study_of_a_plan_is_added_to_its_cases(tmp_path: Path) -> None:
    path = tmp_path / "conformance.toml"
    path.write_text("system = 'builtin'\ncases = ['en50318-2002/250']\ndamping_study = true\nformats = ['html']\n")
    prepared = prepare_plan(read_plan(path))
    assert [case.file.study is not None for case in prepared.cases] == [True]
    assert prepared.formats == ("json", "html")
    assert prepared.out == tmp_path / "report"


def test_limits_of_a_plan_replace_those_of_its_cases(tmp_path: Path) -> None:
    limits = tmp_path / "limits.toml"
    limits.write_text('[[limit]]\nquantity = "mean_force_N"\nupper = 1.0\ntrust = "primary"\nsource = "own"\n')
    prepared = prepare_plan(Plan(cases=("en50318-2002/250",), limits=str(limits), out=str(tmp_path / "report")))
    assert {limit.upper for limit in prepared.cases[0].limits if limit.quantity == "mean_force_N"} == {1.0}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cases": ("no-such-case",)}, "there is no such case"),
        ({"formats": ("htm",)}, "there is no such format"),
        ({"baseline": "no-such-file.json"}, "no-such-file.json"),
        ({"out": "/dev/null/report"}, "/dev/null"),
    ],
)
def test_wrong_option_is_reported_before_anything_runs(
    options: dict[str, object], message: str, tmp_path: Path
) -> None:
    plan = Plan.model_validate({"cases": ("en50318-2002/250",), "out": str(tmp_path / "report")} | options)
    with pytest.raises(InputError, match=message):
        prepare_plan(plan).start_system()

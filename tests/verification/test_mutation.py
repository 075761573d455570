"""The mutation sample: its mutants, its choice of tests, its interval, and one mutant of a toy package."""

import json
from pathlib import Path

import pytest

pytest.importorskip("cosmic_ray", reason="cosmic-ray is optional: pip install 'pantocheck[mutation]'")

from verification.attacks.covering_tests import CoveringTests, list_statement_lines, name_definitions
from verification.attacks.mutants import Mutant, draw_sample, list_folders, list_mutants
from verification.attacks.mutation import Worker

SOURCE = '''"""A docstring with 1 number."""

LIMIT: float = 0.5


def grade(value: float) -> bool:
    """Whether a value is small."""
    return value < LIMIT
'''
FILES = {
    "pyproject.toml": '[tool.setuptools.package-dir]\n"toy" = "toy"\n"toy.model" = "model"\n',
    "model/grading/grade.py": SOURCE,
    "model/grading/kernel.py": "import numba\n\nX = 1\n",
    "model/use.py": "from dataclasses import dataclass\nfrom pantocheck.model.grading.grade import grade\n\n\n"
    "@dataclass(frozen=True)\nclass Use:\n    pass\n"
    "\n\n@inline_kernel\ndef double(value):\n    return 2 * value\n",
    "tests/model/test_near.py": "from toy.model.grading.grade import grade\n\n\n"
    "def test_grade():\n    assert grade(0.4)\n    assert not grade(0.6)\n",
    "tests/model/grading/test_grade.py": "from pantocheck.model.grading.grade import grade\n",
    "tests/conformance/test_all.py": "import pantocheck.model.grading.grade\n",
    "tests/conformance/test_use.py": "import pantocheck.model.use\n# grade\n",
    "tests/docs/test_page.py": "from pantocheck.model.grading.grade import grade\n",
}


@pytest.fixture
def toy(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        path = tmp_path / "toy" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return tmp_path / "toy"


def test_mutants_change_code_and_no_text(toy: Path) -> None:
    changed = [mutant.mutate(SOURCE) for mutant in list_mutants(toy, "model/grading/grade.py")]
    assert {line.strip() for source in changed for line in set(source.splitlines()) - set(SOURCE.splitlines())} == {
        "LIMIT: float = 1.5",
        "LIMIT: float = -0.5",
        "return value <= LIMIT",
        "return value > LIMIT",
    }


def test_sample_is_seeded_and_leaves_kernels_and_listed_mutants_out(toy: Path) -> None:
    folders = list_folders(toy)
    assert folders == {"model/grading": ["model/grading/grade.py"], "model": ["model/use.py"]}
    sample = draw_sample(toy, folders["model/grading"], 3, [])
    assert sample == draw_sample(toy, folders["model/grading"], 4, [])[:3]
    known = {"file": "model/grading/grade.py", "line": "return value < LIMIT", "mutant": "return value <= LIMIT"}
    assert len(draw_sample(toy, folders["model/grading"], 4, [known])) == 3
    assert len(draw_sample(toy, folders["model/grading"], 4, [{**known, "mutant": "return True"}])) == 4
    (toy / "model/use.py").write_text("def use(value):\n    if found := value:\n        return found\n", "utf-8")
    assert draw_sample(toy, folders["model"], 4, []) == []  # `if not found := value` is no Python
    (toy / "model/use.py").write_text(FILES["model/use.py"], "utf-8")
    assert draw_sample(toy, folders["model"], 4, []) == []  # no `frozen`, which the type checker finds, no kernels


def test_covering_tests_execute_the_line_and_the_one_of_its_name_comes_first(toy: Path) -> None:
    assert name_definitions(SOURCE, 8) == ["grade"]
    assert name_definitions(SOURCE, 3) == ["LIMIT"]
    assert list(list_statement_lines(SOURCE, 6)) == [6]  # the body of a function is other statements
    file, named, near = (
        "model/grading/grade.py",
        "tests/model/grading/test_grade.py::test",
        "tests/model/test_near.py::a",
    )
    use = "tests/conformance/test_use.py::test"
    lines = {file: {"8": "0x3", "6": "0x2"}, "model/use.py": {"6": "0x1"}}
    first = {"lines": lines, "seconds": {named: 9.0, use: 1.0}}
    other = {"lines": {file: {"8": "0x1"}, "model/use.py": {"6": "0x1"}}, "seconds": {near: 12.0, f"{near}b": 1.0}}
    tests = CoveringTests(toy, [first, other])
    assert tests.file_seconds["tests/model/test_near.py"] == 13.0
    assert tests.select(file, 8) == [named, use, near]
    assert tests.select(file, 6) == [named, use, near]  # a definition, which the first importing test executes
    assert tests.select(file, 3) == [named, use, near]  # a constant: every test of the file
    assert tests.select("model/use.py", 6) == [near, named]  # the same folder
    assert tests.select("model/grading/kernel.py", 3) == []
    unexecuted = CoveringTests(toy, [{"lines": {file: {"3": "0x2"}}, "seconds": first["seconds"]}])
    assert unexecuted.select(file, 8) == []


def test_coverage_of_the_tests_is_recorded_by_line(toy: Path, tmp_path: Path) -> None:
    worker = Worker.create(toy, tmp_path / "worker")
    worker.run_tests(["tests/model/test_near.py"], 60.0, tmp_path / "coverage.json")
    worker.close()
    record = json.loads((tmp_path / "coverage.json").read_text("utf-8"))
    test = "tests/model/test_near.py::test_grade"
    assert [*record["seconds"]] == [test]
    assert record["seconds"][test] > 0
    assert record["lines"]["model/grading/grade.py"]["8"] == "0x1"
    assert record["lines"]["model/grading/grade.py"]["6"] == "0x0"  # at import


def test_tests_run_on_the_changed_copy(toy: Path, tmp_path: Path) -> None:
    worker = Worker.create(toy, tmp_path / "worker")
    tests = ["tests/model/test_near.py"]
    assert worker.run_tests(tests, 60.0)[0] == 0
    reverse = Mutant("model/grading/grade.py", "core/ReplaceComparisonOperator_Lt_Gt", 0)
    worker.write(reverse.file, reverse.mutate(SOURCE))
    assert worker.run_tests(tests, 60.0)[0] == 1
    worker.write(reverse.file, SOURCE)
    assert worker.run_tests(tests, 60.0)[0] == 0
    (worker.place / tests[0]).write_text("while True:\n    pass\n", "utf-8")
    assert worker.run_tests(tests, 0.01)[0] is None
    worker.close()

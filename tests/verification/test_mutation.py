"""The mutation run: its operators on a few lines, its sample, and its outcomes on a toy package with known gaps."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "verification" / "attacks"

MODULE = '''"""A docstring with 1 number."""
import logging

__all__ = ["grade"]
LIMIT: float = 0.5


def grade(values: list[float], low: int = 0) -> float | None:
    """Largest of 3 values."""
    if not values or low > 2:
        raise ValueError("no 1 value", 7)
    logging.info("value 1", 5)
    total = 0.0
    for value in values[1:]:
        total += abs(value - LIMIT)
    return max(total, values[0])
'''

EXPECTED = {
    ("constant", "0.5 -> 1.0"),
    ("constant", "0.5 -> 0.25"),
    ("constant", "0 -> 1"),
    ("negate condition", "not values or low > 2 -> not (not values or low > 2)"),
    ("connective", "or -> and"),
    ("drop not", "not values -> values"),
    ("boundary", "> -> >="),
    ("comparison", "> -> <="),
    ("constant", "2 -> 3"),
    ("constant", "2 -> 1"),
    ("drop raise", 'raise ValueError("no 1 value", 7) -> pass'),
    ("constant", "0.0 -> 1.0"),
    ("first only", "values[1:] -> [*values[1:]][:1]"),
    ("slice", "1 -> nothing"),
    ("constant", "1 -> 2"),
    ("drop statement", "total += abs(value - LIMIT) -> pass"),
    ("arithmetic", "+= -> -="),
    ("drop abs", "abs -> nothing"),
    ("arithmetic", "- -> +"),
    ("return none", "max(total, values[0]) -> None"),
    ("opposite", "max -> min"),
    ("index", "0 -> 1"),
}


@pytest.fixture(autouse=True)
def scripts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(BENCHMARKS)


def test_operators_change_code_and_never_texts() -> None:
    from verification.attacks.mutation_mutants import find_mutants

    mutants = find_mutants("toy.py", MODULE.encode())
    assert {(mutant.operator, mutant.change) for mutant in mutants} == EXPECTED
    for mutant in mutants:
        text = mutant.apply(MODULE.encode()).decode()
        assert ast.dump(ast.parse(text)) != ast.dump(ast.parse(MODULE))
        assert len(text.splitlines()) == len(MODULE.splitlines())


def test_ids_survive_line_shifts() -> None:
    from verification.attacks.mutation_mutants import find_mutants

    shifted = MODULE.replace("import logging\n", "import logging\n# one line more\n\n")
    ids = [[mutant.id for mutant in find_mutants("toy.py", text.encode())] for text in (MODULE, shifted)]
    assert ids[0] == ids[1]
    assert len(set(ids[0])) == len(ids[0])


@pytest.fixture
def toy(tmp_path: Path) -> Path:
    """Package of one module: `reaches` is tested on both sides of the limit but not at it, `unused` not at all."""
    root = tmp_path / "toy-root"
    (root / "toy").mkdir(parents=True)
    (root / "tests").mkdir()
    (root / "pyproject.toml").write_text('[tool.setuptools.package-dir]\ntoy = "toy"\n')
    (root / "toy" / "__init__.py").touch()
    (root / "toy" / "limits.py").write_text(
        "def reaches(value, limit):\n    return value >= limit\n\n\n"
        "def unused(value):\n    return value + value\n\n\n"
        "def count_down(value):\n    while value > 0:\n        value = value - 1\n    return value\n"
    )
    (root / "tests" / "test_limits.py").write_text(
        "from toy.limits import count_down, reaches\n\n\n"
        "def test_reaches():\n    assert reaches(3, 2) and not reaches(1, 2)\n\n\n"
        "def test_count_down():\n    assert count_down(3) == 0\n\n\n"
        "def test_reaches_in_a_worker():\n"
        "    from concurrent.futures import ProcessPoolExecutor\n"
        "    from multiprocessing import get_context\n"
        "    with ProcessPoolExecutor(1, get_context('spawn')) as pool:\n"
        "        assert pool.submit(reaches, 3, 2).result()\n"
    )
    (root / "mutation.toml").write_text(
        'seed = 1\n[areas.toy]\nmutants = 100\nfiles = ["toy/*.py"]\n[[equivalent]]\nfile = "toy/limits.py"\n'
        'line = "while value > 0:"\noperator = "constant"\nreason = "named for this test"\n'
    )
    return root


def test_sample_depends_on_the_seed_alone(toy: Path, tmp_path: Path) -> None:
    from dataclasses import replace

    from verification.attacks.mutation_project import Settings, Sources

    settings = Settings.read(toy / "mutation.toml")
    samples = [
        [mutant.id for mutant in Sources(toy, replace(settings, seed=seed)).sample("toy", 5)] for seed in (1, 1, 2)
    ]
    assert samples[0] == samples[1] != samples[2]


def test_every_pattern_of_the_committed_settings_matches_a_file() -> None:
    from verification.attacks.mutation_project import Settings, Sources

    settings = Settings.read(BENCHMARKS / "mutation.toml")
    sources = Sources(BENCHMARKS.parents[1], settings)
    patterns = [pattern for area in settings.areas.values() for pattern in area["files"]]
    assert [pattern for pattern in patterns if not sources.files([pattern])] == []


@pytest.mark.thorough
def test_outcomes_on_a_toy_package(toy: Path, tmp_path: Path) -> None:
    pytest.importorskip("coverage", reason="the extra `mutation` is not installed")
    before = (toy / "toy" / "limits.py").read_bytes()

    def run(*arguments: str) -> str:
        script = [sys.executable, str(BENCHMARKS / "mutation.py"), str(tmp_path / "out"), "--root", str(toy)]
        done = subprocess.run(
            [*script, "--settings", str(toy / "mutation.toml"), "--jobs", "2", "--start", "3", *arguments],
            capture_output=True, text=True, check=False, timeout=300,
        )  # fmt: skip
        assert done.stderr == ""
        return done.stdout

    assert "traced tests/test_limits.py: 3 tests, 0 not passed" in run("--seconds", "0")
    run()
    results = json.loads((tmp_path / "out" / "results.json").read_text())["mutants"]
    outcomes = {(entry["source"], entry["change"]): entry["outcome"] for entry in results.values()}
    assert outcomes == {
        ("return value >= limit", ">= -> >"): "survived",
        ("return value >= limit", ">= -> <"): "killed",
        ("return value + value", "+ -> -"): "untested",
        ("while value > 0:", "> -> >="): "killed",
        ("while value > 0:", "> -> <="): "killed",
        ("while value > 0:", "0 -> 1"): "equivalent",
        ("value = value - 1", "- -> +"): "timeout",
        ("value = value - 1", "1 -> 2"): "killed",
    }
    assert (toy / "toy" / "limits.py").read_bytes() == before
    assert "toy/limits.py:6 arithmetic: + -> -" in run("--list", "untested")

"""Tables of a line with any cells: they give a line, or an error with place and hint for every problem."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from helpers.line_table_files import export_tables
from helpers.static_records import LINE_PATH, read_unequal_line
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line

CELLS = st.one_of(
    st.sampled_from(
        ["", "x", "-1", "1e999", "1e-400", "0", "9" * 30, "3", "1,2", '"', "1.5.2", "63", "nan", "inf", "5.0"]
    ),
    st.floats().map(repr),
    st.text(max_size=4),
)
CHANGES = st.lists(st.tuples(st.sampled_from([0, 1]), st.integers(0, 60), st.integers(0, 15), CELLS), max_size=4)


@pytest.fixture(scope="module")
def texts(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Tables of the line of the mass-drop tests."""
    tables = export_tables(tmp_path_factory.mktemp("tables"), read_unequal_line())
    return [table.read_text(encoding="utf-8") for table in tables]


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(CHANGES)
def test_any_cells_give_a_line_or_an_error_with_a_place(
    tmp_path: Path, texts: list[str], changes: list[tuple[int, int, int, str]]
) -> None:
    rows = [[line.split(",") for line in text.splitlines()] for text in texts]
    for table, row, column, cell in changes:
        cells = rows[table][row % len(rows[table])]
        cells[column % len(cells)] = cell
    paths = [tmp_path / name for name in ("supports.csv", "droppers.csv")]
    for path, table_rows in zip(paths, rows, strict=True):
        text = "\n".join(",".join(cells) for cells in table_rows) + "\n"
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        LineFile.model_validate(import_line(LINE_PATH, *paths))
    except InputError as error:
        for problem in error.problems:
            assert problem.where.startswith(("table 'supports.csv'", "table 'droppers.csv'", "line 'line.toml'"))
            assert problem.hint

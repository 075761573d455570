"""Versions of file formats: a file of another version is refused."""

import typing
from pathlib import Path
from typing import Any

import pytest

from pantocheck.conformance.app.schemas import READ_FORMATS, WRITTEN_FORMATS
from pantocheck.conformance.core.format_versions import VERSION, check_version
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.results.results_reading import parse_results


def test_readers_refuse_another_version_than_that_of_all_models(tmp_path: Path) -> None:
    models = [*READ_FORMATS.values(), *WRITTEN_FORMATS.values()]
    fields = [model.model_fields["schema_"] for model in models if "schema_" in model.model_fields]
    stated = {value for field in fields for value in typing.get_args(field.annotation)}
    assert len(stated) == len(fields)
    assert {text.rpartition("/")[2] for text in stated} == {str(VERSION)}
    path = tmp_path / "run.toml"
    path.write_text('schema = "pantocheck.record/2"\n')
    with pytest.raises(InputError, match=r"file 'run.toml', key schema: version 2 of the format record"):
        read_toml(path, "file")
    with pytest.raises(InputError, match=r"version 7 of the format results; Pantocheck .* reads version 1"):
        parse_results(b'{"schema": "pantocheck.results/7"}', "results 'results.json'")


@pytest.mark.parametrize("content", [{}, [], {"schema": 5}, {"schema": "other/9"}, {"schema": "pantocheck.record/1"}])
def test_content_of_this_version_or_without_one_is_accepted(content: Any) -> None:
    assert check_version(content, "file") is None


@pytest.mark.parametrize("number", [0, 2, 999999])
def test_another_version_is_refused_with_the_version_that_is_read(number: int) -> None:
    with pytest.raises(InputError, match=rf"version {number} of the format chain; Pantocheck .* reads version 1"):
        check_version({"schema": f"pantocheck.chain/{number}"}, "file")

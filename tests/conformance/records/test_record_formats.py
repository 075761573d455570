"""Contact-force records in every file format: the same record gives the same samples and quantities."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.foreign_tables import FOREIGN_WRITERS
from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_writing import write_record


def list_channels(record: Record) -> dict[str, np.ndarray]:
    """Channels of a record by the names of columns."""
    assert record.contact_height is not None
    assert record.support_uplift is not None
    rows = {
        "position_{}_m": record.position,
        "force_{}_N": record.force,
        "contact_height_{}_m": record.contact_height,
        "uplift_{}_m": record.support_uplift,
    }
    named = {name.format(i): row for name, array in rows.items() for i, row in enumerate(array, 1)}
    return {"time_s": record.time, **named}


@pytest.mark.parametrize("name", [name for name in FOREIGN_WRITERS if name != "groups.h5"])
def test_own_names_are_read_from_every_format(name: str, tmp_path: Path, two_pantograph_record: Record) -> None:
    """Fifteen digits in CSV, doubles elsewhere; an interval of a file gives the time to rounding."""
    sidecar = write_record(tmp_path / f"{Path(name).stem}.csv", two_pantograph_record)
    edit_toml(sidecar, {"sha256": None, "file": name})
    FOREIGN_WRITERS[name](tmp_path / name, list_channels(two_pantograph_record))
    record, _ = read_record(sidecar)
    for key in ("time", "position", "force", "contact_height", "support_uplift"):
        expected = getattr(two_pantograph_record, key)
        assert_allclose(getattr(record, key), expected, rtol=1e-12, atol=1e-14, err_msg=key)


def test_stated_layout_of_a_table_is_used_and_refused_for_other_formats(
    tmp_path: Path, two_pantograph_record: Record
) -> None:
    sidecar = write_record(tmp_path / "a.csv", two_pantograph_record)
    text = (tmp_path / "a.csv").read_text()
    (tmp_path / "a.csv").write_text("train 7,3,1\n" + text)
    edit_toml(sidecar, {"sha256": None, "table": {"header_lines": 1, "separator": ","}})
    assert read_record(sidecar)[0].force.shape == two_pantograph_record.force.shape
    FOREIGN_WRITERS["a.mat"](tmp_path / "a.mat", list_channels(two_pantograph_record))
    edit_toml(sidecar, {"file": "a.mat"})
    with pytest.raises(InputError, match=r"key table: states the layout of a text table, but \.mat is no text table"):
        read_record(sidecar)

"""TDMS and MDF tables: units, rates, counts and faults of the files of data loggers."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import EVERY_CHANNEL, read_tables

SAMPLES = np.random.default_rng(8).standard_normal((40, 2))


def write_tdms(path: Path, *channels: tuple[str, str, Any, dict[str, Any]]) -> Path:
    """File of channels: group, name, samples and properties."""
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment([nptdms.ChannelObject(*channel) for channel in channels])
    return path


def write_mdf(path: Path, *groups: dict[str, tuple[Any, Any, str]]) -> Path:
    """File with one group per table of samples, times and unit by name."""
    asammdf = pytest.importorskip("asammdf", reason="extra mdf")
    with asammdf.MDF(version="4.10") as file:
        for group in groups:
            file.append(
                [asammdf.Signal(samples, time, name=name, unit=unit) for name, (samples, time, unit) in group.items()]
            )
        file.save(path, overwrite=True)
    return path


def test_tdms_has_units_and_the_rate_of_its_interval(tmp_path: Path) -> None:
    path = write_tdms(
        tmp_path / "r.tdms",
        ("g", "a", SAMPLES[:, 0], {"wf_increment": 0.02, "unit_string": "g"}),
        ("h", "b", SAMPLES[:, 1], {"wf_increment": 0.02}),
    )
    (table,) = read_tables(path, (), 1000)
    assert_array_equal(table.values, SAMPLES)
    assert table.rate == pytest.approx(50.0)
    assert [(column.name, column.unit) for column in table.columns] == [("a", "g"), ("b", None)]


def test_tdms_without_an_interval_has_no_rate_and_without_samples_is_refused(tmp_path: Path) -> None:
    path = write_tdms(tmp_path / "r.tdms", ("g", "a", SAMPLES[:, 0], {}), ("g", "empty", [], {"wf_increment": 1.0}))
    (table,) = read_tables(path, (), 1000)
    assert (table.rate, table.values.shape) == (None, (40, 1))
    path = write_tdms(tmp_path / "r.tdms", ("g", "a", [], {}))
    with pytest.raises(InputError, match=r"r\.tdms': holds no samples"):
        read_tables(path, (), 1000)


@pytest.mark.parametrize("groups", ["gg", "gh"])
def test_tdms_states_its_samples_before_they_are_read(groups: str, tmp_path: Path) -> None:
    """Two channels of 40 samples, in one group or in two."""
    channels = [(group, name, SAMPLES[:, c], {}) for c, (group, name) in enumerate(zip(groups, "ab", strict=True))]
    path = write_tdms(tmp_path / "r.tdms", *channels)
    assert read_tables(path, (), 80)[0].values.size == 80
    with pytest.raises(InputError, match="states 80 samples"):
        read_tables(path, (), 79)


def test_mdf_states_its_samples_before_they_are_read(tmp_path: Path) -> None:
    """The samples of all channels count, also where the channels stand in several groups."""
    time = np.arange(40) / 50
    path = write_mdf(
        tmp_path / "r.mf4", {"a": (SAMPLES[:, 0], time, "g")}, {"b": (SAMPLES[:, 1], time, ""), "c": (time, time, "m")}
    )
    (table,) = read_tables(path, ("b", "a"), 80)
    assert_array_equal(table.values, SAMPLES[:, ::-1])
    assert [(column.name, column.unit) for column in table.columns] == [("b", None), ("a", "g")]
    assert table.time is not None
    assert_array_equal(table.time, time)
    with pytest.raises(InputError, match="states 80 samples"):
        read_tables(path, ("b", "a"), 79)


@pytest.mark.parametrize(("shift", "together"), [(0.9e-6, True), (1.1e-6, False)])
def test_mdf_channels_are_sampled_within_a_microsecond(shift: float, together: bool, tmp_path: Path) -> None:
    time = np.arange(40) / 50
    path = write_mdf(tmp_path / "r.mf4", {"a": (SAMPLES[:, 0], time, "g")}, {"b": (SAMPLES[:, 1], time + shift, "g")})
    different = pytest.raises(InputError, match="has channels with different sampling times")
    with nullcontext() if together else different:
        assert read_tables(path, ("a", "b"), 1000)[0].values.shape == (40, 2)


def test_mdf_names_the_missing_channel_and_needs_a_sidecar(tmp_path: Path) -> None:
    path = write_mdf(tmp_path / "r.mf4", {"a": (SAMPLES[:, 0], np.arange(40) / 50, "g")})
    with pytest.raises(
        InputError, match=r"has no channel 'b', which the sidecar names\.\n  The file holds the channels a, time"
    ):
        read_tables(path, ("a", "b", "c"), 1000)
    with pytest.raises(InputError, match="has no sidecar"):
        read_tables(path, (), 1000)


def test_mdf_states_the_bytes_of_its_records_before_they_are_read(tmp_path: Path) -> None:
    """The library allocates as many bytes as a damaged group states."""
    path = write_mdf(tmp_path / "r.mf4", {"a": (SAMPLES[:, 0], np.arange(40) / 50, "g")})
    content = bytearray(path.read_bytes())
    place = content.index(b"##CG") + 96  # bytes of a record, after the links, the id, the cycles and the flags
    content[place : place + 4] = (2**31).to_bytes(4, "little")
    path.write_bytes(content)
    for names in (("a",), EVERY_CHANNEL):
        with pytest.raises(InputError, match="states 40 records of 2147483648 bytes"):
            read_tables(path, names, 1000)

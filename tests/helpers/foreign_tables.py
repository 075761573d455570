"""Tables of channels in every file format, as programs of others write them."""

from collections.abc import Callable, Mapping
from pathlib import Path

import h5py
import numpy as np
import pytest
import pyuff
import scipy.io

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.hdf5_table import write_hdf5_table
from pantocheck.conformance.core.uff_table import write_data_sets

Channels = Mapping[str, RealArray]


def _write_csv(path: Path, channels: Channels) -> None:
    write_csv_table(path, list(channels), np.column_stack(list(channels.values())), 15)


def _write_hdf5(path: Path, channels: Channels) -> None:
    write_hdf5_table(path, {}, dict(channels))


def _write_groups(path: Path, channels: Channels) -> None:
    """Groups as a logger nests them."""
    with h5py.File(path, "w") as file:
        for name, samples in channels.items():
            file[f"daq/{name}"] = samples
        file["daq/info"] = np.arange(3)


def _write_matlab(path: Path, channels: Channels) -> None:
    scipy.io.savemat(path, {"comment": "test", **dict(channels)}, do_compression=True)


def _write_matlab_7_3(path: Path, channels: Channels) -> None:
    with h5py.File(path, "w") as file:
        for name, samples in channels.items():
            file[name] = samples[None, :]


def _write_uff(path: Path, channels: Channels) -> None:
    time = channels["time_s"]
    sets = [
        dict(
            pyuff.prepare_58(
                binary=1,
                func_type=1,
                rsp_node=number,
                rsp_dir=3,
                ref_node=0,
                ref_dir=0,
                ord_data_type=4,
                num_pts=samples.size,
                data=np.array(samples),
                x=time,
                abscissa_spacing=1,
                abscissa_min=0.0,
                abscissa_inc=float(time[1] - time[0]),
                abscissa_spec_data_type=17,
                abscissa_axis_units_lab="s",
                ordinate_spec_data_type=13,
                ordinate_axis_units_lab="NONE",
                orddenom_spec_data_type=0,
                orddenom_axis_units_lab="NONE",
                z_axis_spec_data_type=0,
                z_axis_axis_units_lab="NONE",
                id1=name,
                id2="NONE",
                id3="NONE",
                id4="NONE",
                id5="NONE",
            )
        )
        for number, (name, samples) in enumerate(channels.items(), 1)
        if name != "time_s"
    ]
    write_data_sets(path, sets)


def _write_tdms(path: Path, channels: Channels) -> None:
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment([nptdms.ChannelObject("daq", name, np.array(array)) for name, array in channels.items()])


def _write_mdf(path: Path, channels: Channels) -> None:
    asammdf = pytest.importorskip("asammdf", reason="extra mdf")
    time = channels["time_s"]
    with asammdf.MDF(version="4.10") as file:
        file.append(
            [
                asammdf.Signal(np.array(samples), np.array(time), name=name)
                for name, samples in channels.items()
                if name != "time_s"
            ]
        )
        file.save(path, overwrite=True)


FOREIGN_WRITERS: dict[str, Callable[[Path, Channels], None]] = {
    "a.csv": _write_csv,
    "a.h5": _write_hdf5,
    "groups.h5": _write_groups,
    "a.mat": _write_matlab,
    "v73.mat": _write_matlab_7_3,
    "a.uff": _write_uff,
    "a.tdms": _write_tdms,
    "a.mf4": _write_mdf,
}
"""Writers of channels by the name of the file, which names the format."""

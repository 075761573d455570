"""Several files and several rates of one measurement: what `describe` writes, `check` and `assess` accept."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import pyuff
import scipy.io

from helpers.command_line import pantocheck
from helpers.measured_pairs import SPACING, STATED, MeasuredPair, write_german
from pantocheck.conformance.core.uff_table import write_data_sets

COMPLETED = {
    "speed_km_h": "252.0",
    "filter_applied_Hz": '"none"',
    "evaluated_m": "[300.0, 420.0]",
    "spacing_m": f"[{SPACING}]",
    "support_position_m": "[300.0, 360.0, 420.0]",
    "span_m": "60.0",
    "wave_speed_m_s": "120.0",
    "uplift_space_mm": "80.0",
}


def complete(sidecar: Path) -> None:
    """Complete the commented keys, the uplift and the first way to join the clocks."""
    text = sidecar.read_text(encoding="utf-8")
    for key, value in COMPLETED.items():
        text = re.sub(rf"(?m)^# {key} = [^#\n]*", f"{key} = {value} ", text)
    text = re.sub(r"(?m)^# (uplift_\d_m = )", r"\1", text)
    text = re.sub(r"(?m)^# (join = .*# COMPLETE)", r"\1", text)
    sidecar.write_text(text, encoding="utf-8", newline="\n")


def read_value(folder: Path, *files: Path) -> float:
    """Largest uplift [mm] of a measurement that is described, completed, checked and assessed."""
    sidecar = folder / "described.toml"
    drafted = pantocheck("describe", *files, "--sidecar", sidecar)
    assert drafted.exit_code == 0, drafted.output
    complete(sidecar)
    checked = pantocheck("check", sidecar)
    assert checked.exit_code == 0, checked.output + sidecar.read_text()
    assert "is confirmed: 6 of 6 passages show a pulse" in checked.output or "2 of 2 passages" in checked.output
    arguments = ("--profile", "acceptance-ac", "--out", folder / "report", "--formats", "json")
    assessed = pantocheck("assess", sidecar, *arguments)
    assert assessed.exit_code == 0, assessed.output
    return json.loads((folder / "report" / "results.json").read_text())["cases"][0]["quantities"]["0"][
        "max_uplift_at_support_mm"
    ]


@pytest.mark.parametrize("order", [1, -1])
def test_describe_joins_a_train_and_its_masts(order: int, tmp_path: Path) -> None:
    """The file with the force becomes the first one, in whatever order the files are given."""
    pair = MeasuredPair()
    pair.write(tmp_path, 'kind = "time"')
    files = [tmp_path / "zug.csv", tmp_path / "mast.csv"][::order]
    assert read_value(tmp_path, *files) == pytest.approx(pair.masts()[:, 1:].max(), abs=1e-5)
    text = (tmp_path / "described.toml").read_text(encoding="utf-8")
    assert text.index('file = "zug.csv"') < text.index("[[source]]") < text.index('file = "mast.csv"')


def test_file_of_another_folder_than_the_sidecar_is_refused(tmp_path: Path) -> None:
    """`check` takes the names of files in the folder of the sidecar."""
    MeasuredPair().write(tmp_path, STATED)
    (tmp_path / "masts").mkdir()
    (tmp_path / "mast.csv").rename(tmp_path / "masts" / "mast.csv")
    files = tmp_path / "zug.csv", tmp_path / "masts" / "mast.csv"
    done = pantocheck("describe", *files, "--sidecar", tmp_path / "described.toml", COLUMNS="400")
    assert done.exit_code == 2
    assert "mast.csv': is not in the folder of the sidecar" in done.output
    assert not (tmp_path / "described.toml").exists()


def test_describe_counts_supports_over_all_files(tmp_path: Path) -> None:
    pair = MeasuredPair()
    pair.write(tmp_path, 'kind = "time"')
    table = pair.masts()
    for n in (1, 2, 3):
        write_german(tmp_path / f"mast{n}.csv", ["t [s]", "Anhub [mm]"], table[:, [0, n]])
    files = [tmp_path / name for name in ("zug.csv", "mast1.csv", "mast2.csv", "mast3.csv")]
    assert read_value(tmp_path, *files) == pytest.approx(table[:, 1:].max(), abs=1e-5)


# Files with channels of two rates.
Rates = tuple[dict[str, np.ndarray], dict[str, np.ndarray]]


def list_channels(pair: MeasuredPair) -> Rates:
    """Channels of the train and of the masts by name with unit."""
    train, masts = pair.train(), pair.masts()
    fast = {"Zeit [s]": train[:, 0], "Weg [m]": train[:, 1], "Kraft 1 [N]": train[:, 2], "Kraft 2 [N]": train[:, 3]}
    return fast, {"Uhrzeit [s]": masts[:, 0], **{f"Anhub {n} [mm]": masts[:, n] for n in (1, 2, 3)}}


def write_hdf5(path: Path, rates: Rates) -> None:
    with h5py.File(path, "w") as file:
        for group, channels in zip(("train", "masts"), rates, strict=True):
            for name, samples in channels.items():
                file[f"{group}/{name}"] = samples


def write_matlab(path: Path, rates: Rates) -> None:
    names = {"Zeit [s]": "Zeit_s", "Weg [m]": "Weg_m", "Uhrzeit [s]": "Uhrzeit_s"}
    content = {
        names.get(name, re.sub(r" (\d) \[(\w+)\]", r"\1_\2", name)): samples
        for channels in rates
        for name, samples in channels.items()
    }
    scipy.io.savemat(path, content)


def write_tdms(path: Path, rates: Rates) -> None:
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    channels = [
        nptdms.ChannelObject(group, name, np.array(samples))
        for group, part in zip(("train", "masts"), rates, strict=True)
        for name, samples in part.items()
    ]
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment(channels)


def write_mdf(path: Path, rates: Rates) -> None:
    asammdf = pytest.importorskip("asammdf", reason="extra mdf")
    with asammdf.MDF(version="4.10") as file:
        for channels in rates:
            time, *others = channels.items()
            split = [re.fullmatch(r"(.*) \[(.*)\]", name).groups() for name, _ in others]
            signals = zip(split, others, strict=True)
            file.append([asammdf.Signal(np.array(x), np.array(time[1]), name=n, unit=u) for (n, u), (_, x) in signals])
        file.save(path, overwrite=True)


def write_uff(path: Path, rates: Rates) -> None:
    sets = []
    for channels in rates:
        (_, time), *others = channels.items()
        sets += [
            dict(
                pyuff.prepare_58(
                    binary=1, func_type=1, rsp_node=1, rsp_dir=3, ref_node=0, ref_dir=0, ord_data_type=4,
                    num_pts=samples.size, data=np.array(samples), x=time, abscissa_spacing=1, abscissa_min=0.0,
                    abscissa_inc=float(time[1] - time[0]), abscissa_spec_data_type=17, abscissa_axis_units_lab="s",
                    ordinate_spec_data_type=13, ordinate_axis_units_lab="NONE", orddenom_spec_data_type=0,
                    orddenom_axis_units_lab="NONE", z_axis_spec_data_type=0, z_axis_axis_units_lab="NONE", id1=name,
                    id2="NONE", id3="NONE", id4="NONE", id5="NONE",
                )
            )
            for name, samples in others
        ]  # fmt: skip
    write_data_sets(path, sets)


WRITERS: dict[str, Callable[[Path, Rates], None]] = {
    "a.h5": write_hdf5,
    "a.mat": write_matlab,
    "a.tdms": write_tdms,
    "a.mf4": write_mdf,
    "a.uff": write_uff,
}


@pytest.mark.parametrize("name", WRITERS)
def test_file_with_two_rates_is_read_as_it_is(name: str, tmp_path: Path) -> None:
    """One file, two sources: samples of the masts keep their 200 Hz. UFF and MDF times begin at 0 and -7.2 s."""
    pair = MeasuredPair()
    path = tmp_path / name
    WRITERS[name](path, list_channels(pair))
    shown = pantocheck("describe", path)
    assert "500 Hz" in shown.output
    assert "200 Hz" in shown.output
    expected = pair.masts()[:, 1:].max()
    # UFF 58b with type 4 has single precision: 4e-6 mm.
    assert read_value(tmp_path, path) == pytest.approx(expected, abs=1e-5)


def test_columns_of_two_rates_in_one_table_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    write_hdf5(path, list_channels(MeasuredPair()))
    (tmp_path / "a.toml").write_text("""schema = "pantocheck.record/1"
file = "a.h5"
speed_km_h = 252.0
pantographs = 1
filter_applied_Hz = "none"
support_position_m = [300.0]
[columns]
time_s = { column = "train/Zeit [s]" }
force_1_N = { column = "train/Kraft 1 [N]" }
uplift_1_m = { column = "masts/Anhub 1 [mm]" }
""")
    done = pantocheck("check", tmp_path / "a.toml", COLUMNS="400")
    assert done.exit_code == 2
    assert "record 'a.h5': the columns have different sampling times" in done.output
    assert "[[source]]" in done.output


def test_mass_drop_is_one_file(tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        write_german(tmp_path / name, ["t [s]", "a1 [g]"], np.column_stack([np.arange(50) / 100, np.zeros(50)]))
    done = pantocheck("describe", tmp_path / "a.csv", tmp_path / "b.csv")
    assert done.exit_code == 2
    assert "file 'b.csv': is a second file of a mass drop" in done.output

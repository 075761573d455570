"""Mass drops in Python: signals, figures and files of a simulated or recorded drop."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pantocheck.conformance.app.notebook.display import describe_in_one_line, tabulate_columns
from pantocheck.conformance.core.drawn_axes import INK, in_report_style, provide_axes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.units import SI_UNITS
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import select_drop_writer


@dataclass(frozen=True)
class OpenedDrop:
    """A mass drop with the signals of its sensors: simulated, or read from a record."""

    record: DropRecord
    """Signals, sensors and description of the drop."""

    def __repr__(self) -> str:
        """Name, quantity, channels and duration in one line."""
        record = self.record
        channels = f"{record.quantity} in {count_noun(len(self.channels), 'channel')}"
        return describe_in_one_line(self, record.name, channels, f"{record.time[-1]:g} s")

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels."""
        return tuple(channel.name for channel in self.record.channels)

    def signals(self) -> Any:
        """Signals in SI units: a table of pandas, or columns of numpy.

        Columns are `time_s`, from the first sample, and one per channel.
        """
        return tabulate_columns(
            {"time_s": self.record.time, **dict(zip(self.channels, self.record.signals.T, strict=True))}
        )

    @in_report_style
    def plot(self, channel: str | None = None, axes: Any = None) -> Any:
        """Plot the signal of a channel over the time; returns matplotlib axes.

        Args:
            channel: Name of the channel; None: the first one.
            axes: Axes of the plot (matplotlib.axes.Axes); None: those of a new figure.

        Raises:
            ValueError: There is no such channel.
        """
        column = 0 if channel is None else self.channels.index(channel)
        axes, record = provide_axes(axes), self.record
        axes.plot(record.time, record.signals[:, column], color=INK, linewidth=0.6)
        label = f"{record.quantity} of {self.channels[column]} [{SI_UNITS[record.quantity]}]"
        axes.set(xlabel="time [s]", ylabel=label, title=record.name)
        return axes

    def write(self, path: str | Path) -> Path:
        """Write the drop as a record, `.csv`, `.uff` or `.h5` by its suffix; returns the path.

        Args:
            path: Path of the record; its suffix chooses the format.

        Raises:
            InputError: The suffix is not one of these, or the file cannot be written.
        """
        file = Path(path)
        select_drop_writer(file)(self.record, file)
        return file


def open_drop(path: str | Path, run: int = 1) -> OpenedDrop:
    """Read a mass-drop record.

    Args:
        path: Record in one of the formats of `pantocheck drop identify`; its sidecar has the same stem.
        run: Number of the run in a record with several, from 1.

    Raises:
        InputError: The record cannot be read, or has no such run.
    """
    return OpenedDrop(read_drop_run(Path(path), run, f"record '{Path(path).name}'"))


def read_drop_run(path: Path, number: int, where: str) -> DropRecord:
    """Run of a record, from 1; `where` names its number in a message."""
    records = read_drop_records(path)
    if not 1 <= number <= len(records):
        found = f"'{path.name}' has {len(records)}, numbered from 1."
        raise InputError(where, f"there is no run {number}", found)
    return records[number - 1]

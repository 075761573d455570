"""Files of a record: columns of a file that share one sampling, and the join of the clocks of several files.

A record has the file at its top, which holds the force, and one table `source` for each further file or further rate
of a file. Every source keeps its own sampling times. Its join states the time of the record that belongs to them:

    time of the record = time of the source + offset + drift (time of the source - middle of the ties)
"""

from typing import Annotated, Literal

from pydantic import Discriminator, Field

from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    Problems,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.core.table_sidecar import TableName, TableSidecar
from pantocheck.conformance.records.column_values import ColumnSource, FileColumnName, list_used_columns
from pantocheck.conformance.records.record import find_column
from pantocheck.conformance.records.sidecar_tables import MarkPosition

Offset = Annotated[float, Field(ge=-1e10, le=1e10)]
SOURCE_CHANNELS = ("time", "force", "speed", "position", "uplift")
"""Channels of a further source. Heights, events and arcs are those of the first file."""


class ColumnFile(TableSidecar):
    """File of a record, or those of its columns that are sampled together."""

    file: TableName
    columns: Annotated[dict[str, ColumnSource] | None, Field(min_length=1, max_length=200)] = None
    """Columns of the file by channel, such as force_1_N; default: the file uses these names itself."""


class TimeJoin(InputTable):
    """Both files count from the same instant, such as GPS time; or from instants with a known difference."""

    kind: Literal["time"]
    offset_s: Offset = 0.0
    """Time of the record less the time of the source [s]."""
    uncertainty_s: Annotated[Positive, Field(le=10)]
    """Half-width of the 95 % interval of this difference, with the drift since the clocks were set [s]."""


class PulseJoin(InputTable):
    """Both files have a column with one pulse at each full second, such as the PPS output of a GPS receiver."""

    kind: Literal["pps"]
    column: FileColumnName
    """Column of the pulses in the file of the source."""
    record_column: FileColumnName
    """Column of the pulses in the file of the record."""
    offset_s: Offset
    """Time of the record less the time of the source, to half a second [s]."""


class PassageJoin(InputTable):
    """The pulses of the uplift show when each pantograph passes the known support."""

    kind: Literal["passage"]
    offset_s: Offset
    """Time of the record less the time of the source, roughly [s]."""
    within_s: Annotated[NonNegative, Field(le=100_000)]
    """Largest error of this difference; the passage is searched in this range [s]."""


JoinTable = Annotated[TimeJoin | PulseJoin | MarkPosition | PassageJoin, Discriminator("kind")]


class SourceTable(ColumnFile):
    """Further file of a record, or further columns of a file with another rate, with its own clock."""

    join: JoinTable
    """Join of the clocks of source and record."""

    @cross_check
    def _check_channels(self) -> Problems:
        for name in self.columns or ():
            meaning = find_column(name, 1)
            if meaning is not None and meaning.channel.name not in SOURCE_CHANNELS:
                yield validation_problem(
                    f"columns.{name[:80]}",
                    "a further source holds force, uplift, position or speed only",
                    "Give it in [columns], with the file at the top of the record.",
                )


def list_source_columns(source: SourceTable) -> tuple[str, ...]:
    """Names of all columns of the file that a source uses."""
    pulses = (source.join.column,) if isinstance(source.join, PulseJoin) else ()
    return tuple(dict.fromkeys((*list_used_columns(source.columns or {}), *pulses)))

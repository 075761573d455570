"""Population of tests: every mass-drop record identified on its own, whatever its mass, place, sensors and tensions."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain

from pantocheck.conformance.core.array_types import ComplexArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_preparation import PreparedDecay, choose_band, prepare_decay
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.identification_plan import IdentificationPlan, exclude_channels, exclude_stretches
from pantocheck.conformance.drops.identify import (
    NO_PLAN,
    Identification,
    group_by_line,
    identify_decays,
)
from pantocheck.model.description.one_thread import use_one_thread


@dataclass(frozen=True)
class UnusableRecord:
    """Record that cannot be identified on its own, and the reason."""

    record: DropRecord
    error: InputError


@dataclass(frozen=True)
class PopulationTest:
    """One record with its own identification, and the joint identification of all records of its line."""

    record: DropRecord
    single: Identification
    joint: Identification


@dataclass(frozen=True)
class Population:
    """Tests of a population, the joint identifications of their lines, and the records that are left out."""

    tests: tuple[PopulationTest, ...]
    joint: tuple[Identification, ...]
    unusable: tuple[UnusableRecord, ...]


@use_one_thread
def identify_population(
    records: tuple[DropRecord, ...],
    highest: float = 10.0,
    poles: ComplexArray | None = None,
    progress: Callable[[str], None] = lambda text: None,
    plan: IdentificationPlan = NO_PLAN,
) -> Population:
    """Identify every record on its own, and the records of each line together.

    A record that cannot be identified on its own is left out of both. Parameters are as in `identify_modes`.

    Returns:
        At least one test; the tests of a line follow each other.

    Raises:
        InputError: No record can be identified; the error is that of the first one. Or the sampling rate of one record
            is too low for any mode, so that its line has no band.
    """
    used = exclude_channels(records, plan)
    lines = [_identify_line(line_records, highest, poles, progress, plan) for line_records in group_by_line(used)]
    population = Population(*(tuple(chain.from_iterable(parts)) for parts in zip(*lines, strict=True)))
    if not population.tests:
        raise population.unusable[0].error
    return population


def _identify_line(
    records: list[DropRecord],
    highest: float,
    poles: ComplexArray | None,
    progress: Callable[[str], None],
    plan: IdentificationPlan,
) -> tuple[list[PopulationTest], list[Identification], list[UnusableRecord]]:
    """Tests, joint identification and unusable records of one line; every record is prepared once."""
    band = choose_band(records, plan.highest_Hz or highest)
    usable: list[tuple[PreparedDecay, Identification]] = []
    unusable = []
    for record in records:
        progress(f"{record.name} on its own")
        try:
            decay = exclude_stretches(prepare_decay(record, band), plan)
            usable.append((decay, identify_decays([decay], band, poles, progress, plan)))
        except InputError as error:
            unusable.append(UnusableRecord(record, error))
    if not usable:
        return [], [], unusable
    (_, joint), *others = usable
    if others:
        joint = identify_decays([decay for decay, _ in usable], band, poles, progress, plan)
    return [PopulationTest(decay.record, single, joint) for decay, single in usable], [joint], unusable

"""Population of tests: every mass-drop record identified on its own, whatever its mass, place, sensors and tensions."""

from collections.abc import Callable
from dataclasses import dataclass

from pantocheck.conformance.array_types import ComplexArray
from pantocheck.conformance.identification.identify import Identification, identify_modes
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_record import DropRecord


@dataclass(frozen=True)
class UnusableRecord:
    """Record that cannot be identified on its own, and the reason."""

    record: DropRecord
    reason: str


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


def identify_population(
    records: tuple[DropRecord, ...],
    highest: float = 10.0,
    poles: ComplexArray | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Population:
    """Identify every record on its own, and the records of each line together.

    A record that cannot be identified on its own is left out of both.

    Parameters
    ----------
    records, highest, poles, progress
        As in `identify_modes`.

    Returns
    -------
    Population
        At least one test.

    Raises
    ------
    InputError
        No record can be identified; the error is that of the first one.
    """
    singles: list[tuple[DropRecord, Identification]] = []
    unusable: list[UnusableRecord] = []
    errors: list[InputError] = []
    for record in records:
        try:
            singles.append((record, identify_modes((record,), highest, poles, progress)[0]))
        except InputError as error:
            errors.append(error)
            unusable.append(UnusableRecord(record, str(error)))
    if not singles and errors:
        raise errors[0]
    joint = identify_modes(tuple(record for record, _ in singles), highest, poles, progress)
    line_of = {id(fit.decay.record): line for line in joint for fit in line.fit.records}
    tests = tuple(PopulationTest(record, single, line_of[id(record)]) for record, single in singles)
    return Population(tests, joint, tuple(unusable))


def find_joint_mode(mode: Mode, joint: tuple[Mode, ...]) -> Mode | None:
    """Mode of the joint identification nearest in frequency; None beyond half of the half-power bandwidth."""
    nearest = min(joint, key=lambda other: abs(other.frequency_Hz - mode.frequency_Hz), default=None)
    if nearest is None or abs(nearest.frequency_Hz - mode.frequency_Hz) > mode.damping_ratio * mode.frequency_Hz:
        return None
    return nearest

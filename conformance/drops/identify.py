"""Identification of the modes of a line from mass-drop records."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.drops.classical_poles import find_classical_poles
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.decay_onset import (
    NO_DELAY,
    find_onset,
    find_transients,
    move_onset,
    refuse_onset,
    restore_onset,
)
from pantocheck.conformance.drops.decay_preparation import (
    REMEDY,
    LinearDecay,
    PreparedDecay,
    choose_band,
    extend_decay,
    prepare_again,
    prepare_decay,
)
from pantocheck.conformance.drops.decay_search import SHORTEST_DECAY
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.fit_warnings import SHARED_POLES, list_fit_warnings
from pantocheck.conformance.drops.identification_plan import (
    IdentificationPlan,
    choose_poles,
    exclude_channels,
    exclude_stretches,
    refine_all,
    select_reported,
)
from pantocheck.conformance.drops.line_fit import (
    LAST_STEPS,
    UNCERTAIN,
    LineFit,
    build_modes,
    fit_line,
    group_into_blocks,
)
from pantocheck.conformance.drops.model_order import (
    PoleSelection,
    estimate_block_noise,
    find_hidden_poles,
    select_poles,
)
from pantocheck.conformance.drops.noise_estimate import LEAST_EXCESS, residual_excess, select_driven_poles
from pantocheck.conformance.drops.projection import DataBlock, build_block
from pantocheck.conformance.drops.sensor_clocks import (
    SensorClock,
    align_record,
    compare_clocks,
    describe_clocks,
    list_corrections,
    refuse_shared_clock,
    sum_clocks,
)
from pantocheck.conformance.drops.start_poles import BandTrials, join_start_poles, try_orders
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model.description.one_thread import use_one_thread

ROUNDS = 10
"""Largest number of identifications until the clocks of the sensors agree, and the decay begins where it is linear."""
BEGIN_STEP = 8.0
"""Time by which a decay begins later if no later part agrees with the others [s]."""
DRIVEN_STEPS = 4
"""Largest number of steps of the last refinement beside process noise; the search leaves little to refine."""
INCOMPLETE = 5.0
"""Misfit of poles of a user, above which some are missing: ambient motion would not be told from their modes [-]."""
NOT_CONTAINED = (
    "the residual follows the modes, as if the line moved by itself (light wind); with the classical method, or with "
    "too few poles chosen by the user, the intervals do not contain this motion"
)
START = "start poles"
"""Name of the first step of a search."""
LEAST_CERTAIN = 3
"""Fewest certain modes of an identification, unless half of its modes are certain."""
NO_PLAN = IdentificationPlan()
"""Plan that changes nothing."""


@dataclass(frozen=True)
class PoleSearch:
    """Steps of the search for the poles of a line."""

    trials: tuple[BandTrials, ...] = ()
    """Poles of all orders of the search for start poles; empty if there was none."""
    steps: tuple[tuple[str, ComplexArray], ...] = ()
    """Name of each step, and the poles after it, (m,) [1/s]."""


@dataclass(frozen=True)
class Identification:
    """Modes of one line."""

    fit: LineFit
    """Poles, residues and residual of its records."""
    modes: tuple[Mode, ...]
    """Modes in the reported band, by frequency."""
    warnings: tuple[str, ...]
    """Caveats on the whole identification."""
    search: PoleSearch = PoleSearch()
    """Steps of the search for the poles."""
    clocks: tuple[SensorClock, ...] = ()
    """Clocks of the sensors, against that of the first one; empty: not compared."""
    hidden: ComplexArray = field(default_factory=lambda: np.zeros(0, dtype=np.complex128))
    """Poles that are not reported, because the plan drops them [1/s]."""


@use_one_thread
def identify_modes(
    records: tuple[DropRecord, ...],
    highest: float = 10.0,
    poles: ComplexArray | None = None,
    progress: Callable[[str], None] = lambda text: None,
    plan: IdentificationPlan = NO_PLAN,
) -> tuple[Identification, ...]:
    """Identify the modes of each line in the records.

    Records of one line (same spans and tensions) have common poles; the residues differ between records.

    Args:
        records: Repeated drops, or drops at several positions.
        highest: Highest frequency of a reported mode [Hz].
        poles: Start poles placed by hand, (m,) [1/s], whose number is kept; None: start poles are searched in the
            records.
        progress: Function that receives the name of each step.
        plan: Choices of the user.

    Raises:
        InputError: A record cannot be used, or does not fit the plan.
    """
    used = exclude_channels(records, plan)
    return tuple(_identify_line(line_records, highest, poles, progress, plan) for line_records in group_by_line(used))


def group_by_line(records: tuple[DropRecord, ...]) -> list[list[DropRecord]]:
    """Records of each line, in the order of the records.

    Raises:
        InputError: There is no record.
    """
    if not records:
        raise InputError("records", "missing", "Name at least one record.")
    lines: dict[object, list[DropRecord]] = {}
    for record in records:
        lines.setdefault(_line_key(record), []).append(record)
    return list(lines.values())


def _line_key(record: DropRecord) -> object:
    line = record.line
    # Records without data of their line count as records of one line only if they are in the same file.
    return line if line.spans_m else (line, record.file or record.source)


def _identify_line(
    records: list[DropRecord],
    highest: float,
    start: ComplexArray | None,
    progress: Callable[[str], None],
    plan: IdentificationPlan,
) -> Identification:
    band = choose_band(records, plan.highest_Hz or highest)
    decays = []
    for record in records:
        progress(f"{record.name}: release and linear decay")
        decays.append(exclude_stretches(prepare_decay(record, band), plan))
    return identify_decays(decays, band, start, progress, plan)


def identify_decays(
    decays: list[PreparedDecay],
    band: FrequencyBand,
    start: ComplexArray | None,
    progress: Callable[[str], None],
    plan: IdentificationPlan = NO_PLAN,
) -> Identification:
    """Identify the modes of a line from decays in one band; further parameters as in `identify_modes`.

    The clocks of the sensors are corrected until they agree, and the decays begin where their modes agree with those
    of all later parts.

    Raises:
        InputError: The records state one clock, and the decays refute it; or no part of the decays is linear.
    """
    applied: list[SensorClock] = []
    earlier: Identification | None = None
    for _ in range(ROUNDS):
        found = _identify_once(decays, band, start, progress, plan, earlier)
        onset = find_onset(found.fit) if _is_free(start, plan) else NO_DELAY
        # Poles that every later part refutes are searched anew.
        earlier = None if onset.delay is None else found
        # Poles that the user left out, and transients, would be taken for wrong clocks.
        is_explained = not onset.transients and (start is None or found.fit.misfit < SHARED_POLES)
        compared = compare_clocks(found.fit) if is_explained and plan.method != "classical" else None
        clocks = () if compared is None else sum_clocks(compared.clocks, applied)
        moved = [] if compared is None else list_corrections(compared.clocks, applied)
        records = [decay.record for decay in decays]
        if moved and onset.delay == 0:
            refuse_shared_clock(records, clocks)
        if moved and not any(record.shared_clock for record in records):
            applied += moved
            progress(f"{records[0].name}: clocks of the sensors")
            aligned = [
                exclude_stretches(prepare_again(decay, align_record(decay.record, moved), band), plan)
                for decay in decays
            ]
            decays = [restore_onset(new, old) for new, old in zip(aligned, decays, strict=True)]
        elif onset.delay == 0:
            break
        else:
            delay = BEGIN_STEP if onset.delay is None else onset.delay
            decays = [
                move_onset(old, record.decay, delay) for old, record in zip(decays, found.fit.records, strict=True)
            ]
            if min(decay.linear.duration for decay in decays) < SHORTEST_DECAY:
                break
    if onset.delay != 0:
        raise refuse_onset(decays[0], onset)
    if compared is not None and any(clock.rate for clock in applied):
        # The rates were found from the same decays as the poles: both are estimated together.
        fit = replace(found.fit, poles=compared.poles, covariance=compared.covariance)
        found = replace(found, fit=fit, modes=_report_modes(fit, plan, found.hidden))
    if _is_free(start, plan):
        _require_certain(decays[0].record.name, found.modes)
    return replace(found, clocks=clocks, warnings=(*found.warnings, *describe_clocks(clocks)))


def _require_certain(name: str, modes: tuple[Mode, ...]) -> None:
    """Refuse a record whose decay determines hardly any mode.

    Raises:
        InputError: Fewer than `LEAST_CERTAIN` modes, and fewer than half, are certain.
    """
    certain = sum(mode.certain for mode in modes)
    if certain < min(LEAST_CERTAIN, len(modes) / 2):
        raise InputError(
            name,
            f"determines {certain} of its {count_noun(len(modes), 'mode')}: the others have a standard deviation above "
            f"{100 * UNCERTAIN:g} % of the damping ratio",
            REMEDY,
        )


def _is_free(start: ComplexArray | None, plan: IdentificationPlan) -> bool:
    """Whether the identification chooses poles and method; with those of a user it does not test the onset."""
    return start is None and not plan.changes_poles and plan.method != "classical"


def _identify_once(
    decays: list[PreparedDecay],
    band: FrequencyBand,
    start: ComplexArray | None,
    progress: Callable[[str], None],
    plan: IdentificationPlan,
    earlier: Identification | None,
) -> Identification:
    """Identify decays from their present start, beside ambient motion if they show any.

    The search starts at the poles of an earlier identification, with other clocks or another start of the decays.
    """
    driven, given = any(decay.driven for decay in decays), None
    if not (driven and _is_free(start, plan)):
        found = _identify_free_decays(decays, band, start, progress, plan, earlier)
        if not driven and residual_excess(found.fit.poles, [block.data for block in found.fit.blocks]) < LEAST_EXCESS:
            return found
        if not _is_free(start, plan):
            if plan.method == "classical" or found.fit.misfit > INCOMPLETE:
                return replace(found, warnings=(*found.warnings, NOT_CONTAINED))
            # Poles that were refined without ambient motion follow it.
            given = found if start is None else replace(found, search=PoleSearch((), (("placed by hand", start),)))
    whole = [decay if decay.driven else exclude_stretches(extend_decay(decay, band), plan) for decay in decays]
    return _identify_driven_decays(whole, band, progress, plan, given, earlier)


def _identify_driven_decays(
    decays: list[PreparedDecay],
    band: FrequencyBand,
    progress: Callable[[str], None],
    plan: IdentificationPlan,
    given: Identification | None,
    earlier: Identification | None,
) -> Identification:
    """Identify decays with ambient motion: the records are blocks of their own, because their motion differs.

    The poles of an identification that the user chose are refined; none is added.
    """
    name = decays[0].record.name
    samples = [(decay.linear.samples, decay.linear.dt) for decay in decays]
    places = [(number, slice(0, channels.shape[1])) for number, (channels, _) in enumerate(samples)]
    data = [build_block(channels, dt, band.low, band.fitted) for channels, dt in samples]
    progress(f"{name}: poles beside ambient motion")
    if given is None:
        longest = max(samples, key=lambda part: part[0].shape[0] * part[1])
        search = _begin_search(samples, band, plan, earlier) or _begin_search([longest], band, plan, earlier)
        assert search is not None
    else:
        search = given.search
    hidden = np.zeros(0, dtype=np.complex128) if given is None else given.hidden
    selection = select_driven_poles(search.steps[-1][1], data, given is None)
    step = "added and removed" if given is None else "refined beside ambient motion"
    search = replace(search, steps=(*search.steps, (step, selection.poles)))
    progress(f"{name}: uncertainty")
    fit = fit_line(decays, places, data, selection.poles, selection.noise, band, DRIVEN_STEPS)
    return Identification(fit, _report_modes(fit, plan, hidden), list_fit_warnings(fit), search, hidden=hidden)


def _identify_free_decays(
    decays: list[PreparedDecay],
    band: FrequencyBand,
    start: ComplexArray | None,
    progress: Callable[[str], None],
    plan: IdentificationPlan,
    earlier: Identification | None,
) -> Identification:
    """Identify decays without ambient motion; parameters as in `_identify_once`."""
    name = decays[0].record.name
    samples, places = group_into_blocks(decays)
    data = [build_block(channels, dt, band.low, band.fitted) for channels, dt in samples]
    progress(f"{name}: poles")
    is_classical = plan.method == "classical"
    if is_classical:
        selection, search = _find_peaks(data)
    elif start is not None:
        selection, search = _use_poles(start, data)
    else:
        search = _begin_search(samples, band, plan, earlier) or PoleSearch((), ((START, _find_longest(decays).poles),))
        selection, search = _search_poles(search, data)
    hidden = np.zeros(0, dtype=np.complex128)
    if plan.changes_poles:
        selection, hidden = choose_poles(selection, data, plan)
        search = replace(search, steps=(*search.steps, ("chosen by the plan", selection.poles)))
    progress(f"{name}: uncertainty")
    # A classical pole stays where its peak puts it; the residual then shows what the method leaves.
    last_steps = 0 if is_classical else LAST_STEPS
    fit = fit_line(decays, places, data, selection.poles, selection.noise, band, last_steps)
    modes = _report_modes(fit, plan, hidden)
    return Identification(fit, modes, list_fit_warnings(fit), search, hidden=hidden)


def _report_modes(fit: LineFit, plan: IdentificationPlan, hidden: ComplexArray) -> tuple[Mode, ...]:
    spans = fit.records[0].decay.record.line.spans_m
    return select_reported(build_modes(fit, len(spans) or None), plan, hidden)


def _search_poles(started: PoleSearch, data: list[DataBlock]) -> tuple[PoleSelection, PoleSearch]:
    selected = select_poles(started.steps[-1][1], data)
    complete = find_hidden_poles(selected, data)
    steps = (("added and removed", selected.poles), ("hidden poles tried", complete.poles))
    return complete, replace(started, steps=(*started.steps, *steps))


def _find_longest(decays: list[PreparedDecay]) -> LinearDecay:
    """Longest linear decay, whose poles are the start poles of records with different sampling rates."""
    return max((decay.linear for decay in decays), key=lambda linear: linear.duration)


def _begin_search(
    samples: list[tuple[RealArray, float]],
    band: FrequencyBand,
    plan: IdentificationPlan,
    earlier: Identification | None,
) -> PoleSearch | None:
    """Start poles: those of the plan, those of an earlier identification, or those of all orders in all records.

    None if the sampling rates of the records differ: the search of all orders needs one rate.
    """
    placed = plan.list_poles("start")
    if placed.size:
        return PoleSearch((), ((START, placed),))
    if earlier is not None:
        return PoleSearch(earlier.search.trials, ((START, earlier.fit.poles[~find_transients(earlier.fit)]),))
    intervals = {dt for _, dt in samples}
    if len(intervals) > 1:
        return None
    scaled = [np.asarray(channels / channels.std(axis=0)) for channels, _ in samples]
    trials = try_orders(scaled, 1 / intervals.pop(), band.low, band.fitted + 0.5)
    return PoleSearch(trials, ((START, join_start_poles(trials)),))


def _use_poles(start: ComplexArray, data: list[DataBlock]) -> tuple[PoleSelection, PoleSearch]:
    """Refine poles placed by hand, whose number is kept."""
    refined = refine_all(start, data)
    return refined, PoleSearch((), (("placed by hand", start), ("refined", refined.poles)))


def _find_peaks(data: list[DataBlock]) -> tuple[PoleSelection, PoleSearch]:
    """Poles of the classical method, and the noise that they leave."""
    poles = find_classical_poles(data)
    return PoleSelection(poles, estimate_block_noise(poles, data)), PoleSearch((), (("peaks of the spectrum", poles),))

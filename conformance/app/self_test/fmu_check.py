"""Check of an FMU as a pantograph: every gap is named before a passage depends on it."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.app.self_test.adapter_check import AdapterFinding
from pantocheck.conformance.comparison.response_comparison import (
    LARGEST_SUPPORTED_DEVIATION,
    find_supported_frequency,
    model_stiffness,
    response_deviation,
)
from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.fmu_table import FmuTable
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.pantograph.response_record import ResponseRecord
from pantocheck.conformance.runs.fmu_process import INPUTS, OUTPUTS, FmuPantograph, open_fmu
from pantocheck.conformance.runs.force_dynamics import MISFIT
from pantocheck.model.description.failures import SimulationError
from pantocheck.model.description.pantograph import Pantograph, equilibrium

PERIOD_S, PERIODS, EVALUATED = 2.0, 3, 2
"""Period of the force that excites the head, their number, and that of the last ones, which are evaluated."""
FREQUENCIES_HZ = np.arange(1, 51) / PERIOD_S
"""Frequencies of this force: 0.5 to 25 Hz."""
AMPLITUDE_N = 5.6
"""Amplitude at each frequency: an RMS of 28 N together, about that of a contact force."""
SUPPORTED_HZ = 20.0
"""Highest frequency at which the response is judged: lumped models are validated up to there."""
STEP_CHANGE = 0.05
"""Largest change of the response with half of the step; the record has it as its discretisation error."""
ACTIVE_SHARE = 1e-3
"""Share of the receptance above which a positive imaginary part delivers energy."""


@dataclass(frozen=True)
class FmuCheck:
    """Findings on an FMU, in the order of the check, which ends at the first failure of its process."""

    findings: tuple[AdapterFinding, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing is wrong."""
        return all(finding.state != "wrong" for finding in self.findings)


@dataclass(frozen=True)
class ExcitedHead:
    """Response of the head to the exciting force."""

    height: RealArray
    """Mean height of the strips, (n,) [m]."""
    receptance: ComplexArray
    """Height over upward force at `FREQUENCIES_HZ` [m/N]."""
    seconds_per_step: float


def check_fmu(
    file: PantographFile, uplift_force: float, time_step: float, measured: Sequence[ResponseRecord] = ()
) -> FmuCheck:
    """Check the FMU of a pantograph file that the user has named.

    Args:
        file: Pantograph file with an FMU.
        uplift_force: Uplift force [N].
        time_step: Step of the coupling [s].
        measured: Measured responses.

    Raises:
        InputError: The file has no FMU, its variables do not exist or have other units, or a response was not measured
            at the centre of the head.
    """
    if file.fmu is None:
        raise InputError("pantograph", "has no table [fmu]", "Name a pantograph file with an FMU, or an FMU beside it.")
    for record in measured:
        if not record.sidecar.is_at_head:
            found = "was not measured at the centre of the head"
            raise InputError(f"record '{record.source}'", found, "Give a response of the whole head.")
    findings: list[AdapterFinding] = []
    try:
        for finding in _list_findings(file, file.fmu, uplift_force, time_step, measured):
            findings.append(finding)
    except SimulationError as error:
        findings.append(AdapterFinding("wrong", "run", f"{error}."))
    return FmuCheck(tuple(findings))


def _list_findings(
    file: PantographFile, table: FmuTable, uplift_force: float, time_step: float, measured: Sequence[ResponseRecord]
) -> Iterator[AdapterFinding]:
    values = {"uplift_force_N": uplift_force, "train_speed_km_h": 0.0, "base_height_m": 0.0}
    model = build_pantograph(file, uplift_force, 0.0)

    def respond(step: float) -> tuple[FmuPantograph, ExcitedHead, float]:
        with open_fmu(table, values, step, -table.working_height_m) as fmu:
            return fmu, *_excite(fmu, model, step)

    with open_fmu(table, values, time_step, -table.working_height_m) as fmu:
        facts = fmu.facts
        tool = f" by {facts.tool}" if facts.tool else ""
        name = f"{facts.model_name} {facts.model_version}".strip()
        yield AdapterFinding("ok", "model", f"{name}{tool}, FMI {facts.fmi_version} {table.interface}.")
        names = {name for key in (*INPUTS, *OUTPUTS) for name in np.atleast_1d(getattr(table, key) or [])}
        bare = sorted(name for name in names if not facts.variables[name]["unit"])
        text = f"the FMU states no unit of {', '.join(bare)}; taken as the unit of the key."
        yield AdapterFinding("missing", "units", text) if bare else AdapterFinding("ok", "units", "all are stated.")
        yield (rollback := _check_rollback(fmu, uplift_force))
    if rollback.state == "wrong":
        return
    fmu, response, resting = respond(time_step)
    expected = float(equilibrium(model, 0.0)[1].sum())
    text = f"{resting:.2f} N hold the head at its working height; the linear model of the file has {expected:.2f} N."
    yield AdapterFinding("ok" if abs(resting - expected) <= 0.02 * expected else "wrong", "static force", text)
    force = exciting_force(time_step)
    linear = _receptance(_linear_heights(model, force, time_step), force, time_step)
    yield _compare_response(table, response.receptance, linear)
    for record in measured:
        yield _compare_measured(record, file, table, response.receptance / linear)
    yield _check_passivity(table, response)
    again, halved = respond(time_step)[1], respond(time_step / 2)[1]
    same = np.array_equal(again.height, response.height)
    text = "a second process gave the same heights, bit for bit." if same else "a second process gave other heights."
    yield AdapterFinding("ok" if same else "wrong", "determinism", text)
    change = _deviation(halved.receptance, response.receptance)
    text = f"half of the step changes the response up to {SUPPORTED_HZ:g} Hz by {change:.2%}."
    yield AdapterFinding("ok" if change <= STEP_CHANGE else "wrong", "step", text)
    share = response.seconds_per_step / time_step
    yield AdapterFinding(
        "note", "time", f"{1e6 * response.seconds_per_step:.0f} us per step, {share:.2g} of its length."
    )


def _check_rollback(fmu: FmuPantograph, uplift_force: float) -> AdapterFinding:
    """Repeat a step with other forces in between."""
    if not fmu.can_repeat:
        text = "no state rollback: the coupling is explicit; halve the time step of the case to know its error."
        return AdapterFinding("note", "rollback", text)
    force = np.full(len(fmu.table.contact_force_N), uplift_force / len(fmu.table.contact_force_N))
    for _ in range(20):
        fmu.attempt(force)
        fmu.accept()
    heights = [fmu.attempt(force + change) for change in (5.0, -30.0, 5.0)]
    if np.array_equal(heights[0], heights[2]):
        return AdapterFinding("ok", "rollback", "a repeated step gives the same heights, bit for bit.")
    return AdapterFinding("wrong", "rollback", "a repeated step gives other heights: the state is not restored.")


def _excite(fmu: FmuPantograph, model: Pantograph, time_step: float) -> tuple[ExcitedHead, float]:
    """Hold the head at its working height, then add the exciting force; response and holding force [N]."""
    from pantocheck.model.dynamics.foreign_pantograph import hold_head, measure_admittance  # loads the time steps

    shares = model.strip_shares
    first = model.static_force * shares
    admittance = measure_admittance(fmu, first)
    resting = hold_head(fmu, np.zeros(shares.size), first, admittance, time_step)
    force = exciting_force(time_step)
    begin, heights = time.perf_counter(), []
    for value in force:
        heights.append(float(fmu.attempt(resting + value * shares).mean()))
        fmu.accept()
    seconds = (time.perf_counter() - begin) / force.size
    height = np.array(heights)
    return ExcitedHead(height, _receptance(height, force, time_step), seconds), float(resting.sum())


def exciting_force(time_step: float) -> RealArray:
    """Downward force on the head, a sum of all frequencies with fixed phases, held over each step, (n,) [N]."""
    middle = time_step * (np.arange(round(PERIODS * PERIOD_S / time_step)) + 0.5)
    phase = np.pi * np.arange(FREQUENCIES_HZ.size) ** 2 / FREQUENCIES_HZ.size  # Schroeder: no high peaks
    force = AMPLITUDE_N * np.sin(2 * np.pi * np.outer(middle, FREQUENCIES_HZ) + phase).sum(axis=1)
    return np.asarray(force * np.minimum(middle / 0.5, 1.0))


def _receptance(height: RealArray, force: RealArray, time_step: float) -> ComplexArray:
    """Height over upward force in the last periods; heights stand at the ends of the steps, forces in their middle.

    A Hann window keeps the slow motion that is left of the start away from the frequencies, which stand two lines of
    the spectrum apart.
    """
    last = round(EVALUATED * PERIOD_S / time_step)
    line = np.rint(EVALUATED * PERIOD_S * FREQUENCIES_HZ).astype(int)
    window = 1 - np.cos(2 * np.pi * np.arange(last) / last)
    lag = np.exp(1j * np.pi * FREQUENCIES_HZ * time_step)
    spectra = [np.fft.rfft(window * signal[-last:])[line] for signal in (height, force)]
    return np.asarray(-spectra[0] / spectra[1] / lag)


def _linear_heights(model: Pantograph, force: RealArray, time_step: float) -> RealArray:
    """Mean height of the strips of a linear model from rest under forces held over each step, (n,) [m]."""
    h, z = time_step, np.zeros(model.head.size)
    v, heights = z, []
    matrix = model.mass + h / 2 * model.damping + h**2 / 4 * model.stiffness
    share = model.strip_shares @ model.strip_shapes
    for value in force:
        mean = np.linalg.solve(matrix, model.mass @ v - h / 2 * (value * share + model.stiffness @ z))
        z, v = z + h * mean, 2 * mean - v
        heights.append(float(model.head @ z))
    return np.array(heights)


def _deviation(found: ComplexArray, expected: ComplexArray) -> float:
    """RMS of the complex deviation of a receptance up to `SUPPORTED_HZ` [-]."""
    judged = FREQUENCIES_HZ <= SUPPORTED_HZ
    return float(np.sqrt(np.mean(np.abs(found / expected - 1)[judged] ** 2)))


def _compare_response(table: FmuTable, found: ComplexArray, linear: ComplexArray) -> AdapterFinding:
    """Compare a receptance with that of the linear model, in the same steps from the same rest."""
    deviation, largest = _deviation(found, linear), MISFIT.thresholds["contradiction"]
    ratio = np.abs(found / linear)
    worst = int(np.argmax(np.abs(found / linear - 1) * (FREQUENCIES_HZ <= SUPPORTED_HZ)))
    text = (
        f"the response from {FREQUENCIES_HZ[0]:g} to {SUPPORTED_HZ:g} Hz differs from the linear model of the file by"
        f" {deviation:.2%}, most at {FREQUENCIES_HZ[worst]:g} Hz, where it is {ratio[worst]:.4g} times as large."
    )
    if not table.is_linear:
        return AdapterFinding("note", "response", text)
    hint = "" if deviation <= largest else " Correct mass, springs and dampers of one of both."
    return AdapterFinding("ok" if deviation <= largest else "wrong", "response", text + hint)


def _compare_measured(
    record: ResponseRecord, file: PantographFile, table: FmuTable, ratio: ComplexArray
) -> AdapterFinding:
    """Compare the head with a measured response.

    The ratio of the receptance to that of the linear model changes slowly with the frequency, and is interpolated.
    """
    inside = (record.frequency >= FREQUENCIES_HZ[0]) & (record.frequency <= SUPPORTED_HZ)
    inside &= np.isfinite(record.stiffness)
    frequency, subject = record.frequency[inside], "measured"
    if frequency.size < 2:
        text = f"{record.source} has no values from {FREQUENCIES_HZ[0]:g} to {SUPPORTED_HZ:g} Hz."
        return AdapterFinding("missing", subject, text)
    softer = np.interp(frequency, FREQUENCIES_HZ, ratio.real) + 1j * np.interp(frequency, FREQUENCIES_HZ, ratio.imag)
    deviation = response_deviation(model_stiffness(file, frequency) / softer, record.stiffness[inside])
    supported = find_supported_frequency(frequency, deviation)
    rms = float(np.sqrt(np.mean(np.abs(deviation) ** 2)))
    reach = "at no frequency" if supported is None else f"up to {supported:.3g} Hz"
    text = (
        f"{record.source} supports the FMU {reach}, within {LARGEST_SUPPORTED_DEVIATION:.0%} in each third of an"
        f" octave; from {frequency[0]:.3g} to {frequency[-1]:.3g} Hz the deviation is {rms:.1%}."
    )
    if not table.is_linear:
        return AdapterFinding("note", subject, text)
    return AdapterFinding("ok" if supported is not None and supported >= frequency[-1] else "wrong", subject, text)


def _check_passivity(table: FmuTable, response: ExcitedHead) -> AdapterFinding:
    """Find frequencies at which the head delivers energy to the wire."""
    active = response.receptance.imag > ACTIVE_SHARE * np.abs(response.receptance)
    if not active.any():
        text = f"passive: the head takes energy at every frequency up to {FREQUENCIES_HZ[-1]:g} Hz."
        return AdapterFinding("ok", "energy", text)
    # Work of the exciting force in one period, per frequency: pi F^2 Im(H).
    work = np.pi * AMPLITUDE_N**2 * response.receptance.imag
    worst = int(np.argmax(np.where(active, work, 0.0)))
    text = (
        f"the head delivers energy at {active.sum()} frequencies from {FREQUENCIES_HZ[active][0]:g} to"
        f" {FREQUENCIES_HZ[active][-1]:g} Hz, at {FREQUENCIES_HZ[worst]:g} Hz"
        f" {1000 * work[worst]:.2g} mJ per cycle of {AMPLITUDE_N:g} N."
    )
    return AdapterFinding("wrong" if table.is_linear else "note", "energy", text)

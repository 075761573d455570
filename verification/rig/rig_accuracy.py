"""Contact force of a line under a simulated rig, over that of the line under the pantograph of the rig itself.

`python -m verification.tables rig-accuracy`: in simulated time, over the delay of the actuator and the differences
between the pantograph of the rig and the linear model of the case.
"""

import io
from dataclasses import replace
from itertools import pairwise

import numpy as np

from pantocheck.conformance.app.commands.options import choose_train_case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.runs.rig_control import RigControl, RigLimits
from pantocheck.conformance.runs.rig_loop import RigLog, run_loop
from pantocheck.conformance.runs.rig_run import build_stepped_passage
from pantocheck.model.description.pantograph import Pantograph
from pantocheck.model.dynamics.simulation import simulate_passage
from pantocheck.model.dynamics.stepped_passage import SteppedPassage
from verification.rig.simulated_rig import DirectLink, RigFaults, SimulatedClock, SimulatedRig, change_head

CASE, STEP_S, SETTLED_S, CUTOFF_HZ = "en50318-2002/250", 1e-3, 1.5, 50.0
LIMITS = RigLimits(force=500.0, travel=0.3, speed=5.0, correction=200.0, watchdog=0.05, connection=1.0)
DELAYS_MS = (0, 2, 5, 10)
CHANGES = ((1.0, 1.0), (1.05, 1.0), (1.1, 1.0), (1.2, 1.0), (1.5, 1.0), (1.0, 1.1))
"""Mass of the head, and springs and dampers, of the rig over those of the model."""
EDGES_HZ = (0.5, *range(5, 51, 5))
ACCEPTED = 0.05


def run_simulated(line: SteppedPassage, pantograph: Pantograph, faults: RigFaults, cutoff: float = CUTOFF_HZ) -> str:
    """Run one passage in simulated time; reason of a stop, empty: none."""
    rig = SimulatedRig(pantograph, line.start_height, STEP_S, faults=faults)
    control = RigControl(line, LIMITS, cutoff, 1)
    run_loop(control, DirectLink(rig), SimulatedClock(), RigLog(io.BytesIO()))
    return control.reason


def compare_bands(found: RealArray, expected: RealArray) -> RealArray:
    """RMS of the difference of two forces over the RMS of the expected one, per band [-]."""
    settled = round(SETTLED_S / STEP_S)
    window = np.hanning(found.size - settled)
    spectra = [np.fft.rfft(window * (force[settled:] - force[settled:].mean())) for force in (found, expected)]
    frequency = np.fft.rfftfreq(window.size, STEP_S)
    bands = [(first < frequency) & (frequency <= end) for first, end in pairwise(EDGES_HZ)]
    power = [np.array([np.sum(np.abs(x[band]) ** 2) for band in bands]) for x in (spectra[0] - spectra[1], spectra[1])]
    return np.asarray(np.sqrt(power[0] / power[1]))


def right_up_to(deviation: RealArray) -> float:
    """Frequency up to which no band deviates by more than is accepted [Hz]."""
    wrong = np.flatnonzero(deviation > ACCEPTED)
    return float(EDGES_HZ[wrong[0]] if wrong.size else EDGES_HZ[-1])


def main() -> None:
    """Print the table."""
    case = choose_train_case(CASE, ())
    line, stepped = discretise_line(case.line, case.file.discretisation.element_m), build_stepped_passage(case, STEP_S)
    model = stepped.passage.pantographs[0]
    print("| mass of the head | springs, dampers | delay [ms] | within 5 % up to [Hz] | to 20 Hz | to 50 Hz |")
    print("|--:|--:|--:|--:|--:|--:|")
    for mass, springs in CHANGES:
        pantograph = change_head(model, mass, springs)
        truth = simulate_passage(line, replace(stepped.passage, pantographs=(pantograph,))).force[0]
        for delay in DELAYS_MS:
            result = "stopped |  | "
            if not run_simulated(stepped, pantograph, RigFaults(delay_s=delay / 1000)):
                deviation = compare_bands(stepped.build_history().force[0], truth)
                shares = (f"{100 * part.max():.1f} %" for part in (deviation[:4], deviation))
                result = f"{right_up_to(deviation):g} | {' | '.join(shares)}"
            print(f"| {mass:g} | {springs:g} | {delay} | {result} |", flush=True)


if __name__ == "__main__":
    main()

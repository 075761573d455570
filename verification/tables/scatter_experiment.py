"""Scatter of Figure 5 of Vo Van, Balmes and Lorang (2015): which tests and which identification give it?

python -m verification.tables.scatter_experiment --tests 10

Figure 5 shows a variability that falls with frequency, and outliers that always overestimate. The stand-in has one
damping ratio per group, so that all scatter comes from the identification. Every test is identified on its own, by the
method of this suite and by the classical one. The tests differ in mass, place and noise; then also in tension and in
record length; and, on request, in an ambient motion of the line.
"""

import argparse
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_simulation import require_mass_drop, simulate_drop
from pantocheck.conformance.drops.identification_plan import IdentificationPlan, Method
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.drops.population import Population, PopulationTest
from pantocheck.conformance.drops.population_analysis import analyse_population
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.results.population_format import PopulationFile
from pantocheck.model import discretise
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.modes import compute_modes_below, deflection_at

CASE = "vovan2015/mass-drop/stand-in"
SEED = 20150818
TENSION_SCATTER = 0.01
"""Standard deviation of the tension of a wire from day to day, relative: a choice."""
RECORD_S = (120.0, 240.0)
MASSES_KG = (20.0, 40.0)
"""Printed ranges of record length and mass."""
LONGEST_DIFFERENCE_M = 3.0
"""Largest distance of the mass from its place in the case [m]: a choice."""
METHODS: tuple[Method, ...] = ("finite-record", "classical")


class Setting(NamedTuple):
    """Differences between the tests beside mass, place and noise."""

    name: str
    varies: bool = True
    """Whether tensions and record lengths vary."""
    ambient: float = 0.0
    """RMS of the ambient motion at the sensor that moves most [m/s2]; the noise of a sensor has 0.003 m/s2."""


SETTINGS = (
    Setting("mass, place and noise", varies=False),
    Setting("also tension and record length"),
)


def build_test(case: Case, setting: Setting, number: int) -> Case:
    """Case of one test: its first drop is that of the test."""
    random = np.random.default_rng((SEED, number))
    mass_drop = require_mass_drop(case)
    drop = mass_drop.drop[number % len(mass_drop.drop)]
    change = {
        "mass_kg": float(random.uniform(*MASSES_KG)),
        "x_m": drop.x_m + 0.75 * round(float(random.uniform(-1, 1)) * LONGEST_DIFFERENCE_M / 0.75),
    }
    scale, length = 1 + TENSION_SCATTER * random.standard_normal(2), float(random.uniform(*RECORD_S))
    changed = mass_drop.model_copy(
        update={"drop": (drop.model_copy(update=change),), "record_s": length if setting.varies else RECORD_S[0]}
    )
    line = case.line
    if setting.varies:
        wires = {
            name: getattr(line, name).model_copy(update={"tension_N": float(factor * getattr(line, name).tension_N)})
            for name, factor in zip(("contact_wire", "messenger_wire"), scale, strict=True)
        }
        line = line.model_copy(update=wires)
    return replace(case, line=line, file=case.file.model_copy(update={"mass_drop": changed}))


def add_ambient(test: Case, record: DropRecord, rms: float, number: int) -> DropRecord:
    """Record with an ambient motion: every mode is driven by its own white noise, all with the same acceleration."""
    random = np.random.default_rng((SEED, 1000 + number))
    mesh = discretise(build_catenary(test.line), test.file.discretisation.element_m)
    modes = compute_modes_below(mesh, require_mass_drop(test).highest_Hz)
    ratios = apply_modal_bands(np.zeros(modes.frequency.size), modes.frequency, mesh.catenary.modal_damping)
    rows = {"CW": 0, "MW": 1}
    shape = np.array([deflection_at(mesh, modes, rows[c.wire], c.position or 0.0) for c in record.channels]).T
    motion = np.zeros_like(record.signals)
    for frequency, ratio, at_sensors in zip(modes.frequency, ratios, shape, strict=True):
        motion += np.outer(_drive_mode(frequency, ratio, record, random), at_sensors)
    return replace(record, signals=record.signals + motion * (rms / motion.std(axis=0).max()))


def _drive_mode(frequency: float, ratio: float, record: DropRecord, random: np.random.Generator) -> RealArray:
    """Stationary motion of one mode with unit RMS, (n,)."""
    n, run_in = record.signals.shape[0], int(1.0 / (ratio * frequency) * record.rate)
    pole = np.exp(2 * np.pi * frequency * (-ratio + 1j) / record.rate)
    noise = random.standard_normal(n + run_in)
    response = scipy.signal.lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], noise)[run_in:]
    return np.asarray(response / response.std())


def simulate_tests(setting: Setting, count: int) -> list[tuple[Case, DropRecord]]:
    """Cases and records of all tests of a setting, without ambient motion."""
    (case,) = select_cases([CASE])
    tests = [build_test(case, setting, number) for number in range(count)]
    records = (simulate_drop(test, 1).record for test in tests)
    names = (f"test {number}" for number in range(1, count + 1))
    return [
        (test, replace(record, name=name, source=name))
        for test, record, name in zip(tests, records, names, strict=True)
    ]


def analyse(records: list[DropRecord], method: Method) -> PopulationFile:
    """Population of the records, each identified on its own."""
    (case,) = select_cases([CASE])
    highest, tests = require_mass_drop(case).highest_Hz, []
    for record in records:
        try:
            (found,) = identify_modes((record,), highest, plan=IdentificationPlan(method=method))
        except InputError as error:
            print(f"{record.name}: {error}")
            continue
        # The joint result is not used: the tests have different lines.
        tests.append(PopulationTest(record, found, found))
    return analyse_population(Population(tuple(tests), tuple(test.joint for test in tests), ()))


def format_row(setting: Setting, method: Method, population: PopulationFile) -> str:
    """Row of the table."""
    variability, groups = population.variability, population.groups
    spread = [100 * (group.upper_quartile - group.lower_quartile) / group.median for group in groups]
    outliers = sum(group.outliers_above for group in groups), sum(group.outliers_below for group in groups)
    cells = [
        setting.name,
        method,
        f"{np.mean([record.modes for record in population.records]):.1f}",
        "-" if variability.rank_correlation is None else f"{variability.rank_correlation:+.2f}",
        f"{spread[0]:.2f}, {spread[1]:.2f}, {spread[-1]:.2f}",
        f"{outliers[0]} and {outliers[1]}",
        ", ".join(f"{100 * group.median:.3f}" for group in groups[:3]),
    ]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Run every setting with both methods and print one row each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tests", type=int, default=10)
    parser.add_argument("--ambient", type=float, nargs="*", default=[], help="RMS of ambient motion [m/s2]; slow")
    options = parser.parse_args()
    count, motions = options.tests, [Setting(f"also ambient motion of {x:g} m/s²", ambient=x) for x in options.ambient]
    heads = (
        "tests differ in", "method", "modes per test", "rank correlation of the interquartile range",
        "range of groups 1, 2 and last [%]", "outliers above and below", "median of groups 1 to 3 [%]",
    )  # fmt: skip
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}")
    simulated = {varies: simulate_tests(Setting("", varies=varies), count) for varies in (False, True)}
    for setting in (*SETTINGS, *motions):
        records = [
            add_ambient(test, record, setting.ambient, number) if setting.ambient else record
            for number, (test, record) in enumerate(simulated[setting.varies])
        ]
        for method in METHODS:
            print(format_row(setting, method, analyse(records, method)), flush=True)


if __name__ == "__main__":
    main()

"""Damping fit: it returns the coefficients of a small finite-element line from its modes."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.damping_model import (
    DampingBasis,
    MeasuredModes,
    build_damping_basis,
    compute_observability,
    fit_damping_model,
    fit_modal_bands,
    residual_without_term,
)
from pantocheck.conformance.drops.mode_matching import MatchedModes, modal_assurance, pair_modes
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.modes import ComponentEnergies

SPANS = (63.0, 63.0, 58.5, 63.0, 54.0, 63.0)
WIRES = {"contact_wire": (20e3, 1.334, 0.055, 5e-5), "messenger_wire": (15e3, 1.06, 0.075, 8e-5)}
DROPPER_STIFFNESS = 1e-5  # stated, not fitted [s]
STEP = 2.25  # node distance [m]; strings, whose bending below 6 Hz does not matter


class Line(NamedTuple):
    """Computed modes of a line with their exact damping ratios and their groups."""

    frequency: RealArray
    energies: ComponentEnergies
    basis: DampingBasis
    ratio: RealArray
    group: IntegerArray


@pytest.fixture(scope="module")
def line() -> Line:
    """Two strings on a common grid, droppers between them, arms and supports at the masts; plain dense matrices."""
    n = round(sum(SPANS) / STEP) + 1
    kinds = (*WIRES, "dropper", "steady_arm")
    K, M = ({kind: np.zeros((2 * n, 2 * n)) for kind in kinds} for _ in "KM")
    for w, (kind, (tension, mass, _, _)) in enumerate(WIRES.items()):
        for i in range(n - 1):
            at = np.ix_([w * n + i, w * n + i + 1], [w * n + i, w * n + i + 1])
            K[kind][at] += tension / STEP * np.array([[1, -1], [-1, 1]])
            M[kind][at] += mass * STEP / 6 * np.array([[2, 1], [1, 2]])
    masts = np.round(np.cumsum((0.0, *SPANS)) / STEP).astype(int)
    for i in range(1, n - 1):
        if i % 3 == 0 and not np.any(np.abs(masts - i) < 2):
            at = np.ix_([i, n + i], [i, n + i])
            K["dropper"][at] += 1e5 * np.array([[1, -1], [-1, 1]])
            M["dropper"][at] += np.diag([0.23, 0.26])
    for i in masts[1:-1]:
        K["steady_arm"][i, i] += 250.0
        M["steady_arm"][i, i] += 0.5
    held = np.concatenate([[0, n - 1], n + masts])
    free = np.setdiff1d(np.arange(2 * n), held)
    cut = np.ix_(free, free)
    w2, shapes = scipy.linalg.eigh(sum(K.values())[cut], sum(M.values())[cut], subset_by_index=[0, 35])
    energy = {
        name: np.array([[phi @ table[kind][cut] @ phi for kind in kinds] for phi in shapes.T])
        for name, table in (("K", K), ("M", M))
    }
    frequency, energies = np.sqrt(w2) / (2 * np.pi), ComponentEnergies(kinds, energy["K"], energy["M"])
    damping = sum(b * M[kind] + a * K[kind] for kind, (_, _, b, a) in WIRES.items()) + DROPPER_STIFFNESS * K["dropper"]
    # The exact ratios come from the complex eigenvalues, not from the modal formula that is fitted.
    mass_inverse = np.linalg.inv(sum(M.values())[cut])
    zero, one = np.zeros_like(mass_inverse), np.eye(len(mass_inverse))
    state = np.block([[zero, one], [-mass_inverse @ sum(K.values())[cut], -mass_inverse @ damping[cut]]])
    poles = np.linalg.eigvals(state)
    poles = np.sort_complex(poles[poles.imag > 0] * -1j)[:36] * 1j
    ratio = -poles.real / np.abs(poles)
    stated = DROPPER_STIFFNESS * energies.stiffness[:, kinds.index("dropper")] / (4 * np.pi * frequency)
    basis = build_damping_basis(frequency, energies, stated)
    return Line(frequency, energies, basis, ratio, np.repeat(np.arange(1, 7), 6))


def build_measured_modes(line: Line, noise: float, random: np.random.Generator) -> MeasuredModes:
    noisy = line.ratio * (1 + noise * random.standard_normal(line.ratio.size))
    return MeasuredModes(line.frequency, noisy, np.maximum(noise, 1e-4) * line.ratio, line.group)


def test_energies_add_up_and_the_fit_returns_the_coefficients(line: Line) -> None:
    assert line.energies.mass.sum(axis=1) == pytest.approx(1, rel=1e-10)
    assert line.energies.stiffness.sum(axis=1) == pytest.approx((2 * np.pi * line.frequency) ** 2, rel=1e-8)
    # Both wires within 5 % from ratios known to 0.3 %.
    fit = fit_damping_model(line.basis, build_measured_modes(line, 0.003, np.random.default_rng(1)))
    for kind, (_, _, mass, stiffness) in WIRES.items():
        assert fit.values[kind, "mass"] == pytest.approx(mass, rel=0.05)
        assert fit.values[kind, "stiffness"] == pytest.approx(stiffness, rel=0.05)
    assert fit.residual < 0.006


def test_stated_damping_of_other_components_is_subtracted(line: Line) -> None:
    """Dampers that give a tenth of the damping of every mode: known they change nothing, unknown they bias all fits."""
    # Both coefficients of a wire grow by a ninth, many times their intervals of about 1 %.
    measured = build_measured_modes(line, 0.001, np.random.default_rng(5))
    added = measured.damping_ratio / 9
    damped = replace(measured, damping_ratio=measured.damping_ratio + added)
    known = fit_damping_model(replace(line.basis, stated=line.basis.stated + added), damped)
    unknown = fit_damping_model(line.basis, damped)
    for c, wrong in zip(known.coefficients, unknown.coefficients, strict=True):
        true = WIRES[c.kind][2 if c.matrix == "mass" else 3]
        assert c.low_95 <= true <= c.high_95
        assert wrong.low_95 > true
    assert known.predicted == pytest.approx(damped.damping_ratio, rel=0.01)


def test_intervals_cover_the_truth(line: Line) -> None:
    """Of 10 fits x 4 coefficients, 95 % intervals miss about 2; fewer than 9 is five standard errors away."""
    missed = 0
    for seed in range(10):
        fit = fit_damping_model(line.basis, build_measured_modes(line, 0.02, np.random.default_rng(seed)))
        for c in fit.coefficients:
            true = WIRES[c.kind][2 if c.matrix == "mass" else 3]
            missed += not c.low_95 <= true <= c.high_95
    assert missed < 9


def test_fit_finds_outliers_and_the_coefficients_that_the_modes_determine(line: Line) -> None:
    measured = build_measured_modes(line, 0.003, np.random.default_rng(2))
    measured.damping_ratio[8] *= 1.5
    fit = fit_damping_model(line.basis, measured)
    assert not fit.used[8]
    assert fit.used.sum() >= 34
    assert fit.values["contact_wire", "stiffness"] == pytest.approx(5e-5, rel=0.06)
    measured = build_measured_modes(line, 0.003, np.random.default_rng(3))
    fit = fit_damping_model(line.basis, measured)
    observable = {(row.kind, row.matrix) for row in compute_observability(line.basis, measured, fit) if row.observable}
    assert observable == {(kind, matrix) for kind in WIRES for matrix in ("stiffness", "mass")}
    for term in observable:
        assert residual_without_term(line.basis, measured, fit, term) > 2 * fit.residual
    measured = MeasuredModes(line.frequency[:4], np.full(4, 0.005), np.full(4, 1e-5), np.ones(4, dtype=np.int64))
    with pytest.raises(InputError, match="only 4 modes for a fit of 4 coefficients"):
        fit_damping_model(line.basis.select_modes(np.arange(4)), measured)


def test_wires_are_determined_together_where_each_alone_is_not(line: Line) -> None:
    """The least residual of b / (4 pi f) + a pi f against a constant over 0.9 to 6 Hz is 13 % with equal weights."""
    # The wires together keep an interior minimum: both terms are positive.
    ratio = np.full(line.ratio.size, 0.002)
    measured = MeasuredModes(line.frequency, ratio, 1e-4 * ratio, line.group)
    separate = fit_damping_model(line.basis, measured)
    rows = compute_observability(line.basis, measured, separate)
    assert not any(row.observable for row in rows if row.matrix == "stiffness")
    joined = line.basis.join_wires()
    common = fit_damping_model(joined, measured)
    assert set(common.values) == {("wires", "stiffness"), ("wires", "mass")}
    observable = {(row.kind, row.matrix) for row in compute_observability(joined, measured, common) if row.observable}
    assert observable == set(common.values)
    assert separate.residual < common.residual < 0.2
    # Both wires simulated with the same coefficients: their sum is fitted without error.
    common = {"stiffness": 7e-5, "mass": 0.03}
    wires = line.basis.ratios @ [common[matrix] if kind in WIRES else 0.0 for kind, matrix in line.basis.terms]
    ratio = line.basis.stated + wires
    fit = fit_damping_model(line.basis.join_wires(), MeasuredModes(line.frequency, ratio, 1e-4 * ratio, line.group))
    assert fit.values == pytest.approx({("wires", matrix): value for matrix, value in common.items()}, rel=1e-9)


def test_coefficients_are_those_of_the_modes_used(line: Line) -> None:
    """Outliers of all sizes, some of which stand out only after larger ones are removed, leave no trace."""
    # A fit of the used modes alone, with the weights of their groups, gives the same coefficients to rounding.
    for seed in range(5):
        random = np.random.default_rng(seed)
        measured = build_measured_modes(line, 0.003, random)
        measured.damping_ratio[random.choice(36, 8, replace=False)] *= 1 + 10 ** random.uniform(-2, -0.5, 8)
        fit = fit_damping_model(line.basis, measured)
        columns = line.basis.ratios[:, [line.basis.terms.index(term) for term in fit.values]]
        count = np.array([np.sum(fit.used & (measured.group == number)) for number in measured.group])[fit.used]
        std = np.hypot(measured.std, 0.01 * measured.damping_ratio)[fit.used]
        weight = 1 / (std * np.sqrt(count))
        scale = columns.max(axis=0)
        target = (measured.damping_ratio - line.basis.stated)[fit.used]
        anew = scipy.optimize.nnls(columns[fit.used] / scale * weight[:, None], target * weight)
        assert [c.value for c in fit.coefficients] == pytest.approx(anew[0] / scale, rel=1e-8, abs=1e-15)


def test_a_coefficient_fitted_as_zero_can_be_left_out(line: Line) -> None:
    """A negative coefficient is fitted as 0; groups of different uncertainty make the weights matter."""
    true = {("contact_wire", "stiffness"): 5e-5, ("contact_wire", "mass"): -0.01, ("messenger_wire", "mass"): 0.1}
    ratio = line.basis.ratios @ [true.get(term, 0.0) for term in line.basis.terms]
    random = np.random.default_rng(6)
    std = ratio * np.array([0.001, 0.05])[line.group % 2]
    measured = MeasuredModes(line.frequency, ratio + std * random.standard_normal(ratio.size), std, line.group)
    fit = fit_damping_model(line.basis, measured)
    assert fit.values["contact_wire", "mass"] == 0.0
    growth = {(row.kind, row.matrix): row.residual_without for row in compute_observability(line.basis, measured, fit)}
    assert growth["contact_wire", "mass"] == pytest.approx(1.0, rel=1e-9)
    assert growth["contact_wire", "stiffness"] > 1.0


def test_modal_bands_give_the_first_groups_their_medians(line: Line) -> None:
    measured = build_measured_modes(line, 0.0, np.random.default_rng(4))
    assert len(fit_modal_bands(measured)) == 2
    bands = fit_modal_bands(measured, 3)
    assert len(bands) == 3
    assert all(a.to_frequency <= b.from_frequency for a, b in pairwise(bands))
    changed = apply_modal_bands(measured.damping_ratio, measured.frequency, bands)
    assert changed[:6] == pytest.approx(np.median(measured.damping_ratio[:6]))
    assert np.array_equal(changed[18:], measured.damping_ratio[18:])


def test_pairs_by_frequency_and_shapes() -> None:
    """All computed frequencies are 2 % low and two neighbours have exchanged their order: the shapes decide."""
    random = np.random.default_rng(5)
    shapes = random.standard_normal((6, 4))
    measured = np.array([1.0, 1.1, 1.2, 1.21, 1.4, 1.5])
    computed = 0.98 * measured[[0, 1, 3, 2, 4, 5]]
    table = [shapes[[0, 1, 3, 2, 4, 5]]] * 6
    order = np.argsort(computed)
    pairs = pair_modes(
        measured, [row.astype(complex) * 2j for row in shapes], computed[order], [t[order] for t in table]
    )
    assert len(pairs) == 6
    for p in pairs:
        assert p.mac == pytest.approx(1.0)
    assert modal_assurance(np.array([1.0, 0.0]), np.array([[0.0, 1.0], [2.0, 0.0]])).tolist() == [0.0, 1.0]
    # One sensor has no shape to compare: its similarity is 1, on a node of the computed mode, too.
    (pair,) = pair_modes(np.array([1.0]), [np.array([1.0 + 0.0j])], np.array([1.0]), [np.array([[0.0]])])
    assert (pair.measured, pair.computed, pair.mac) == (0, 0, 1.0)


def test_paired_modes_keep_their_groups() -> None:
    facts = {"damping_ratio": 1e-3, "damping_ratio_std": 1e-5}
    usable: Any = [SimpleNamespace(frequency_Hz=float(group), group=group, **facts) for group in (1, 2, 3)]
    pairs: Any = [SimpleNamespace(measured=number) for number in (0, 2)]
    nothing: Any = None
    measured = MatchedModes(usable, nothing, nothing, pairs, nothing).measured
    assert (measured.group.tolist(), measured.frequency.tolist()) == ([1, 3], [1.0, 3.0])


@pytest.mark.parametrize(("mac", "paired"), [(0.1, False), (0.3, False), (0.49, False), (0.51, True), (0.9, True)])
def test_modes_of_different_shapes_are_no_pair(mac: float, paired: bool) -> None:
    """Two measured modes at the computed frequencies; shapes (1, t) and (1, 0) have the MAC 1 / (1 + t^2)."""
    frequency, shape = np.array([1.0, 1.3]), np.array([2j, 2j * np.sqrt(1 / mac - 1)])
    computed = np.array([[1.0, 0.0], [np.sqrt(1 / mac - 1), -1.0]])  # the second one is orthogonal to the first shape
    same = np.array([0.0, 1.0])
    pairs = pair_modes(frequency, [shape, same.astype(complex)], frequency, [computed, np.array([same[::-1], same])])
    assert [(pair.measured, pair.computed) for pair in pairs] == [(0, 0)] * paired + [(1, 1)]
    assert [pair.mac for pair in pairs] == pytest.approx([mac] * paired + [1.0])


@pytest.mark.parametrize(
    ("gap", "mac", "exchanged"),
    [(0.005, 0.92, True), (0.005, 0.95, False), (0.01, 0.7, True), (0.01, 0.8, False), (0.015, 0.52, False)],
)
def test_gap_of_one_percent_weighs_as_a_quarter_of_mac(gap: float, mac: float, exchanged: bool) -> None:
    """Two neighbours whose shapes fit better if they are exchanged: (gap / 1 %)^2 against 4 (1 - MAC)."""
    # Eight other modes, equal in frequency and shape, keep the common factor at 1.
    others = np.array([2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
    measured_shapes = [np.array([1.0 + 0j, 0.0]), np.array([np.sqrt(mac), np.sqrt(1 - mac)], dtype=complex)]
    measured_shapes += [np.array([1.0 + 0j, 1.0])] * others.size
    frequency = np.array([1.0, np.exp(gap), *others])
    computed = np.array([measured_shapes[1].real, measured_shapes[0].real, *[np.array([1.0, 1.0])] * others.size])
    pairs = pair_modes(frequency, measured_shapes, frequency, [computed] * frequency.size)
    found = {pair.measured: pair.computed for pair in pairs}
    assert (found[0], found[1]) == ((1, 0) if exchanged else (0, 1))

"""Local fit around a frequency, and the trial poles and contributions that it gives."""

from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.core.array_types import ComplexArray
from pantocheck.conformance.drops.decay_kernel import far_pole_columns
from pantocheck.conformance.drops.model_order import (
    crowded_poles,
    find_best_candidate,
    pole_contributions,
    restrict_fit,
)
from pantocheck.conformance.drops.projection import DataBlock, build_block, solve_residues

DT = 0.05


def build_data(poles: ComplexArray, duration: float, channels: int = 2, seed: int = 1) -> DataBlock:
    """Block of decays without noise."""
    random = np.random.default_rng(seed)
    residues = random.standard_normal((poles.size, channels)) + 1j * random.standard_normal((poles.size, channels))
    samples = 2 * (np.exp(np.outer(np.arange(round(duration / DT)) * DT, poles)) @ residues).real
    return build_block(np.asarray(samples), DT, 0.3, 6.0)


def test_neighbourhood_reaches_to_150_mHz_and_twelve_lines() -> None:
    """200 s: 0.15 Hz are 0.942 rad/s, more than twelve lines. 60 s: twelve lines are 0.2 Hz, 1.257 rad/s."""
    centre = 10.0
    poles = -0.05 + 1j * (centre + np.array([-1.27, -1.24, -0.95, -0.93, 0.0, 0.93, 0.95, 1.24, 1.27]))
    for durations, inside in (((200.0,), 3), ((60.0,), 7), ((200.0, 60.0), 7)):
        blocks = [build_data(poles, duration) for duration in durations]
        local = restrict_fit(poles, blocks, [solve_residues(poles, block) for block in blocks], centre)
        assert (local.near.sum(), local.poles.size, len(local.blocks)) == (inside, inside, len(blocks))
        wide = restrict_fit(poles, blocks, [solve_residues(poles, block) for block in blocks], centre, 1.26)
        assert wide.near.sum() == 7
    lines = local.blocks[1].omega - centre
    step = 2 * np.pi / 60.0
    assert np.abs(lines).max() == pytest.approx(18 * step, abs=step)


def test_local_lines_hold_the_near_decays_alone() -> None:
    """Lines minus the distant poles are those of a record with the near poles only; an exact fit, so rounding."""
    centre = 10.0
    poles = np.array([-0.05 + 5.0j, -0.04 + 9.9j, -0.03 + 10.2j, -0.06 + 15.0j])
    block = build_data(poles, 100.0)
    fit = solve_residues(poles, block)
    local = restrict_fit(poles, [block], [fit], centre)
    (data,) = local.blocks
    exact = solve_residues(local.poles, data)
    assert np.abs(exact.residual).max() < 1e-8 * np.abs(data.spectrum).max()
    assert exact.residues == pytest.approx(fit.residues[1:3], rel=1e-6)
    assert restrict_fit(poles, [block], [fit], 200.0).blocks == []


def test_best_candidate_lies_on_the_grid_of_a_quarter_line() -> None:
    """A missing pole at 5/4 lines beside the centre, with the decay rate of its neighbour."""
    duration, centre = 100.0, 10.0
    missing = -0.05 + 1j * (centre + 1.25 * 2 * np.pi / duration)
    poles = np.array([-0.05 + 9.6j, missing])
    short, long = build_data(poles, 60.0), build_data(poles, duration, seed=2)
    blocks = [short, long]
    local = restrict_fit(poles[:1], blocks, [solve_residues(poles[:1], block) for block in blocks], centre)
    candidate = find_best_candidate(local, centre)
    assert candidate[0] == pytest.approx(missing, rel=1e-12)
    assert candidate[1] > 0
    alone = restrict_fit(poles[:0], [long], [solve_residues(poles[:0], long)], centre)
    nothing = replace(alone, blocks=[replace(alone.blocks[0], spectrum=0 * alone.blocks[0].spectrum)])
    assert find_best_candidate(nothing, centre) is None


def test_crowded_poles_and_contributions() -> None:
    """The other poles fixed: the squared error of a fit without the pole; the complete fit has none."""
    poles = np.array([-0.05 + 5.0j, -0.04 + 9.9j, -0.03 + 10.2j])
    blocks = [build_data(poles, 100.0), build_data(poles, 60.0, 3, seed=2)]
    for j, contribution in enumerate(pole_contributions(poles, blocks)):
        others = np.delete(poles, j)
        without = sum(np.sum(np.abs(solve_residues(others, block).residual) ** 2) for block in blocks)
        assert contribution == pytest.approx(without, rel=1e-6)
    line = 2 * np.pi / 100.0
    poles = -0.05 + 1j * np.array([5.0, 5.0 + 1.4 * line, 8.0, 8.0 + 1.6 * line])
    blocks = [build_data(poles, duration) for duration in (40.0, 100.0)]
    assert list(crowded_poles(poles, blocks)) == [True, True, False, False]
    assert list(crowded_poles(poles[:1], blocks)) == [False]


def test_lines_must_determine_the_local_poles_and_one_more() -> None:
    """Nine lines at the edge of the band hold 18 equations; a pole takes two, the distant modes the others."""
    block = build_data(np.array([-0.02 + 2j * np.pi]), 60.0)
    lines, no_poles = 9, np.zeros(0, dtype=np.complex128)
    terms = far_pole_columns(block.omega[:lines], 2)
    edge = DataBlock(block.lines[:lines], block.spectrum[:lines], block.dt, block.n, terms)
    centre = float(edge.omega.mean())
    spare = 2 * lines - terms.shape[1]
    for count, expected in ((spare // 2 - 1, 1), (spare // 2, 0)):
        poles = -0.02 + 1j * (centre + 0.01 * np.arange(count))
        fit = replace(solve_residues(no_poles, edge), residues=np.zeros((count, 2), dtype=complex))
        assert len(restrict_fit(poles, [edge], [fit], centre).blocks) == expected

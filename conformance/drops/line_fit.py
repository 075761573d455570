"""Fit of one line: common poles of all its records, and residues of each record."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.decay_preparation import PreparedDecay
from pantocheck.conformance.drops.pole_refinement import refine_poles
from pantocheck.conformance.drops.projection import DataBlock, ProjectionFit, residue_spread, solve_residues, whiten

SAME_LENGTH = 0.02
"""Largest relative difference in length of repeats that are cut to the shortest one and put into one block [-]."""


@dataclass(frozen=True)
class FittedBlock:
    """Spectra of a block, their fit, noise of the channels, (c,), and standard deviation of the residues, (m,).

    The standard deviation of the residues is that for unit noise.
    """

    data: DataBlock
    fit: ProjectionFit
    noise: RealArray
    residue_std: RealArray


@dataclass(frozen=True)
class RecordFit:
    """Part of a fit for one record: its block, and its channels in the block."""

    decay: PreparedDecay
    block: FittedBlock
    columns: slice

    @property
    def residues(self) -> ComplexArray:
        """Residues at the first sample of the linear decay, (m, c) [unit of the record]."""
        return self.block.fit.residues[:, self.columns]

    @property
    def noise(self) -> RealArray:
        """Standard deviation of the real or imaginary part of a spectral line, (c,) [unit of the spectrum]."""
        return self.block.noise[self.columns]


@dataclass(frozen=True)
class LineFit:
    """Fit of all records of one line."""

    band: FrequencyBand
    """Band of the identification."""
    poles: ComplexArray
    """Poles, including those outside the band of the reported modes, (m,) [1/s]."""
    covariance: RealArray
    """Covariance of the decay rates [1/s] and angular frequencies [rad/s] of the poles, (2 m, 2 m)."""
    blocks: tuple[FittedBlock, ...]
    """Data of the fit."""
    records: tuple[RecordFit, ...]
    """Parts of the fit for the records, in the order of the input."""
    misfit: float
    """Squared residual over its expectation for noise [-]; 1 for a complete model."""


def share_blocks(decays: list[PreparedDecay]) -> tuple[list[tuple[RealArray, float]], list[tuple[int, slice]]]:
    """Put records of about equal length into one block, cut to the shortest.

    Returns:
        Samples and sampling interval [s] of each block, each (n, c).
        Block of each record, and its channels in the block.
    """
    blocks: list[tuple[RealArray, float]] = []
    places = []
    for decay in decays:
        samples, dt = decay.linear.samples, decay.linear.dt
        for b, (others, other_dt) in enumerate(blocks):
            shorter = min(samples.shape[0], others.shape[0])
            if dt == other_dt and shorter > (1 - SAME_LENGTH) * max(samples.shape[0], others.shape[0]):
                places.append((b, slice(others.shape[1], others.shape[1] + samples.shape[1])))
                blocks[b] = (np.hstack([others[:shorter], samples[:shorter]]), dt)
                break
        else:
            places.append((len(blocks), slice(0, samples.shape[1])))
            blocks.append((samples, dt))
    return blocks, places


def fit_line(
    decays: list[PreparedDecay],
    places: list[tuple[int, slice]],
    data: list[DataBlock],
    poles: ComplexArray,
    noise: list[RealArray],
    band: FrequencyBand,
) -> LineFit:
    """Refine the poles once more and solve for the residues of every record.

    Args:
        decays: The records.
        places: Block of each record, and its channels in the block.
        data: The blocks.
        poles: Selected poles, (m,) [1/s].
        noise: Noise of the channels of each block, each (c,) [unit of the spectrum].
        band: Band of the identification.
    """
    white = whiten(data, noise)
    refined = refine_poles(poles, white, iterations=10)
    poles = refined.poles
    blocks = tuple(
        FittedBlock(block, solve_residues(poles, block), sigma, residue_spread(poles, block))
        for block, sigma in zip(data, noise, strict=True)
    )
    records = tuple(RecordFit(decay, blocks[b], columns) for decay, (b, columns) in zip(decays, places, strict=True))
    unknowns = sum((2 * poles.size + block.residual_terms.shape[1]) * block.spectrum.shape[1] for block in white)
    rows = sum(2 * block.spectrum.size for block in white)
    misfit = float(refined.cost / max(rows - unknowns - 2 * poles.size, 1))
    return LineFit(band, poles, refined.covariance, blocks, records, misfit)

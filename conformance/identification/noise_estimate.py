"""Noise of the channels, estimated from the residual of a fit."""

from dataclasses import replace

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.projection import DataBlock, ProjectionFit


def estimate_noise(fit: ProjectionFit, poles: int, data: DataBlock) -> RealArray:
    """Standard deviation of the real or imaginary part of a spectral line, per channel, (c,).

    It follows from the median over the lines, which a few peaks outside the model do not move: |r|^2 / (2 sigma^2) of
    white noise has the median ln 2. It is corrected for the number of fitted parameters.

    Parameters
    ----------
    fit : ProjectionFit
        Fit of the block.
    poles : int
        Number of poles.
    data : DataBlock
        The block.
    """
    rows, channels = 2 * data.lines.size, data.spectrum.shape[1]
    fitted = 2 * poles + data.residual_terms.shape[1] + 2 * poles / channels
    share_left = max(1 - fitted / rows, 0.1)
    median = np.median(np.abs(fit.residual) ** 2, axis=0)
    return np.asarray(np.sqrt(np.maximum(median, np.finfo(float).tiny) / (2 * np.log(2) * share_left)))


def whiten(blocks: list[DataBlock], noise: list[RealArray]) -> list[DataBlock]:
    """Blocks with each channel in units of its noise."""
    return [replace(data, spectrum=data.spectrum / sigma) for data, sigma in zip(blocks, noise, strict=True)]

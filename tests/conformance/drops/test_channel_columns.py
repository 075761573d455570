"""Columns of channels with correlated noise against the expanded array, and factors of both kinds of columns."""

import numpy as np
import pytest

from pantocheck.conformance.drops.channel_columns import ChannelColumns
from pantocheck.conformance.drops.elimination import REFINEMENTS, StoredColumns, prepare_elimination

LINES, CHANNELS, OWN = 30, 3, 4


@pytest.fixture
def columns() -> ChannelColumns:
    """Four columns of three channels at 30 lines, with a triangular whitening."""
    random = np.random.default_rng(1)
    parts = random.standard_normal((2, LINES, CHANNELS, CHANNELS))
    whitening = np.tril(parts[0] + 1j * parts[1]) + 3 * np.eye(CHANNELS)
    return ChannelColumns(random.standard_normal((2 * LINES, OWN)), whitening)


def test_expanded_columns_are_those_of_one_channel_in_units_of_the_noise(columns: ChannelColumns) -> None:
    """Channel 1 alone with column 2: each line holds that column of the whitening times the value of the line."""
    number = 2 * CHANNELS + 1
    expanded = columns.expand()[:, number].reshape(2, LINES, CHANNELS)
    value = columns.columns[:LINES, 2] + 1j * columns.columns[LINES:, 2]
    assert expanded[0] + 1j * expanded[1] == pytest.approx(columns.whitening[:, :, 1] * value[:, None], abs=1e-14)


def test_products_are_those_of_the_expanded_columns(columns: ChannelColumns) -> None:
    """Sums of at most 180 products of order 10: rounding is below 1e-12."""
    expanded, random = columns.expand(), np.random.default_rng(2)
    signals = random.standard_normal((2 * LINES * CHANNELS, 5))
    coefficients = random.standard_normal((OWN * CHANNELS, 5))
    assert columns.multiply() == pytest.approx(expanded.T @ expanded, abs=1e-11)
    assert columns.correlate(signals) == pytest.approx(expanded.T @ signals, abs=1e-12)
    assert columns.combine(coefficients) == pytest.approx(expanded @ coefficients, abs=1e-12)


def test_covariance_of_fitted_values_is_that_of_the_basis(columns: ChannelColumns) -> None:
    """With the inverse of the Gram matrix, it is the projection on the columns: a sum over an orthonormal basis."""
    q = np.linalg.qr(columns.expand())[0].reshape(2, LINES, CHANNELS, -1)
    basis = q[0] + 1j * q[1]
    spread = columns.spread(prepare_elimination(columns).inverse)
    assert spread == pytest.approx(basis @ basis.conj().transpose(0, 2, 1), abs=1e-12)


@pytest.mark.parametrize("repeat", [0.0, 1 - 1e-7])
def test_elimination_is_that_of_singular_values(columns: ChannelColumns, repeat: float) -> None:
    """Both kinds of columns, independent ones and two that nearly repeat, which are left to Householder's method."""
    # The condition number is about 10, or 1e8; times rounding, it is the error of coefficients and inverse.
    stored = columns.columns.copy()
    stored[:, 3] = repeat * stored[:, 0] + (1 - repeat) * stored[:, 3]
    columns = ChannelColumns(stored, columns.whitening)
    x = np.random.default_rng(3).standard_normal((2 * LINES * CHANNELS, 2))
    left, singular, right = np.linalg.svd(columns.expand(), full_matrices=False)
    expected, inverse = right.T @ (left.T @ x / singular[:, None]), right.T / singular**2 @ right
    relative = 1e-14 * singular[0] / singular[-1]
    for arranged in (columns, StoredColumns(columns.expand())):
        elimination = prepare_elimination(arranged)
        coefficients, residual = elimination.solve(x, 1 + REFINEMENTS)
        assert coefficients == pytest.approx(expected, abs=relative * np.abs(expected).max())
        assert residual == pytest.approx(x - left @ (left.T @ x), abs=1e-12)
        assert elimination.inverse == pytest.approx(inverse, abs=relative * np.abs(inverse).max())
        assert elimination.log_determinant == pytest.approx(2 * np.sum(np.log(singular)), abs=10 * relative)

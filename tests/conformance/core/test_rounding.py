import numpy as np

from pantocheck.conformance.core.rounding import round_digits


def test_numbers_keep_their_first_digits() -> None:
    numbers = np.array([0.0, -1234.56, 0.00123456, 9.99996, 999999.5, 1e-300, np.inf])
    assert round_digits(numbers, 4) == [0.0, -1235.0, 0.001235, 10.0, 1e6, 1e-300, np.inf]
    assert round_digits(numbers, 6) == [0.0, -1234.56, 0.00123456, 9.99996, 1e6, 1e-300, np.inf]

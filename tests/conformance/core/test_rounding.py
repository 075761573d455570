import numpy as np

from pantocheck.conformance.core.rounding import round_digits


def test_numbers_keep_their_first_digits() -> None:
    numbers = np.array([0.0, -1234.56, 0.00123456, 9.99996, 999999.5, 1e-300, np.inf])
    assert round_digits(numbers, 4) == [0.0, -1235.0, 0.001235, 10.0, 1e6, 1e-300, np.inf]
    assert round_digits(numbers, 6) == [0.0, -1234.56, 0.00123456, 9.99996, 1e6, 1e-300, np.inf]


def test_rounded_numbers_are_the_floats_of_their_texts() -> None:
    """Also at ties, beside powers of ten and with a zero of either sign: equal to the last bit."""
    random = np.random.default_rng(1)
    spread = random.standard_normal(3000) * 10 ** random.uniform(-25, 25, 3000)
    ties = np.round(random.standard_normal(1000) * 100, 2) + 0.005
    powers = 10.0 ** np.arange(-30, 30)
    numbers = np.concatenate([spread, ties, powers, np.nextafter(powers, 0), [-0.0, 5e-324, 1.7e308]])
    for digits in (4, 6):
        expected = np.array([float(f"{number:.{digits}g}") for number in numbers.tolist()])
        assert np.array(round_digits(numbers, digits)).tobytes() == expected.tobytes()

"""Description of the search for the model order."""

import numpy as np

from pantocheck.conformance.drops.identification_analysis import describe_search
from pantocheck.conformance.drops.identify import PoleSearch
from pantocheck.conformance.drops.start_poles import BandTrials


def pole(frequency: float, ratio: float) -> complex:
    """Pole of a frequency [Hz] and a damping ratio [1/s]."""
    return 2 * np.pi * frequency * complex(-ratio, np.sqrt(1 - ratio**2))


def test_pole_is_stable_if_frequency_and_damping_stay() -> None:
    """Limits of 0.1 % and 10 %. At the first order no pole is stable."""
    orders = (
        [pole(1.0, 0.005)],
        [pole(1.0009, 0.0054), pole(1.2, 0.004)],  # both within the limits; new
        [],
        [pole(1.0, 0.005), pole(1.2, 0.004)],  # none at the order before
        [pole(1.0012, 0.005), pole(1.2, 0.0045)],  # frequency beyond its limit, damping beyond its limit
    )
    trials = (BandTrials(0.8, 1.4, tuple(np.array(poles, dtype=complex) for poles in orders), 2),)
    (band,) = describe_search(PoleSearch(trials)).bands
    assert (band.from_Hz, band.to_Hz, band.selected_order) == (0.8, 1.4, 2)
    assert band.order == (1, 2, 2, 4, 4, 5, 5)
    np.testing.assert_allclose(band.frequency_Hz, [1.0, 1.0009, 1.2, 1.0, 1.2, 1.0012, 1.2], rtol=1e-5)
    assert band.stable == (False, True, False, False, False, False, False)


def test_steps_keep_their_order_and_their_poles() -> None:
    first, second = np.array([pole(1.0, 0.005)]), np.array([pole(1.0, 0.005), pole(2.0, 0.01)])
    search = describe_search(PoleSearch((), (("start poles", first), ("refined", second))))
    assert [(step.name, len(step.frequency_Hz)) for step in search.steps] == [("start poles", 1), ("refined", 2)]
    np.testing.assert_allclose(search.steps[1].frequency_Hz, [1.0, 2.0])
    assert search.bands == ()

"""Warning about identified modes whose half-power bands overlap."""

from pantocheck.conformance.drops.mode_groups import warn_about_overlap
from pantocheck.conformance.results.identified_modes import Mode


def build_mode(frequency: float, **changes: bool) -> Mode:
    return Mode(frequency_Hz=frequency, damping_ratio=0.005, damping_ratio_std=1e-6, sensor_shape=(), **changes)


def test_pairs_are_counted_and_named() -> None:
    """Bandwidth 10 mHz at 1 Hz and 20 mHz at 2 Hz: three modes at 1 Hz make two pairs, those at 2 Hz one."""
    modes = [build_mode(f) for f in (0.95, 1.0, 1.006, 1.013, 1.5, 1.99, 2.005, 2.03)]
    (warning,) = warn_about_overlap(modes)
    assert warning.startswith("3 near-coincident pairs of modes with overlapping half-power bands: ")
    assert ": 1.000, 1.006, 1.013, 1.990, 2.005 Hz. " in warning
    assert warn_about_overlap(modes[:2]) == ()
    assert warn_about_overlap(modes[:3])[0].startswith("1 near-coincident pair of modes")


def test_uncertain_and_lateral_modes_do_not_count() -> None:
    near = build_mode(1.004)
    for other in (build_mode(1.0, certain=False), build_mode(1.0, lateral=True)):
        assert warn_about_overlap([other, near]) == ()
    assert warn_about_overlap([build_mode(1.0), near]) != ()
    assert warn_about_overlap([near]) == warn_about_overlap([]) == ()

r"""
Tolerance study
===============

No line is built exactly as it is drawn. This campaign gives the line of EN 50318:2002 random tensions and dropper
lengths, and asks two questions: how often is the standard deviation of the contact force above a bound, and which
tolerance causes it?
"""

# %%
# A campaign is a case with inputs that vary. Tensions are normally distributed with a standard deviation of 1 %; every
# dropper has its own random length. The sizes of the tolerances are assumed.

import tempfile

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import open_case, run_campaign

TENSION = {"kind": "truncated-normal", "mean": 0.0, "std": 0.01, "lower": -0.03, "upper": 0.03}
CAMPAIGN = {
    "title": "Tolerances of a line",
    "cases": ["en50318-2002/250"],
    "sampling": {
        "method": "latin-hypercube",
        "runs": 32,
        "seed": 1,
        "input": [
            {"key": "line.variation.contact_wire.tension_change_share", "distribution": TENSION},
            {"key": "line.variation.messenger_wire.tension_change_share", "distribution": TENSION},
            {
                "key": "line.variation.droppers.tolerance_m",
                "distribution": {"kind": "uniform", "lower": 0.001, "upper": 0.006},
            },
            {"key": "line.variation.droppers.seed", "distribution": {"kind": "seed"}},
        ],
    },
}
LABELS = ["tension of the contact wire", "tension of the messenger wire", "tolerance of the droppers"]

# %%
# The share of runs above a bound is the exceedance. The tornado chart shows the slopes of a linear model,
#
# .. math:: \sigma \approx \sigma_0 + \sum_i c_i \frac{x_i - \bar x_i}{s_i},
#
# where :math:`s_i` is the standard deviation of input :math:`x_i`, with 95 % intervals from the scatter of the runs.


def fit_slopes(inputs, values):
    """Slopes per standard deviation of each input, and half-widths of their 95 % intervals."""
    columns = np.column_stack([np.ones(len(values)), (inputs - inputs.mean(axis=0)) / inputs.std(axis=0)])
    slopes, *_ = np.linalg.lstsq(columns, values, rcond=None)
    variance = np.sum((values - columns @ slopes) ** 2) / (len(values) - columns.shape[1])
    return slopes[1:], 1.96 * np.sqrt(variance * np.linalg.inv(columns.T @ columns).diagonal())[1:]


def show(deviation_N, nominal_N, slopes, half_widths):
    """Exceedance and tornado chart."""
    _, (exceedance, tornado) = plt.subplots(2, 1, figsize=(7, 5.2), layout="constrained")
    share = 100 * (1 - np.arange(deviation_N.size) / deviation_N.size)
    exceedance.step(np.sort(deviation_N), share, where="pre")
    exceedance.axvline(nominal_N, color="C1", linestyle="--", label="line as drawn")
    exceedance.set(xlabel="standard deviation of the force, 0-20 Hz [N]", ylabel="share of the runs above [%]")
    exceedance.legend()
    tornado.barh(LABELS[::-1], slopes[::-1], xerr=half_widths[::-1], color="C0", capsize=4)
    tornado.axvline(0.0, color="0.2", linewidth=0.8)
    tornado.set_xlabel("change per standard deviation of the input [N]")


# %%
# Run the campaign: the workers are other processes, which import this file, hence the condition. The tension of the
# messenger wire has the largest slope. The size of the tolerance of the droppers has none that is distinguished from
# zero: the place of a long dropper decides, so that it scatters the runs.
#
# The check repeats the slopes of both tensions with two runs each, where nothing else varies. The tolerance is three
# standard errors, 1.5 times the half-width of the interval.

if __name__ == "__main__":
    table = run_campaign(CAMPAIGN, tempfile.mkdtemp())
    keys = [each["key"] for each in CAMPAIGN["sampling"]["input"][:3]]
    inputs = np.column_stack([table[key] for key in keys])
    deviation_N = np.array(table["1.std_force_N"])
    case = open_case("en50318-2002/250")
    slopes, half_widths = fit_slopes(inputs, deviation_N)
    show(deviation_N, case.simulate().quantity("std_force_N"), slopes, half_widths)

    assert deviation_N.size == 32
    for key, step, slope, half_width in zip(keys[:2], inputs.std(axis=0), slopes, half_widths, strict=False):
        low, high = (case.with_({key: sign * step}).simulate().quantity("std_force_N") for sign in (-1, 1))
        assert abs(slope - (high - low) / 2) < 1.5 * half_width

r"""
Pantograph response
===================

A pantograph is measured by exciting its head and recording force and motion. A chain of masses is then fitted to the
response. Recursion from the base gives the dynamic stiffness of the chain, force over displacement at the head:

.. math::

   D_i = -\omega^2 m_i + \frac{1}{1 / B_i + 1 / D_{i-1}}, \quad B_i = k_i + i \omega c_i, \quad 1 / D_0 = 0

This example fits a chain to a response with noise, whose true parameters are known.
"""

# %%
# The truth: a chain of three masses, base to head. The response is evaluated at 80 frequencies by the formula above.
# Noise of 0.5 % in the modulus and 0.3 degrees in the phase stands for the test rig.

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import fit_pantograph

TRUTH = {
    "masses_kg": [6.0, 9.0, 7.5],
    "stiffness_N_m": [160.0, 15500.0, 7000.0],
    "damping_N_s_m": [100.0, 10.0, 30.0],
}
frequency_Hz = np.geomspace(0.4, 40.0, 80)


def dynamic_stiffness(chain):
    """Dynamic stiffness of a chain at its head [N/m]."""
    omega, below = 2 * np.pi * frequency_Hz, np.inf
    for m, k, c in zip(*chain.values(), strict=True):
        below = 1 / (1 / (k + 1j * omega * c) + 1 / below) - omega**2 * m
    return below


rng = np.random.default_rng(1)
noise = 0.005 * rng.standard_normal(80) + 1j * np.radians(0.3) * rng.standard_normal(80)
measured = dynamic_stiffness(TRUTH) * np.exp(noise)

# %%
# A response record is a table and a sidecar, which states what was measured and how well: half-widths of the 95 %
# intervals, twice the noise.

folder = Path(tempfile.mkdtemp())
columns = (frequency_Hz, np.abs(measured), np.degrees(np.angle(measured)))
header = "frequency_Hz,modulus_N_m,phase_deg"
np.savetxt(folder / "rig.csv", np.column_stack(columns), delimiter=",", header=header, comments="")
(folder / "rig.toml").write_text("""
schema = "pantocheck.response/1"
file = "rig.csv"
kind = "dynamic_stiffness"
rows = 80
static_force_N = 70.0
modulus_uncertainty_pct = 1.0
phase_uncertainty_deg = 0.6
""")

# %%
# Fit chains of two, three and four masses; the information criterion chooses between them.

fit = fit_pantograph(folder / "rig.csv")
for candidate in fit.report.candidates:
    print(f"{candidate.masses} masses: RMS deviation {candidate.complex_deviation_pct:.2f} %")

# %%
# Above: apparent mass, force over acceleration. Below: each parameter over its true value. The damper of the second
# element hardly changes the response, so its interval is wide: the measurement does not determine it.

parameters = fit.report.parameters
truth = np.array([TRUTH[item.key][item.number - 1] for item in parameters])
value, half_width = np.array([[item.value, item.half_width] for item in parameters]).T

fig, (response, chart) = plt.subplots(2, 1, figsize=(7, 6.5), layout="constrained", height_ratios=(1, 1.2))
fit.plot(axes=response)
names = [f"{item.key.split('_')[0]} {item.number}" for item in parameters]
chart.errorbar(value / truth, names, xerr=half_width / truth, fmt="o", capsize=4, label="fitted, 95 % interval")
chart.axvline(1.0, color="C1", label="truth")
chart.set(xlabel="parameter / true parameter [-]")
chart.legend()

# %%
# Check: three masses are found. Of nine intervals of 95 %, three or more miss the truth in 0.8 % of all experiments.
# The mass of the head is found to 0.3 %, twice the half-width of its interval.

assert fit.report.masses == 3
assert np.sum(np.abs(value - truth) > half_width) <= 2
assert abs(fit.parameter("masses_kg", 3).value / TRUTH["masses_kg"][2] - 1) < 0.003

r"""
Damping fit
===========

Rayleigh damping gives each component of a line the damping matrix :math:`C = a M + b K`. A mode of the angular
frequency :math:`\omega` then has the damping ratio

.. math:: \zeta = \sum_e \left( a_e \frac{m_e}{2 \omega} + b_e \frac{k_e}{2 \omega} \right)

where :math:`m_e` and :math:`k_e` are the shares of component :math:`e` in the mass and stiffness of the mode. This
example fits :math:`a_e` and :math:`b_e` to identified modes, and compares them with the coefficients of the line.
"""

# %%
# The simulated records have known coefficients: those that Vo Van et al. (2015) use as an example. Two drops on four
# spans, and four sensors with noise, as in :ref:`sphx_glr_gallery_drop_and_identification.py`.

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import identify_line, open_case

case = open_case("vovan2015/mass-drop/printed").with_(
    {
        "line.geometry.spans": 4,
        "mass_drop.record_s": 60.0,
        "mass_drop.drop": [
            {"mass_kg": 40.0, "wire": "contact_wire", "x_m": 94.5},
            {"mass_kg": 30.0, "wire": "messenger_wire", "x_m": 148.5},
        ],
        "mass_drop.sensor": [
            {"wire": "contact_wire", "x_m": 94.5},
            {"wire": "contact_wire", "x_m": 40.5},
            {"wire": "messenger_wire", "x_m": 171.0},
            {"wire": "messenger_wire", "x_m": 219.75},
        ],
    }
)
line = identify_line(case.simulate_drop(1), case.simulate_drop(2), highest_Hz=4.0)

# %%
# Fit the model to the modes. The line of the fit must be that of the record: spans, tensions and sensors are compared.
# The fit states for each coefficient whether the modes determine it.

fit = line.fit_damping(case, element_m=0.75)
rows = fit.results.coefficients
for row in rows:
    print(f"{row.kind} {row.matrix}: {row.value:.3g} ({row.low_95:.3g} to {row.high_95:.3g}) {row.reason}")

# %%
# The block below replaces the table ``[damping]`` of the line file. It leaves out what the modes do not determine.

print(fit.toml)

# %%
# Above: damping ratios of the modes. Mass damping dominates at low frequencies, stiffness damping at high ones. Below:
# each coefficient over its true value. The messenger wire is seen less well than the contact wire, so its intervals
# are wider.

truth = case.inputs["line"]["damping"]
KEYS = {"mass": "mass_coefficient_1_s", "stiffness": "stiffness_coefficient_s"}
scaled = np.array([[row.value, row.low_95, row.high_95] for row in rows])
scaled /= np.array([truth[row.kind][KEYS[row.matrix]] for row in rows])[:, None]

fig, (ratios, coefficients) = plt.subplots(2, 1, figsize=(7, 5.5), layout="constrained")
fit.plot(axes=ratios)
ratios.set(ylim=(0, None))
names = [f"{row.kind.replace('_', ' ')}, {row.matrix}" for row in rows]
errors = np.abs(scaled[:, 1:].T - scaled[:, 0])
coefficients.errorbar(scaled[:, 0], names, xerr=errors, fmt="o", capsize=4, label="fitted, 95 % interval")
coefficients.axvline(1.0, color="C1", label="truth")
coefficients.set(xlabel="coefficient / true coefficient [-]", ylim=(-0.6, 3.6))
coefficients.legend()

# %%
# Check: every true coefficient lies in its 95 % interval, and no interval is wider than 12 %, so that the coverage says
# something. The frequencies and shapes of the modes are those of the same line, which a real fit knows less well.

assert len(rows) == 4
assert np.all((scaled[:, 1] <= 1) & (scaled[:, 2] >= 1))
assert errors.max() < 0.12

r"""
Drop and identification
=======================

A mass hangs on the contact wire and is released. The line then vibrates freely, and every mode decays with its own
damping ratio :math:`\zeta`:

.. math:: u(t) = \sum_k A_k \, e^{-\zeta_k \omega_k t} \cos\left(\sqrt{1 - \zeta_k^2} \, \omega_k t + \varphi_k\right)

The identification finds all :math:`\omega_k` and :math:`\zeta_k` of the records together. In this example, the line
has a known damping ratio, so that the result can be compared with the truth.
"""

# %%
# The line has four spans of 63 m. Two modal bands give its modes their damping ratios: 0.5 % below 1.3 Hz, 0.3 % above.
# A weight of 40 kg drops from the contact wire, another one of 30 kg from the messenger wire. Four accelerometers with
# a noise of 3 mm/s² measure the decay.

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import identify_line, open_case

EDGE_HZ, LOW, HIGH = 1.3, 0.005, 0.003
case = open_case("vovan2015/mass-drop/printed").with_(
    {
        "line.geometry.spans": 4,
        "damping": {
            "contact_wire": {"stiffness_coefficient_s": 1e-4},
            "messenger_wire": {"stiffness_coefficient_s": 1e-4},
            "modal": [
                {"from_Hz": 0.0, "to_Hz": EDGE_HZ, "damping_ratio": LOW},
                {"from_Hz": EDGE_HZ, "to_Hz": 5.0, "damping_ratio": HIGH},
            ],
        },
        "mass_drop.record_s": 80.0,
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
drops = [case.simulate_drop(number) for number in (1, 2)]

# %%
# Identify all modes up to 4 Hz from both records. A measured record is used in the same way: give its path in place of
# the simulated drop.

line = identify_line(*drops, highest_Hz=4.0)
modes = line.to_dataframe()
frequency, ratio = np.array(modes["frequency_Hz"]), np.array(modes["damping_ratio"])
half_width = 1.96 * np.array(modes["damping_ratio_std"])

# %%
# The signal decays while the modes beat: four spans have four modes in each group. The identified ratios lie on the
# two values of the line. Their intervals are smaller than the symbols.

fig, (decay, damping) = plt.subplots(2, 1, figsize=(7, 5.5), layout="constrained")
drops[0].plot(axes=decay)
decay.set(title="", ylim=(-6, 6), ylabel="acceleration [m/s²]", xlabel="time [s]")
damping.step([0.5, EDGE_HZ, 4.0], [100 * LOW, 100 * LOW, 100 * HIGH], color="C1", label="truth")
damping.errorbar(frequency, 100 * ratio, yerr=100 * half_width, fmt="o", color="C0", label="identified")
damping.set(xlabel="frequency [Hz]", ylabel="damping ratio [%]", ylim=(0.0, 0.6))
damping.legend()

# %%
# Check: four spans have four modes in each of the four groups. The damping ratios are the given ones. The tolerance of
# 0.5 % covers the numerical damping of the simulation and the decay between the drop and the first used sample.

assert frequency.size == 16
truth = np.where(frequency < EDGE_HZ, LOW, HIGH)
assert np.abs(ratio / truth - 1).max() < 0.005

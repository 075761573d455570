r"""
Irregular contact wire
======================

The running surface of a contact wire is never flat: wear, kinks and the rolls of the factory leave heights of some
tenths of a millimetre. A wave of the length :math:`\lambda` excites the pantograph with the frequency
:math:`v/\lambda`. Waves of two to four metres lie in the band from 20 to 50 Hz, where a measurement with a filter of 20
Hz sees nothing of them.
"""

# %%
# Give the wire heights with a power spectral density: it falls with the square of the spatial frequency, between waves
# of 10 m and of 1.7 m. The standard deviation of the heights is 0.3 mm. The line is AC simple of EN 50318:2018, at 275
# km/h.

import matplotlib.pyplot as plt
import numpy as np
from scipy.signal import welch

from pantocheck.conformance import open_case
from pantocheck.model import build_chain

case = open_case("en50318-2018/ac-simple/275")
heights = {"frequency_1_m": [0.1, 0.6], "density_m3": [1e-6, 1e-6 / 36], "seed": 1}
wavy = case.with_({"line.contact_wire.irregularity": heights})
smooth_run, wavy_run = case.simulate(), wavy.simulate()
smooth_N, wavy_N = (np.array(run.signals()["force_N"]) for run in (smooth_run, wavy_run))

# %%
# A closed form for the force per height follows from three flexibilities in series: the head, the spring of the
# contact, and the wire. A force at the circular frequency :math:`\omega` on an infinite string meets the impedance
# :math:`2\sqrt{T m}`, and this does not change when the force moves. So
#
# .. math:: \left|\frac{F}{h}\right| = \frac{1}{\left|\alpha_\mathrm{head} + 1/k + 1/(2 i \omega \sqrt{T m})\right|}
#
# .. math:: G_F(f) = \left|\frac{F}{h}\right|^2 \frac{S(f/v)}{v}
#
# with the density :math:`S` of the heights over the spatial frequency and :math:`G_F` of the force over the frequency.

inputs = case.inputs
wire, pantograph = inputs["line"]["contact_wire"], inputs["pantographs"][0]
contact_N_m, speed = pantograph["contact"]["stiffness_N_m"], inputs["case"]["speed_km_h"] / 3.6
parts = [np.array(pantograph["chain"][key]) for key in ("masses_kg", "stiffness_N_m", "damping_N_s_m")]
head = build_chain(*parts, uplift_force=0.0, uplift_on=0, contact_stiffness=contact_N_m)


def force_density(frequency):
    """Power spectral density of the force by the closed form [N2/Hz]."""
    w = 2 * np.pi * frequency
    dynamic = head.stiffness + 1j * w * head.damping - w**2 * head.mass
    receptance = head.head @ np.linalg.solve(dynamic, head.head.astype(complex))
    flexibility = receptance + 1 / contact_N_m + 1 / (2j * w * np.sqrt(wire["tension_N"] * wire["mass_kg_m"]))
    return 1e-8 * (speed / frequency) ** 2 / speed / abs(flexibility) ** 2


# %%
# The density of the force that the heights add, beside that on the smooth wire. The lines of the smooth wire are the
# harmonics of the span passing frequency :math:`v/L = 1.4` Hz and of the droppers. The heights fill the band between.

frequency_Hz, added = welch(wavy_N - smooth_N, 1000.0, nperseg=2048)
_, smooth = welch(smooth_N, 1000.0, nperseg=2048)
band = np.linspace(0.1 * speed, 0.6 * speed, 200)
closed = np.array([force_density(f) for f in band])
fig, ax = plt.subplots(figsize=(8, 3.8), layout="constrained")
ax.semilogy(frequency_Hz, smooth, color="0.7", label="smooth wire")
ax.semilogy(frequency_Hz, added, color="C1", linewidth=1.5, label="added by the heights")
ax.semilogy(band, closed, "--", color="C2", linewidth=2, label="added by the heights, closed form")
ax.axvspan(20, 50, color="0.95", zorder=0)
ax.set(xlabel="frequency [Hz]", ylabel="density of the force [N²/Hz]", xlim=(0, 50), ylim=(1e-2, 1e3))
ax.legend(loc="upper right")

# %%
# The standard deviation in the band from 20 to 50 Hz rises, that of the filtered force hardly.
#
# Check: the standard deviation of the added force, against the integral of the closed form. The wire of the closed form
# has no droppers. They reflect two fifths of every wave, which comes back to the head and adds to the force. This
# effect and the random phases of one realisation are worth about a fifth; the tolerance is a quarter.

for name in ("std_force_N", "rms_20_50_N"):
    print(f"{name}: {smooth_run.quantity(name):.1f} (smooth wire), {wavy_run.quantity(name):.1f} (wavy wire)")
computed_N, expected_N = (np.sqrt(np.trapezoid(g, f)) for f, g in ((frequency_Hz[:110], added[:110]), (band, closed)))
print(f"added force: computed {computed_N:.1f} N, closed form {expected_N:.1f} N")
assert abs(computed_N / expected_N - 1) < 0.25
assert wavy_run.quantity("rms_20_50_N") > 1.2 * smooth_run.quantity("rms_20_50_N")

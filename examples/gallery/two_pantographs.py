r"""
Two pantographs
===============

The leading pantograph of a train leaves the line in vibration. The rear one meets this vibration, and the spacing of
the pantographs decides in which phase. The line is AC simple of EN 50318:2018; the train runs at 320 km/h.
"""

# %%
# Simulate the train with six spacings. The uplift force of each pantograph is tuned, so that both have the mean contact
# force of the case, 169 N. All differences are therefore dynamic.

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import open_case

case = open_case("en50318-2018/ac-simple/320-twin")
spacings_m = np.arange(120, 221, 20)
runs = [case.with_(spacing_m=[float(spacing)]).simulate() for spacing in spacings_m]
deviation_N = np.array([[run.quantity("std_force_N", pantograph) for pantograph in (1, 2)] for run in runs])

# %%
# Behind the leading pantograph, a span vibrates in its first mode. Its frequency is a little below that of both wires
# as one string between two supports,
#
# .. math:: f = \frac{1}{2L}\sqrt{\frac{T_\mathrm{contact} + T_\mathrm{messenger}}{m_\mathrm{contact} +
#           m_\mathrm{messenger} + m_\mathrm{droppers}}}
#
# The rear pantograph arrives after the time :math:`s/v`. If that is a whole number of periods, the wire rises just then
# and pushes the head away, then falls and follows it: the force varies most. Half a period later it varies least. The
# distance from a bad spacing to the next good one is therefore :math:`v/2f`.

span_m, droppers_kg = 55.0, 9 * (0.195 + 0.165 + 0.1)  # both clamps and the wire of each dropper
mass_kg_m = 1.35 + 1.08 + droppers_kg / span_m
frequency_Hz = np.sqrt((22e3 + 16e3) / mass_kg_m) / (2 * span_m)
half_wave_m = 320 / 3.6 / (2 * frequency_Hz)
print(f"first mode of a span: {frequency_Hz:.2f} Hz; from a bad to a good spacing: {half_wave_m:.0f} m")

worst, best = int(np.argmax(deviation_N[:, 1])), int(np.argmin(deviation_N[2:, 1])) + 2
fig, (above, below) = plt.subplots(2, figsize=(7.5, 6), layout="constrained", height_ratios=(2, 3))
above.plot(spacings_m, deviation_N[:, 0], "o-", color="C2", label="leading pantograph")
above.plot(spacings_m, deviation_N[:, 1], "s--", color="C1", label="rear pantograph")
above.set(xlabel="spacing of the pantographs [m]", ylabel="standard deviation [N]", ylim=0)
above.legend()
for place, colour in ((worst, "C1"), (best, "0.2")):
    signals = runs[place].signals(2)
    label = f"rear pantograph, spacing {spacings_m[place]} m"
    below.plot(signals["position_m"], signals["force_20_N"], color=colour, label=label)
below.set(
    xlabel="position along the track [m]", ylabel="contact force, 0-20 Hz [N]", xlim=(1650, 1870), ylim=(-40, 500)
)
below.axhline(0, color="0.6", linewidth=0.8)
below.legend(loc="upper right", ncols=2)

# %%
# At the worst spacing the rear pantograph loses contact, although it has the mean force of the leading one. The leading
# pantograph hardly notices the rear one: only waves that run faster than the train reach it.
#
# Check: the distance from the worst to the best spacing, and the leading pantograph. The tolerances are half a step of
# the spacings, 10 m, and a tenth of the standard deviation, the usual effect of waves from behind.

print(f"from {spacings_m[worst]} m, the worst spacing, to {spacings_m[best]} m: expected {half_wave_m:.0f} m")
assert abs(spacings_m[best] - spacings_m[worst] - half_wave_m) < 10
assert np.ptp(deviation_N[:, 0]) < 0.1 * deviation_N[:, 0].mean()
assert deviation_N[worst, 1] > 1.5 * deviation_N[worst, 0]

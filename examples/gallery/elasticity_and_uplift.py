r"""
Elasticity and uplift
=====================

The uplift of the contact wire at a support is limited by the room above it. At low speed the uplift is a matter of
statics: elasticity times force. At high speed the train comes near the speed of its own waves, and the uplift grows.
"""

# %%
# The elasticity is the static uplift of the contact wire over the force that lifts it. The lines are AC simple of
# EN 50318:2018. The simplest model of a span is one string with the tension of both wires, fixed at the supports. Under
# a force at :math:`x` it is lifted by
#
# .. math:: e(x) = \frac{x\,(L - x)}{L\,(T_\mathrm{contact} + T_\mathrm{messenger})}

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import open_case
from pantocheck.model import wave_speed

line = open_case("en50318-2018/ac-simple/static").line
start_m, end_m = line.span_limits[24:26]
x_m = np.linspace(0, end_m - start_m, 111)
string_mm_N = 1e3 * x_m * (x_m[-1] - x_m) / (x_m[-1] * (22e3 + 16e3))
fig, ax = plt.subplots(figsize=(8, 3.6), layout="constrained")
for force_N, colour, style in ((1.0, "0.25", "-"), (150.0, "C2", "--"), (300.0, "C1", "-.")):
    elasticity = line.elasticity(start_m + x_m, force_N)
    ax.plot(x_m, elasticity, style, color=colour, label=f"force of {force_N:g} N")
ax.plot(x_m, string_mm_N, ":", color="0.5", label="one string with both tensions")
ax.set(xlabel="position in the span [m]", ylabel="elasticity [mm/N]", ylim=0)
ax.legend(loc="lower center")

# %%
# The contact wire also bends from dropper to dropper, and gives way at the supports, where the string does not. A
# dropper in the middle of the span carries about 50 N. Under a larger force it becomes slack: the contact wire is
# softer then, and the dips at the droppers vanish.
#
# Now drive a pantograph at several speeds, on the line of EN 50318:2002. A force that moves on a string lifts it by the
# static uplift times :math:`1/(1 - v^2/c^2)`. The line has supports and droppers, so this is a trend and no more.

reference = open_case("en50318-2002/250").with_({"line.geometry.spans": 16}, evaluated_spans=[7, 12])
speeds_km_h = np.array([60, 100, 140, 180, 220, 260, 300])
runs = [reference.with_(speed_km_h=float(speed)).simulate() for speed in speeds_km_h]
uplift_mm = np.array([run.quantity("max_uplift_at_support_mm", 0) for run in runs])
static_mm = float(reference.line.elasticity(reference.line.span_limits[9], 120.0)[0]) * 120.0
v, c = np.linspace(0, 300, 200), 3.6 * wave_speed(20e3, 1.35)
fig, ax = plt.subplots(figsize=(8, 3.6), layout="constrained")
ax.plot(speeds_km_h, uplift_mm, "o", color="C1", label="simulated")
ax.plot(v, static_mm / (1 - (v / c) ** 2), "--", color="C2", label="static uplift, moving on a string")
ax.axhline(static_mm, color="0.5", linestyle=":", label="static uplift under 120 N")
ax.set(xlabel="speed [km/h]", ylabel="largest uplift at a support [mm]", xlim=(0, 310), ylim=(0, 80))
ax.legend(loc="upper left")

# %%
# Check: the elasticity in the middle of the span lies above that of the string, and near the range
# :math:`L/3.5\,T` to :math:`L/4\,T` that handbooks give for simple lines; its edges are widened by 5 %. The uplift at
# 60 km/h is the static one, within the variation of the force at this speed, a tenth of its mean.

middle_mm_N = float(line.elasticity((start_m + end_m) / 2)[0])
rule_mm_N = [1e3 * 55 / (divisor * (22e3 + 16e3)) for divisor in (4.0, 3.5)]
print(f"middle of the span: {middle_mm_N:.3f} mm/N; rule: {rule_mm_N[0]:.3f} to {rule_mm_N[1]:.3f} mm/N")
print(f"uplift at 60 km/h: {uplift_mm[0]:.1f} mm, static {static_mm:.1f} mm; at 300 km/h: {uplift_mm[-1]:.1f} mm")
assert 0.95 * rule_mm_N[0] < middle_mm_N < 1.05 * rule_mm_N[1]
assert abs(uplift_mm[0] / static_mm - 1) < 0.1
assert uplift_mm[-1] > 1.7 * static_mm

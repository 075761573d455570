r"""
Own line
========

A line of one's own, from two short files to its contact force. The files hold the data that a design office has:
spans, tensions, masses and the positions of the droppers. Then one input changes, and the force shows the effect.
"""

# %%
# **Write the line and the train.** Keys end with their unit. The pantograph is one of the library; a path to an own
# file may stand in its place. ``pantocheck new line my-line.toml`` writes a longer file with comments.

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import open_case

LINE = """
title = "Own line: spans of 60 m"
geometry = { span_m = 60.0, spans = 22, encumbrance_m = 1.4 }
contact_wire = { tension_N = 20e3, mass_kg_m = 1.07, bending_stiffness_N_m2 = 130.0 }
messenger_wire = { tension_N = 15e3, mass_kg_m = 0.85, bending_stiffness_N_m2 = 100.0 }
messenger_support = { stiffness_N_m = 5e5 }
steady_arm = { vertical_stiffness_N_m = 150.0, mass_kg_m = 0.8, length_m = 1.2, static_share = "level" }

[droppers]
x_m = [5.0, 15.0, 25.0, 35.0, 45.0, 55.0]
stiffness_N_m = 1e5
mass_kg_m = 0.1

[damping]
contact_wire = { mass_coefficient_1_s = 0.0125, stiffness_coefficient_s = 1e-4 }
messenger_wire = { mass_coefficient_1_s = 0.0125, stiffness_coefficient_s = 1e-4 }
"""
CASE = """
id = "own/first"
title = "Own line, 250 km/h"
line = "line.toml"
speed_km_h = 250.0
evaluated_spans = [13, 18]
pantograph = [{ model = "en50318-2018/pantograph.toml", uplift_force_N = 130.0 }]
"""
folder = Path(tempfile.mkdtemp())
(folder / "line.toml").write_text(LINE, "utf-8")
(folder / "case.toml").write_text(CASE, "utf-8")
case = open_case(folder / "case.toml")

# %%
# **Look at the line at rest.** The droppers hold the contact wire level, so that the messenger wire carries both wires.
# Its sag in a span of length :math:`L` is that of a string with the weight :math:`q` per length of both wires,
#
# .. math:: f = \frac{q L^2}{8\,T_\mathrm{m}}

fig, ax = plt.subplots(figsize=(8, 3), layout="constrained")
case.line.plot(14, 16, axes=ax)
ax.set(title="Wires at rest, heights enlarged")

# %%
# **Simulate, then change the line.** A change gives a new case; the first one stays as it is. With the higher tension,
# waves run faster along the contact wire: :math:`c = \sqrt{T/m}`. The train then runs at a smaller share of the wave
# speed, and the force varies less.

fig, ax = plt.subplots(figsize=(8, 3.4), layout="constrained")
deviation_N = {}
for tension_kN, colour in ((20, "C1"), (26, "C2")):
    run = case.with_({"line.contact_wire.tension_N": 1e3 * tension_kN}).simulate()
    signals = run.signals()
    deviation_N[tension_kN] = run.quantity("std_force_N")
    share = case.inputs["case"]["speed_km_h"] / 3.6 / np.sqrt(1e3 * tension_kN / 1.07)
    label = f"{tension_kN} kN: speed is {share:.2f} of the wave speed, σ = {deviation_N[tension_kN]:.0f} N"
    ax.plot(signals["position_m"], signals["force_20_N"], color=colour, label=label)
for support in case.line.span_limits[12:19]:
    ax.axvline(support, color="0.85", zorder=0)
ax.set(xlabel="position along the track [m] (lines: supports)", ylabel="contact force, 0-20 Hz [N]", xlim=(720, 1080))
fig.legend(loc="outside upper center", ncols=2, frameon=False)

# %%
# **Check.** The sag of the computed messenger wire against the formula. The formula spreads the weight evenly. The six
# droppers carry it as point loads, and 5 m of contact wire at each support hang on the arms; this is worth 3 %.

shape = case.line.shape()
messenger = np.array(shape["wire"]) == "messenger wire"
height = np.interp([900.0, 930.0], np.array(shape["position_m"])[messenger], np.array(shape["height_m"])[messenger])
sag_m = (1.07 + 0.85) * 9.81 * 60**2 / (8 * 15e3)
print(f"sag: computed {height[0] - height[1]:.3f} m, formula {sag_m:.3f} m")
assert abs((height[0] - height[1]) / sag_m - 1) < 0.03
assert deviation_N[26] < 0.9 * deviation_N[20]

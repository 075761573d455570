r"""
Speed sweep
===========

Standard deviation of the contact force of two pantographs over the speed of the train. The line is AC simple of
EN 50318:2018. The static force is tuned at every speed, so that the mean force stays at the 169 N of the case.
"""

# %%
# Open the case, and simulate it at each speed.

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import open_case

case = open_case("en50318-2018/ac-simple/320-twin")
speeds_km_h = np.arange(240, 341, 20)
deviation_N = np.array(
    [
        [run.quantity("std_force_N", pantograph) for pantograph in (1, 2)]
        for run in (case.with_(speed_km_h=float(speed)).simulate() for speed in speeds_km_h)
    ]
)

# %%
# The force of the leading pantograph varies more at a higher speed. The rear pantograph meets the waves of the leading
# one, so its force has a maximum: at that speed the waves of both pantographs add up.

fig, ax = plt.subplots(figsize=(7, 3.5), layout="constrained")
ax.plot(speeds_km_h, deviation_N[:, 0], "o-", label="leading pantograph")
ax.plot(speeds_km_h, deviation_N[:, 1], "s--", label="rear pantograph")
ax.set(xlabel="speed [km/h]", ylabel="standard deviation of the force, 0-20 Hz [N]")
ax.legend()

# %%
# Check: the maximum of the rear pantograph. The tolerance is the uncertainty of the mesh, below 1 % of the value.

worst = int(np.argmax(deviation_N[:, 1]))
assert speeds_km_h[worst] == 280
assert abs(deviation_N[worst, 1] - 63.5) < 0.6

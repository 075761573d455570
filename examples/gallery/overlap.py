r"""
Overlap of two tension sections
===============================

A contact wire is about 1.2 km long. Where it ends, it rises to its anchor, and the wire of the next section comes down.
Over a few spans both wires lie side by side, and the pantograph changes from one to the other. The line is that of
EN 50318:2002, with two sections; the train runs at 300 km/h.
"""

# %%
# Divide the line into sections with overlaps of one and of three spans. Both lines have 23 spans, and so has a third
# line of one section.

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.conformance import open_case
from pantocheck.model import wave_speed

SPAN = 60.0
plain = open_case("en50318-2002/300").with_({"line.geometry.spans": 23}, evaluated_spans=[3, 20])


def divide(overlap_spans):
    """Line of two sections with an overlap that begins in the same span."""
    sections = [{"spans": 10 + overlap_spans}, {"spans": 13}]
    overlap = {"spans": overlap_spans, "anchor_rise_m": 0.5}
    return plain.with_({"line.section": sections, "line.overlap": overlap})


cases = {"one section": plain, "overlap of 1 span": divide(1), "overlap of 3 spans": divide(3)}
signals = {name: case.simulate().signals() for name, case in cases.items()}

# %%
# The upper figure shows the wires at rest around the overlap of three spans. In its middle both contact wires have the
# same height. A short overlap needs a steep rise: the wire then pushes the head down at once, and the force has a peak.

fig, (line, force) = plt.subplots(2, figsize=(8, 6), layout="constrained", height_ratios=(2, 3), sharex=True)
cases["overlap of 3 spans"].line.plot(9, 15, axes=line)
line.set(title="Wires at rest, overlap of 3 spans", xlabel="")
for (name, run), colour, style in zip(signals.items(), ("0.6", "C1", "C2"), ("-", "-", "--"), strict=True):
    force.plot(run["position_m"], run["force_20_N"], style, color=colour, label=name)
force.set(xlabel="position along the track [m]", ylabel="contact force, 0-20 Hz [N]", xlim=(8 * SPAN, 15 * SPAN))
force.legend(ncols=3, loc="upper left")

# %%
# Long before the overlap the force knows nothing of it. The start of the run sends a wave ahead of the train. It runs
# to the anchor of the first wire at the distance :math:`d`, is reflected there, and meets the head at
#
# .. math:: x = x_0 + \frac{2 d\,v}{c + v}, \qquad c = \sqrt{T/m}
#
# Up to this place the force is that on one section. Behind it, waves that the two ends reflect have different phases.
#
# Check: the first place where the force differs by 1 N. The tolerance is a tenth of a span: the front of the wave
# passes many droppers, which smooth it.

speed, wave, start_m = 300 / 3.6, wave_speed(20e3, 1.35), SPAN
position_m, whole_N = (np.array(signals["one section"][key]) for key in ("position_m", "force_N"))
for name, anchor_m in (("overlap of 1 span", 11 * SPAN), ("overlap of 3 spans", 13 * SPAN)):
    difference_N = abs(np.array(signals[name]["force_N"]) - whole_N)
    found_m = position_m[np.argmax(difference_N > 1.0)]
    expected_m = start_m + 2 * (anchor_m - start_m) * speed / (wave + speed)
    print(f"{name}: the force changes from {found_m:.0f} m on, expected {expected_m:.0f} m")
    assert difference_N[position_m < expected_m - 0.1 * SPAN].max() < 1.0
    assert abs(found_m - expected_m) < 0.1 * SPAN

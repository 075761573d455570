r"""
Waves and the Doppler effect
============================

A pantograph sends waves along the contact wire in both directions. Waves ahead of the train are compressed, waves
behind it are stretched, as is the sound of a moving source. This example uses ``pantocheck.model`` alone, with the
simplest line there is: one tensioned wire.
"""

# %%
# The wire is 800 m long and level. Constant forces, here steady arms without stiffness, carry its weight at every
# metre, so that nothing reflects a wave but the two ends. The running surface is wavy: the head feels a wave of 8 m at
# 40 m/s, a frequency of 5 Hz.

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.model import (
    Catenary,
    Irregularity,
    Kind,
    Passage,
    SteadyArm,
    Wire,
    build_chain,
    discretise,
    doppler_factor,
    simulate_passage,
    wave_speed,
)

LENGTH, TENSION, MASS, SPEED, WAVE, AMPLITUDE = 800.0, 15e3, 1.35, 40.0, 8.0, 6e-3
x = np.arange(0.0, LENGTH + 0.25, 0.5)
surface = Irregularity(tuple(x), tuple(AMPLITUDE * np.sin(2 * np.pi * x / WAVE)))
wire = Wire("wire", Kind.CONTACT_WIRE, 0.0, LENGTH, TENSION, MASS, 150.0, irregularity=surface)
weights = tuple(
    SteadyArm(float(place), "wire", vertical_stiffness=0.0, carries_share=True) for place in np.arange(1.0, LENGTH)
)
line = discretise(Catenary((wire,), steady_arms=weights), element_length=0.5)

# %%
# Drive one pantograph from 300 m on, and watch the motion of the wire between 100 and 600 m.

head = build_chain(
    np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.array([90.0, 10.0]), 60.0, uplift_on=0, contact_stiffness=50e3
)
places = np.arange(100.0, 601.0, 2.5)
passage = Passage((head,), (300.0,), SPEED, 3.0, 1e-3, watched=tuple(("wire", float(place)) for place in places))
history = simulate_passage(line, passage)

# %%
# The figure shows the velocity of the wire over place and time. All waves run with :math:`c = \sqrt{T/m}`, the dashed
# lines; the train is the solid line. With the frequency :math:`f_0 = v/\lambda` at the head, a point ahead of the train
# and a point behind it vibrate with
#
# .. math:: f_\mathrm{ahead} = \frac{f_0}{1 - v/c}, \quad f_\mathrm{behind} = \frac{f_0}{1 + v/c}

c = wave_speed(TENSION, MASS)
velocity = history.motion[:, :, 1]
fig, ax = plt.subplots(figsize=(8, 4.2), layout="constrained")
image = ax.pcolormesh(places, history.time, velocity.T, cmap="viridis", vmin=-0.18, vmax=0.09, rasterized=True)
fig.colorbar(image, label="velocity of the wire [m/s]")
ax.plot(history.position[0], history.time, "w-", linewidth=1.8, label="train, 40 m/s")
for sign in (-1, 1):
    label = f"wave, {c:.0f} m/s" if sign > 0 else None
    ax.plot(300 + sign * c * history.time, history.time, "w--", linewidth=1.2, label=label)
ax.set(xlabel="position along the track [m]", ylabel="time [s]", xlim=(places[0], places[-1]), ylim=(0, 3.0))
ax.legend(loc="lower left", facecolor="0.4", labelcolor="white")

# %%
# Check: the highest line in the spectrum of the velocity at 430 m, ahead of the train, and at 230 m, behind it. In 1.5
# s a line can be placed to about a tenth of its width of 1/1.5 s, or 2 % of the lower frequency. The bending stiffness
# adds less than 1 %. The tolerance is 3 %. The ratio of both frequencies is the Doppler factor.


def frequency_at(place, start, end):
    """Frequency of the highest line in the spectrum between two instants [Hz]."""
    inside = (history.time >= start) & (history.time < end)
    signal = velocity[np.searchsorted(places, place), inside]
    spectrum = abs(np.fft.rfft((signal - signal.mean()) * np.hanning(signal.size), 2**16))
    return float(np.fft.rfftfreq(2**16, passage.time_step)[np.argmax(spectrum)])


ahead = frequency_at(430.0, 1.5, 3.0)
behind = frequency_at(230.0, 1.5, 3.0)
print(f"ahead {ahead:.2f} Hz, behind {behind:.2f} Hz, at the head {SPEED / WAVE:.2f} Hz")
print(f"ratio {behind / ahead:.3f}, Doppler factor {doppler_factor(SPEED, c):.3f}")
assert abs(ahead * (1 - SPEED / c) * WAVE / SPEED - 1) < 0.03
assert abs(behind * (1 + SPEED / c) * WAVE / SPEED - 1) < 0.03
assert abs(behind / ahead / doppler_factor(SPEED, c) - 1) < 0.03

r"""
Catenary in Python
==================

``pantocheck.model`` describes a line with Python objects and simulates it, without files, cases or verdicts. This
example builds a line of ten spans, looks at its modes, and drives a pantograph along it. All values are in SI units.
"""

# %%
# **Build the line.** A ``Catenary`` is a collection of wires and of the parts that join them. Droppers state the height
# of the contact wire at their place; their lengths follow. Supports hold the messenger wire, arms the contact wire.

import matplotlib.pyplot as plt
import numpy as np

from pantocheck.model import (
    Catenary,
    Dropper,
    Kind,
    MessengerSupport,
    Passage,
    Rayleigh,
    SteadyArm,
    Wire,
    build_chain,
    compute_modes,
    damping_ratios,
    discretise,
    rest_height,
    simulate_passage,
)

SPAN, SPANS, SAG = 50.0, 10, 0.03
LENGTH = SPANS * SPAN
contact = Wire("contact", Kind.CONTACT_WIRE, 0.0, LENGTH, tension=20e3, mass_per_length=1.07, bending_stiffness=130.0)
messenger = Wire("messenger", Kind.MESSENGER_WIRE, 0.0, LENGTH, 16e3, 0.85, 100.0, end_heights=(1.3, 1.3))
droppers = tuple(
    Dropper(
        start + x, "messenger", "contact", stiffness=1e5, contact_wire_height=-4 * SAG * (x / SPAN) * (1 - x / SPAN)
    )
    for start in np.arange(SPANS) * SPAN
    for x in (5.0, 13.0, 21.0, 29.0, 37.0, 45.0)
)
masts = np.arange(1, SPANS) * SPAN
damping = dict.fromkeys((Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE), Rayleigh(0.02, 1e-4))
catenary = Catenary(
    wires=(contact, messenger),
    droppers=droppers,
    steady_arms=tuple(SteadyArm(float(x), "contact", vertical_stiffness=100.0, mass=0.8) for x in masts),
    messenger_supports=tuple(MessengerSupport(float(x), "messenger", height=1.3, stiffness=5e5) for x in masts),
    damping=damping,
)
line = discretise(catenary, element_length=0.5)

# %%
# **Modes.** In the highest mode with one half-wave per span, neighbouring spans move in opposite directions. The
# supports are at rest, and both wires together vibrate like one string:
#
# .. math:: f = \frac{1}{2L}\sqrt{\frac{T_\mathrm{c} + T_\mathrm{m}}{m_\mathrm{c} + m_\mathrm{m}}}
#
# Rayleigh damping with the coefficients :math:`\alpha` and :math:`\beta` gives every mode the damping ratio
# :math:`\zeta = (\alpha/\omega + \beta\,\omega)/2`: the slow motion of the spans and the fast ripple are damped more
# than the modes between.

modes = compute_modes(line, SPANS)
string_Hz = np.sqrt((20e3 + 16e3) / (1.07 + 0.85)) / (2 * SPAN)
print("modes:", np.round(modes.frequency, 3), f"Hz; string: {string_Hz:.3f} Hz")
print("damping ratios:", np.round(100 * damping_ratios(line, modes), 2), "%")

# %%
# **Passage.** One pantograph, 60 m/s, and the motion of the contact wire watched at 61 places.

pantograph = build_chain(
    masses=np.array([6.0, 9.0, 7.5]),
    stiffness=np.array([160.0, 15500.0, 7000.0]),
    damping=np.array([100.0, 0.1, 45.0]),
    uplift_force=120.0,
    uplift_on=0,
    contact_stiffness=50e3,
)
places = np.linspace(150.0, 300.0, 61)
watched = tuple(("contact", float(x)) for x in places)
history = simulate_passage(line, Passage((pantograph,), (50.0,), 60.0, 6.0, 1e-3, watched))

# %%
# The figure shows the uplift of the contact wire while the pantograph passes. The wave ahead of the train, the largest
# uplift behind the head, and the vibration of the spans afterwards follow each other.

uplift_mm = 1e3 * history.motion[:, :, 0]
fig, (shape, waves) = plt.subplots(2, figsize=(8, 6), layout="constrained", height_ratios=(1, 2), sharex=True)
x = line.mesh.position
for wire, colour in (("messenger", "C2"), ("contact", "0.1")):
    shape.plot(x, line.state.deflection[line.mesh.row_of[wire, "z"], :, 0], color=colour, label=f"{wire} wire")
for dropper, length in zip(droppers, line.state.dropper_length, strict=True):
    foot = rest_height(line, np.array([dropper.position]))[0]
    shape.plot([dropper.position] * 2, [foot, foot + length], color="0.6", linewidth=0.8)
shape.set(ylabel="height at rest [m]")
shape.legend(loc="center right")
image = waves.pcolormesh(places, history.time, uplift_mm.T, cmap="cividis", rasterized=True)
fig.colorbar(image, label="uplift of the contact wire [mm]", ax=waves)
waves.plot(history.position[0], history.time, "w--", linewidth=1.2)
waves.annotate("train", (160, 1.5), color="white")
waves.set(xlabel="position along the track [m]", ylabel="time [s]", xlim=(places[0], places[-1]), ylim=(1, 6))

# %%
# Check: the highest of the ten modes against the formula. Droppers join the wires at six places per span, not
# everywhere; 1 % is ample. And the droppers in the middle of a span: on a parabola of the sag :math:`f` the tension of
# the contact wire carries a part of its weight, so that a dropper in the distance :math:`d` of its neighbours has the
# force
#
# .. math:: F = \left(m g - \frac{8 f\,T}{L^2}\right) d
#
# Bending at the droppers takes part in it; the tolerance is 2 %.

dropper_N = (1.07 * 9.81 - 8 * SAG * 20e3 / SPAN**2) * 8.0
middle_N = line.state.dropper_tension[6 * 4 + 2]  # the third dropper of the fifth span
print(f"dropper in the middle: {middle_N:.1f} N, formula {dropper_N:.1f} N")
assert abs(modes.frequency[-1] / string_Hz - 1) < 0.01
assert abs(middle_N / dropper_N - 1) < 0.02

"""Single-arm pantograph as planar multibody system, as FMU: lower arm, upper arm, coupling rod and head.

              E  apex; the head stands on springs above it
             /
            /  upper arm
           /
      B   o                    a: angle of the lower arm
     /   . .                   b: angle of the upper arm, by the coupling rod D-C
    C     .  .  lower arm
     \\       .  .
  rod \\        .  .
       D         A  base

Build it:  pythonfmu3 build -f multibody_pantograph.py --handle-state --no-external-tool
Check it:  pantocheck pantograph check MultibodyPantograph.fmu --uplift-force-N 120

The unknowns are the angle of the lower arm and the height of the head; the rest follows from geometry. A step is the
midpoint rule, whose mean rates are iterated.
"""

from math import acos, atan2, cos, hypot, sin, tanh

from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability, Unit

LOWER_M, UPPER_M, LEVER_M, ROD_M = 1.55, 1.75, 0.38, 1.10
"""Lengths AB, BE, BC and CD [m]."""
ROD_BASE_M = (-0.85, -0.15)
"""Place of D from A [m]."""
LOWER_KG, UPPER_KG, APEX_KG = 22.0, 10.0, 2.0
"""Masses of both arms, uniform rods, and at the apex [kg]."""
HEAD_KG, HEAD_N_M, HEAD_N_S_M = 7.2, 4200.0, 10.0
"""Mass, springs and dampers of the head [kg, N/m, N s/m]."""
FREE_M = 0.15
"""Height of the head above the apex without a force [m]."""


def arms(a):
    """Angle of the upper arm, its slope db/da, and the height of the apex with its slope, by the angle a."""
    x, y = -LOWER_M * cos(a) - ROD_BASE_M[0], LOWER_M * sin(a) - ROD_BASE_M[1]
    distance = hypot(x, y)
    b = atan2(y, x) - acos((distance**2 + LEVER_M**2 - ROD_M**2) / (2 * LEVER_M * distance))
    rod = x - LEVER_M * cos(b), y - LEVER_M * sin(b)
    slope = LOWER_M * (rod[0] * sin(a) + rod[1] * cos(a)) / (LEVER_M * (rod[1] * cos(b) - rod[0] * sin(b)))
    return b, slope, LOWER_M * sin(a) + UPPER_M * sin(b), LOWER_M * cos(a) + UPPER_M * cos(b) * slope


def inertia(a):
    """Inertia of both arms and the apex by the rate of the angle a [kg m2]."""
    b, slope, *_ = arms(a)

    def square(along):
        """Square of the speed of a point of the upper arm, over that of the rate."""
        return (LOWER_M * sin(a) - along * sin(b) * slope) ** 2 + (LOWER_M * cos(a) + along * cos(b) * slope) ** 2

    turning = LOWER_KG * LOWER_M**2 / 3 + UPPER_KG * UPPER_M**2 / 12 * slope**2
    return turning + UPPER_KG * square(UPPER_M / 2) + APEX_KG * square(UPPER_M)


class MultibodyPantograph(Fmi3Slave):
    """Pantograph whose lift force acts on the apex, whatever its height."""

    def __init__(self, **arguments):
        super().__init__(**arguments)
        self.register_units([Unit("N", kg=1, m=1, s=-2), Unit("m", m=1)])
        self.contact_force, self.uplift_force = 0.0, 120.0
        self.damper, self.friction = 630.0, 0.0
        self.angle, self.rate, self.speed = 0.55, 0.0, 0.0
        self.head = arms(self.angle)[2] + FREE_M
        self.time = 0.0
        self.add("time", Fmi3Causality.independent)
        self.add("contact_force", Fmi3Causality.input, "N")
        self.add("uplift_force", Fmi3Causality.input, "N")
        self.add("head", Fmi3Causality.output, "m")
        for name in ("damper", "friction"):  # of the lower arm [N m s, N m]
            self.add(name, Fmi3Causality.parameter)
        for name in ("angle", "rate", "speed"):  # with the head, all that a step changes
            self.add(name, Fmi3Causality.local)

    def add(self, name, causality, unit=None):
        fixed = causality == Fmi3Causality.parameter
        variability = Fmi3Variability.tunable if fixed else Fmi3Variability.continuous
        self.register_variable(Float64(name, causality=causality, variability=variability, unit=unit))

    def accelerations(self, angle, height, rate, speed):
        """Second derivatives of both unknowns."""
        _, _, apex, slope = arms(angle)
        spring = HEAD_N_M * (apex + FREE_M - height) + HEAD_N_S_M * (slope * rate - speed)
        change = (inertia(angle + 1e-5) - inertia(angle - 1e-5)) / 2e-5
        moment = slope * (self.uplift_force - spring) - change * rate**2 / 2
        moment -= self.damper * rate + self.friction * tanh(rate / 1e-3)
        return moment / inertia(angle), (spring - self.contact_force) / HEAD_KG

    def do_step(self, current_time, step_size):
        """One step by the implicit midpoint rule; the rates at its middle follow by fixed-point iteration."""
        h, rate, speed = step_size, self.rate, self.speed
        for _ in range(30):
            a, z = self.accelerations(self.angle + h / 2 * rate, self.head + h / 2 * speed, rate, speed)
            before, (rate, speed) = (rate, speed), (self.rate + h / 2 * a, self.speed + h / 2 * z)
            if abs(rate - before[0]) + abs(speed - before[1]) < 1e-13:
                break
        self.angle += h * rate
        self.head += h * speed
        self.rate, self.speed = 2 * rate - self.rate, 2 * speed - self.speed
        return True

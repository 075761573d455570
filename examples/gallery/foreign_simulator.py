r"""
Foreign simulator
=================

Any program can be graded that answers the messages of the command protocol. This example grades the string catenary
of ``examples/string_catenary``: finite differences and an explicit time step, without a line of the reference
simulator. Its adapter has 60 lines.
"""

# %%
# The program runs the case as system ``command:PROGRAM``. It receives the inputs of the case, never the limits.

import sys
from pathlib import Path

import matplotlib.pyplot as plt

from pantocheck.conformance import compare_runs, open_case

EXAMPLES = Path(sys.argv[0]).resolve().parents[1]
ADAPTER = EXAMPLES / "string_catenary" / "adapter.py"
SYSTEM = f'command:"{sys.executable}" "{ADAPTER}"'
case = open_case("en50318-2002/250")
reference = case.simulate()
foreign = case.run(SYSTEM)

# %%
# Compare both forces at the same positions. They agree well below 5 Hz, where the span passing rules, and less in each
# higher band.

compared = compare_runs(reference, foreign)
agreement = compared.agreement()
for band in agreement.bands:
    print(
        f"{band.low_Hz:g}-{band.high_Hz:g} Hz: reference {band.first_N:.2f} N, string catenary {band.other_N:.2f} N, "
        f"difference {band.difference_N:.2f} N"
    )

fig, (force, spectrum) = plt.subplots(2, 1, figsize=(7, 5.5), layout="constrained")
compared.plot(axes=force)
for run, color, style in ((reference, "C0", "-"), (foreign, "C1", "--")):
    (curve,) = run.plot_spectrum(axes=spectrum).lines[-1:]
    curve.set(color=color, linestyle=style)
spectrum.set(yscale="log", ylim=(0.05, 30), title="")

# %%
# The verdict has two parts: the limits of EN 50318:2002, and the comparison with the converged solution up to 50 Hz.
# The program fails both. The comparison above shows where to look: its band from 5 to 20 Hz is too weak, so that the
# statistical minimum is too high.

graded = case.grade(SYSTEM)
(result,) = graded.results.cases
for row in result.criteria:
    print(f"{row.verdict}: {row.quantity} {row.value:.4g}, limits {row.lower} and {row.upper}")
print(f"EN 50318 criteria: {result.verdict}; verification: {result.verification.verdict}")

# %%
# Check: the statistical minimum, mean minus three standard deviations, is above its upper limit of 40 N. The program is
# deterministic, so the tolerance is the rounding of the printed value.

assert result.verdict == "fail"
assert abs(foreign.quantity("statistical_min_N") - 40.8) < 0.05
assert agreement.bands[0].difference_N < 0.05 * agreement.bands[0].first_N

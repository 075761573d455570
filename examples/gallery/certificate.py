r"""
Certificate
===========

A case is graded, its report is written, and the report is verified as its reader would: the results inside are graded
again, the pages are made again, and the case is compared with the library. Then one number is changed.
"""

# %%
# Grade the 250 km/h case of EN 50318:2002 on the reference simulator, and write the report.

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

from pantocheck.conformance import grade_cases, verify_report

graded = grade_cases("en50318-2002/250")
folder = Path(tempfile.mkdtemp())
for path in graded.write(folder, ("html", "json")):
    print(path.name)

# %%
# Each criterion has a value, its limits and a margin: 1 in the middle of the limits, 0 on a limit, negative outside.
# The uncertainty of a value is drawn on the same scale as its limits.

(case,) = graded.results.cases
rows = [row for row in case.criteria if row.lower is not None and row.upper is not None and row.upper > row.lower]
uncertainty = case.uncertainty["1"] | case.uncertainty["0"]

fig, ax = plt.subplots(figsize=(7, 4.2), layout="constrained")
for place, row in enumerate(reversed(rows)):
    width = row.upper - row.lower
    ax.barh(place, 1.0, color="0.9", edgecolor="0.5")
    share = (row.value - row.lower) / width
    ax.errorbar(share, place, xerr=(uncertainty[row.quantity] or 0) / width, fmt="o", color="C0", capsize=4)
names = [f"{row.quantity}\n{row.value:.4g} in {row.lower:g} to {row.upper:g}" for row in reversed(rows)]
ax.set_yticks(range(len(rows)), names)
ax.set(xlabel="value between its lower (0) and upper (1) limit [-]", title=f"verdict: {graded.verdict}")
ax.set_xticks([0.0, 0.5, 1.0])

# %%
# Verify the page. A consistent report need not be genuine: ``rerun=True`` runs the simulator again, and a signature
# shows who made the report.

report = verify_report(folder / "certificate.html")
print(report.state)
for check in report.checks:
    print(f"{check.outcome}: {check.statement}")

# %%
# Change the standard deviation by 1 N in the results, as somebody would who wants a larger margin.

results = folder / "results.json"
value = next(row.value for row in rows if row.quantity == "std_force_N")
text = results.read_text()
assert repr(value) in text
changed = folder / "changed.json"
changed.write_text(text.replace(repr(value), repr(value + 1.0)))
forged = verify_report(changed)
for line in forged.contradictions:
    print(line)

# %%
# Check: the genuine report is consistent. In the changed one, the value contradicts its margin and the bands, whose
# squares add up to the variance; a forger would have to change all of them alike. No tolerance: it is a count.

assert (report.state, forged.state) == ("consistent", "contradicted")
assert len(report.contradictions) == 0
assert len(forged.contradictions) >= 5

// The uplift of the contact wire at the supports of a case.

/** Stretch of time that shows the largest uplift [s]. */
const UPLIFT_STRETCH_S = 2;

/** Levels of the limits of the largest uplift. */
function upliftLimits(shownCase, count) {
  const limits = shownCase.criteria
    .filter((criterion) => criterion.quantity === "max_uplift_at_support_mm" && criterion.baseline === null)
    .flatMap(({ lower, upper }) => [[translate("lower limit"), lower], [translate("upper limit"), upper]])
    .filter(([, value]) => value !== null);
  return [...new Map(limits.map(([label, value]) => [`${label} ${formatNumber(value)} mm`, value]))].map(([label, value]) =>
    level(label, value, count, { colour: "ink", dash: [6, 3] }),
  );
}

/** View of the uplift of a figure. */
function viewUplift(figure) {
  const shownCase = caseOf(figure);
  const supports = shownCase.uplift.filter((support) => support.time_s.length);
  const [x, ...uplift] = uPlot.join(supports.map((support) => [support.time_s, support.uplift_mm]));
  const curves = supports.map((support, number) => ({
    ...{ label: fill(translate("support at {n} m"), { n: formatNumber(support.support_m, 6) }), values: uplift[number], ...curveStyle(number) },
  }));
  const view = new CurvesView(
    {
      ...{ label: translate("Uplift at the supports"), xLabel: translate("time [s]"), xUnit: "s", yLabel: translate("uplift [mm]"), yUnit: "mm", height: 260 },
      ...{ x, curves: [...curves, ...upliftLimits(shownCase, x.length)] },
    },
    {
      name: fileName(shownCase, "uplift"),
      headings: ["support_m", "time_s", "uplift_mm"],
      makeRows: () =>
        supports.flatMap((support) => support.time_s.map((time, i) => [support.support_m, time, support.uplift_mm[i]])),
    },
  );
  view.showPlace = (place, text, name) => view.plot.showPlace(place.time_s, UPLIFT_STRETCH_S, text, name);
  return view;
}

// The force of one pantograph in a simulated run and in the measured one.

/** View of both forces of a figure and of their difference. */
function viewMeasured(figure) {
  const shownCase = caseOf(figure);
  const { position_m: x, simulated_N, measured_N, spans } = shownCase.comparison.pantographs[figure.dataset.owner];
  const difference = simulated_N.map((force, i) => force - measured_N[i]);
  const name = fill(translate("pantograph {n}"), { n: figure.dataset.owner });
  const curves = [
    { label: translate("simulated"), values: simulated_N, colour: "ink" },
    { label: translate("measured"), values: measured_N, colour: "curve-3", dash: [7, 3] },
    { label: translate("simulated − measured"), values: difference, colour: "curve-2", width: 1 },
  ];
  return new CurvesView(
    {
      ...{ label: fill(translate("Simulated and measured force of {t}"), { t: name }), xLabel: translate("position along the track [m]"), xUnit: "m" },
      ...{ yLabel: translate("contact force [N]"), yUnit: "N", height: 300, x, curves },
      lines: [...new Set(spans.flatMap(({ start_m, end_m }) => [start_m, end_m]))],
    },
    {
      name: fileName(shownCase, name, "measured"),
      headings: ["position_m", "simulated_N", "measured_N"],
      makeRows: () => x.map((place, i) => [place, simulated_N[i], measured_N[i]]),
    },
  );
}

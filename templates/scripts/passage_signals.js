// Signals of a moving line over its time: force with limits, its 20–50 Hz part, uplift, sensors.

/** Time of a passage when its first pantograph is where that of another one is at its own time. */
function alignTime(passage, other, time) {
  const place = other.pantographs[0].start_m + other.speed_m_s * (time - other.start_s);
  return passage.start_s + (place - passage.pantographs[0].start_m) / passage.speed_m_s;
}

/** Curves of the panels of signals: `key`, `unit` and `curves` with times, values, colour, width, and `levels`. */
function listSignals(shownCase, passage, others) {
  const frameTimes = Array.from({ length: passage.frames }, (_, i) => passage.start_s + i * passage.step_s);
  const force = { key: "force", label: translate("force [N]"), curves: [], levels: [] };
  const band = { key: "band", label: "20–50 Hz [N]", curves: [], levels: [] };
  passage.pantographs.forEach((part, i) => {
    const trace = shownCase.traces[i + 1];
    const { colour: name } = curveStyle(i);
    const timeAt = (place) => passage.start_s + (place - part.start_m) / passage.speed_m_s;
    if (trace) force.curves.push({ x: trace.position_m.map(timeAt), y: trace.force_N, colour: "faint", width: 0.7 });
    force.curves.push({ x: frameTimes, y: part.force.values, colour: name, width: 1.6 });
    force.levels.push(...forceLevels(shownCase, i + 1, name));
    if (!part.band) return;
    const times = Array.from(part.band.values, (_, n) => part.band_start_s + n * part.band_step_s);
    band.curves.push({ x: times, y: part.band.values, colour: name, width: 1.2 });
  });
  others.forEach((other, number) =>
    other.pantographs.forEach((part, i) => {
      const style = { colour: `curve-${number + 2}`, dash: DASHES[i + 1] };
      const times = (start, step, count) => Array.from({ length: count }, (_, n) => alignTime(passage, other, start + n * step));
      force.curves.push({ x: times(other.start_s, other.step_s, part.force.frames), y: part.force.values, width: 1.6, ...style });
      if (part.band) band.curves.push({ x: times(part.band_start_s, part.band_step_s, part.band.frames), y: part.band.values, width: 1.2, ...style });
    }),
  );
  const supports = shownCase.uplift.filter((support) => support.time_s.length);
  const uplift = { key: "uplift", label: translate("uplift [mm]"), levels: [], curves: [] };
  supports.forEach((support, i) => uplift.curves.push({ x: support.time_s, y: support.uplift_mm, width: 1.3, ...curveStyle(i), peak: `${formatNumber(support.support_m, 6)} m` }));
  if (supports.length) uplift.levels = upliftLimits(shownCase, 1).map(({ values }) => ({ lower: values[0], upper: values[0], text: "", colour: "ink" }));
  const sensor = { key: "sensor", label: shownCase.label, levels: [], curves: [] };
  listSensors(passage).forEach(({ wire, x_m: place, text }, i) => {
    const values = frameTimes.map((_, frame) => 1000 * riseAt(wire, frame, place));
    sensor.curves.push({ x: frameTimes, y: values, width: 1.3, ...curveStyle(i), peak: text });
  });
  return [force, band, uplift, sensor].filter(({ curves }) => curves.length);
}

/** Sensors on the wires of a moving line. */
function listSensors(passage) {
  return passage.points.filter(({ symbol, wire }) => symbol === "sensor" && wire);
}

/** Limits of mean and extremes of the force of a pantograph: a band between two limits, or a line. */
function forceLevels(shownCase, owner, name) {
  const names = { mean_force_N: translate("mean"), max_force_N: translate("maximum"), min_force_N: translate("minimum") };
  return shownCase.criteria
    .filter((row) => row.pantograph === owner && row.quantity in names && row.baseline === null)
    .map(({ lower, upper, quantity }) => ({ lower: lower ?? upper, upper: upper ?? lower, text: names[quantity], colour: name }))
    .filter(({ lower }) => lower !== null);
}

/** Range of values, rounded outwards. */
function findRange(values) {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const step = niceStep((high - low || 1) / 4);
  return [Math.floor(low / step) * step, Math.ceil(high / step) * step || step];
}

/** Give signals of the same kind common axes in all scenes. */
function shareRanges(scenes) {
  const signals = scenes.flatMap((scene) => scene.signals);
  for (const signal of signals) signal.range = findRange(signals.filter(({ key }) => key === signal.key).flatMap(({ ends }) => ends));
}

/** A step of 1, 2 or 5 times a power of ten that is not below a length. */
function niceStep(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= length * (1 - 1e-9));
}

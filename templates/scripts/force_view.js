// The force of one pantograph: curves over the track, spectrum of the visible stretch, spans over each other.

/** Series of a constant level. */
function level(label, value, count, style) {
  return { label, values: Array(count).fill(value), width: 1, ...style };
}

/** Forces of the front and the rear strip; none of a head with one strip. */
function stripForces(trace) {
  return trace.strip_forces_N ?? [];
}

/** Curves of a force: that of the reference behind it, as delivered, filtered, and its levels. */
function forceCurves(trace, reference, referenceLabel = translate("reference, 0–20 Hz")) {
  const count = trace.position_m.length;
  const curves = reference.length ? [{ label: referenceLabel, values: reference, colour: "curve-2", width: 2 }] : [];
  curves.push({ label: translate("unfiltered"), values: trace.force_N, colour: "faint", width: 1 });
  const names = [translate("front strip"), translate("rear strip")];
  stripForces(trace).forEach((values, i) => curves.push({ label: names[i], values, colour: `curve-${3 * (i + 1)}`, width: 1 }));
  if (trace.force_20_N) curves.push({ label: "0–20 Hz", values: trace.force_20_N, colour: "ink", width: 2 });
  if (trace.std_N !== null) {
    curves.push(level(translate("mean"), trace.mean_N, count, { colour: "ink", dash: [9, 3, 2, 3] }));
    curves.push(level(translate("mean + 3 σ"), trace.mean_N + 3 * trace.std_N, count, { colour: "ink", dash: [6, 3] }));
    curves.push(level(translate("mean − 3 σ"), trace.mean_N - 3 * trace.std_N, count, { colour: "ink", dash: [3, 3] }));
  }
  return curves;
}

/** Time between two points of a trace [s]; null if the points are uneven or the speed is not known. */
function traceStep(shownCase, trace) {
  const step = trace.position_m.length > 1 ? evenStep(trace.position_m) : null;
  const speed = shownCase.run.speed_km_h;
  return step && speed ? step / (speed / 3.6) : null;
}

/** Sentence on the resolution of a trace in the page. */
function describeResolution(shownCase, trace) {
  const step = traceStep(shownCase, trace);
  const count = trace.position_m.length;
  if (step === null) {
    return fill(translate("The curves have {n} points: of each few neighbouring samples, the lowest and the highest."), { n: count });
  }
  const rate = shownCase.run.rate_Hz;
  const nth = rate ? Math.max(1, Math.round(step * rate)) : 1;
  const facts = { n: count, n2: formatNumber(1e3 * step, 3), n3: nth, n4: formatNumber(0.5 / step) };
  if (nth === 1) return fill(translate("The curves have {n} points: every {n2} ms."), facts);
  const thinned = translate("The curves have {n} points: one of {n3} samples of the record, every {n2} ms.");
  const mirrored = translate("In the spectrum of the curves, parts of the force above {n4} Hz appear mirrored.");
  return fill(`${thinned} ${mirrored}`, facts);
}

/** View of the force of a figure. */
class ForceView {
  constructor(figure) {
    this.case = caseOf(figure);
    this.trace = this.case.traces[figure.dataset.owner];
    this.supported = Number(figure.dataset.supported ?? HIGHEST_HZ);
    const { position_m: x, supports_m: lines } = this.trace;
    const reference = this.case.reference?.force_20_N[figure.dataset.owner] ?? [];
    const name = fill(translate("pantograph {n}"), { n: figure.dataset.owner });
    this.plot = new Plot({
      ...{ label: fill(translate("Contact force of {t}"), { t: name }), xLabel: translate("position along the track [m]") },
      ...{ xUnit: "m", yLabel: translate("contact force [N]"), yUnit: "N", height: 300, x, lines, curves: forceCurves(this.trace, reference, this.case.reference?.label) },
      levels: forceLevels(this.case, Number(figure.dataset.owner), "ink"),
    });
    const strips = stripForces(this.trace);
    const headings = ["position_m", "force_N", "force_20_N", ...(reference.length ? ["reference_force_20_N"] : [])];
    headings.push(...["front_strip_N", "rear_strip_N"].slice(0, strips.length));
    const beside = (i) => [...(reference.length ? [reference[i]] : []), ...strips.map((force) => force[i])];
    const makeRows = () => x.map((place, i) => [place, this.trace.force_N[i], this.trace.force_20_N?.[i], ...beside(i)]);
    const save = saveButton(translate("Curves as CSV"), fileName(this.case, name, "force"), headings, makeRows);
    this.tools = [...this.plot.makeButtons(), save];
    const note = element("p", { class: "small" }, describeResolution(this.case, this.trace));
    this.parts = [this.plot.element, note, element("div", { class: "pair" }, ...this.makeSpectrum(name), ...this.makeSpans(name))];
  }

  /** Spectrum of the visible stretch, below the force; none without an even step. */
  makeSpectrum(name) {
    this.step = traceStep(this.case, this.trace);
    if (this.step === null) return [];
    const above = this.supported < HIGHEST_HZ ? [{ label: translate("not supported"), values: [0, 0], colour: "faint" }] : [];
    this.spectrum = new Plot({
      ...{ label: fill(translate("Amplitude spectrum of the force of {t}"), { t: name }), xLabel: translate("frequency [Hz]") },
      ...{ xUnit: "Hz", yLabel: translate("amplitude [N]"), yUnit: "N", height: 230, lines: [5, 20], x: [0, HIGHEST_HZ] },
      curves: [{ label: translate("amplitude"), values: [0, 0], colour: "ink" }, ...above],
    });
    this.spectrumTitle = element("p", { class: "small" });
    return [element("div", {}, this.spectrumTitle, this.spectrum.element)];
  }

  /** Forces of the spans over each other; none with fewer than two spans. */
  makeSpans(name) {
    const { position_m: position, force_20_N: filtered, force_N: delivered, supports_m: supports } = this.trace;
    const { distance, spans } = laySpans(position, filtered ?? delivered, supports);
    if (spans.length < 2) return [];
    const curves = spans.map(({ start, end, force }, number) => ({
      ...{ label: `${formatNumber(start, 6)}–${formatNumber(end, 6)} m`, values: force, ...curveStyle(number) },
    }));
    this.spans = new Plot({
      ...{ label: fill(translate("Spans of {t}"), { t: name }), xLabel: translate("distance from the support [m]"), xUnit: "m" },
      ...{ yLabel: translate("contact force [N]"), yUnit: "N", height: 230, x: distance, curves },
    });
    const title = filtered ? translate("Spans over each other, 0–20 Hz.") : translate("Spans over each other, unfiltered.");
    return [element("div", {}, element("p", { class: "small" }, title), this.spans.element)];
  }

  /** Plots of the view that are made. */
  get plots() {
    return [this.plot, this.spectrum, this.spans].filter(Boolean);
  }

  /** Draw all plots of the view. */
  draw() {
    for (const plot of this.plots) plot.draw();
    if (!this.spectrum) return;
    this.plot.onRange = (range) => this.updateSpectrum(range);
    this.updateSpectrum(this.plot.stretch);
  }

  /** Compute the spectrum of the samples between two positions. */
  updateSpectrum([start, end]) {
    const { position_m: position, force_N: force } = this.trace;
    const visible = force.filter((_, i) => position[i] >= start && position[i] <= end);
    const [n, n2] = [Math.max(start, position[0]), Math.min(end, position.at(-1))].map((place) => formatNumber(place, 6));
    if (visible.length < FEWEST_SAMPLES) {
      this.spectrumTitle.textContent = fill(translate("The visible stretch, {n} m to {n2} m, is too short for a spectrum."), { n, n2 });
      return;
    }
    this.spectrumTitle.textContent = fill(translate("Spectrum of the visible stretch, {n} m to {n2} m, unfiltered."), { n, n2 });
    const { frequency, amplitude } = amplitudeSpectrum(visible, this.step);
    const select = (isShown) => amplitude.map((value, i) => (isShown(frequency[i]) ? value : null));
    const above = this.supported < HIGHEST_HZ ? [select((f) => f > this.supported)] : [];
    this.spectrum.setCurves(frequency, [select((f) => f <= this.supported || !above.length), ...above]);
  }

  /** Show the place of an extreme, one span wide. */
  showPlace(place, text, name) {
    const supports = this.trace.supports_m;
    const { position_m: x } = this.trace;
    const span = supports.length > 1 ? Math.abs(supports.at(-1) - supports[0]) / (supports.length - 1) : (x.at(-1) - x[0]) / 5;
    this.plot.showPlace(place.position_m, span, text, name);
  }
}

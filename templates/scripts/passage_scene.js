// Drawing of one instant of a passage on a canvas: side view, plan view, and signals over one time axis.

/** Heights of the panels [px], margins at the left and right, and distance of two panels. */
const PANELS = { side: 230, plan: 64, force: 130, band: 64, uplift: 90 };
const LEFT = 50;
const RIGHT = 8;
const BETWEEN = 32;

/** Length of the line that is visible while a pantograph is followed [m]. */
const FOLLOWED_M = 50;

/** Distance of two masses of a pantograph, and half of the width of a mass [px]. */
const MASS_GAP = 30;
const MASS_HALF = 12;

/** Width of a line by the kind of a wire [px]. */
const WIRE_WIDTHS = { contact_wire: 2.4, messenger_wire: 1.5, stitch_wire: 1 };

/** Curves of the panels of signals: `key`, `unit` and `curves` with times, values, colour, width, and `levels`. */
function listSignals(shownCase, passage) {
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
  const supports = shownCase.uplift.filter((support) => support.time_s.length);
  const uplift = { key: "uplift", label: translate("uplift [mm]"), levels: [], curves: [] };
  supports.forEach((support, i) => uplift.curves.push({ x: support.time_s, y: support.uplift_mm, width: 1.3, ...curveStyle(i), peak: `${formatNumber(support.support_m, 6)} m` }));
  uplift.levels = upliftLimits(shownCase, 1).map(({ values }) => ({ lower: values[0], upper: values[0], text: "", colour: "ink" }));
  return [force, band, uplift].filter(({ curves }) => curves.length);
}

/** Limits of mean and extremes of the force of a pantograph: a band between two limits, or a line. */
function forceLevels(shownCase, owner, name) {
  const names = { mean_force_N: translate("mean"), max_force_N: translate("maximum"), min_force_N: translate("minimum") };
  return shownCase.criteria
    .filter((row) => row.pantograph === owner && row.quantity in names && row.baseline === null)
    .map(({ lower, upper, quantity }) => ({ lower: lower ?? upper, upper: upper ?? lower, text: names[quantity], colour: name }))
    .filter(({ lower }) => lower !== null);
}

/** Scene of a passage: draws on the canvas of a view. */
class PassageScene {
  constructor(canvas, shownCase, passage) {
    Object.assign(this, { canvas, passage, case: shownCase, signals: listSignals(shownCase, passage) });
    const places = passage.wires.flatMap(({ curve }) => [curve.x_m[0], curve.x_m.at(-1)]);
    this.whole = [Math.min(...places), Math.max(...places)];
    const heights = passage.wires.flatMap(({ curve }) => curve.y_m);
    this.heights = [Math.min(...heights), Math.max(...heights)];
    this.times = [passage.start_s, passage.start_s + (passage.frames - 1) * passage.step_s];
    const keys = ["side", ...(passage.shape.plan ? ["plan"] : []), ...this.signals.map(({ key }) => key)];
    this.panels = {};
    let top = 6;
    for (const key of keys) {
      this.panels[key] = { top, height: PANELS[key] };
      top += PANELS[key] + BETWEEN;
    }
    this.height = top + 12;
    this.masses = Math.max(...passage.pantographs.map(({ height }) => height.columns));
  }

  /** Fit the canvas to a width [px]. */
  fit(width) {
    const ratio = window.devicePixelRatio || 1;
    this.width = width;
    Object.assign(this.canvas, { width: Math.round(width * ratio), height: Math.round(this.height * ratio) });
    this.canvas.style.height = `${this.height}px`;
    this.pen = this.canvas.getContext("2d");
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  /** Visible stretch of the line at a time [m]. */
  findStretch(time, followed) {
    if (!followed) return this.whole;
    const length = Math.min(FOLLOWED_M, this.whole[1] - this.whole[0]);
    const centre = this.placeOf(this.passage.pantographs[followed - 1], time);
    const start = Math.min(Math.max(centre - length / 2, this.whole[0]), this.whole[1] - length);
    return [start, start + length];
  }

  placeOf(part, time) {
    return part.start_m + this.passage.speed_m_s * (time - this.passage.start_s);
  }

  /** Pixels per metre along and across the line. */
  get scales() {
    const room = this.panels.side.height - 44 - MASS_GAP * this.masses;
    return [(this.width - LEFT - RIGHT) / (this.stretch[1] - this.stretch[0]), room / (this.heights[1] - this.heights[0] || 1)];
  }

  /** Horizontal pixel of a place. */
  atPlace(place) {
    return LEFT + (place - this.stretch[0]) * this.scales[0];
  }

  /** Vertical pixel of a point of the side view, at rest and with its magnified rise [m]. */
  atHeight(rest, rise) {
    return this.panels.side.top + 26 + (this.heights[1] - rest - this.gain * rise) * this.scales[1];
  }

  /** Horizontal pixel of a time, and its inverse. */
  atTime(time) {
    return LEFT + ((time - this.times[0]) / (this.times[1] - this.times[0])) * (this.width - LEFT - RIGHT);
  }

  timeAt(pixel) {
    return this.times[0] + ((pixel - LEFT) / (this.width - LEFT - RIGHT)) * (this.times[1] - this.times[0]);
  }

  /** Draw an instant; `gain` magnifies the motion over the heights, `followed` is a pantograph or 0. */
  draw(time, gain, followed) {
    this.gain = gain;
    this.stretch = this.findStretch(time, followed);
    const { pen } = this;
    const frame = (time - this.times[0]) / this.passage.step_s;
    pen.clearRect(0, 0, this.width, this.height);
    pen.font = "12px system-ui, sans-serif";
    this.drawGround();
    this.inPanel("side", () => this.drawLine(frame));
    this.inPanel("side", () => this.passage.pantographs.forEach((part, i) => this.drawPantograph(part, i, time, frame)));
    if (this.panels.plan) this.drawPlan(time);
    for (const signal of this.signals) this.drawSignal(signal);
    this.drawCursor(time);
  }

  /** Draw inside the frame of a panel. */
  inPanel(key, act) {
    const { pen, panels } = this;
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, panels[key].top, this.width - LEFT - RIGHT, panels[key].height);
    pen.clip();
    act();
    pen.restore();
  }

  /** A line through points; a missing height lifts the pen. */
  stroke(points, name, width, dash = []) {
    const { pen } = this;
    pen.strokeStyle = colour(name);
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.beginPath();
    let drawn = false;
    for (const [x, y] of points) {
      if (Number.isNaN(y)) drawn = false;
      else if (drawn) pen.lineTo(x, y);
      else {
        pen.moveTo(x, y);
        drawn = true;
      }
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  write(text, x, y, name = "ink", align = "left") {
    this.pen.fillStyle = colour(name);
    this.pen.textAlign = align;
    this.pen.fillText(text, x, y);
  }

  /** Ground of the analysis section, masts, and positions of the supports below the side view. */
  drawGround() {
    const { top, height } = this.panels.side;
    const section = this.case.run.evaluated_m;
    this.inPanel("side", () => {
      this.pen.fillStyle = colour("pale");
      if (section) this.pen.fillRect(this.atPlace(section[0]), top, (section[1] - section[0]) * this.scales[0], height);
      for (const x of this.passage.shape.supports_m) {
        this.stroke([[this.atPlace(x), top], [this.atPlace(x), top + height]], "line", 3);
      }
    });
    let free = LEFT;
    for (const x of this.passage.shape.supports_m) {
      const text = `${formatNumber(x, 6)} m`;
      const half = this.pen.measureText(text).width / 2;
      const middle = this.atPlace(x);
      if (middle - half < free || middle + half > this.width) continue;
      this.write(text, middle, top + height + 14, "soft", "center");
      free = middle + half + 8;
    }
  }

  /** Height of a wire at a place [px]. */
  wireAt(wire, frame, place) {
    return this.atHeight(wire.rest(place), riseAt(wire, frame, place));
  }

  /** Wires, droppers, arms and other points. */
  drawLine(frame) {
    const { passage, pen } = this;
    const visible = (x) => x >= this.stretch[0] - 5 && x <= this.stretch[1] + 5;
    for (const dropper of passage.droppers.filter(({ x }) => visible(x))) {
      const x = this.atPlace(dropper.x);
      const [low, high] = [dropper.lower, dropper.upper].map((wire) => this.wireAt(wire, frame, dropper.x));
      if (dropper.column >= 0 && this.isSlack(dropper, frame)) {
        pen.strokeStyle = colour("curve-2");
        pen.lineWidth = 2;
        pen.beginPath();
        pen.moveTo(x, low);
        pen.quadraticCurveTo(x + 9, (low + high) / 2, x, high);
        pen.stroke();
      } else this.stroke([[x, low], [x, high]], "faint", 1);
    }
    for (const wire of passage.wires) {
      const points = wire.x.map((x, i) => [this.atPlace(x), this.atHeight(wire.rest(x), readField(wire.rise, frame, i) / 1000)]);
      this.stroke(points, "ink", WIRE_WIDTHS[wire.kind]);
    }
    for (const point of passage.points.filter(({ x_m, wire }) => wire && visible(x_m))) {
      const [x, y] = [this.atPlace(point.x_m), this.wireAt(point.wire, frame, point.x_m)];
      if (point.symbol === "steady arm") this.stroke([[x - 10, y - 7], [x, y]], "curve-3", 3);
      pen.fillStyle = colour(point.symbol === "steady arm" ? "curve-3" : "ink");
      pen.beginPath();
      pen.arc(x, y, 3, 0, 7);
      pen.fill();
    }
  }

  isSlack(dropper, frame) {
    const { slack } = this.passage;
    return slack !== null && slack.values[Math.min(Math.round(frame), slack.frames - 1) * slack.columns + dropper.column] > 0;
  }

  /** Contact wire under a place: the lowest one. */
  contactWire(place) {
    const wires = this.passage.wires.filter(({ kind, x }) => kind === "contact_wire" && place >= x[0] && place <= x.at(-1));
    return wires.sort((first, second) => first.rest(place) - second.rest(place))[0];
  }

  /** Masses with springs between them; the head touches its wire, or its distance from it is magnified like a rise. */
  drawPantograph(part, number, time, frame) {
    const place = this.placeOf(part, time);
    const wire = this.contactWire(place);
    if (!wire) return;
    const [x, rest] = [this.atPlace(place), wire.rest(place)];
    const { columns } = part.height;
    const headHeight = readField(part.height, frame, columns - 1);
    const rise = riseAt(wire, frame, place);
    const head = this.atHeight(rest, Number.isNaN(rise) ? headHeight / 1000 - rest : Math.min(headHeight / 1000 - rest, rise));
    const tone = curveStyle(number).colour;
    const bottom = this.panels.side.top + this.panels.side.height - 4;
    let above = head;
    this.stroke([[x - 22, head + 2], [x + 22, head + 2]], tone, 4);
    for (let mass = columns - 2; mass >= 0; mass--) {
      const closing = readField(part.height, frame, mass) - headHeight - part.rest[mass];
      const y = head + MASS_GAP * (columns - 1 - mass) - (this.gain * closing * this.scales[1]) / 1000;
      this.drawSpring(x, above + 4, y - 5, tone);
      this.pen.fillStyle = colour(tone);
      this.pen.fillRect(x - MASS_HALF, y - 5, 2 * MASS_HALF, 10);
      above = y;
    }
    this.drawSpring(x, above + 5, bottom, tone);
    this.stroke([[x - MASS_HALF, bottom], [x + MASS_HALF, bottom]], tone, 2);
    const text = `${number + 1}: ${formatNumber(Math.round(readField(part.force, frame, 0)), 4)} N`;
    this.write(text, Math.min(x + MASS_HALF + 6, this.width - 70), bottom - 4, tone);
  }

  /** Zigzag of a spring between two heights [px]. */
  drawSpring(x, top, bottom, tone) {
    const points = Array.from({ length: 8 }, (_, i) => [x + (i % 7 === 0 ? 0 : i % 2 ? 5 : -5), top + ((bottom - top) * i) / 7]);
    this.stroke(points, tone, 1.2);
  }

  /** Stagger of the wires, and the contact points of the pantographs. */
  drawPlan(time) {
    const { top, height } = this.panels.plan;
    const curves = this.passage.shape.plan.curves;
    const widest = Math.max(0.05, ...curves.flatMap(({ y_m }) => y_m.map(Math.abs)));
    const at = (y) => top + height / 2 - (y / widest) * (height / 2 - 5);
    this.write("y [m]", LEFT, top - 4, "soft");
    for (const y of [widest, -widest]) this.write(formatNumber(y, 2), LEFT - 4, at(y) + 8, "soft", "right");
    this.inPanel("plan", () => {
      this.stroke([[LEFT, at(0)], [this.width, at(0)]], "line", 1);
      for (const { kind, x_m, y_m } of curves) {
        this.stroke(x_m.map((x, i) => [this.atPlace(x), at(y_m[i])]), kind === "contact_wire" ? "ink" : "faint", WIRE_WIDTHS[kind]);
      }
      this.passage.pantographs.forEach((part, i) => {
        const x = this.placeOf(part, time);
        const curve = curves.find(({ kind, x_m }) => kind === "contact_wire" && x >= x_m[0] && x <= x_m.at(-1));
        const tone = curveStyle(i).colour;
        this.stroke([[this.atPlace(x), top], [this.atPlace(x), top + height]], tone, 2);
        if (!curve) return;
        this.pen.fillStyle = colour(tone);
        this.pen.beginPath();
        this.pen.arc(this.atPlace(x), at(restHeight(curve)(x)), 5, 0, 7);
        this.pen.fill();
      });
    });
  }

  /** Curves of one panel with its levels and scale. */
  drawSignal(signal) {
    const { top, height } = this.panels[signal.key];
    const inside = ({ x, y }) => Array.from(y).filter((_, i) => x[i] >= this.times[0] && x[i] <= this.times[1]);
    signal.range ??= findRange([...signal.curves.flatMap(inside), ...signal.levels.flatMap(({ lower, upper }) => [lower, upper])]);
    const [low, high] = signal.range;
    const at = (value) => top + height - ((value - low) / (high - low)) * height;
    this.write(signal.label, LEFT, top - 6, "soft");
    for (const value of height > 80 ? [low, (low + high) / 2, high] : [low, high]) {
      this.write(formatNumber(value, 3), LEFT - 4, at(value) + 4, "soft", "right");
      this.stroke([[LEFT, at(value)], [this.width - RIGHT, at(value)]], "line", 1);
    }
    this.inPanel(signal.key, () => {
      for (const { lower, upper, text, colour: name } of signal.levels) {
        this.pen.fillStyle = colour("pale");
        this.pen.fillRect(LEFT, at(upper), this.width, at(lower) - at(upper));
        for (const value of new Set([lower, upper])) this.stroke([[LEFT, at(value)], [this.width - RIGHT, at(value)]], name, 0.8, [6, 4]);
        this.write(text, this.width - RIGHT - 4, (at(lower) + at(upper)) / 2 + 4, "soft", "right");
      }
      for (const { x, y, colour: name, width, dash, peak } of signal.curves) {
        this.stroke(Array.from(x, (time, i) => [this.atTime(time), at(y[i])]), name, width, dash);
        const highest = peak ? y.indexOf(Math.max(...y)) : -1;
        if (peak && this.case.uplift.length < 6) this.write(peak, this.atTime(x[highest]) + 6, at(y[highest]) + 8, name);
      }
    });
  }

  /** Line of the instant through all signals, and the time axis below them. */
  drawCursor(time) {
    const [first, last] = [this.panels[this.signals[0].key], this.panels[this.signals.at(-1).key]];
    const bottom = last.top + last.height;
    const x = this.atTime(time);
    this.stroke([[x, first.top], [x, bottom]], "link", 2);
    const step = niceStep((this.times[1] - this.times[0]) / Math.max(2, this.width / 120));
    for (let tick = Math.ceil(this.times[0] / step) * step; tick < this.times[1]; tick += step) {
      this.write(`${formatNumber(tick, 4)} s`, this.atTime(tick), bottom + 15, "soft", "center");
      this.stroke([[this.atTime(tick), bottom], [this.atTime(tick), bottom + 4]], "soft", 1);
    }
  }
}

/** Range of values, rounded outwards. */
function findRange(values) {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const step = niceStep((high - low || 1) / 4);
  return [Math.floor(low / step) * step, Math.ceil(high / step) * step || step];
}

/** A step of 1, 2 or 5 times a power of ten that is not below a length. */
function niceStep(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= length * (1 - 1e-9));
}

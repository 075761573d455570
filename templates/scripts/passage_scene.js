// Drawing of one instant of a moving line on a canvas: side view, plan view, and signals over one time axis.

/** Heights of the panels [px], margins at the left and right, and distance of two panels. */
const PANELS = { side: 230, plan: 64, force: 130, band: 64, uplift: 90, sensor: 130 };
const LEFT = 50;
const RIGHT = 8;
const BETWEEN = 32;

/** Length of the line that is visible while a pantograph is followed [m]. */
const FOLLOWED_M = 50;

/** Room above and below the wires for shapes without a scale [m]. */
const SHAPE_ROOM_M = 0.5;

/** Distance of two masses of a pantograph, and half of the width of a mass [px]. */
const MASS_GAP = 30;
const MASS_HALF = 12;

/** Symbols as lines of points, across and along. */
const SYMBOLS = @look.symbol@;

/** Width of a line by the kind of a wire [px]. */
const WIRE_WIDTHS = { contact_wire: 2.4, messenger_wire: 1.5, stitch_wire: 1 };

/** Scene of a moving line: draws on the canvas of a view. */
class PassageScene {
  constructor(canvas, shownCase, passage, others = []) {
    Object.assign(this, { canvas, passage, others, case: shownCase, signals: listSignals(shownCase, passage, others) });
    const places = passage.wires.flatMap(({ curve }) => [curve.x_m[0], curve.x_m.at(-1)]);
    this.whole = [Math.min(...places), Math.max(...places)];
    const heights = passage.wires.flatMap(({ curve }) => curve.y_m);
    this.hasScale = passage.error_mm !== null;
    const room = this.hasScale ? 0 : SHAPE_ROOM_M;
    this.heights = [Math.min(...heights) - room, Math.max(...heights) + room];
    this.times = [passage.start_s, passage.start_s + (passage.frames - 1) * passage.step_s];
    const keys = ["side", ...(passage.shape.plan ? ["plan"] : []), ...this.signals.map(({ key }) => key)];
    this.panels = {};
    let top = 6;
    for (const key of keys) {
      this.panels[key] = { top, height: PANELS[key] };
      top += PANELS[key] + BETWEEN;
    }
    this.height = top + 12;
    this.masses = Math.max(2, ...passage.pantographs.map(({ height }) => height.columns));
    this.layer = element("canvas");
    const inside = ({ x, y }) => Array.from(y).filter((_, i) => x[i] >= this.times[0] && x[i] <= this.times[1]);
    for (const signal of this.signals) {
      const values = [...signal.curves.flatMap(inside), ...signal.levels.flatMap(({ lower, upper }) => [lower, upper])];
      signal.ends = [Math.min(...values), Math.max(...values)];
      signal.range = findRange(signal.ends);
    }
  }

  /** Fit the canvas to a width [px]. */
  fit(width) {
    const ratio = window.devicePixelRatio || 1;
    this.width = width;
    this.canvas.style.height = `${this.height}px`;
    [this.still, this.pen] = [this.layer, this.canvas].map((canvas) => {
      Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(this.height * ratio) });
      const pen = canvas.getContext("2d");
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.font = "12px system-ui, sans-serif";
      return pen;
    });
    this.drawStill();
  }

  /** Draw what no instant changes, the signals, once on a layer of its own. */
  drawStill() {
    const { pen } = this;
    this.pen = this.still;
    this.pen.clearRect(0, 0, this.width, this.height);
    for (const signal of this.signals) this.drawSignal(signal);
    this.pen = pen;
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
    pen.drawImage(this.layer, 0, 0, this.width, this.height);
    this.drawGround();
    this.inPanel("side", () => this.others.forEach((other, number) => this.drawOther(other, number, time)));
    this.inPanel("side", () => this.drawLine(frame));
    this.inPanel("side", () => this.passage.pantographs.forEach((part, i) => this.drawPantograph(part, i, time, frame)));
    if (this.panels.plan) this.drawPlan(time);
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

  /** A text that ends at a place, on a piece of paper that hides the curves below it. */
  writeOnPaper(text, right, y) {
    if (!text) return;
    const width = this.pen.measureText(text).width;
    this.pen.fillStyle = colour("paper");
    this.pen.fillRect(right - width - 3, y - 11, width + 6, 14);
    this.write(text, right, y, "ink", "right");
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
    const sensors = listSensors(passage);
    const released = this.times[0] + frame * passage.step_s > 0;
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
      if (!this.hasScale) this.stroke(wire.curve.x_m.map((x, i) => [this.atPlace(x), this.atHeight(wire.curve.y_m[i], 0)]), "faint", 0.7);
      this.stroke(points, "ink", WIRE_WIDTHS[wire.kind]);
    }
    for (const point of passage.points.filter(({ x_m, wire, symbol }) => wire && visible(x_m) && !(symbol === "mass" && released))) {
      const [x, y] = [this.atPlace(point.x_m), this.wireAt(point.wire, frame, point.x_m)];
      if (point.symbol === "steady arm") this.stroke([[x - 10, y - 7], [x, y]], "curve-3", 3);
      const sensor = sensors.indexOf(point);
      pen.fillStyle = colour(sensor >= 0 ? curveStyle(sensor).colour : point.symbol === "steady arm" ? "curve-3" : "ink");
      pen.beginPath();
      if (sensor >= 0) pen.rect(x - 5, y - 5, 10, 10);
      else pen.arc(x, y, point.symbol === "mass" ? 6 : 3, 0, 7);
      pen.fill();
      if (point.symbol === "mass") this.write(point.text, x + 9, y + 14);
    }
  }

  /** Wires and heads of another passage, with its name, over those of the first one. */
  drawOther(other, number, time) {
    const at = alignTime(other, this.passage, time);
    const frame = (at - other.start_s) / other.step_s;
    const [tone, top] = [`curve-${number + 2}`, this.panels.side.top + 14];
    this.write(this.case.names[0], LEFT + 6, top);
    this.write(this.case.names[number + 1], LEFT + 6, top + 16 * (number + 1), tone);
    if (frame < 0 || frame > other.frames - 1) return;
    for (const wire of other.wires) {
      const points = wire.x.map((x, i) => [this.atPlace(x), this.atHeight(wire.rest(x), readField(wire.rise, frame, i) / 1000)]);
      this.stroke(points, tone, WIRE_WIDTHS[wire.kind], DASHES[1]);
    }
    for (const part of other.pantographs) {
      const place = part.start_m + other.speed_m_s * (at - other.start_s);
      const wire = this.contactWire(place, other);
      if (!wire) continue;
      const [x, y] = [this.atPlace(place), this.wireAt(wire, frame, place)];
      this.stroke([[x - 22, y + 2], [x + 22, y + 2]], tone, 4);
    }
  }

  isSlack(dropper, frame) {
    const { slack } = this.passage;
    return slack !== null && slack.values[Math.min(Math.round(frame), slack.frames - 1) * slack.columns + dropper.column] > 0;
  }

  /** Contact wire under a place: the lowest one. */
  contactWire(place, passage = this.passage) {
    const wires = passage.wires.filter(({ kind, x }) => kind === "contact_wire" && place >= x[0] && place <= x.at(-1));
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

  /** Symbol of a spring between two heights [px]. */
  drawSpring(x, top, bottom, tone) {
    for (const line of SYMBOLS.spring) this.stroke(line.map(([across, along]) => [x + 5 * across, bottom + along * (top - bottom)]), tone, 1.2);
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
      }
      for (const { x, y, colour: name, width, dash, peak } of signal.curves) {
        this.stroke(Array.from(x, (time, i) => [this.atTime(time), at(y[i])]), name, width, dash);
        const highest = peak ? y.indexOf(Math.max(...y)) : -1;
        if (peak && signal.curves.length < 6) this.write(peak, this.atTime(x[highest]) + 6, at(y[highest]) + 8, name);
      }
      for (const { lower, upper, text } of signal.levels) this.writeOnPaper(text, this.width - RIGHT - 4, (at(lower) + at(upper)) / 2 + 4);
    });
  }

  /** Line of the instant through all signals, and the time axis below them. */
  drawCursor(time) {
    const [first, last] = [this.panels[this.signals[0].key], this.panels[this.signals.at(-1).key]];
    const bottom = last.top + last.height;
    const x = this.atTime(time);
    this.stroke([[x, first.top], [x, bottom]], "link", 2);
    const step = niceStep((this.times[1] - this.times[0]) / Math.max(4, this.width / 90));
    for (let tick = Math.ceil(this.times[0] / step) * step; tick < this.times[1]; tick += step) {
      this.write(`${formatNumber(tick, 4)} s`, this.atTime(tick), bottom + 15, "soft", "center");
      this.stroke([[this.atTime(tick), bottom], [this.atTime(tick), bottom + 4]], "soft", 1);
    }
  }
}

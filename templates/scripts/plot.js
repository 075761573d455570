// A plot with zoom, pan, values under the cursor and a legend of switches, on a canvas of uPlot.

/** Share of the visible stretch by which one step of a button or key moves it. */
const PAN_SHARE = 0.25;

/** Factor of one step of zoom. */
const ZOOM_FACTOR = 2;

/** Fewest points of the visible stretch. */
const FEWEST_POINTS = 8;

/**
 * Plot of curves over a common axis.
 *
 * @param {object} content `label`, `xLabel`, `xUnit`, `yLabel`, `yUnit`, `height` [px]; `x`, and `curves` with `label`, `values`,
 *   `colour`, `dash`, `width` and `hidden`; `lines`, positions of vertical lines; `levels`, limits with `lower`, `upper` and `text`.
 */
class Plot {
  constructor(content) {
    this.content = content;
    this.mark = null;
    this.stretch = [content.x[0], content.x.at(-1)];
    this.onRange = () => {};
    this.status = element("p", { class: "unseen", role: "status" });
    this.area = element("div", { class: "area", tabindex: "0", role: "application", "aria-label": this.describe() });
    this.area.style.height = `${content.height}px`;
    this.legend = new Legend(this);
    this.element = element("div", { class: "plot" }, this.legend.element, this.area, this.status);
  }

  /** Name of the plot for screen readers, with its keys. */
  describe() {
    const keys = translate("Arrow keys read values, with shift they move the stretch; plus and minus zoom; home shows all.");
    const limits = (this.content.levels ?? []).map(({ lower, upper, text }) => `${text} ${formatNumber(lower)}–${formatNumber(upper)} ${this.content.yUnit}`);
    const levels = limits.length ? ` ${translate("Limits")}: ${limits.join("; ")}.` : "";
    return `${this.content.label}.${levels} ${keys}`;
  }

  /** Draw the plot in its place of the page, which must be visible. */
  draw() {
    const { x, curves, xLabel, yLabel, height } = this.content;
    const series = curves.map((curve) => ({
      label: curve.label,
      show: !curve.hidden,
      stroke: () => colour(curve.colour),
      width: curve.width ?? 1.5,
      dash: curve.dash,
      points: { show: false },
      spanGaps: false,
    }));
    const options = {
      width: this.area.clientWidth || 300,
      height,
      legend: { show: false },
      cursor: { drag: { x: true, y: false }, bind: { mousedown: (...parts) => bindDrag(this, ...parts) } },
      scales: { x: { time: false }, y: { range: (_, low, high) => this.findHeights(low, high) } },
      axes: [axis(xLabel, 42), axis(yLabel, 52)],
      series: [{}, ...series],
      hooks: {
        setScale: [(canvas, scale) => scale === "x" && this.readStretch()],
        setCursor: [() => this.legend.showValues()],
        drawAxes: [() => drawLimits(this)],
        draw: [() => drawLines(this)],
      },
    };
    this.canvas = new uPlot(options, [x, ...curves.map((curve) => curve.values)], this.area);
    this.size = new ResizeObserver(() => this.fit());
    this.size.observe(this.area);
    this.ignoreScheme = onSchemeChange(() => this.canvas.redraw());
    bindKeys(this);
    bindTouch(this);
  }

  /** Range of the vertical axis: that of the visible values and of all limits, with a margin. */
  findHeights(low, high) {
    const values = [low, high, ...(this.content.levels ?? []).flatMap(({ lower, upper }) => [lower, upper])].filter(Number.isFinite);
    return values.length ? uPlot.rangeNum(Math.min(...values), Math.max(...values), 0.1, true) : [null, null];
  }

  /** Release the plot before another one takes its place. */
  remove() {
    this.size.disconnect();
    this.ignoreScheme();
    this.canvas.destroy();
  }

  /** Fit the canvas to the width of the page. */
  fit() {
    if (this.area.clientWidth) this.canvas.setSize({ width: this.area.clientWidth, height: this.content.height });
  }

  /** Replace the curves, for the same legend. */
  setCurves(x, values) {
    Object.assign(this.content, { x });
    this.canvas.setData([x, ...values]);
  }

  /** Note the visible stretch after the canvas has changed it. */
  readStretch() {
    const { min, max } = this.canvas.scales.x;
    this.stretch = [min, max];
    this.onRange(this.stretch);
  }

  /** Show a stretch, moved into the curves and not shorter than a few of their points. */
  show(start, end) {
    const { x } = this.content;
    const whole = x.at(-1) - x[0];
    const length = Math.min(whole, Math.max(end - start, (FEWEST_POINTS * whole) / x.length));
    const centre = Math.min(Math.max((start + end) / 2, x[0] + length / 2), x.at(-1) - length / 2);
    this.stretch = [centre - length / 2, centre + length / 2];
    this.canvas.setScale("x", { min: this.stretch[0], max: this.stretch[1] });
  }

  /** Zoom by a factor about a place, the centre of the visible stretch without one. */
  zoom(factor, place) {
    const [start, end] = this.stretch;
    const fixed = place ?? (start + end) / 2;
    this.show(fixed - (fixed - start) / factor, fixed + (end - fixed) / factor);
  }

  /** Move the visible stretch by a share of its length. */
  pan(share) {
    const [start, end] = this.stretch;
    this.show(start + share * (end - start), end + share * (end - start));
  }

  /** Show the whole curves. */
  showAll() {
    this.show(this.content.x[0], this.content.x.at(-1));
  }

  /** Show a place of the curves in the middle of a stretch, with a line and a text, and tell its name. */
  showPlace(place, length, text, name) {
    this.mark = { place, text };
    this.show(place - length / 2, place + length / 2);
    this.afterDrawing(() => {
      this.canvas.redraw(false);
      this.moveCursor(this.canvas.valToIdx(place));
    });
    this.announce(`${name} ${text}`);
  }

  /** Act after the canvas has applied its changes, which it does at the end of the present task. */
  afterDrawing(act) {
    queueMicrotask(act);
  }

  /** Buttons for zoom and pan. */
  makeButtons() {
    const buttons = {
      "−": [translate("Zoom out"), () => this.zoom(1 / ZOOM_FACTOR)],
      "+": [translate("Zoom in"), () => this.zoom(ZOOM_FACTOR)],
      "←": [translate("Move left"), () => this.pan(-PAN_SHARE)],
      "→": [translate("Move right"), () => this.pan(PAN_SHARE)],
      [translate("Show all")]: [translate("Show all"), () => this.showAll()],
    };
    return Object.entries(buttons).map(([sign, [label, act]]) => {
      const button = element("button", { type: "button", title: label, "aria-label": label }, sign);
      button.addEventListener("click", act);
      return button;
    });
  }

  /** Put the cursor on a point. */
  moveCursor(index) {
    this.canvas.setCursor({ left: this.canvas.valToPos(this.content.x[index], "x"), top: this.canvas.over.clientHeight / 2 });
  }

  /** Tell a text to screen readers. */
  announce(text) {
    this.status.textContent = text;
  }
}

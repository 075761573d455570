// Legend of a plot: a switch for each curve with its value under the cursor.

/** Short line in the style of a curve. */
function makeSample({ colour: name, dash = [], width = 1.5 }) {
  const draw = (kind, attributes) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  };
  const line = { d: "M0 5H26", stroke: `var(--${name})`, "stroke-width": width, "stroke-dasharray": dash.join(" ") };
  const sample = draw("svg", { width: 26, height: 10, "aria-hidden": "true", class: "sample" });
  sample.append(draw("path", line));
  return sample;
}

/** Legend of a plot. */
class Legend {
  constructor(plot) {
    this.plot = plot;
    this.place = element("output", { class: "place" });
    this.values = plot.content.curves.map(() => element("output", {}));
    const switches = plot.content.curves.map((curve, number) => {
      const box = element("input", { type: "checkbox", checked: "" });
      box.addEventListener("change", () => plot.canvas.setSeries(number + 1, { show: box.checked }));
      return element("label", {}, box, makeSample(curve), ` ${curve.label} `, this.values[number]);
    });
    const label = fill(translate("Curves: {t}"), { t: plot.content.label });
    this.element = element("div", { class: "legend", role: "group", "aria-label": label }, this.place, ...switches);
  }

  /** Show the values under the cursor; none outside of the plot. */
  showValues() {
    const { canvas, content } = this.plot;
    const index = canvas.cursor.idx ?? null;
    this.place.value = index === null ? "" : fill(translate("at {x}"), { x: `${formatNumber(canvas.data[0][index], 6)} ${content.xUnit}` });
    this.values.forEach((value, number) => {
      value.value = index === null ? "" : `${formatNumber(canvas.data[number + 1][index])} ${content.yUnit}`;
    });
  }

  /** The values under the cursor as text. */
  describeValues() {
    const shown = this.plot.content.curves.flatMap((curve, number) =>
      this.plot.canvas.series[number + 1].show ? [`${curve.label} ${this.values[number].value}`] : [],
    );
    return [this.place.value, ...shown].join(", ");
  }
}

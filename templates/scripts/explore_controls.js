// Explorer: sliders of the inputs, and requests to the simulator on this machine, of which the newest counts.

const TOKEN = new URLSearchParams(location.search).get("token") ?? "";

/** Time in which further changes are taken together [ms]. */
const PAUSE_MS = 60;

/** Positions of a slider whose steps multiply its value. */
const POSITIONS = 200;

/** Answer of the server to a request; a refusal is an error whose message is one sentence. */
async function ask(path, content, signal) {
  const headers = { "Content-Type": "application/json", "X-Pantocheck-Token": TOKEN };
  const answer = await fetch(path, { method: "POST", headers, body: JSON.stringify(content), signal });
  const found = await answer.json();
  if (!answer.ok) throw Object.assign(new Error(found.problem), { isReplaced: answer.status === 409 });
  return found;
}

/** A slider with a field for the exact number. */
class Control {
  constructor(slider, act) {
    this.slider = slider;
    const { label, unit, low, high, step, is_logarithmic: scaled } = slider;
    const ends = scaled ? { min: 0, max: POSITIONS, step: 1 } : { min: low, max: high, step };
    this.range = element("input", { type: "range", "aria-label": `${label} [${unit}]`, ...ends });
    this.number = element("input", { type: "number", "aria-label": `${label} [${unit}], exact`, min: low, max: high, step: "any" });
    this.range.addEventListener("input", () => this.take(this.valueAt(Number(this.range.value)), act));
    this.number.addEventListener("input", () => this.take(this.number.valueAsNumber, act, this.number));
    this.problem = element("span", { class: "problem", role: "alert" });
    const marks = element("span", { class: "ends", "aria-hidden": "true" }, element("span", {}, formatNumber(low, 6)), element("span", {}, formatNumber(high, 6)));
    const field = element("span", { class: "exact" }, this.number, ` ${unit}`);
    this.element = element("div", { class: "control" }, element("span", { class: "name" }, label), field, this.problem, this.range, marks);
    this.take(slider.value, () => {});
  }

  /** Value at a position of the slider, with three digits if its steps multiply it, and its inverse. */
  valueAt(position) {
    const { low, high, is_logarithmic: scaled } = this.slider;
    return scaled ? Math.min(Math.max(Number((low * (high / low) ** (position / POSITIONS)).toPrecision(3)), low), high) : position;
  }

  positionAt(value) {
    const { low, high, is_logarithmic: scaled } = this.slider;
    return scaled ? (POSITIONS * Math.log(value / low)) / Math.log(high / low) : value;
  }

  /** Take a value, show it in the other field, and act. */
  take(value, act, source) {
    this.value = value;
    const { slider } = this;
    this.isRefused = !(value >= slider.low && value <= slider.high);
    const stretch = `${formatNumber(slider.low, 6)} to ${formatNumber(slider.high, 6)} ${slider.unit}`;
    this.problem.textContent = this.isRefused ? `${Number.isNaN(value) ? "No number" : "Outside of the range"}. Choose ${stretch}.` : "";
    this.number.setAttribute("aria-invalid", String(this.isRefused));
    if (source !== this.number) this.number.value = value;
    if (!this.isRefused) this.range.value = this.positionAt(value);
    this.range.setAttribute("aria-valuetext", `${formatNumber(value, 6)} ${slider.unit}`);
    this.element.classList.toggle("changed", value !== slider.value);
    act();
  }
}

/** Sliders of the page; `act` is called shortly after a change, and again and again while a slider moves. */
class Controls {
  constructor(sliders, act) {
    let timer = 0;
    const changed = () => {
      timer ||= setTimeout(() => {
        timer = 0;
        act();
      }, PAUSE_MS);
    };
    this.controls = sliders.map((slider) => new Control(slider, changed));
    const reset = element("button", { type: "button" }, "Values of the case");
    reset.addEventListener("click", () => {
      for (const control of this.controls) control.take(control.slider.value, () => {});
      act();
    });
    this.tools = [reset];
    this.element = element("div", { class: "controls", role: "group", "aria-label": "Inputs" }, ...this.controls.map((control) => control.element));
  }

  /** Whether a field has no number of its range. */
  get isRefused() {
    return this.controls.some((control) => control.isRefused);
  }

  /** Values of the sliders that do not stand at those of the case. */
  get values() {
    const changed = this.controls.filter(({ value, slider }) => value !== slider.value);
    return Object.fromEntries(changed.map(({ value, slider }) => [slider.id, value]));
  }
}

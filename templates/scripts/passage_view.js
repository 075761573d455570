// A passage, mass drops or mode shapes as moving pictures: play, speed, step, drag, and links to an instant such as `#t=3.214`.

/** Speeds of the picture over that of the passage, and magnifications of the motion over the heights. */
const SPEEDS = [1, 0.5, 0.2, 0.1, 0.02];
const GAINS = [1, 2, 5, 10, 20];

/** Time between two pictures for readers who prefer less motion [ms]. */
const STILL_MS = 500;

/** Width of a picture below which it follows the first pantograph [px]. */
const NARROW_PX = 600;

/** Choice of one of several values with its label. */
function choice(label, options, chosen, act) {
  const list = element("select", { "aria-label": label });
  for (const [value, text] of options) list.append(element("option", { value }, text));
  list.value = chosen;
  list.addEventListener("change", act);
  return list;
}

/** View of the moving pictures of a figure: one passage, or those of a line from which the reader chooses. */
class PassageView {
  constructor(figure) {
    this.figure = figure;
    const shown = caseOf(figure);
    this.motions = shown.motions ?? [shown.motion];
    this.slider = element("input", { type: "range", "aria-label": translate("Time [s]") });
    this.slider.addEventListener("input", () => this.pause(Number(this.slider.value)));
    this.playing = false;
    this.select(shown, 0);
    const { motion } = this.case;
    const button = (text, label, act) => {
      const made = element("button", { type: "button", "aria-label": label, title: label }, text);
      made.addEventListener("click", act);
      return made;
    };
    const redraw = () => this.show(this.time);
    this.play = button("▶", translate("Play"), () => this.toggle());
    this.speed = choice(translate("Speed"), SPEEDS.map((value) => [value, `× ${value}`]), shown.speed, redraw);
    this.gain = choice(translate("Motion over heights"), GAINS.map((value) => [value, `${translate("motion")} × ${value}`]), shown.gain, redraw);
    const parts = motion.pantographs.map((_, i) => [i + 1, fill(translate("pantograph {n}"), { n: i + 1 })]);
    this.followed = choice(translate("Shown stretch"), [[0, translate("whole stretch")], ...parts], 0, redraw);
    const names = (shown.names ?? []).map((name, n) => [n, name]);
    this.chosen = choice(translate("Shown motion"), names, 0, () => this.choose(Number(this.chosen.value)));
    this.tools = [
      ...(names.length > 1 && !shown.together ? [this.chosen] : []),
      ...[button("|◀", translate("Step back"), () => this.step(-1)), this.play, button("▶|", translate("Step forward"), () => this.step(1))],
      ...[this.speed, this.gain],
      ...(parts.length ? [this.followed, button(translate("Smallest force"), translate("Smallest force"), () => this.showSmallest())] : []),
      ...(figure.id ? [button(translate("Link to this instant"), translate("Link to this instant"), () => this.link())] : []),
    ];
    this.hint = translate("Drag the picture or the curves; space plays, arrow keys step.");
    this.canvas = element("canvas", { "aria-hidden": "true" });
    const label = fill(translate("Moving picture of {x}. Space plays, arrow keys step, home and end go to the ends."), { x: this.case.id });
    this.area = element("div", { class: "area scene", tabindex: "0", role: "application", "aria-label": label }, this.canvas);
    this.readout = element("p", { class: "readout" });
    this.scale = element("p", { class: "small" });
    this.status = element("p", { class: "unseen", role: "status" });
    this.parts = [this.slider, this.area, this.readout, this.scale, this.status];
    this.plot = { area: this.area };
  }

  /** Select a moving picture, at its first instant. */
  select(shown, number) {
    const motion = this.motions[number];
    this.case = { ...shown, motion };
    this.first = this.time = motion.start_s;
    this.last = motion.start_s + (motion.wires[0].rise_mm.frames - 1) * motion.step_s;
    Object.assign(this.slider, { min: this.first, max: this.last, step: motion.step_s, value: this.first });
  }

  /** Show another of the moving pictures; it goes on if one plays. */
  async choose(number) {
    this.select(this.case, number);
    await this.decode();
    this.fit();
  }

  /** Show another passage, at the same instant if it has it; it goes on if one plays. */
  async change(shown) {
    const { time } = this;
    this.motions = [shown.motion];
    this.select(shown, 0);
    this.time = Math.min(Math.max(time, this.first), this.last);
    await this.decode();
    this.fit();
  }

  /** Decode the picture, unless another one is selected meanwhile. */
  async decode() {
    const { case: shown } = this;
    const motions = shown.together ? this.motions : [shown.motion];
    const [passage, ...others] = await Promise.all(motions.map((motion) => decodePassage({ ...shown, motion })));
    if (shown === this.case) this.scene = new PassageScene(this.canvas, shown, passage, others);
  }

  /** Decode the picture once, draw its first instant and bind keys and pointers. */
  draw() {
    return (this.drawn ??= this.begin());
  }

  async begin() {
    this.plot.canvas = this.canvas;
    await this.decode();
    new ResizeObserver(() => this.fit()).observe(this.area);
    onSchemeChange(() => this.fit());
    this.area.addEventListener("keydown", (event) => this.press(event));
    this.area.addEventListener("pointerdown", (event) => this.drag(event));
    // On a narrow screen the whole stretch is a comb of masts: begin with the first pantograph.
    if (this.area.clientWidth < NARROW_PX && this.case.motion.pantographs.length) this.followed.value = 1;
    this.fit();
  }

  fit() {
    if (!this.area.clientWidth) return;
    this.scene.fit(this.area.clientWidth);
    this.show(this.time);
  }

  /** Show an instant [s]. */
  show(time) {
    this.time = Math.min(Math.max(time, this.first), this.last);
    this.slider.value = this.time;
    this.slider.setAttribute("aria-valuetext", `${formatNumber(this.time)} s`);
    if (!this.scene?.pen) return;
    const [gain, followed] = [Number(this.gain.value), Number(this.followed.value)];
    this.scene.draw(this.time, gain, followed);
    this.readout.textContent = this.describe();
    const [along, across] = this.scene.scales;
    if (!this.scene.hasScale) return;
    const values = { n: formatNumber(across / along, 2), n2: formatNumber((gain * across) / along, 2), n3: formatNumber(this.case.motion.error_mm, 2) };
    const text = translate("Heights {n} times, motion {n2} times the scale along the track. Error of the coded wires: at most {n3} mm.");
    this.scale.textContent = fill(text, values);
  }

  /** The instant in words. */
  describe() {
    const { passage } = this.scene;
    const frame = (this.time - this.first) / passage.step_s;
    const slack = passage.droppers.filter((dropper) => dropper.column >= 0 && this.scene.isSlack(dropper, frame)).length;
    const parts = passage.pantographs.map((part, i) => {
      const values = { n: i + 1, n2: formatNumber(this.scene.placeOf(part, this.time), 5), n3: formatNumber(readField(part.force, frame, 0), 3) };
      return fill(translate("pantograph {n}: {n2} m, {n3} N (0–20 Hz)"), values);
    });
    const sensors = listSensors(passage).map(({ wire, x_m: place, text }) => `${text}: ${formatNumber(1000 * riseAt(wire, frame, place), 3)}`);
    const droppers = passage.slack ? [fill(translate("slack droppers: {n}"), { n: slack })] : [];
    const named = sensors.length ? [`${this.case.label} ${sensors.join(", ")}`] : [];
    const others = this.scene.others.map((other, i) => {
      const at = (alignTime(other, passage, this.time) - other.start_s) / other.step_s;
      return `${this.case.names[i + 1]}: ${other.pantographs.map((part) => `${formatNumber(readField(part.force, at, 0), 3)} N`).join(", ")}`;
    });
    return [`t = ${this.time.toFixed(3)} s`, ...parts, ...others, ...named, ...droppers].join("; ");
  }

  /** Play, or pause. */
  toggle() {
    if (this.playing) return this.pause(this.time);
    if (this.time >= this.last) this.show(this.first);
    this.setPlaying(true);
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    let shown = performance.now();
    const advance = (now) => {
      if (!this.playing) return;
      if (!still || now - shown >= STILL_MS) {
        this.show(this.time + (Number(this.speed.value) * Math.max(now - shown, 0)) / 1000);
        shown = now;
      }
      if (this.time >= this.last) this.pause(this.last);
      else requestAnimationFrame(advance);
    };
    return requestAnimationFrame(advance);
  }

  setPlaying(playing) {
    this.playing = playing;
    const label = playing ? translate("Pause") : translate("Play");
    this.play.textContent = playing ? "❚❚" : "▶";
    this.play.setAttribute("aria-label", label);
    this.play.title = label;
  }

  /** Stop at an instant, and tell it. */
  pause(time) {
    this.setPlaying(false);
    this.show(time);
    if (this.scene) this.status.textContent = this.readout.textContent;
  }

  /** Move by whole frames. */
  step(frames) {
    const { step_s: step } = this.case.motion;
    this.pause(this.first + (Math.round((this.time - this.first) / step) + frames) * step);
  }

  press(event) {
    const steps = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (steps) this.step(event.shiftKey ? 10 * steps : steps);
    else if (event.key === " ") this.toggle();
    else if (event.key === "Home") this.pause(this.first);
    else if (event.key === "End") this.pause(this.last);
    else return;
    event.preventDefault();
  }

  /** Drag: in the signals to an instant, in the views with the train. */
  drag(event) {
    const box = this.area.getBoundingClientRect();
    const signals = !this.case.motion.speed_m_s || event.clientY - box.top > this.scene.panels[this.scene.signals[0].key].top - 20;
    const [start, begin] = [event.clientX, this.time];
    const [along] = this.scene.scales;
    const move = ({ clientX }) => {
      const seconds = (clientX - start) / along / this.scene.passage.speed_m_s;
      this.pause(signals ? this.scene.timeAt(clientX - box.left) : begin + seconds);
    };
    move(event);
    this.area.setPointerCapture(event.pointerId);
    this.area.addEventListener("pointermove", move);
    for (const end of ["pointerup", "pointercancel"]) {
      this.area.addEventListener(end, () => this.area.removeEventListener("pointermove", move), { once: true });
    }
  }

  /** Go to the smallest force up to 20 Hz in the analysis section, close to its pantograph. */
  async showSmallest() {
    await this.draw();
    const [low, high] = this.case.run.evaluated_m ?? [-Infinity, Infinity];
    let smallest = { force: Infinity };
    this.scene.passage.pantographs.forEach((part, i) => {
      part.force.values.forEach((force, frame) => {
        const time = this.first + frame * this.case.motion.step_s;
        const place = this.scene.placeOf(part, time);
        if (place >= low && place < high && force < smallest.force) smallest = { force, time, owner: i + 1 };
      });
    });
    this.followed.value = smallest.owner;
    this.pause(smallest.time);
    this.onSmallest?.(smallest.owner);
  }

  /** Put the instant into the address of the page. */
  link() {
    const name = document.querySelector('figure[data-curves="passage"]') === this.figure ? "" : `&case=${this.figure.dataset.case}`;
    history.replaceState(null, "", `#t=${this.time.toFixed(3)}${name}`);
  }
}

/** Go to the instant that the address names. */
function followInstant() {
  const stated = new URLSearchParams(location.hash.slice(1));
  if (!stated.has("t")) return;
  const figures = [...document.querySelectorAll('figure[data-curves="passage"]')];
  const figure = figures.find(({ dataset }) => dataset.case === stated.get("case")) ?? figures[0];
  const time = Number(stated.get("t"));
  if (!figure || !Number.isFinite(time)) return;
  views.get(figure.id).pause(time);
  figure.scrollIntoView();
}

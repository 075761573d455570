// Explorer: the page itself, which follows the sliders, keeps a setting for comparison, and saves settings as files.

/** Time after which a running passage is ended by a change [ms]. */
const PATIENCE_MS = 400;

/** A field with its label. */
function field(label, input) {
  return element("label", { class: "field" }, `${label} `, input);
}

/** Explorer of one case. */
class Explorer {
  constructor() {
    this.controls = new Controls(results.sliders, () => this.run());
    this.status = element("p", { class: "readout", role: "status" });
    this.command = element("code", {});
    this.inputs = element("div", { class: "small" });
    this.keep = element("button", { type: "button" }, "Keep as setting 2");
    this.keep.addEventListener("click", () => this.keepSetting());
    this.drop = element("button", { type: "button", hidden: "" }, "Remove setting 2");
    this.drop.addEventListener("click", () => this.dropSetting());
    const tools = element("div", { class: "tools" }, ...this.controls.tools, this.keep, this.drop);
    openPart("inputs").append(this.controls.element, tools, this.status, this.inputs, element("p", { class: "small" }, "The same inputs, graded: ", this.command));
    [this.values, this.bands] = ["values", "bands"].map(openPart);
    this.note = element("p", { class: "problem", hidden: "" }, "Outdated: the values are those of the last setting that was simulated.");
    this.values.before(this.note);
    [this.forces, this.pictures] = [new ForcePart(), new PicturePart()];
    openPart("save").append(...(results.can_save ? this.makeForms() : ["Start the command with --out FOLDER to save settings."]));
  }

  /** Follow a change: a passage that will soon be there is shown first, so that a moving slider shows some; a long one is ended. */
  run() {
    const age = performance.now() - this.begun;
    if (!this.isSimulating || age >= PATIENCE_MS) return this.start();
    this.next ??= setTimeout(() => this.start(), PATIENCE_MS - age);
    return undefined;
  }

  /** Simulate the setting of the sliders, show its values, then its moving picture. */
  async start() {
    clearTimeout(this.next);
    this.next = undefined;
    this.request?.abort();
    this.markOutdated(this.controls.isRefused);
    if (this.controls.isRefused) return this.end("A field has no number of its range.");
    this.request = new AbortController();
    const { signal } = this.request;
    [this.isSimulating, this.begun] = [true, performance.now()];
    this.status.textContent = `Simulating … ${results.cases.length ? "" : results.waiting}`;
    document.body.setAttribute("aria-busy", "true");
    try {
      const { values } = this.controls;
      const passage = { ...(await ask("/simulate", { values }, signal)), values };
      this.isSimulating = false;
      this.show(passage);
      if (this.next) return this.start();
      this.status.textContent = `Simulated in ${formatNumber(passage.computing_s, 2)} s. Drawing the moving picture …`;
      const motion = await ask("/motion", { number: passage.number }, signal);
      results.cases.forEach((setting) => setting.number === passage.number && Object.assign(setting, { motion }));
      for (const [number, setting] of results.cases.entries()) if (setting.motion === motion) await this.pictures.show(number);
      this.status.textContent = `Simulated in ${formatNumber(passage.computing_s, 2)} s. ${this.countOutside()}`;
    } catch (error) {
      if (error.name === "AbortError" || error.isReplaced) return undefined;
      this.isSimulating = false;
      if (this.next) return this.start();
      this.markOutdated(true);
      return this.end(error.message);
    }
    return this.end(this.status.textContent);
  }

  /** End the work for a setting with a text; values of an earlier setting are named so. */
  end(text) {
    this.isSimulating = false;
    this.status.textContent = this.isOutdated ? `${text} The page shows the last setting that was simulated.` : text;
    document.body.removeAttribute("aria-busy");
  }

  /** Mark values, curves and pictures as those of an earlier setting, or not. */
  markOutdated(outdated) {
    this.isOutdated = outdated && results.cases.length > 0;
    this.note.hidden = !this.isOutdated;
    for (const part of [this.values, this.bands, this.forces.part, this.pictures.part]) part.classList.toggle("outdated", this.isOutdated);
  }

  /** Number of values outside of their limits, in words. */
  countOutside() {
    const limited = results.cases[0].criteria.filter(({ is_inside: inside }) => inside !== null);
    if (!limited.length) return "The case has no limits.";
    return `${limited.filter(({ is_inside: inside }) => !inside).length} of ${limited.length} values lie outside of the limits.`;
  }

  /** Show a passage as setting 1, beside the kept one. */
  show(passage) {
    const count = Object.keys(passage.traces).length;
    results.cases[0] = { ...passage, run: { ...passage.run, count } };
    this.command.textContent = passage.command;
    this.pictures.outdate(0);
    this.redraw();
  }

  /** Draw values, bands and forces of the settings. */
  redraw() {
    const [shown, kept] = results.cases;
    shown.reference = layOver(shown, kept);
    const settings = kept ? [shown, kept] : [shown];
    this.inputs.replaceChildren(...settings.map((setting, i) => element("div", {}, `Setting ${i + 1}: ${describeInputs(setting)}`)));
    this.values.replaceChildren(makeValueTable(settings));
    const owners = Object.keys(shown.traces);
    const captions = owners.length > 1 ? owners.map((owner) => element("p", {}, `Pantograph ${owner}`)) : [];
    this.bands.replaceChildren(...owners.flatMap((owner, i) => [...captions.slice(i, i + 1), makeBars(settings, Number(owner))]));
    this.forces.show();
  }

  /** Keep setting 1 for comparison. */
  async keepSetting() {
    if (!results.cases[0]) return;
    results.cases[1] = { ...results.cases[0], reference: null };
    this.drop.hidden = false;
    this.redraw();
    await this.pictures.show(1);
  }

  dropSetting() {
    results.cases.length = 1;
    this.drop.hidden = true;
    this.pictures.remove(1);
    this.redraw();
  }

  /** Forms that save the setting as a case, and a campaign around it. */
  makeForms() {
    const name = (text) => element("input", { type: "text", value: text, maxlength: "60", required: "" });
    const [caseName, campaignName] = [name("explored-case"), name("explored-campaign")];
    const varied = element("select", {}, ...results.sliders.map(({ id, label }) => element("option", { value: id }, label)));
    const [first, last, count] = ["", "", "9"].map((value) => element("input", { type: "number", step: "any", value, required: "" }));
    const fill = () => {
      const slider = results.sliders.find(({ id }) => id === varied.value);
      [first.value, last.value] = [slider.low, slider.high];
    };
    varied.addEventListener("change", fill);
    fill();
    const range = () => ({ varied: varied.value, first: Number(first.value), last: Number(last.value), count: Math.round(Number(count.value)) });
    return [
      this.makeForm("/case", "Save as case", [field("Name of the folder", caseName)], () => ({ name: caseName.value })),
      this.makeForm(
        ...["/campaign", "Save as campaign"],
        [field("Name of the file", campaignName), field("varied", varied), field("from", first), field("to", last), field("values", count)],
        () => ({ name: campaignName.value, ...range() }),
      ),
    ];
  }

  makeForm(path, label, fields, read) {
    const answer = element("p", { class: "small", role: "status" });
    const form = element("form", { class: "tools", "aria-label": label }, ...fields, element("button", { type: "submit" }, label));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      try {
        const { file, command } = await ask(path, { values: this.controls.values, ...read() });
        answer.replaceChildren(`Written: ${file}. Run it: `, element("code", {}, command));
      } catch (error) {
        answer.textContent = error.message;
      }
    });
    return element("div", {}, form, answer);
  }
}

new Explorer().run();

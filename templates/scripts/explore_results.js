// Explorer: values beside the limits, bands, forces and moving pictures of one or two settings.

const BANDS = { rms_0_5_N: "0–5 Hz", rms_5_20_N: "5–20 Hz", rms_20_50_N: "20–50 Hz" };

/** Part of the page below a heading, whose static content it replaces. */
function openPart(anchor) {
  const heading = document.getElementById(anchor);
  while (heading.nextSibling) heading.nextSibling.remove();
  const part = element("div", {});
  heading.after(part);
  return part;
}

/** Name of a value with its pantograph. */
function nameValue({ label, pantograph }) {
  return pantograph > 1 || (pantograph === 1 && results.cases[0].run.count > 1) ? `${label}, pantograph ${pantograph}` : label;
}

/** Inputs of a setting that differ from those of the case. */
function describeInputs({ values }) {
  const changed = results.sliders.filter(({ id }) => id in values);
  return changed.map(({ id, label, unit }) => `${label} ${formatNumber(values[id], 6)} ${unit}`).join(", ") || "inputs of the case";
}

/** Limits of a value in words. */
function describeLimits({ lower, upper }) {
  if (lower !== null && upper !== null) return `${formatNumber(lower)} to ${formatNumber(upper)}`;
  if (lower !== null) return `at least ${formatNumber(lower)}`;
  return upper === null ? "–" : `at most ${formatNumber(upper)}`;
}

/** Change from the second value to the first: its share, or the difference where a share has no meaning. */
function describeChange(first, second, unit) {
  if (first === null || second === null || first === undefined || second === undefined) return "–";
  const sign = first >= second ? "+" : "−";
  const isShare = first > 0 && second > 0;
  return `${sign}${formatNumber(Math.abs(isShare ? 100 * (first / second - 1) : first - second), 3)} ${isShare ? "%" : unit === "%" ? "points" : unit}`;
}

/** Cell of a value: the number, and whether it lies inside, below or above its limits. */
function valueCell(label, row) {
  const number = element("data", { value: row.value ?? "" }, formatNumber(row.value));
  const side = row.is_inside ? "inside" : row.lower !== null && row.value < row.lower ? "below" : "above";
  const state = row.is_inside === null ? [] : [" ", element("span", { class: row.is_inside ? "inside" : `outside ${side}` }, side)];
  return element("td", { role: "cell", class: "number", "data-label": label }, element("span", {}, number, ...state));
}

/** Table of the values of the settings. */
function makeValueTable(settings) {
  const names = settings.map((_, i) => `setting ${i + 1}`);
  const headings = ["value", "limits", ...names, ...(settings.length > 1 ? ["1 against 2"] : [])];
  const inputs = (text) => (names.includes(text) ? [element("small", {}, describeInputs(settings[names.indexOf(text)]))] : []);
  const head = element("tr", { role: "row" }, ...headings.map((text, i) => element("th", { role: "columnheader", scope: "col", ...(i ? { class: "number" } : {}) }, text, ...inputs(text))));
  const rows = settings[0].criteria.map((row) => {
    const others = settings.map(({ criteria }) => criteria.find(({ quantity, pantograph }) => quantity === row.quantity && pantograph === row.pantograph));
    const cells = others.map((other, i) => (other ? valueCell(names[i], other) : element("td", { role: "cell", "data-label": names[i] }, "–")));
    if (settings.length > 1) {
      const [one, two] = others.map((other) => other?.value);
      cells.push(element("td", { role: "cell", class: "number", "data-label": "1 against 2" }, describeChange(one, two, row.unit)));
    }
    const name = element("th", { role: "rowheader", scope: "row", title: row.quantity }, `${nameValue(row)} [${row.unit}]`);
    return element("tr", { role: "row" }, name, element("td", { role: "cell", class: "number", "data-label": "limits" }, describeLimits(row)), ...cells);
  });
  const label = "Values beside the limits that the case has for its own inputs";
  const table = element("table", { class: "cards", role: "table", "aria-label": label }, element("thead", { role: "rowgroup" }, head), element("tbody", { role: "rowgroup" }, ...rows));
  return element("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": label }, table);
}

/** Bars of the bands of one pantograph, with one scale for all pantographs and settings. */
function makeBars(settings, owner) {
  const find = ({ criteria }, name) => criteria.find(({ quantity, pantograph }) => quantity === name && pantograph === owner)?.value ?? 0;
  const highest = Math.max(...settings.flatMap(({ criteria }) => criteria.filter(({ quantity }) => quantity in BANDS).map(({ value }) => value ?? 0)));
  const rows = Object.entries(BANDS).map(([name, text]) => {
    const bars = settings.map((setting, i) => {
      const bar = element("div", { class: `bar setting-${i + 1}` });
      bar.style.width = `${(75 * find(setting, name)) / highest}%`;
      return element("div", { class: "row" }, bar, element("span", {}, `${settings.length > 1 ? `${i + 1}: ` : ""}${formatNumber(find(setting, name), 3)} N`));
    });
    return element("div", { class: "band" }, element("span", { class: "name" }, text), element("div", {}, ...bars));
  });
  return element("div", { class: "bars", role: "img", "aria-label": `RMS of the force of pantograph ${owner} by band; the table has the numbers` }, ...rows);
}

/** Figure without a static picture, for a view of a setting. */
function makeFigure(number, owner = "0") {
  return element("figure", { class: "viewed", "data-case": number, "data-owner": owner });
}

/** Force of the kept setting at the places of the shown one. */
function layOver(shown, kept) {
  if (!kept) return null;
  const forces = Object.entries(shown.traces).map(([owner, { position_m: x }]) => {
    const other = kept.traces[owner];
    return [owner, other?.force_20_N ? x.map((place) => interpolate(other.position_m, other.force_20_N, place)) : []];
  });
  return { label: "setting 2, 0–20 Hz", force_20_N: Object.fromEntries(forces) };
}

/** Forces of the pantographs; they are drawn anew, because their curves differ in number. */
class ForcePart {
  constructor() {
    this.part = openPart("force");
    this.views = [];
  }

  show() {
    const stretches = this.views.map(({ plot }) => plot.stretch);
    for (const plot of this.views.flatMap(({ plots }) => plots)) plot.remove();
    const owners = Object.keys(results.cases[0].traces);
    const figures = owners.map((owner) => makeFigure(0, owner));
    this.views = figures.map((figure) => new ForceView(figure));
    this.views.forEach((view, i) => {
      figures[i].append(element("div", { class: "tools" }, ...view.tools), element("div", { class: "view" }, ...view.parts));
      figures[i].append(element("figcaption", {}, `Contact force of pantograph ${owners[i]}.`));
    });
    this.part.replaceChildren(...figures);
    this.views.forEach((view, i) => {
      view.draw();
      if (stretches[i]) view.plot.afterDrawing(() => view.plot.show(...stretches[i]));
    });
  }
}

/** Moving pictures of the settings, side by side. */
class PicturePart {
  constructor() {
    this.part = openPart("picture");
    this.part.className = "settings";
    this.views = [];
  }

  /** Show the picture of a setting; an earlier one of the same place changes. */
  async show(number) {
    const shown = results.cases[number];
    if (!shown?.motion) return this.remove(number);
    const made = this.views[number];
    const view = made ?? this.make(number);
    view.figure.classList.remove("outdated");
    const move = number ? " “Smallest force” of one picture moves the other to the same place of the first pantograph." : "";
    view.caption.textContent = `Setting ${number + 1}: ${describeInputs(shown)}. An illustration, no value follows from it.${move}`;
    await (made ? view.change(caseOf(view.figure)) : view.draw());
    if (!made && number) {
      view.followed.value = this.views[0].followed.value;
      view.pause(this.views[0].time);
    }
    this.compare();
  }

  /** Add a view of a setting. */
  make(number) {
    const figure = makeFigure(number);
    const view = new PassageView(figure);
    view.caption = element("figcaption", {});
    view.onSmallest = (owner) => {
      for (const other of this.views.filter((one) => one && one !== view)) {
        other.followed.value = owner;
        other.pause(alignTime(other.scene.passage, view.scene.passage, view.time));
      }
    };
    figure.append(element("div", { class: "tools" }, ...view.tools), element("div", { class: "view" }, ...view.parts), view.caption);
    this.views[number] = view;
    this.part.append(figure);
    return view;
  }

  /** Give the signals of all pictures common axes. */
  compare() {
    const views = this.views.filter((view) => view?.scene);
    shareRanges(views.map(({ scene }) => scene));
    for (const view of views) view.fit();
  }

  /** Mark the picture of an earlier setting until that of the present one is there. */
  outdate(number) {
    this.views[number]?.figure.classList.add("outdated");
  }

  /** Remove the picture of a setting. */
  remove(number) {
    this.views[number]?.setPlaying(false);
    this.views[number]?.figure.remove();
    this.views[number] = undefined;
    this.compare();
  }
}

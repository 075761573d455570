// Page of the verifier: a document is chosen or dropped, and its report is shown.
const HEADINGS = { contradicted: "Contradictions", incomplete: "Not compared in full", proved: "Proved", open: "Not proved" };
const REMARKS = {
  contradicted: "Details without a translation are in English, as the command pantocheck verify prints them.",
  open: "Nothing in this list is proved here. The command pantocheck verify checks it, as far as it is given the named files. "
    + "It belongs to the Python package pantocheck: the README of its source tells how to install it.",
};
const output = document.getElementById("report");

function element(name, text = "", attributes = {}) {
  const space = name === "svg" || attributes.svg ? "2000/svg" : "1999/xhtml";
  const made = document.createElementNS(`http://www.w3.org/${space}`, name);
  for (const [key, value] of Object.entries(attributes)) if (key !== "svg") made.setAttribute(key, value);
  made.textContent = text;
  return made;
}

// Force after the filter of the case over the analysis section, with supports and the limits of its extremes.
function drawForce(result, key, signals, say) {
  const [width, height, left, bottom] = [900, 260, 46, 30], svg = element("svg", "", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  const trace = result.traces[key], x = signals ? signals.cut(signals.position) : trace.position_m;
  const y = (signals ? signals.graded : trace.force_20_N) ?? [];
  const rows = result.criteria.filter((row) => String(row.pantograph) === key && ["max_force_N", "min_force_N"].includes(row.quantity));
  const limits = rows.flatMap((row) => [row.lower, row.upper]).filter((limit) => limit !== null);
  const low = Math.min(smallest(y), ...limits), high = Math.max(largest(y), ...limits), span = high - low || 1;
  const px = (value) => left + ((value - x[0]) / (x[x.length - 1] - x[0])) * (width - left - 10);
  const py = (value) => 10 + ((high - value) / span) * (height - bottom - 10);
  const add = (name, text, attributes) => svg.append(element(name, text, { svg: true, ...attributes }));
  for (const support of trace.supports_m) {
    add("line", "", { x1: px(support), x2: px(support), y1: 10, y2: height - bottom, class: "support" });
    add("text", `${support} m`, { x: Math.min(px(support), width - 45), y: height - 10, class: "label" });
  }
  const power = 10 ** Math.floor(Math.log10(span)), mark = [0.2, 0.5, 1, 2].map((part) => part * power).find((part) => span / part <= 6);
  for (let force = Math.ceil(low / mark) * mark; force <= high; force += mark) {
    add("line", "", { x1: left - 5, x2: left, y1: py(force), y2: py(force), class: "axis" });
    add("text", `${formatG(force, 4)} N`, { x: left - 8, y: py(force) + 4, class: "label tick" });
  }
  add("line", "", { x1: left, x2: left, y1: 10, y2: height - bottom, class: "axis" });
  for (const row of rows) {
    for (const limit of [row.lower, row.upper].filter((value) => value !== null)) {
      add("line", "", { x1: left, x2: width - 10, y1: py(limit), y2: py(limit), class: row.verdict === "fail" ? "limit failed" : "limit" });
      add("text", `${formatG(limit, 4)} N`, { x: left + 4, y: Math.max(py(limit) - 3, 22), class: "label" });
    }
  }
  const step = Math.max(1, Math.floor(x.length / 3000)), points = [];
  for (let i = 0; i < x.length; i += step) points.push(`${px(x[i]).toFixed(1)},${py(y[i]).toFixed(1)}`);
  add("polyline", "", { points: points.join(" "), class: "force" });
  const bounds = limits.length ? "with the limits of its largest and smallest value" : "without limits of its largest and smallest value";
  const name = `Force of pantograph ${key} up to ${result.run.filter.cutoff_Hz} Hz, ${bounds}`, origin = signals ? ", drawn from the embedded signals" : "";
  svg.setAttribute("aria-label", say(name));
  const figure = element("figure");
  figure.append(svg, element("figcaption", say(`${name}${origin}.`)));
  return figure;
}

// Half-width of an uncertainty as the certificate prints it: one of zero lacks a component, or is that of a closed form.
function describeWidth(row, { uncertainty_basis: basis }) {
  const missing = row.trust !== "computed" && Object.values(basis ?? {}).some((text) => text.startsWith("not known"));
  if ((row.uncertainty ?? null) === null) return "—";
  if (row.uncertainty) return `± ${formatG(row.uncertainty, 2)}`;
  return !SIGNAL_NAME.test(row.quantity) ? "exact" : missing ? "not known" : "± 0";
}

// Margin as the certificate prints it: two decimals, or more where two would show no distance to the limit.
function describeMargin({ margin, lower, upper, unit }) {
  if ((margin ?? null) === null || (margin === 0 && lower === upper)) return "—";
  let decimals = 2;
  while (margin && decimals < 13 && !Number(margin.toFixed(decimals))) decimals++;
  const text = decimals > 12 ? formatG(margin, 2) : margin.toFixed(decimals);
  return `${margin > 0 ? "+" : ""}${text.replace("-", "−")}${lower || upper ? "" : ` ${unit}`}`;
}

// Whether a contradiction names a row: its case or step, quantity and pantograph.
const names = (line, id, row) => [`${id}:`, `${id},`].some((start) => line.startsWith(start))
  && line.split(/\W+/).includes(row.quantity) && (/pantograph (\d+)/.exec(line)?.[1] ?? String(row.pantograph)) === String(row.pantograph);

function fillTable(heads, rows) {
  const table = element("table");
  for (const [i, { cells, wrong }] of [{ cells: heads }, ...rows].entries()) {
    const row = element("tr", "", wrong ? { class: "contradicted" } : {});
    row.append(...cells.map((cell) => (cell instanceof Node ? cell : element(i ? "td" : "th", cell))));
    table.append(row);
  }
  return table;
}

// Criteria of a case or step as stated; where something is contradicted, with the values and verdicts that follow.
function tabulate(id, result, follows, contradictions, say) {
  const others = follows?.criteria ?? result.criteria, text = ({ value, unit }) => ((value ?? null) === null ? "—" : `${formatG(value, 6)} ${unit}`);
  const mark = (row) => say(markRows(row.verdict, [row]));
  const wrong = result.criteria.map((row, i) => contradictions.some((line) => names(line, id, row)) || row.verdict !== others[i].verdict);
  const both = (first, second) => (wrong.includes(true) ? [first, second] : [first]);
  const rows = result.criteria.map((row, i) => {
    const limits = `${row.lower === null ? "" : formatG(row.lower, 6)} … ${row.upper === null ? "" : formatG(row.upper, 6)}`;
    const label = LABELS[row.quantity.split(",")[0]], first = element("td", label ? `${say(label)} ` : "");
    first.append(element("code", row.quantity));
    const owner = row.pantograph ? `${row.pantograph}` : say(row.item ? `line, no. ${row.item}` : "line");
    const cells = [...both(text(row), text(others[i])), say(describeWidth(row, result)), limits, describeMargin(row), ...both(mark(row), mark(others[i]))];
    return { cells: [first, owner, ...cells], wrong: wrong[i] };
  });
  const heads = ["Quantity", "Pantograph", ...both("Value", "Value that follows"), "Uncertainty", "Limits", "Margin", ...both("Verdict", "Verdict that follows")];
  return fillTable(heads.map(say), rows);
}

// A stated verdict, with the one that follows if it is another.
function compareMarks(stated, follows, wrong, say) {
  if (follows !== stated) return `${say(stated)} (${say(`contradicted: ${follows} follows`)})`;
  return wrong ? `${say(stated)} (${say("contradicted")})` : say(stated);
}

// Steps of a dossier with their cases and claims, and the criteria that belong to no case.
function* showSteps({ results: { procedure, cases }, follows }, contradictions, say) {
  if (!procedure) return;
  const after = follows?.procedure ?? procedure, rows = (step, all) => all.filter(({ id }) => step.cases?.includes(id)).flatMap((result) => result.criteria);
  const claim = ({ kind, name, claimed, unit, verdict }) =>
    [`${say(PRINTED.claim[kind])}:`, name, claimed && `${claimed.join(" … ")} ${unit}`, say(WORDS[verdict])].filter(Boolean).join(" ");
  const list = procedure.steps.map((step, i) => {
    const marks = [[step, cases], [after.steps[i], follows?.cases ?? cases]].map(([part, all]) => markRows(part.verdict, [...part.criteria ?? [], ...rows(step, all)]));
    const parts = [...step.cases ?? [], ...(step.step === "limits_of_validity" ? (procedure.claims ?? []).map(claim) : [])].join("; ");
    const wrong = contradictions.some((line) => line.startsWith(`step ${step.step}`));
    const role = say(step.required ? "decides the verdict" : "for information");
    return { cells: [`${i + 1} ${say(PRINTED.procedure[step.step])}`, compareMarks(...marks, wrong, say), role, parts || "—"], wrong };
  });
  yield element("h3", `${say("Dossier")}: ${procedure.title}`);
  yield fillTable(["Step", "Verdict", "Role", "Cases"].map(say), list);
  for (const [i, step] of procedure.steps.entries()) {
    if (!step.criteria?.length) continue;
    yield element("h4", `${i + 1} ${say(PRINTED.procedure[step.step])}`);
    yield tabulate(`step ${step.step}`, step, null, contradictions, say);
  }
}

// A contradiction with the words of the quantities that it names.
const explain = (line, say) => line.replace(/[a-z]\w*_\w+/g, (name) => (LABELS[name] ? `${name} (${say(LABELS[name])})` : name));

function showReport(report) {
  const output = element("section", "", { lang: report.language ?? "en" }), say = buildTranslator(report.language);
  const contradictions = report.checks.filter((check) => check.outcome === "contradicted").flatMap((check) => check.details);
  output.append(element("h2", report.name), element("p", say(report.conclusion), { class: `conclusion ${report.authentic ? "authentic" : report.state}` }));
  if (report.digest) output.append(element("p", `${say("Digest of the results")}: ${report.digest}`, { class: "small" }));
  for (const [outcome, heading] of Object.entries(HEADINGS)) {
    const checks = report.checks.filter((check) => check.outcome === outcome);
    if (!checks.length) continue;
    const list = element("ul");
    for (const check of checks) {
      const item = element("li", say(check.statement)), details = element("ul");
      details.append(...check.details.map((line) => element("li", say(explain(line, say)))));
      if (check.details.length) item.append(details);
      list.append(item);
    }
    output.append(element("h3", say(heading)), ...(REMARKS[outcome] && (outcome === "open" || report.language in TEXTS) ? [element("p", say(REMARKS[outcome]))] : []), list);
  }
  output.append(...showSteps(report, contradictions, say));
  for (const [i, result] of report.results.cases.entries()) {
    const name = result.library === "modified" ? say(`modified copy of ${result.id}`) : result.id, follows = report.follows?.cases[i] ?? result;
    const wrong = contradictions.some((line) => [`${result.id}:`, `${result.id},`].some((start) => line.startsWith(start)));
    const verdict = compareMarks(markRows(result.verdict, result.criteria), markRows(follows.verdict, follows.criteria), wrong, say);
    output.append(element("h3", `${result.title} (${name}): ${verdict}`), tabulate(result.id, result, follows, contradictions, say));
    for (const key of Object.keys(result.traces)) {
      if (!result.traces[key].force_20_N?.length) continue;
      const signals = report.evaluated[result.id]?.[key];
      try {
        output.append(drawForce(result, key, signals?.covered ? signals : null, say));
      } catch (error) {
        output.append(element("p", error.message));
      }
    }
  }
  return output;
}

const given = { documents: [], signatures: [], roots: [], changes: 0 };

// Documents replace those before with their signatures; trust roots and signature files are added to them.
async function showFiles(files) {
  const list = [...files], pick = (test) => list.filter((file) => test.test(file.name)), change = ++given.changes;
  const signatures = pick(/\.p7s$/i), roots = pick(/\.(pem|crt|cer|der)$/i);
  const documents = list.filter((file) => ![...signatures, ...roots].includes(file));
  if (documents.length) Object.assign(given, { documents, signatures: [] });
  given.signatures.push(...signatures);
  if (roots.length) given.roots = roots;
  const read = async (file) => (file ? new Uint8Array(await file.arrayBuffer()) : null), count = given.documents.length;
  output.replaceChildren(element("p", count ? "The document is read and computed again …" : "Drop the certificate, too."));
  if (!count) return;
  const shown = [], used = [];
  for (const file of given.documents) {
    const { name } = file, own = given.signatures.findLast((other) => count === 1 || other.name === `${name}.p7s`);
    if (own) used.push(own);
    try {
      const trusted = [];
      for (const root of given.roots) trusted.push({ name: root.name, content: await read(root) });
      const report = await verifyDocument(await read(file), name, await read(own), trusted.length ? trusted : null);
      const parts = [name, own?.name, trusted.length && `trust roots ${trusted.map((root) => root.name).join(", ")}`];
      shown.push(showReport({ ...report, name: parts.filter(Boolean).join(", ") }));
    } catch (error) {
      shown.push(element("p", `${name}: ${error.message}. Nothing is proved.`, { class: "conclusion contradicted" }));
    }
  }
  const listNames = (all) => all.map((file) => file.name).join(", "), unused = given.signatures.filter((file) => !used.includes(file));
  if (unused.length) shown.unshift(element("p", `Not used: ${listNames(unused)}. The name of a signature file is that of its document with .p7s.`));
  if (count > 1) shown.unshift(element("p", `${count} documents, a section for each: ${listNames(given.documents)}.`));
  if (change === given.changes) output.replaceChildren(...shown);
}

document.getElementById("file").addEventListener("change", (event) => showFiles(event.target.files));
for (const name of ["dragover", "drop"]) document.addEventListener(name, (event) => event.preventDefault());
document.addEventListener("drop", (event) => showFiles(event.dataTransfer.files));
// Tests and other pages call this with the bytes of a document; the numbers of the report can be sent as text.
globalThis.verifyDocument = verifyDocument;

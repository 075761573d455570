// Page of the verifier: a document is chosen or dropped, and its report is shown.
const HEADINGS = { contradicted: "Contradictions", incomplete: "Not compared in full", proved: "Proved", open: "Not proved" };
const output = document.getElementById("report");

// Printed names of the quantities.
const LABELS = "@labels@";

function element(name, text = "", attributes = {}) {
  const space = name === "svg" || attributes.svg ? "2000/svg" : "1999/xhtml";
  const made = document.createElementNS(`http://www.w3.org/${space}`, name);
  for (const [key, value] of Object.entries(attributes)) if (key !== "svg") made.setAttribute(key, value);
  made.textContent = text;
  return made;
}

// Force after the filter of the case over the analysis section, with supports and the limits of its extremes.
function drawForce(result, key, signals) {
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
  for (const row of rows) {
    for (const limit of [row.lower, row.upper].filter((value) => value !== null)) {
      add("line", "", { x1: left, x2: width - 10, y1: py(limit), y2: py(limit), class: row.verdict === "fail" ? "limit failed" : "limit" });
      add("text", `${formatG(limit, 4)} N`, { x: 2, y: py(limit) + 4, class: "label" });
    }
  }
  const step = Math.max(1, Math.floor(x.length / 3000)), points = [];
  for (let i = 0; i < x.length; i += step) points.push(`${px(x[i]).toFixed(1)},${py(y[i]).toFixed(1)}`);
  add("polyline", "", { points: points.join(" "), class: "force" });
  const name = `Force of pantograph ${key} up to ${result.run.filter.cutoff_Hz} Hz, with the limits of its largest and smallest value`;
  svg.setAttribute("aria-label", name);
  const figure = element("figure");
  figure.append(svg, element("figcaption", `${name}${signals ? ", drawn from the embedded signals" : ""}.`));
  return figure;
}

// Half-width of an uncertainty as the certificate prints it: one of zero lacks a component, or is that of a closed form.
function describeWidth(row, { uncertainty_basis: basis }) {
  const missing = row.trust !== "computed" && Object.values(basis ?? {}).some((text) => text.startsWith("not known"));
  if ((row.uncertainty ?? null) === null) return "—";
  if (row.uncertainty) return `± ${formatG(row.uncertainty, 2)}`;
  return !SIGNAL_NAME.test(row.quantity) ? "exact" : missing ? "not known" : "± 0";
}

// Mark of a verdict on criteria as on a page: a pass with a value close to a limit is CLOSE.
const markRows = (verdict, rows) =>
  verdict === "pass" && rows.some((row) => row.verdict === "pass" && row.close?.length) ? "PASS, CLOSE" : WORDS[verdict] ?? verdict;

// Whether a contradiction names a row: its case, quantity and pantograph.
const names = (line, { id }, row) => [`${id}:`, `${id},`].some((start) => line.startsWith(start))
  && line.split(/\W+/).includes(row.quantity) && (/pantograph (\d+)/.exec(line)?.[1] ?? String(row.pantograph)) === String(row.pantograph);

function tabulate(result, contradictions) {
  const table = element("table"), add = (cells, name, attributes) => {
    const row = element("tr", "", attributes);
    row.append(...cells.map((cell) => (cell instanceof Node ? cell : element(name, cell))));
    table.append(row);
  };
  add(["Quantity", "Pantograph", "Value", "Uncertainty", "Limits", "Margin", "Verdict"], "th");
  for (const row of result.criteria) {
    const limits = `${row.lower === null ? "" : formatG(row.lower, 6)} … ${row.upper === null ? "" : formatG(row.upper, 6)}`;
    const text = (value, digits, unit = "") => ((value ?? null) === null ? "—" : `${formatG(value, digits)} ${unit}`);
    const [value, margin] = [text(row.value, 6, row.unit), text(row.margin, 2)];
    const wrong = contradictions.some((line) => names(line, result, row)), mark = markRows(row.verdict, [row]);
    const verdict = wrong ? `${mark} (contradicted)` : mark;
    const first = element("td", LABELS[row.quantity] ? `${LABELS[row.quantity]} ` : "");
    first.append(element("code", row.quantity));
    add([first, row.pantograph || "line", value, describeWidth(row, result), limits, margin, verdict], "td", wrong && { class: "contradicted" });
  }
  return table;
}

function showReport(report) {
  const output = element("section"), contradicted = report.checks.filter((check) => check.outcome === "contradicted");
  const contradictions = contradicted.flatMap((check) => check.details);
  output.append(element("h2", report.name), element("p", report.conclusion, { class: `conclusion ${report.authentic ? "authentic" : report.state}` }));
  if (report.digest) output.append(element("p", `Digest of the results: ${report.digest}`, { class: "small" }));
  for (const [outcome, heading] of Object.entries(HEADINGS)) {
    const checks = report.checks.filter((check) => check.outcome === outcome);
    if (!checks.length) continue;
    const list = element("ul");
    for (const check of checks) {
      const item = element("li", check.statement), details = element("ul");
      details.append(...check.details.map((line) => element("li", line)));
      if (check.details.length) item.append(details);
      list.append(item);
    }
    output.append(element("h3", heading), list);
  }
  for (const result of report.results.cases) {
    const name = result.library === "modified" ? `modified copy of ${result.id}` : result.id;
    const heading = `${result.title} (${name}): ${markRows(result.verdict, result.criteria)}`;
    output.append(element("h3", heading), tabulate(result, contradictions));
    for (const key of Object.keys(result.traces)) {
      if (!result.traces[key].force_20_N?.length) continue;
      const signals = report.evaluated[result.id]?.[key];
      try {
        output.append(drawForce(result, key, signals?.covered ? signals : null));
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

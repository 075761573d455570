// Steps of the EN 50318 procedure of a dossier: their verdicts follow from their criteria, cases and claims.
const PROCEDURE_STEPS = ["pantograph_model", "static_check", "simulation_parameters", "reference_models", "line_test", "limits_of_validity"];
const SAME_CONDITION = 1e-9;

const judgeProcedure = ({ steps }) => worst(steps.filter((step) => step.required).map((step) => step.verdict));

// Counted criterion with the smallest margin; `rows`: pairs of the id of a case, or null, and a criterion.
function findClosest(rows) {
  const exactly = (row) => row.margin === 0 && !row.uncertainty && !row.limit_uncertainty;
  const counted = rows.filter(([, row]) => ["pass", "undecided", "fail"].includes(row.verdict) && (row.margin ?? null) !== null
    && row.lower !== row.upper && !exactly(row));
  if (!counted.length) return { closest: null, margin: null, uncertainty: null };
  const [id, row] = counted.reduce((least, item) => (item[1].margin < least[1].margin ? item : least));
  const width = Math.hypot(row.uncertainty ?? 0, row.limit_uncertainty ?? 0), both = row.lower !== null && row.upper !== null;
  const uncertainty = both ? (2 * width) / (row.upper - row.lower) : width / (Math.abs(row.lower ?? row.upper) || 1);
  const owner = row.pantograph ? `pantograph ${row.pantograph}` : "the line";
  const name = `${row.quantity}${row.item ? `[${row.item}]` : ""} of ${owner}`;
  return { closest: id === null ? name : `${id}, ${name}`, margin: row.margin, uncertainty: uncertainty || null };
}

// A claim is verified if runs that passed cover it for every claimed line with every claimed pantograph.
function judgeClaim(claim, claims, evidence) {
  const list = (kind) => (claim.kind === kind ? [claim] : claims.filter((other) => other.kind === kind)).map((other) => other.name);
  const [lines, pantographs] = ["line", "pantograph"].map((kind) => (list(kind).length ? list(kind) : [""]));
  const valuesOf = (item) =>
    ({ speed: [item.speed_km_h], spacing: item.spacing_m, change: [item.inputs?.[claim.name] ?? []].flat() })[claim.kind] ?? [0];
  const groups = lines.flatMap((line) => pantographs.map((pantograph) => {
    const belongs = (item) => ["", item.line].includes(line) && (!pantograph || item.pantographs.includes(pantograph));
    return { line, pantograph, items: evidence.filter((item) => item.passed && belongs(item) && valuesOf(item).length) };
  }));
  const judged = { ...claim, verified: null, evidence: [...new Set(groups.flatMap(({ items }) => items.map((item) => item.id)))].sort() };
  const empty = groups.find(({ items }) => !items.length), quote = (text) => (/'/.test(text) && !/"/.test(text) ? `"${text}"` : `'${text}'`);
  if (empty) {
    const on = (empty.line && ` on line ${quote(empty.line)}`) + (empty.pantograph && ` with pantograph ${quote(empty.pantograph)}`);
    return { ...judged, verdict: "skip", reason: `no run passed${on}` };
  }
  if ((claim.claimed ?? null) === null) return { ...judged, verdict: "pass", reason: null };
  const ranges = groups.map(({ items }) => items.flatMap(valuesOf)), [from, to] = claim.claimed;
  const low = Math.max(...ranges.map(smallest)), high = Math.min(...ranges.map(largest));
  const slack = SAME_CONDITION * Math.max(...[low, high, from, to].map(Math.abs)), inside = low <= from + slack && to <= high + slack;
  const reason = inside ? null : `the runs that passed cover ${formatG(low, 6)} to ${formatG(high, 6)} ${claim.unit}`.trimEnd();
  return { ...judged, verified: low <= high ? [low, high] : null, verdict: inside ? "pass" : "skip", reason };
}

// A claim passes only if every step before it passes; a failed step leaves it not verified.
function requireSteps(claim, steps) {
  const missing = steps.map((step, i) => [i + 1, step]).filter(([, step]) => step.verdict !== "pass");
  if (!missing.length) return claim;
  const least = worst([claim.verdict, ...missing.map(([, step]) => step.verdict)]);
  const state = (step) => (step.state === "not done" ? "not done" : `has the verdict ${step.verdict.toUpperCase()}`);
  const listed = missing.map(([number, step]) => `step ${number} (${step.step.replaceAll("_", " ")}) ${state(step)}`).join(", ");
  const verdict = WORST_FIRST.indexOf(least) < WORST_FIRST.indexOf("skip") ? "skip" : least;
  return { ...claim, verified: null, verdict, reason: `${claim.reason || "rests on runs only"}; ${listed}` };
}

function judgeStep(step, parts, accepted) {
  if (step.state !== "done") return step.state === "error" ? "error" : "skip";
  const verdict = worst([...(step.criteria?.length ? [judgeRows(step.criteria)] : []), ...parts]);
  return verdict === "pass" && (step.unconfirmed ?? null) !== null && !accepted ? "unconfirmed" : verdict;
}

// Procedure with the verdicts that follow from those of the cases.
function decideProcedure(results) {
  const { procedure, cases } = results, steps = [], accepts = results.accepted_unconfirmed.includes(results.system.name);
  const references = procedure.steps.filter((step) => step.step === "reference_models").flatMap((step) => step.cases ?? []);
  const verdicts = Object.fromEntries(cases.map((result) => {
    const accepted = accepts && result.verdict === "unconfirmed" && !lacksVerification(results)(result);
    const verdict = accepted ? "pass" : result.verdict, foreign = references.includes(result.id) && result.library !== "identical";
    return [result.id, foreign ? worst([verdict, "info"]) : verdict];
  }));
  const evidence = (procedure.evidence ?? []).map((item) => ({ ...item, passed: verdicts[item.id] === "pass" }));
  let claims = [];
  for (const step of procedure.steps) {
    const named = (step.cases ?? []).flatMap((id) => cases.filter((result) => result.id === id)), parts = named.map(({ id }) => verdicts[id]);
    if (step.step === "limits_of_validity") {
      const all = procedure.claims ?? [];
      claims = all.map((claim) => requireSteps(judgeClaim(claim, all, evidence), steps));
      parts.push(...claims.map((claim) => claim.verdict));
    }
    if (step.step === "reference_models" && !named.some((result) => (result.steps ?? []).includes("reference_models"))) parts.push("info");
    const rows = [...(step.criteria ?? []).map((row) => [null, row]), ...named.flatMap(({ id, criteria }) => criteria.map((row) => [id, row]))];
    steps.push({ ...step, verdict: judgeStep(step, parts, accepts), ...findClosest(rows) });
  }
  return { ...procedure, steps, evidence, claims };
}

// Contradictions of a stated procedure with the one that follows.
function checkProcedure({ procedure: stated, cases, trust }, follows) {
  const found = [], named = stated.steps.flatMap((step) => step.cases ?? []);
  if (stated.steps.map((step) => step.step).join() !== PROCEDURE_STEPS.join()) {
    found.push("procedure: its steps are not complete, or not in their order");
  }
  for (const { id } of cases) {
    const count = named.filter((name) => name === id).length;
    if (count !== 1) found.push(`procedure: ${id} belongs to ${count} steps`);
  }
  stated.steps.forEach((step, i) => {
    for (const row of step.criteria ?? []) found.push(...checkGrade(row, trust).map((text) => `step ${step.step}, ${row.quantity}: ${text}`));
    const numbers = ({ verdict, closest = null, margin = null, uncertainty = null }) => ({ verdict, closest, margin, uncertainty });
    if (compareTrees(numbers(step), numbers(follows.steps[i]), EXACT).length) {
      found.push(`step ${step.step}: verdict '${step.verdict}', margin or uncertainty do not follow: '${follows.steps[i].verdict}'`);
    }
  });
  (stated.claims ?? []).forEach((claim, i) => {
    const other = follows.claims[i], known = { verified: null, evidence: [], reason: null, ...claim };
    if (!other || compareTrees(known, { ...known, ...other }, EXACT).length) {
      found.push(`claim on ${claim.kind}: '${claim.verdict}' stated, '${other?.verdict ?? "nothing"}' follows`);
    }
  });
  if ((stated.evidence ?? []).some((item, i) => Boolean(item.passed) !== follows.evidence[i].passed)) {
    found.push("procedure: the passed runs are not those whose cases pass");
  }
  return found;
}

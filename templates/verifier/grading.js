// Grades: a value against its limits, its uncertainty, the decision rule, and the verdicts of cases and of the run.
const WORST_FIRST = ["error", "fail", "undecided", "skip", "info", "unconfirmed", "pass"];
const TRUSTS = ["primary", "secondary", "provisional"], QUANTILE_95 = 1.959964;
const COMPONENTS = ["discretisation", "start", "section", "length", "sampling", "resolution", "line", "alignment"];
const BOUNDED = ["sampling", "resolution", "alignment"];
const REMEDIES = {
  discretisation: "a finer mesh and time step", start: "another start or run-in", section: "another analysis section",
  length: "a longer record", sampling: "a higher sampling rate", resolution: "a finer resolution",
  line: "a line that is known better", alignment: "a better join of the clocks",
  limit: "another record behind the limit",
};

const worst = (verdicts) => WORST_FIRST.find((verdict) => verdicts.includes(verdict)) ?? "info";
const judgeParts = (verdicts) => worst(verdicts.filter((verdict) => verdict !== "info"));
const judge = (value, lower, upper) =>
  (lower === null || value >= lower) && (upper === null || value <= upper) ? "pass" : "fail";

function findMargin(value, lower, upper) {
  if (lower !== null && lower === upper) return value === lower ? 0 : -Math.abs(value - lower) / Math.max(Math.abs(lower), 1);
  const distance = Math.min(lower === null ? Infinity : value - lower, upper === null ? Infinity : upper - value);
  if (lower !== null && upper !== null) return 2 * (distance / (upper - lower));
  return distance / (Math.abs(lower ?? upper) || 1);
}

function decides(trust, lowest) {
  if (trust === null || trust === "own") return lowest !== "computed";
  if (trust === "computed" || lowest === "computed") return trust === lowest;
  return TRUSTS.indexOf(trust) <= TRUSTS.indexOf(lowest);
}

function halfWidth(value, draws) {
  const distances = draws.map((draw) => Math.abs(draw - value)).sort((a, b) => a - b);
  const place = 0.95 * (distances.length - 1), i = Math.floor(place), next = Math.min(i + 1, distances.length - 1);
  return distances[i] + (place - i) * (distances[next] - distances[i]);
}

// Distribution function of the normal distribution: series near zero, continued fraction in the tails.
function normalCdf(z) {
  const x = Math.abs(z) / Math.SQRT2;
  if (x > 6) return z > 0 ? 1 : 0;
  let tail;
  if (x < 2.5) {
    let [sum, term] = [x, x];
    for (let n = 1; Math.abs(term) > 1e-17 * sum; n++) {
      term *= (2 * x * x) / (2 * n + 1);
      sum += term;
    }
    tail = 0.5 - (sum * Math.exp(-x * x)) / Math.sqrt(Math.PI);
  } else {
    let fraction = x;
    for (let n = 120; n > 0; n--) fraction = x + n / 2 / fraction;
    tail = Math.exp(-x * x) / fraction / Math.sqrt(Math.PI) / 2;
  }
  return z > 0 ? 1 - tail : tail;
}

// Errors of a criterion: half-width of its 95 % interval, and probability that its value lies inside its limits.
function findErrors(row, unknown) {
  const draws = row.draws ?? [], widths = Object.values(row.components ?? {}), components = row.components ?? {};
  const of = (value) => (draws.length ? halfWidth(value, draws) : widths.length ? Math.hypot(...widths) : null);
  return {
    unknown, limit: row.limit_uncertainty, halfWidth: of,
    expanded: (value) => Math.hypot(of(value) ?? 0, row.limit_uncertainty ?? 0),
    recordBound: BOUNDED.reduce((sum, name) => sum + (components[name] ?? 0), 0),
    conformity: () => {
      if (!draws.length) return null;
      const [lower, upper] = [row.lower ?? -Infinity, row.upper ?? Infinity];
      if (!row.limit_uncertainty) return draws.filter((x) => lower <= x && x <= upper).length / draws.length;
      const sigma = row.limit_uncertainty / QUANTILE_95;
      return mean(draws.map((x) => normalCdf((upper - x) / sigma) - normalCdf((lower - x) / sigma)));
    },
  };
}

function judgeByRule(value, row, errors, rule) {
  const contains = (width) => [value - width, value + width].every((x) => judge(x, row.lower, row.upper) === "pass");
  if (judge(value, row.lower, row.upper) === "fail") return "fail";
  if (BOUNDED.some((name) => errors.unknown.includes(name))) return "undecided";
  if (errors.recordBound && !contains(errors.recordBound)) return "undecided";
  if (rule === "simple") return "pass";
  if (errors.unknown.length || errors.limit === null) return "undecided";
  const conformity = rule === "guarded" ? null : errors.conformity();
  if (conformity === null) return contains(errors.expanded(value)) ? "pass" : "undecided";
  return 1 - conformity <= Number(rule.split(":")[1]) ? "pass" : "undecided";
}

function closeRemarks(row, errors) {
  const { value, lower, upper, unit } = row;
  if (value === null || (lower === null && upper === null)) return [];
  const distances = [lower, upper].filter((limit) => limit !== null).map((limit) => Math.abs(value - limit));
  const distance = Math.min(...distances), expanded = errors.expanded(value);
  if (!(distance < expanded)) return [];
  const parts = [["limit", row.limit_uncertainty ?? 0], ...Object.entries(row.components ?? {})];
  const [name] = parts.reduce((most, part) => (part[1] > most[1] ? part : most));
  const text = (number) => `${formatG(number, 2)} ${unit}`.trimEnd();
  return [
    `lies ${text(distance)} from a limit, less than its uncertainty of ${text(expanded)} (mostly ${name}): ` +
      `${REMEDIES[name]} could reverse the verdict`,
  ];
}

const isDrift = (row) => row.baseline !== null || row.quantity === "baseline";

// Grade of a value that follows from its limits, errors and trust.
function gradeRow(row, trust, rule, unknown) {
  const { value, lower, upper, finding } = row, errors = findErrors(row, unknown), role = finding?.role, counts = decides(row.trust, trust);
  if (lower === null && upper === null) return { verdict: counts ? "skip" : "info", margin: null, errors };
  let judged = value === null ? "skip" : judgeByRule(value, row, errors, rule);
  const outcome = { fail: "not_reproduced", pass: role === "imposed" ? "imposed" : "reproduced" }[judged] ?? "not_evaluated";
  if (judged === "pass" && ((row.doubt ?? null) !== null || role === "imposed")) judged = "info";
  return { verdict: counts ? judged : "info", margin: value === null ? null : findMargin(value, lower, upper), outcome, errors };
}

// Contradictions of one criterion with its value, limits, errors and trust.
function checkGrade(row, trust, rule = "simple", unknown = []) {
  const found = [], { value, lower, upper } = row, { verdict, margin, outcome, errors } = gradeRow(row, trust, rule, unknown);
  const suffix = /_([^_]*)$/.exec(row.quantity)?.[1], unit = { N: "N", mm: "mm", pct: "%", s: "s" }[suffix] ?? "";
  if (SIGNAL_NAME.test(row.quantity) && row.unit !== unit) {
    found.push(`unit '${row.unit}' stated, '${unit}' is the unit of this quantity`);
  }
  if (lower === null && upper === null) return [...found, ...(row.verdict === verdict ? [] : ["no limit"])];
  if (lower !== null && upper !== null && lower > upper) {
    return [...found, `lower limit ${exact(lower)} above upper limit ${exact(upper)}`];
  }
  if (row.finding && outcome !== row.finding.outcome) found.push(`finding '${row.finding.outcome}' stated, '${outcome}' follows`);
  if (row.verdict !== verdict) found.push(`verdict '${row.verdict}' stated, '${verdict}' follows from value, limits and trust`);
  if (!sameNumber(row.margin, margin)) {
    found.push(`margin ${exact(row.margin)} stated, ${exact(margin)} follows from value and limits`);
  }
  const width = value === null ? null : errors.halfWidth(value), conformity = value === null ? null : errors.conformity();
  if (Object.keys(row.components ?? {}).length && !sameNumber(row.uncertainty, width)) {
    found.push(`uncertainty ${exact(row.uncertainty)} stated, ${exact(width)} follows from its joint sample and components`);
  }
  if (!sameNumber(row.conformity, conformity)) {
    const texts = [exact(row.conformity), exact(conformity)];
    found.push(`probability of conformity ${texts[0]} stated, ${texts[1]} follows from its joint sample`);
  }
  const remarks = closeRemarks(row, errors);
  if (JSON.stringify(row.close ?? []) !== JSON.stringify(remarks)) {
    found.push(`${(row.close ?? []).length} remarks on a close limit stated, ${remarks.length} follow`);
  }
  return found;
}

const selectItem = (value, item) => (Array.isArray(value) ? value[(item ?? 1) - 1] ?? null : value ?? null);

function unknownComponents(result, row, names) {
  const basis = result.uncertainty_basis ?? {}, reported = result.uncertainty_components?.[row.pantograph]?.[row.quantity];
  const absent = (name) => (basis[name] ?? "does not apply").startsWith("does not apply");
  const lacks = (name) => names.includes(name) && reported && !(name in reported) && !absent(name);
  return [...names.filter((name) => basis[name]?.startsWith("not known")), ...BOUNDED.filter(lacks)];
}

// Components of the uncertainty that count for limits of a trust.
const selectComponents = ({ record }, trust) => (trust !== "computed" ? COMPONENTS
  : ["discretisation", "sampling", "resolution", ...(record?.start === "differs" ? ["start"] : [])]);

function checkCriteria(result, criteria, trust, rule) {
  const names = selectComponents(result, trust);
  return criteria.flatMap((row) => {
    const found = [], reported = selectItem(result.quantities[row.pantograph]?.[row.quantity], row.item);
    if (row.value !== reported) {
      found.push(`value ${exact(row.value)} graded, ${exact(reported)} reported among the quantities`);
    }
    const unlimited = row.lower === null && row.upper === null;
    if (!isDrift(row) && !unlimited && row.value !== null) {
      const widths = Object.entries(result.uncertainty_components?.[row.pantograph]?.[row.quantity] ?? {});
      const listed = Object.fromEntries(widths.filter(([name]) => names.includes(name)).map(([n, w]) => [n, selectItem(w, row.item)]));
      const equal = compareTrees(row.components ?? {}, listed, 0).length === 0;
      if (!equal) found.push("components of the uncertainty differ from those reported with the quantities");
    }
    found.push(...checkGrade(row, trust, rule, unknownComponents(result, row, names)));
    return found.map((text) => `${row.quantity} of pantograph ${row.pantograph}: ${text}`);
  });
}

// Quantities that are zero in most spans: start and section together can cause a loss that neither causes alone.
const LOSSES = ["contact_loss_pct", "longest_contact_loss_s", "contact_loss_events", "long_contact_loss_pct"];

// Every uncertainty follows from its components: those of a mesh alone exactly, those of a joint sample in size.
function checkUncertainties(result) {
  const found = [];
  for (const row of result.criteria) {
    const stated = selectItem(result.uncertainty?.[row.pantograph]?.[row.quantity], row.item);
    if ((row.uncertainty ?? null) !== null && !isDrift(row) && row.uncertainty !== stated) {
      found.push(`pantograph ${row.pantograph}: uncertainty of ${row.quantity} differs from that of its criterion`);
    }
  }
  for (const [key, quantities] of Object.entries(result.uncertainty_components ?? {})) {
    for (const [name, parts] of Object.entries(quantities)) {
      const columns = Object.values(parts).map((width) => [width].flat()), size = Math.min(...columns.map((c) => c.length));
      const expected = Array.from({ length: columns.length ? size : 0 }, (_, i) => Math.hypot(...columns.map((c) => c[i])));
      const numbers = [result.uncertainty?.[key]?.[name] ?? null].flat(), value = result.quantities[key]?.[name] ?? 0;
      const slack = typeof value === "number" ? 1e-5 * Math.abs(value) : 0;
      const unbounded = LOSSES.includes(name) && "start" in parts && "section" in parts;
      const near = (x, y) => Number.isFinite(x) && y / 3 - slack <= x && (unbounded || x <= 3 * y + slack);
      const plausible = numbers.length === expected.length && numbers.every((x, i) => near(x, expected[i]));
      const equal = plausible && numbers.every((x, i) => sameNumber(x, expected[i]));
      if (!plausible || (!equal && Object.keys(parts).join() === "discretisation")) {
        found.push(`pantograph ${key}: uncertainty of ${name} does not follow from its components`);
      }
    }
  }
  return found;
}

// Draws with every counted value inside its limits; null if no value has a joint sample.
// A reading shifts the draws of a value by the difference of its value.
function conformingDraws(criteria, reading = null) {
  const counted = criteria.filter((r) => ["pass", "undecided", "fail"].includes(r.verdict) && !isDrift(r) && r.value !== null);
  const size = Math.max(0, ...counted.map((row) => (row.draws ?? []).length));
  if (!size) return null;
  const shift = (row) => {
    const value = reading && selectItem(reading.quantities[row.pantograph]?.[row.quantity], row.item);
    return value === null ? 0 : value - row.value;
  };
  const shifts = new Map(counted.map((row) => [row, shift(row)]));
  const drawn = (row, i) => (row.draws?.length ? row.draws[i] : row.value) + shifts.get(row);
  const inside = (row, i) => judge(drawn(row, i), row.lower, row.upper) === "pass";
  return Array.from({ length: size }, (_, i) => counted.every((row) => inside(row, i)));
}
const share = (flags) => flags.filter(Boolean).length / flags.length;

function judgeCase(verdicts, record) {
  if (record?.state === "contradicted") return "error";
  const verdict = judgeParts(verdicts), lowered = record?.state === "unconfirmed" && record.demanded;
  return verdict === "pass" && lowered ? "unconfirmed" : verdict;
}

const judgeRows = (rows) => {
  const verdict = judgeParts(rows.map((row) => row.verdict));
  return rows.some((row) => (row.doubt ?? null) !== null) ? worst([verdict, "info"]) : verdict;
};

// Results whose values, states and verdicts are those that follow; `computed`: quantities of the signals by case.
function followResults(results, computed) {
  const cases = results.cases.map((result) => {
    const record = result.record && { ...result.record, state: judgeState(result.record).state };
    const follow = (rows, trust, rule) => rows.map((row) => {
      const known = selectItem(computed[result.id]?.[row.pantograph]?.[row.quantity], row.item);
      const replaced = row.value !== null && known !== null && !isDrift(row) && !sameNumber(row.value, known);
      const graded = { ...row, value: replaced ? known : row.value }, unknown = unknownComponents(result, row, selectComponents(result, trust));
      const { verdict, margin, errors } = gradeRow(graded, trust, rule, unknown);
      return { ...graded, verdict, margin, close: closeRemarks(graded, errors) };
    });
    const criteria = follow(result.criteria, results.trust, results.decision), graded = criteria.filter((row) => !isDrift(row));
    const stated = result.criteria_verdict ?? result.verdict, ungraded = !graded.length && result.reason && ["skip", "error"].includes(stated);
    const verdict = ungraded ? stated : judgeCase([judgeRows(graded)], record), second = result.verification;
    const rows = second && follow(second.criteria, "computed", "simple");
    const verification = second && { ...second, criteria: rows, verdict: rows.length ? judgeCase(rows.map((row) => row.verdict), record) : second.verdict };
    const own = result.criteria_verdict ? { criteria_verdict: verdict } : { verdict };
    return { ...result, record, criteria, verification, ...own };
  });
  const { cases: verdicts, verdict } = decideRun({ ...results, cases });
  const decided = { ...results, cases: cases.map((result, i) => ({ ...result, verdict: verdicts[i] })), verdict };
  if (!results.procedure) return decided;
  const procedure = decideProcedure(decided);
  return { ...decided, procedure, verdict: judgeProcedure(procedure) };
}

// Whether a case lacks the requested verification.
const lacksVerification = ({ requested }) => (result) =>
  requested.includes("verification") && !result.verification && result.record && result.profile === null;

// Verdicts of the cases and of the run, without the steps of a dossier.
function decideRun(results) {
  const { requested, information, verification_only: only } = results, system = results.system.name;
  const of = (name, result) => name === "verification" ? result.verification?.verdict ?? null
    : only.includes(result.id) ? null : result.criteria_verdict ?? result.verdict;
  const accepted = results.accepted_unconfirmed.includes(system);
  const judgeRun = (pairs) => judgeParts(pairs.filter(([id]) => !information.includes(id))
    .map(([, verdict]) => (accepted && verdict === "unconfirmed" ? "pass" : verdict)));
  const lacks = lacksVerification(results);
  const cases = results.cases.map((result) => {
    const errors = [result.criteria_verdict, result.verdict].filter((verdict) => verdict === "error");
    const verdicts = [...requested.map((name) => of(name, result)), ...errors].filter((verdict) => verdict !== null);
    const drift = result.criteria.filter(isDrift).map((row) => row.verdict);
    const verdict = worst(verdicts), lowered = verdict === "pass" && lacks(result) ? "unconfirmed" : verdict;
    return worst([lowered, ...drift, ...(result.baseline ? [result.baseline.verdict] : [])]);
  });
  const one = (name) => {
    const pairs = results.cases.map((result) => [result.id, of(name, result)]).filter(([, verdict]) => verdict !== null);
    return pairs.length ? judgeRun(pairs) : null;
  };
  const named = { criteria: one("criteria"), verification: one("verification") };
  const shown = results.cases.filter((result) => !information.includes(result.id));
  // An accepted record does not replace a requested verification that a case lacks.
  const bounds = results.cases.filter((r, i) => shown.includes(r) && cases[i] === "unconfirmed" && lacks(r)).map(() => "unconfirmed");
  const overall = judgeParts([judgeRun(results.cases.map((result, i) => [result.id, cases[i]])), ...bounds]);
  const doubted = shown.some((result) => result.criteria.some((row) => (row.doubt ?? null) !== null));
  let verdict = judgeParts([overall, ...requested.map((name) => named[name] ?? "unconfirmed")]);
  if (overall === "info" || doubted) verdict = worst([verdict, "info"]);
  const found = shown.map((result) => conformingDraws(result.criteria)).filter((flags) => flags !== null);
  const conformity = found.length ? share(found[0].map((_, i) => found.every((flags) => flags[i]))) : null;
  const compared = results.cases.map((result) => [result.id, result.baseline?.verdict ?? "skip"]);
  const baseline = results.cases.some((result) => result.baseline) ? judgeRun(compared) : null;
  return { cases, verdict, conformity, ...named, baseline };
}

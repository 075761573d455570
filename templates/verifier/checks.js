// Checks of results, in the words of `pantocheck verify`.
const STATEMENT = "self-declared conformance report, in the style of EN 50318";
const STEPS = ["pantograph_model", "static_check", "reference_models", "line_test", "limits_of_validity"];

// Consistency checks: causes of an outcome without a number, and measures with unit,
// side, thresholds, and whether they need a filtered force.
const RECORD_CHECKS = {
  "coverage": [["holds", "does not hold"], {}],
  "motion": [[], {
    "difference of the speed by position and time": ["", "above", {"contradiction": 0.005}]
  }],
  "support passing": [["not possible"], {
    "shift at which the wire bends at the supports": ["m", "above", {"contradiction": 5.0}],
    "scatter of height less uplift at the passages": ["", "above", {"unchecked": 0.25}]
  }],
  "coincidence": [["not possible", "named by another check"], {
    "longest constant part of an uplift": ["s", "above", {"doubt": 0.15}],
    "difference of height less uplift between supports, beside the kink": ["mm", "above", {"doubt": 1.0}],
    "difference of height less uplift between equal pantographs": ["mm", "above", {"doubt": 5.0}],
    "error of the gain of the uplift, beside three standard errors": ["", "above", {"doubt": 0.03}]
  }],
  "roll-off": [["does not apply", "not possible"], {
    "implied content above the cut-off": ["", "above", {"contradiction": 1.0, "doubt": 0.5}]
  }],
  "dynamics": [["not possible"], {
    "misfit of the motion": ["", "above", {"contradiction": 0.1}],
    "error of the gain of the force": ["", "above", {"contradiction": 0.03}],
    "misfit of the motion behind a causal filter": ["", "above", {"doubt": 0.1}, true],
    "error of the gain of the force behind a causal filter": ["", "above", {"doubt": 0.03}, true],
    "misfit of the motion, lateral place of the wire at rest": ["", "above", {"doubt": 0.1}],
    "error of the gain of the force, lateral place of the wire at rest": ["", "above", {"doubt": 0.06}]
  }],
  "implied force": [["not possible", "does not apply", "named by another check"], {
    "largest error of the force up to the cut-off": ["", "above", {"doubt": 0.15}],
    "largest error of the force up to 50 Hz": ["", "above", {"doubt": 0.3}],
    "largest error of the force, lateral place of the wire at rest": ["", "above", {"doubt": 0.3}]
  }],
  "mean force": [["does not apply", "named by another check"], {
    "mean force beyond the allowance for base spring and momentum": ["", "above", {"doubt": 0.03}]
  }],
  "content": [["not possible", "does not apply", "named by another check"], {
    "content of the force over that of kinks": ["", "below", {"doubt": 0.08}]
  }],
  "copy": [["not possible", "does not apply", "named by another check"], {
    "difference from the force of another pantograph": ["", "below", {"doubt": 0.01}],
    "difference of the uplift at passages with the same force": ["mm", "above", {"doubt": 0.5}]
  }]
};

function checkStatistics(values) {
  const { mean_force_N: m, std_force_N: std, std_force_50_N: std50 } = values, expected = {};
  const known = (x) => typeof x === "number";
  if (known(m) && known(std)) Object.assign(expected, { statistical_min_N: m - 3 * std, statistical_max_N: m + 3 * std });
  if (known(m) && m > 0 && known(std)) expected.cov_20 = std / m;
  if (known(m) && m > 0 && known(std50)) expected.cov_50 = std50 / m;
  const wrong = Object.entries(expected).filter(([name, x]) => known(values[name]) && !sameNumber(values[name], x));
  const text = ([name, x]) => `${name} ${exact(values[name])} stated, ${exact(x)} follows from mean and standard deviation`;
  return wrong.map(text);
}

function compareQuantities(stated, computed) {
  return [...new Set([...Object.keys(computed), ...Object.keys(stated)])].flatMap((key) => {
    if (key === "0" && !("0" in computed)) return [];
    const values = Object.fromEntries(Object.entries(stated[key] ?? {}).filter(([name]) => SIGNAL_NAME.test(name)));
    const texts = compareTrees(values, computed[key] ?? {}, EXACT);
    return key === "0" ? texts : texts.map((text) => `pantograph ${key}: ${text}`);
  });
}

// Quantities, readings, curves, places and contact losses of a case against its embedded signals.
async function checkSignals(result) {
  const samples = result.signals, found = [], { run } = result;
  const facts = { "sampling rate": samples.rate_Hz, "analysis section": samples.evaluated_m };
  found.push(...compareTrees({ "sampling rate": run.rate_Hz, "analysis section": run.evaluated_m }, facts, 1e-8));
  if (result.profile === null && samples.excluded_m?.length) {
    found.push("stretches are left out of the embedded signals, which only a profile can state");
  }
  let signals;
  try {
    signals = await unpackSignals(samples);
  } catch (error) {
    if (!(error instanceof Damaged)) throw error;
    return { found: [...found, `the embedded signals: ${error.message}`], parts: {}, computed: {} };
  }
  const evaluated = evaluateSignals(samples, signals, run.filter, samples.evaluated_m), { parts } = evaluated;
  found.push(...compareQuantities(result.quantities, evaluated.found));
  for (const reading of result.readings ?? []) {
    if (reading.reason !== null) continue;
    const again = evaluateSignals(samples, signals, reading.filter, reading.evaluated_m);
    found.push(...compareQuantities(reading.quantities, again.found).map((text) => `reading '${reading.id}', ${text}`));
  }
  const supports = [...new Set(Object.values(result.traces).flatMap((trace) => trace.supports_m))].sort((a, b) => a - b);
  const traces = {}, places = {}, losses = {};
  for (const [key, part] of Object.entries(parts)) {
    if (!part.covered) continue;
    traces[key] = buildTraces(part, supports);
    const position = part.cut(part.position), at = (index) => ({ position_m: position[index], time_s: null });
    if (traces[key].force_20_N) {
      const force = part.graded, of = (extreme) => at(force.indexOf(extreme(force)));
      places[key] = { max_force_N: of(largest), min_force_N: of(smallest) };
    }
    if (part.applied === null) {
      const force = part.delivered, all = findLosses(force).map(([a, b]) => ({
        position_m: position[a], time_s: a / part.rate, duration_s: (b - a) / part.rate, lowest_force_N: smallest(force.slice(a, b)),
      }));
      const longest = all.sort((a, b) => b.duration_s - a.duration_s).slice(0, 200);
      if (longest.length) losses[key] = longest.sort((a, b) => a.position_m - b.position_m);
    }
  }
  const levels = (table) => Object.fromEntries(
    Object.entries(table).map(([key, trace]) => [`drawn levels of pantograph ${key}`, [trace.mean_N, trace.std_N]]));
  found.push(...compareTrees(levels(result.traces), levels(traces), EXACT));
  found.push(...shorten(compareTrees({ "curves of pantograph": result.traces }, { "curves of pantograph": traces }, ROUNDED)));
  found.push(...compareTrees({ "contact losses": result.contact_losses ?? {} }, { "contact losses": losses }, EXACT));
  if (signals.time) {
    found.push(...checkUpliftCurves(result, samples, signals));
    const { uplift } = evaluated;
    if (uplift) places["0"] = { [UPLIFT]: { position_m: uplift.x, time_s: signals.time[uplift.sample] } };
  }
  found.push(...compareTrees({ "place of an extreme": result.places ?? {} }, { "place of an extreme": places }, EXACT));
  return { found, parts, computed: evaluated.found };
}

// Every drawn point of the uplift is that of the signals, where they are embedded.
function checkUpliftCurves(result, samples, { supports, time }) {
  if (time.length > 80000) return [];
  return supports.flatMap((support) => {
    const curve = result.uplift.find((drawn) => drawn.support_m === support.x);
    const slack = ROUNDED * 1e3 * support.uplift.reduce((most, x) => Math.max(most, Math.abs(x) || 0), 0);
    const wrong = (curve?.time_s ?? []).findIndex((t, i) => {
      const value = support.uplift[Math.round((t - time[0]) * samples.rate_Hz) - support.first];
      return value !== undefined && !(Math.abs(curve.uplift_mm[i] - 1e3 * value) <= slack);
    });
    return wrong < 0 ? [] : [`uplift at ${support.x} m: ${exact(curve.uplift_mm[wrong])} mm at ${exact(curve.time_s[wrong])} s drawn`];
  });
}

// Curves without signals: extremes, largest uplift and order, as far as a thinned curve shows them.
function checkThinned(result) {
  const found = [];
  for (const [key, values] of Object.entries(result.quantities)) {
    const trace = result.traces[key], sampled = trace !== undefined || result.run.rate_Hz !== null;
    const { min_force_N: low, max_force_N: high } = values;
    const texts = low > high ? [`min_force_N ${exact(low)} above max_force_N ${exact(high)}`] : [];
    texts.push(...(sampled ? checkStatistics(values) : []));
    if (trace && !result.signals) {
      for (const [drawn, name] of [[trace.mean_N, "mean_force_N"], [trace.std_N, "std_force_N"]]) {
        const stated = values[name], differs = drawn !== null && stated !== undefined && !sameNumber(drawn, stated, ROUNDED);
        if (differs) texts.push(`${name} ${exact(stated)} stated, ${exact(drawn)} drawn`);
      }
      const force = trace.force_20_N ?? [], slack = ROUNDED * force.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
      if (force.length && largest(force) > high + slack) texts.push(`max_force_N ${exact(high)} stated, ${exact(largest(force))} drawn`);
      if (force.length && smallest(force) < low - slack) texts.push(`min_force_N ${exact(low)} stated, ${exact(smallest(force))} drawn`);
    }
    found.push(...texts.map((text) => `pantograph ${key}: ${text}`));
  }
  const drawn = largest(result.uplift.flatMap((curve) => curve.uplift_mm)), stated = result.quantities["0"]?.[UPLIFT];
  if (Number.isFinite(drawn) && stated !== undefined && !(drawn * (1 - ROUNDED) <= stated && stated <= drawn * 1.02)) {
    found.push(`${UPLIFT} ${exact(stated)} stated, ${exact(drawn)} drawn`);
  }
  return found;
}

// The outcome of a check follows from its number, or from the cause without one.
const CAUSES = {
  holds: "confirmed", "does not apply": "confirmed", "named by another check": "confirmed",
  "does not hold": "contradiction", "not possible": "unchecked", "not reached": "not reached",
};

function judgeBasis({ kind, cause, number, side, thresholds }) {
  if (kind !== "measured") return CAUSES[cause];
  const beyond = (limit) => limit !== undefined && (side === "above" ? number > limit : number < limit);
  return ["contradiction", "doubt", "unchecked"].find((outcome) => beyond(thresholds[outcome])) ?? "confirmed";
}

function checkBasis({ check, outcome, basis }) {
  const found = [], follows = judgeBasis(basis), [causes, measures] = RECORD_CHECKS[check] ?? [[], {}];
  if (outcome !== follows) found.push(`outcome '${outcome}' stated, '${follows}' follows from its number or cause`);
  if (!(check in RECORD_CHECKS)) return found;
  if (basis.kind !== "measured") {
    const known = [...causes, "not reached"].includes(basis.cause);
    return known ? found : [...found, `'${basis.cause}' stated; this check has a number`];
  }
  const stated = [basis.unit, basis.side, basis.thresholds], installed = measures[basis.measure]?.slice(0, 3);
  if (!installed || compareTrees(stated, installed, 0).length) {
    found.push(`the number or the thresholds of '${basis.measure}' are not those of the installed suite`);
  }
  return found;
}

// A check that does not apply, or a threshold for filtered forces, has a cause in the results.
function checkCause({ record, signals, quantities, run }, { check, basis }) {
  const applied = Object.values(signals?.pantographs ?? {}).map((part) => part.filter_applied_Hz ?? null);
  if (basis.kind === "measured") {
    const forFiltered = RECORD_CHECKS[check]?.[1][basis.measure]?.[3] && applied.includes(null);
    return forFiltered ? [`'${basis.measure}' needs a filtered force, but the force was delivered without a filter`] : [];
  }
  if (basis.cause === "named by another check" && !record.checks.some((row) => row.outcome === "unchecked")) {
    return ["no other check names a missing channel"];
  }
  if (basis.cause !== "does not apply") return [];
  const applies = {
    "roll-off": applied.some((f) => f !== null && Math.abs(f / run.filter.cutoff_Hz - 1) <= SAME_CUTOFF),
    "implied force": record.checks.some((row) => row.check === "dynamics" && row.basis.kind === "measured"),
    copy: Object.values(quantities).filter((values) => values.std_force_N).length > 1,
  };
  return applies[check] ? ["'does not apply' stated, but the results show that it applies"] : [];
}

// State of a record and its reason, from the outcomes of its checks.
function judgeState({ checks = [], reason: stated }) {
  const of = (...outcomes) => checks.filter((row) => outcomes.includes(row.outcome)).map((row) => row.text);
  const [bad, open] = [of("contradiction"), of("doubt", "unchecked")];
  if (!checks.length) return { state: "unconfirmed", reason: stated };
  const reason = (bad.length ? bad : open).join("; ") || "every consistency check that applies confirms the record";
  return { state: bad.length ? "contradicted" : open.length ? "unconfirmed" : "consistent", reason };
}

// The state of a record follows from the outcomes of its checks, and these fit the remarks of the case.
function checkState(result) {
  const { record, notes, warnings } = result;
  const found = [], rows = record?.checks ?? [], names = rows.map((row) => row.check), texts = rows.map((row) => row.text ?? "");
  if (!record) return [];
  if (!rows.length) return record.state === "unconfirmed" ? [] : [`state '${record.state}' of the record stated, but no check of it`];
  if (names.join() !== Object.keys(RECORD_CHECKS).join()) found.push(`the checks of the record are ${names.join(", ")}`);
  let contradicted = false;
  rows.forEach(({ check, outcome }, i) => {
    if ((outcome === "not reached") !== contradicted) {
      found.push(`check '${check}': outcome '${outcome}' stated ${contradicted ? "behind" : "without"} a contradiction`);
    }
    contradicted ||= outcome === "contradiction";
    found.push(...[...checkBasis(rows[i]), ...checkCause(result, rows[i])].map((text) => `check '${check}': ${text}`));
    const silent = ["confirmed", "not reached"].includes(outcome), remarks = { doubt: warnings, unchecked: notes }[outcome];
    if ((texts[i] === "") !== silent) found.push(`check '${check}': outcome '${outcome}' does not fit its text`);
    if (remarks && !remarks.includes(texts[i])) found.push(`check '${check}': its text is missing among the remarks`);
    const note = notes.find((text) => text.startsWith(`the ${check} check was not made`) && !texts.includes(text));
    if (note) found.push(`check '${check}': a note says that it was not made, its row does not`);
  });
  const { state, reason } = judgeState(record);
  if (record.state !== state || record.reason !== reason) {
    found.push(`state '${record.state}' of the record stated (${record.reason}); '${state}' follows from its checks (${reason})`);
  }
  return found;
}

function checkCase(result, results) {
  const found = [...checkUncertainties(result), ...checkState(result)], { record, verification: second } = result;
  found.push(...checkCriteria(result, result.criteria, results.trust, results.decision));
  const flags = conformingDraws(result.criteria), { conformity } = result;
  const readings = flags === null ? [] : (result.readings ?? []).filter((reading) => reading.reason === null)
    .map((reading) => [reading.id, share(conformingDraws(result.criteria, reading))]);
  const follows = flags && { probability: share(flags), readings: Object.fromEntries(readings) };
  const known = conformity && { probability: conformity.probability, readings: conformity.readings ?? {} };
  if (flags === null ? conformity : !conformity || compareTrees(known, follows, EXACT).length) {
    found.push("the probability of conformity does not follow from the joint samples of the criteria");
  } else if (conformity && conformity.passing_starts > conformity.starts) {
    found.push(`${conformity.passing_starts} of ${conformity.starts} starts pass`);
  }
  const graded = result.criteria.filter((row) => !isDrift(row)), stated = result.criteria_verdict ?? result.verdict;
  const verdict = judgeCase([judgeRows(graded)], record);
  const ungraded = !graded.length && result.reason && ["skip", "error"].includes(stated);
  if (stated !== verdict && !ungraded) {
    found.push(`verdict '${stated}' stated, '${verdict}' follows from the criteria and the record`);
  }
  if (second) {
    found.push(...checkCriteria(result, second.criteria, "computed", "simple").map((text) => `verification: ${text}`));
    const follows = judgeCase(second.criteria.map((row) => row.verdict), record);
    if (second.verdict !== follows && (second.criteria.length || !["info", "skip", "error"].includes(second.verdict))) {
      found.push(`verification '${second.verdict}' stated, '${follows}' follows from its criteria and the record`);
    }
  }
  for (const reading of result.readings ?? []) {
    for (const values of Object.values(reading.quantities)) found.push(...checkStatistics(values));
  }
  return [...found, ...checkThinned(result)].map((text) => `${result.id}: ${text}`);
}

function buildScope(cases) {
  const best = ["done", "informative", "not done"];
  return STEPS.map((step) => {
    const own = cases.filter((result) => (result.steps ?? []).includes(step)), states = own.map((result) => {
      const verdict = result.baseline ? result.criteria_verdict : result.verdict;
      if (verdict === "skip" || verdict === "error") return "not done";
      const rows = result.criteria.filter((row) => (row.quantity === "apparent_mass_kg") === (step === "pantograph_model"));
      const counts = rows.some((row) => !(result.baseline && isDrift(row)) && ["pass", "fail"].includes(row.verdict));
      return counts && result.library !== "modified" ? "done" : "informative";
    });
    return { step, state: best.find((state) => states.includes(state)) ?? "not done", cases: own.map((result) => result.id) };
  });
}

// Contradictions between the numbers and verdicts of results.
async function checkNumbers(results) {
  const found = [], decided = decideRun(results), evaluated = {}, computed = {};
  for (const result of results.cases) {
    found.push(...checkCase(result, results));
    if (result.signals) {
      const checked = await checkSignals(result);
      found.push(...checked.found.map((text) => `${result.id}: ${text}`));
      evaluated[result.id] = checked.parts;
      computed[result.id] = checked.computed;
    }
  }
  const cases = results.cases.map((result, i) => ({ ...result, verdict: decided.cases[i] }));
  const procedure = results.procedure && decideProcedure({ ...results, cases });
  const pairs = [
    ...results.cases.map((result, i) => [`${result.id}: `, result.verdict, decided.cases[i]]),
    ["", results.verdict, procedure ? judgeProcedure(procedure) : decided.verdict],
    ["verification: ", results.verification_verdict ?? null, decided.verification],
    ["baseline: ", results.baseline_verdict ?? null, decided.baseline],
    ["EN 50318 criteria: ", results.criteria_verdict ?? null, decided.criteria],
  ];
  for (const [where, stated, follows] of pairs) {
    if (stated !== follows) found.push(`${where}verdict '${stated}' stated, '${follows}' follows from the cases`);
  }
  if (!sameNumber(results.conformity, decided.conformity)) {
    const texts = [exact(results.conformity), exact(decided.conformity)];
    found.push(`probability of conformity ${texts[0]} stated, ${texts[1]} follows from the joint samples`);
  }
  if (results.statement !== STATEMENT) found.push(`the report is called '${results.statement}'`);
  if (results.scope.length && JSON.stringify(results.scope) !== JSON.stringify(buildScope(results.cases))) {
    found.push("the scope does not follow from the cases");
  }
  const outcomes = results.cases.flatMap((result) => result.criteria).filter((row) => row.finding).map((row) => row.finding.outcome);
  const counted = (name) => outcomes.filter((outcome) => outcome === name).length;
  const counts = ["imposed", "reproduced", "not_reproduced", "not_evaluated"].map((name) => [name, counted(name)]);
  if (JSON.stringify(results.findings ?? null) !== JSON.stringify(outcomes.length ? Object.fromEntries(counts) : null)) {
    found.push("the numbers of findings do not follow from the criteria");
  }
  if (procedure) found.push(...checkProcedure(results, procedure));
  return { found, evaluated, follows: followResults(results, computed) };
}

// Parts that every run writes.
function findGaps(results) {
  const found = results.scope.length ? [] : ["scope is missing"];
  const onlyVerified = results.cases.length && results.cases.every((r) => results.verification_only.includes(r.id));
  if ((results.criteria_verdict ?? null) === null && !onlyVerified) found.push("criteria_verdict is missing");
  for (const result of results.cases) {
    const add = (text) => found.push(`${result.id}: ${text}`), { run, record } = result;
    const owners = Object.entries(result.quantities).filter(([key, values]) => key !== "0" && "mean_force_N" in values);
    const ungraded = !result.criteria.length && result.reason && ["skip", "error"].includes(result.verdict);
    if ((result.criteria_verdict ?? null) === null && !result.profile) add("criteria_verdict is missing");
    if (!record && run.evaluated_m !== null && !ungraded) add("the state of the record is missing");
    if (record?.start_text && !result.reason && record.start !== "as in the case") {
      const texts = record.start === "differs" ? result.warnings : result.notes;
      if (!texts.includes(record.start_text)) add("the remark on the start of the record is missing");
    }
    for (const name of Object.keys(result.quantities).length ? COMPONENTS : []) {
      const basis = result.uncertainty_basis?.[name];
      const widths = Object.values(result.uncertainty_components ?? {}).flatMap((part) => Object.values(part));
      const single = name === "alignment" && !result.sources?.some((source) => source.record === "graded");
      if (basis === undefined && !single) add(`the basis of the uncertainty '${name}' is missing`);
      else if (!single && !/^(not known|does not apply)/.test(basis) && !widths.some((parts) => name in parts)) {
        add(`the uncertainty '${name}' has a basis, but no value`);
      }
    }
    for (const row of result.criteria) {
      const known = Object.keys(result.uncertainty_components?.[row.pantograph]?.[row.quantity] ?? {}).length;
      const graded = row.value !== null && !isDrift(row) && !(row.lower === null && row.upper === null);
      if (known && graded && !Object.keys(row.components ?? {}).length) {
        add(`${row.quantity} of pantograph ${row.pantograph}: the components of its uncertainty are missing`);
      }
    }
    const sampled = Object.keys(result.traces).length > 0 || run.rate_Hz !== null;
    if (owners.length && !sampled && record?.state === "consistent") {
      add("the sampling rate is missing, and a record without samples cannot be consistent");
    }
    if (!owners.length || !sampled) continue;
    for (const [key, values] of run.rate_Hz !== null && run.evaluated_m !== null ? owners : []) {
      const trace = result.traces[key];
      if (!trace) add(`pantograph ${key}: the curves are missing`);
      else if (!trace.position_m.length || !trace.force_N.length || !trace.spectrum.frequency_Hz.length) {
        add(`pantograph ${key}: the curve of the force or its spectrum is empty`);
      } else if ("std_force_N" in values && (!trace.force_20_N?.length || trace.std_N === null || !trace.histogram)) {
        add(`pantograph ${key}: the curve, deviation or histogram of the 20 Hz force is missing`);
      }
    }
    const hasUplift = UPLIFT in (result.quantities["0"] ?? {});
    if (hasUplift && !result.uplift.length && result.profile === null && run.rate_Hz !== null && run.evaluated_m !== null) {
      add("the curves of the uplift are missing");
    }
    const length = run.evaluated_m === null ? 0 : run.evaluated_m[1] - run.evaluated_m[0];
    const needed = run.rate_Hz && run.speed_km_h ? (length / (run.speed_km_h / 3.6)) * run.rate_Hz : 0;
    if (!result.signals) {
      if (needed <= MOST_SAMPLES) add("the evaluated signals are missing");
      continue;
    }
    for (const [key] of owners) if (!(key in result.signals.pantographs)) add(`the signals of pantograph ${key} are missing`);
    const spans = result.uplift.filter((c) => c.time_s.length).map((c) => (c.time_s.at(-1) - c.time_s[0]) * result.signals.rate_Hz);
    if (hasUplift && !result.signals.uplift.length && (!spans.length || Math.max(...spans) < MOST_SAMPLES)) {
      add("the signals of the uplift are missing");
    }
  }
  return found;
}

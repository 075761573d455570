// Facts that only `pantocheck verify` can prove; a test holds this list against its checks.
const ONLY_VERIFY = [
  ["pages", "Whether texts, figures and metadata are, byte for byte, those that the embedded results give."],
  ["library", "Whether inputs, limits, units, texts and warnings of a published case are those that Pantocheck has for it."],
  ["cases from outside", "Whether inputs, limits and texts of a case by another author are those that its author distributes."],
  ["revocation", "Whether the certificate of a signer was revoked (option --trust-roots, with lists of revoked certificates)."],
  ["record", "Whether the record itself, with the numbers of its consistency checks and its digest, is the stated one (option --record)."],
  ["rerun", "Whether a new run of the simulator gives the same values (option --rerun)."],
  ["suite", "Whether the stated version of Pantocheck has the stated digest."],
  ["format", "Whether every key of the results belongs to their format."],
  ["statements", "Whether a case is repeated, a note is foreign, the run starts in the future, or a reason does not follow."],
  ["dossier", "Whether values of a dossier that belong to no case, and limits from measured runs or a baseline, follow from their data."],
  ["remarks", "Whether the remarks on other readings of the evaluation, and on limits that a user widened, are complete."],
  ["static values", "Whether the values of the line at rest, of studies and of the reference simulator are right."],
];

// Suite of this verifier: the rules of another one can differ.
const SUITE = "@suite@";
const OTHER_RULES = "are not those of the installed suite";

const UNCHANGED = "The signature holds: it covers the whole file, and nothing was changed since.";
const ALL_UNCHANGED = "Every signature holds: they cover the whole file, and only signatures were added since the first.";

// Report on a document: its checks by outcome, as `pantocheck verify` prints them.
async function verifyDocument(bytes, name = "document", signatureFile = null, roots = null) {
  const document = await readDocument(bytes), results = JSON.parse(document.text), checks = [];
  const origin = await checkOrigin(bytes, document, signatureFile, roots && [roots].flat().flatMap(({ content, name: file }) => readRoots(content, file)));
  if (results.schema !== "pantocheck.results/1") throw new Error("the document holds no results of Pantocheck");
  const add = (outcome, statement, details = [], part = "") => checks.push({ outcome, statement, details, part });
  const judged = (proved, contradicted, details) =>
    details.length ? add("contradicted", contradicted, details) : add("proved", proved);
  let numbers;
  try {
    numbers = await checkNumbers(results);
  } catch (error) {
    numbers = { found: [`the results are not in the format of Pantocheck (${error.message})`], evaluated: {}, follows: null };
  }
  const isForeign = ["version", "digest"].some((key) => results.suite?.[key] !== SUITE[key]);
  const [rules, lines] = [true, false].map((other) =>
    [...new Set(numbers.found)].filter((line) => (isForeign && line.includes(OTHER_RULES)) === other));
  judged(
    "Verdicts, margins, uncertainties and statistics follow from the embedded numbers.",
    "The embedded numbers and verdicts contradict each other.", lines);
  if (isForeign) {
    add("incomplete", "Another version of Pantocheck made this document. Its pages print the digest of its own verifier.", rules);
  }
  let gaps = [];
  try { gaps = findGaps(results); } catch (error) { gaps = [error.message]; }
  if (gaps.length) add("contradicted", "Parts that every run writes are missing.", gaps);
  if (document.added && !document.signed) {
    add("contradicted", "The file was changed after it was written.", [`${document.added} bytes were appended after the document was written`]);
  }
  if (document.kind === "HTML") {
    const page = checkPage(document.page, document.digest, results);
    const values = page.count ? `, digest and ${page.count} values` : " and digest";
    const texts = `Verdict${values} printed on the page are those of the results.`;
    if (!page.count) add("open", "Whether the tables of the page print the values of the results.");
    judged(texts, "The page prints other numbers than its results.", page.found);
  } else if (document.kind === "PDF") {
    const digest = document.digest ?? "not computed: this browser offers no digests to a local file";
    add("open", "Whether the pages of the PDF print the numbers of the embedded results.", [
      `The first pages print the digest of the results under 'Check of this document'. It must be ${digest}.`,
      "An equal digest shows which results the pages name, not that they print the numbers of these results.",
      ...(origin.authentic ? [`The signature covers the visible pages as well: ${origin.signers.join(", ")} signed what they show.`] : []),
    ]);
  }
  const changed = origin.signers.length ? "The file was changed after signing." : "The signatures cannot be read.";
  if (origin.changes.length) add("contradicted", changed, origin.changes);
  if (origin.damages.length) add("contradicted", "A signature does not hold for this file.", origin.damages);
  const broken = origin.changes.length + origin.damages.length;
  if (origin.signers.length && !broken) add("proved", origin.signers.length > 1 ? ALL_UNCHANGED : UNCHANGED);
  if (origin.note) add("incomplete", "The origin of the document.", origin.lines);
  else if (origin.authentic) add("proved", "Every signer leads to a given trust root.", origin.lines);
  else add("open", "The origin of the document.", origin.lines);
  const unsampled = results.cases.filter((result) => !result.signals && Object.keys(result.traces ?? {}).length)
    .map((result) => result.id);
  if (unsampled.length) add("open", "Whether the statistics of records without embedded signals are right.", unsampled);
  for (const [check, statement] of ONLY_VERIFY) add("open", statement, [], check);
  const contradictions = checks.filter((check) => check.outcome === "contradicted").flatMap((check) => check.details);
  const criteria = results.cases?.reduce((sum, r) => sum + r.criteria.length + (r.verification?.criteria.length ?? 0), 0);
  const noun = (count, one, many = `${one}s`) => `${count} ${count === 1 ? one : many}`;
  const size = `${noun(results.cases?.length, "case")}, ${noun(criteria, "criterion", "criteria")}`;
  const signers = origin.signers.length ? ` by ${origin.signers.join(", ")}` : "";
  const claim = origin.authentic ? "authentic: " : signers || origin.note ? `NOT TRUSTED: the document claims to be signed${signers}; `
    : "UNSIGNED: the numbers are consistent, anyone can have written this document; ";
  const { evaluated, follows } = numbers, mark = markRun(results), other = follows ? `; '${markRun(follows)}' follows` : "";
  const conclusion = contradictions.length
    ? `not consistent: ${noun(contradictions.length, "contradiction")} (${size}; stated verdict '${mark}'${other}).`
    : `${claim}the verdict '${mark}' follows from the embedded numbers (${size}).`;
  const state = contradictions.length ? "contradicted" : origin.note || isForeign ? "incomplete" : "consistent", { kind, language } = document;
  return { name, kind, language, state, conclusion, checks, digest: document.digest ?? null, authentic: origin.authentic, results, evaluated, follows };
}

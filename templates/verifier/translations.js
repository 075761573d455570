// Texts of the report in the language of the document: entries hold arguments, as those of the pages.
const TEXTS = "@texts@", ARGUMENT = /\{([nxt])\d*\}/g;

// Function that gives a text in a language; a text without an entry stays as it is.
function buildTranslator(language) {
  const entries = TEXTS[language] ?? {}, kinds = { n: "([-−+]?\\d[\\d.]*(?:e[-−+]?\\d+)?)", x: "(.+?)", t: "(.+?)" };
  const patterns = Object.keys(entries).filter((key) => key.match(ARGUMENT)).map((key) => {
    const parts = key.split(ARGUMENT).map((part, i) => (i % 2 ? kinds[part] : part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")));
    return { key, names: key.match(ARGUMENT), expression: new RegExp(`^${parts.join("")}$`), letters: key.replace(ARGUMENT, "").length };
  });
  patterns.sort((a, b) => b.letters - a.letters);
  return function translate(text) {
    const core = text.replace(/\.$/, ""), stop = text.slice(core.length);
    if (text in entries || core in entries) return entries[text] ?? `${entries[core]}${stop}`;
    for (const { key, names, expression } of patterns) {
      const match = expression.exec(core), fill = (name, kind) => {
        const part = match[names.indexOf(name) + 1];
        return kind === "t" ? translate(part) : part;
      };
      if (match) return `${entries[key].replace(ARGUMENT, fill)}${stop}`;
    }
    const sentences = text.split(/(?<=[.:]) (?=\S)/);
    return sentences.length > 1 ? sentences.map(translate).join(" ") : text;
  };
}

// Printed words of the verdicts and steps, and names of the quantities.
const PRINTED = "@words@", LABELS = "@labels@";
const WORDS = Object.fromEntries(Object.entries(PRINTED.verdict).map(([name, { word }]) => [name, word]));

// Mark of a verdict on criteria as on a page: a pass with a value close to a limit is CLOSE.
const markRows = (verdict, rows) =>
  WORDS[verdict === "pass" && rows.some((row) => row.verdict === "pass" && row.close?.length) ? "close" : verdict] ?? verdict;

// Mark of the verdict of a run: of the values that decide in its cases, and in the required steps of a dossier.
function markRun({ verdict, cases, procedure, information, requested, verification_only: only }) {
  const decides = (result, name) => requested.includes(name) && !(name === "criteria" && only.includes(result.id));
  const rows = cases.filter(({ id }) => !information.includes(id)).flatMap((result) => [
    ...result.criteria.filter((row) => isDrift(row) || decides(result, "criteria")),
    ...(decides(result, "verification") ? result.verification?.criteria ?? [] : []),
  ]);
  const steps = (procedure?.steps ?? []).filter((step) => step.required);
  return markRows(verdict, [...rows, ...steps.flatMap((step) => step.criteria ?? [])]);
}

// Results or moving pictures embedded in the page, and the figures that show curves of them.

/** Results of the report, the content of results.json, or the moving pictures of a line in place of its cases. */
const results = JSON.parse((document.getElementById("pantocheck-results") ?? document.getElementById("pantocheck-scenes")).textContent);

/** What a moving picture without pantographs does not have, and what that of a passage does not state. */
const NO_CASE = { traces: {}, uplift: [], criteria: [], run: { evaluated_m: null }, speed: 0.1, gain: 5 };

/** Case of the results, or moving pictures of a line, that a figure belongs to. */
function caseOf(figure) {
  return { ...NO_CASE, ...results.cases[Number(figure.dataset.case)] };
}

/** Anchor-like name of a case for a file: letters, digits, dots and hyphens. */
function fileName(shownCase, ...parts) {
  return [shownCase.id, ...parts].join("-").replace(/[^A-Za-z0-9.]+/g, "-").slice(0, 80);
}

/** A number with four significant digits and a true minus sign; an en dash for no number. */
function formatNumber(value, digits = 4) {
  return value === null || value === undefined ? "–" : String(Number(value.toPrecision(digits))).replace("-", "−");
}

// Results embedded in the page, and the figures that show curves of them.

/** Results of the report: the content of results.json. */
const results = JSON.parse(document.getElementById("pantocheck-results").textContent);

/** Case of the results that a figure belongs to. */
function caseOf(figure) {
  return results.cases[Number(figure.dataset.case)];
}

/** Anchor-like name of a case for a file: letters, digits, dots and hyphens. */
function fileName(shownCase, ...parts) {
  return [shownCase.id, ...parts].join("-").replace(/[^A-Za-z0-9.]+/g, "-").slice(0, 80);
}

/** A number with four significant digits and a true minus sign; an en dash for no number. */
function formatNumber(value, digits = 4) {
  return value === null || value === undefined ? "–" : String(Number(value.toPrecision(digits))).replace("-", "−");
}

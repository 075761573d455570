// Sorting and filtering of tables. The rows of a page stay complete: on paper, filtered rows are shown again.

/** Number of rows from which a table can be sorted and filtered; criteria can be from two rows. */
const MANY_ROWS = 10;

/** Verdicts from the worst to the best. */
const VERDICTS = ["error", "fail", "undecided", "skip", "info", "unconfirmed", "close", "pass"];

/** Verdict shown in a part of a page; undefined without one. */
function verdictOf(part) {
  const mark = part.querySelector(".verdict");
  return VERDICTS.find((verdict) => mark?.classList.contains(verdict));
}

/** Key by which a cell is sorted: rank of its verdict, its first number, or its text; null for a dash. */
function sortKey(cell) {
  const verdict = verdictOf(cell);
  if (verdict) return VERDICTS.indexOf(verdict);
  const text = cell.textContent.trim();
  if (text === "" || text === "–") return null;
  const number = parseFloat(text.replaceAll("−", "-").replace(/^[±≤≥=\s]+/, ""));
  return Number.isNaN(number) ? text : number;
}

/** Order of two keys: numbers by size, before texts by the alphabet; without a key last, in either direction. */
function compareKeys(first, second, direction) {
  if (first === null || second === null) return (first === null) - (second === null);
  const kinds = (typeof first === "string") - (typeof second === "string");
  if (kinds) return kinds;
  return direction * (typeof first === "string" ? first.localeCompare(second, "en") : first - second);
}

/** Sort the rows of a table by a column; the direction 0 restores the order of the report. */
function sortRows(rows, column, direction) {
  const keyed = rows.map((row) => [row, sortKey(row.cells[column])]);
  if (direction) keyed.sort(([, first], [, second]) => compareKeys(first, second, direction));
  rows[0].parentElement.append(...keyed.map(([row]) => row));
}

/** Make the headings of a table buttons that sort it: ascending, descending, order of the report. */
function addSorting(table, rows) {
  const headings = [...table.tHead.rows[0].cells];
  const directions = { none: "ascending", ascending: "descending", descending: "none" };
  const signs = { none: 0, ascending: 1, descending: -1 };
  table.classList.add("sortable");
  headings.forEach((heading, column) => {
    const button = element("button", { type: "button", class: "sort" }, ...heading.childNodes);
    heading.append(button);
    heading.setAttribute("aria-sort", "none");
    button.addEventListener("click", () => {
      const direction = directions[heading.getAttribute("aria-sort")];
      for (const other of headings) other.setAttribute("aria-sort", "none");
      heading.setAttribute("aria-sort", direction);
      sortRows(rows, column, signs[direction]);
    });
  });
}

/** Verdicts in the cells of a row with their words: a row of a matrix has several. */
function verdictsOfRow(row) {
  const cells = [...row.cells].filter((cell) => verdictOf(cell));
  return new Map(cells.map((cell) => [verdictOf(cell), cell.querySelector(".verdict").lastChild.textContent.trim()]));
}

/** Selection of a verdict; null for a table whose rows do not differ in it. */
function verdictSelection(rows, label) {
  const marks = new Map(rows.flatMap((row) => [...verdictsOfRow(row)]));
  if (marks.size < 2) return null;
  const options = [...marks].map(([verdict, word]) => element("option", { value: verdict }, word));
  return element("select", { "aria-label": fill(translate("Verdict, {t}"), { t: label }) }, element("option", { value: "" }, translate("all verdicts")), ...options);
}

/** Fields of the columns that offer a choice, with a function that tells whether a row fits: a value, or a date in a period. */
function columnChoices(table, rows, label) {
  return [...table.tHead.rows[0].cells].flatMap((heading, column) => {
    const { choice } = heading.dataset;
    const texts = choice ? rows.map((row) => row.cells[column].textContent.trim()) : [];
    const values = [...new Set(texts)].filter(Boolean).sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
    if (values.length < 2) return [];
    const name = heading.textContent;
    const described = { "aria-label": `${name}, ${label}` };
    const field = choice === "date"
      ? element("input", { type: "date", ...described })
      : element("select", described, element("option", { value: "" }, "–"), ...values.map((value) => element("option", { value }, value)));
    const fits = (row) => {
      const [first, last = first] = row.cells[column].textContent.trim().split(" to ");
      return choice === "date" ? first <= field.value && field.value <= last : row.cells[column].textContent.trim() === field.value;
    };
    return [{ field, part: element("label", {}, `${name} `, field), fits }];
  });
}

/** Put fields above a table that leave only the rows with a text, a verdict and the choices of columns. */
function addFilter(table, rows) {
  const label = table.getAttribute("aria-label");
  const field = element("input", { type: "search", placeholder: translate("Filter rows"), "aria-label": fill(translate("Filter rows, {t}"), { t: label }) });
  const selection = verdictSelection(rows, label);
  const choices = columnChoices(table, rows, label);
  const count = element("output", { role: "status" });
  const filter = () => {
    const words = field.value.toLowerCase().split(/\s+/);
    const chosen = choices.filter((choice) => choice.field.value);
    const left = rows.filter((row) => {
      const text = row.textContent.toLowerCase();
      const fits = words.every((word) => text.includes(word)) && (!selection?.value || verdictsOfRow(row).has(selection.value)) && chosen.every((choice) => choice.fits(row));
      row.classList.toggle("filtered", !fits);
      return fits;
    });
    count.value = left.length < rows.length ? fill(translate("{n} of {n2} rows"), { n: left.length, n2: rows.length }) : "";
  };
  for (const control of [field, selection, ...choices.map((choice) => choice.field)]) control?.addEventListener("input", filter);
  table.parentElement.before(element("div", { class: "tools" }, ...[field, selection, ...choices.map(({ part }) => part), count].filter(Boolean)));
}

for (const table of document.querySelectorAll("table")) {
  const rows = [...table.tBodies[0].rows];
  if (rows.length < (table.matches(".cards, .values") ? 2 : MANY_ROWS)) continue;
  addSorting(table, rows);
  addFilter(table, rows);
}

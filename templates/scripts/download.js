// Curves and quantities as files with comma-separated values, made on this machine from the results in the page.

/** A field of a file with comma-separated values; empty for no value. */
function csvField(value) {
  const text = value === null || value === undefined ? "" : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Text of a table with a row of headings. */
function csvText(headings, rows) {
  return [headings, ...rows].map((row) => row.map(csvField).join(",") + "\n").join("");
}

/** Offer a text as a file to the reader. */
function saveFile(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** Quantities of all cases with their uncertainties; a quantity with several values has a row for each. */
function quantityRows() {
  return results.cases.flatMap((shownCase) =>
    Object.entries(shownCase.quantities).flatMap(([owner, quantities]) =>
      Object.entries(quantities).flatMap(([name, value]) => {
        const width = shownCase.uncertainty[owner]?.[name];
        if (!Array.isArray(value)) return [[shownCase.id, owner, name, "", value, width]];
        return value.map((item, i) => [shownCase.id, owner, name, i + 1, item, Array.isArray(width) ? width[i] : width]);
      }),
    ),
  );
}

/** Button that saves a table; the rows are made when it is pressed. */
function saveButton(label, name, headings, makeRows) {
  const button = element("button", { type: "button" }, label);
  button.addEventListener("click", () => saveFile(`${name}.csv`, csvText(headings, makeRows())));
  return button;
}

const QUANTITY_HEADINGS = ["case", "pantograph", "quantity", "item", "value", "uncertainty"];

document
  .querySelector("main > header")
  .after(
    element("div", { class: "tools" }, saveButton(translate("Quantities as CSV"), "quantities", QUANTITY_HEADINGS, quantityRows)),
  );

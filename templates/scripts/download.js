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

/** Button that saves a table; the rows are made when it is pressed. */
function saveButton(label, name, headings, makeRows) {
  const button = element("button", { type: "button" }, label);
  button.addEventListener("click", () => saveFile(`${name}.csv`, csvText(headings, makeRows()), "text/csv"));
  return button;
}

// Report on an identification: modes are accepted or rejected, and the choice is saved as a plan of the next one.

/** Text of a plan: an accepted pole is kept, a rejected one is dropped. */
function planText(choices) {
  const tables = choices.map(
    ({ frequency, ratio, accepted }) =>
      `[[pole]]\nfrequency_Hz = ${frequency}\ndamping_ratio = ${ratio}\naction = "${accepted ? "keep" : "drop"}"\n`,
  );
  return ["# pantocheck drop identify RECORD --plan plan.toml --out FOLDER\n", ...tables].join("\n");
}

/** Frequency [Hz] and damping ratio of a row of the table of modes, by its headings. */
function readMode(row, headings) {
  const [frequency, percent] = ["f [Hz]", "ζ [%]"].map((name) => parseFloat(row.cells[headings.indexOf(name)].textContent));
  return { frequency, ratio: Number((percent / 100).toPrecision(6)) };
}

for (const table of document.querySelectorAll("table")) {
  if (table.caption?.textContent !== "Modes by frequency") continue;
  const headings = [...table.tHead.rows[0].cells].map((cell) => cell.textContent.trim());
  const rows = [...table.tBodies[0].rows];
  const boxes = rows.map((row, i) => {
    const box = element("input", { type: "checkbox", checked: "", "aria-label": `Accept mode ${i + 1}` });
    row.cells[0].prepend(box, " ");
    return box;
  });
  const button = element("button", { type: "button" }, "Accepted modes as plan.toml");
  button.addEventListener("click", () => {
    const choices = rows.map((row, i) => ({ ...readMode(row, headings), accepted: boxes[i].checked }));
    const address = URL.createObjectURL(new Blob([planText(choices)], { type: "application/toml" }));
    element("a", { href: address, download: "plan.toml" }).click();
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
  });
  table.parentElement.before(element("div", { class: "tools" }, button));
}

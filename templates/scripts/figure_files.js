// Figures and tables as files, made on this machine.

/** Offer a text as a file to the reader. */
function saveFile(name, text, type) {
  const address = URL.createObjectURL(new Blob([text], { type }));
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

document.querySelectorAll("figure").forEach((figure, number) => {
  const drawing = figure.querySelector(":scope > div > svg");
  if (!drawing) return;
  const button = element("button", { type: "button", class: "save" }, translate("Figure as SVG"));
  button.addEventListener("click", () => {
    const name = figure.id || `figure-${number + 1}`;
    saveFile(`${name}.svg`, `<?xml version="1.0" encoding="utf-8"?>\n${new XMLSerializer().serializeToString(drawing)}`, "image/svg+xml");
  });
  figure.querySelector("figcaption").append(" ", button);
});

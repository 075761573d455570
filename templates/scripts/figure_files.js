// Figures and the data behind them as files, made on this machine.

/** Bytes of a base64 text that zlib has compressed. */
async function inflate(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Offer a text as a file to the reader. */
function saveFile(name, text, type) {
  const address = URL.createObjectURL(new Blob([text], { type }));
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** Text of a drawing without the data that it carries. */
function writeDrawing(drawing) {
  const copy = drawing.cloneNode(true);
  copy.removeAttribute("data-points");
  return `<?xml version="1.0" encoding="utf-8"?>\n${new XMLSerializer().serializeToString(copy)}`;
}

document.querySelectorAll("figure").forEach((figure, number) => {
  const drawing = figure.querySelector(":scope > div > svg");
  if (!drawing) return;
  const name = figure.id || `figure-${number + 1}`;
  const addLink = (label, act) => {
    const button = element("button", { type: "button", class: "save" }, label);
    button.addEventListener("click", act);
    figure.querySelector("figcaption").append(" ", button);
  };
  addLink(translate("Figure as SVG"), () => saveFile(`${name}.svg`, writeDrawing(drawing), "image/svg+xml"));
  const { points } = drawing.dataset;
  if (points) addLink(translate("Data as CSV"), async () => saveFile(`${name}.csv`, new TextDecoder().decode(await inflate(points)), "text/csv"));
});

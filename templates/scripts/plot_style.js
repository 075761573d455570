// Colours of plots, from the style sheet, so that they follow the light or dark scheme.

/** Dashes of curves, so that they differ without colour. */
const DASHES = [[], [7, 3], [2, 2], [9, 3, 2, 3]];

/** Number of colours of curves in the style sheet. */
const COLOURS = 6;

/** Colours that were read before, by the name of their variable, for the present scheme. */
const colours = new Map();
onSchemeChange(() => colours.clear());

/** Colour of the style sheet by the name of its variable. */
function colour(name) {
  if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  return colours.get(name);
}

/** Colour and dash of the n-th of several equal curves. */
function curveStyle(number) {
  const dash = Math.floor(number / COLOURS) % DASHES.length;
  return { colour: `curve-${(number % COLOURS) + 1}`, dash: DASHES[dash] };
}

/** Axis of a plot. */
function axis(label, size) {
  return {
    label,
    size,
    labelSize: 22,
    font: "12px system-ui, sans-serif",
    labelFont: "13px system-ui, sans-serif",
    stroke: () => colour("ink"),
    grid: { stroke: () => colour("line"), width: 1 },
    ticks: { stroke: () => colour("line"), width: 1 },
    values: (_, ticks) => ticks.map((tick) => formatNumber(tick, 6)),
  };
}

/** Call a function whenever the reader's system changes between the light and the dark scheme, until the returned one is called. */
function onSchemeChange(redraw) {
  const scheme = matchMedia("(prefers-color-scheme: dark)");
  scheme.addEventListener("change", redraw);
  return () => scheme.removeEventListener("change", redraw);
}

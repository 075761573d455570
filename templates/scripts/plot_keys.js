// Keys and the mouse on a plot.

/** Bind the keys of a plot that has the focus. */
function bindKeys(plot) {
  plot.area.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (step && event.shiftKey) plot.pan(step * PAN_SHARE);
    else if (step) readNextValue(plot, step);
    else if (event.key === "+" || event.key === "=") plot.zoom(ZOOM_FACTOR);
    else if (event.key === "-") plot.zoom(1 / ZOOM_FACTOR);
    else if (event.key === "Home" || event.key === "0") plot.showAll();
    else return;
    event.preventDefault();
  });
}

/** Move the cursor by some points and tell the values there; at the edge of the stretch, move the stretch too. */
function readNextValue(plot, step) {
  const { x } = plot.content;
  const [start, end] = plot.stretch;
  const index = plot.canvas.cursor.idx ?? plot.canvas.valToIdx((start + end) / 2);
  const next = Math.min(Math.max(index + step, 0), x.length - 1);
  if (x[next] < start || x[next] > end) plot.pan(step * PAN_SHARE);
  plot.afterDrawing(() => {
    plot.moveCursor(next);
    plot.announce(plot.legend.describeValues());
  });
}

/** Drag of the mouse with the shift key: it moves the stretch; without the key, the drag of uPlot selects one. */
function bindDrag(plot, canvas, _, select) {
  return (event) => {
    if (!event.shiftKey) return select(event);
    let last = event.clientX;
    const move = ({ clientX }) => {
      plot.pan((last - clientX) / canvas.over.clientWidth);
      last = clientX;
    };
    addEventListener("mousemove", move);
    addEventListener("mouseup", () => removeEventListener("mousemove", move), { once: true });
    return undefined;
  };
}

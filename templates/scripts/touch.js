// Touch on a plot: one finger moves the stretch sideways, two fingers zoom; up and down still scroll the page.

/** Bind the fingers on a plot to its stretch. */
function bindTouch(plot) {
  const area = plot.canvas.over;
  const fingers = new Map();
  const centre = (places) => places.reduce((sum, place) => sum + place, 0) / places.length;
  const spread = (places) => Math.max(...places) - Math.min(...places);
  area.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "touch") fingers.set(event.pointerId, event.clientX);
  });
  area.addEventListener("pointermove", (event) => {
    if (!fingers.has(event.pointerId)) return;
    const before = [...fingers.values()];
    fingers.set(event.pointerId, event.clientX);
    const after = [...fingers.values()];
    if (after.length > 1 && spread(before) > 0 && spread(after) > 0) {
      const place = plot.canvas.posToVal(centre(after) - area.getBoundingClientRect().left, "x");
      plot.zoom(spread(after) / spread(before), place);
    }
    plot.pan((centre(before) - centre(after)) / area.clientWidth);
  });
  for (const end of ["pointerup", "pointercancel", "pointerleave"]) {
    area.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
}

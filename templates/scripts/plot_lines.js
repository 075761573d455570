// Vertical lines of a plot: supports or edges of bands, and the mark of a place with its text.

/** Draw a vertical line; its place on the canvas is returned. */
function drawLine(canvas, place, name, dash) {
  const { ctx, bbox } = canvas;
  const x = canvas.valToPos(place, "x", true);
  ctx.beginPath();
  ctx.setLineDash(dash.map((length) => length * devicePixelRatio));
  ctx.strokeStyle = colour(name);
  ctx.lineWidth = devicePixelRatio;
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  return x;
}

/** Draw the mark of a place, with its text on the side that has room. */
function drawMark(canvas, { place, text }) {
  const { ctx, bbox } = canvas;
  const x = drawLine(canvas, place, "curve-2", []);
  const right = x > bbox.left + bbox.width / 2;
  ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.fillStyle = colour("ink");
  ctx.textAlign = right ? "right" : "left";
  ctx.fillText(text, x + (right ? -6 : 6), bbox.top + 14 * devicePixelRatio);
}

/** Draw inside of the axes of a plot. */
function drawInside({ ctx, bbox }, act) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  act();
  ctx.restore();
}

/** Draw the lines and the mark of a plot, and the names of its limits, over its curves. */
function drawLines({ canvas, content, mark }) {
  drawInside(canvas, () => {
    for (const place of content.lines ?? []) drawLine(canvas, place, "soft", [2, 4]);
    for (const limit of content.levels ?? []) writeLimit(canvas, limit);
    if (mark) drawMark(canvas, mark);
  });
}

/** Draw the limits of a plot below its curves: the ground between two limits, and a dashed line at each. */
function drawLimits({ canvas, content }) {
  const { ctx, bbox } = canvas;
  drawInside(canvas, () => {
    for (const { lower, upper } of content.levels ?? []) {
      const [low, high] = [lower, upper].map((value) => canvas.valToPos(value, "y", true));
      ctx.fillStyle = colour("pale");
      ctx.fillRect(bbox.left, high, bbox.width, low - high);
      ctx.strokeStyle = colour("soft");
      ctx.lineWidth = devicePixelRatio;
      ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
      for (const y of new Set([low, high])) {
        ctx.beginPath();
        ctx.moveTo(bbox.left, y);
        ctx.lineTo(bbox.left + bbox.width, y);
        ctx.stroke();
      }
    }
  });
}

/** Write the name of a limit at the right end, on a piece of paper that hides the curves below it. */
function writeLimit({ ctx, bbox, valToPos }, { lower, upper, text }) {
  const y = (valToPos(lower, "y", true) + valToPos(upper, "y", true)) / 2;
  ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
  const [width, height] = [ctx.measureText(text).width + 6 * devicePixelRatio, 15 * devicePixelRatio];
  const right = bbox.left + bbox.width - 4 * devicePixelRatio;
  ctx.fillStyle = colour("paper");
  ctx.fillRect(right - width, y - height / 2, width, height);
  ctx.fillStyle = colour("ink");
  ctx.textAlign = "right";
  ctx.textBaseline = "middle";
  ctx.fillText(text, right - 3 * devicePixelRatio, y);
  ctx.textBaseline = "alphabetic";
}

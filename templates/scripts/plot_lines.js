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

/** Draw the lines and the mark of a plot inside of its axes. */
function drawLines({ canvas, content, mark }) {
  const { ctx, bbox } = canvas;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const place of content.lines ?? []) drawLine(canvas, place, "soft", [2, 4]);
  if (mark) drawMark(canvas, mark);
  ctx.restore();
}

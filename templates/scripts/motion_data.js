// Coded fields of the moving picture of a line, see `motion_format.py`.

/** Number of a missing value. */
const MISSING = -32768;

/** Values of a coded field, frame by frame; NaN: missing. */
async function decodeField({ frames, columns, step, data }) {
  const halves = await inflate(data);
  const count = frames * columns;
  const numbers = new Int16Array(count);
  for (let frame = 0; frame < frames; frame++) {
    let sum = 0;
    for (let column = 0; column < columns; column++) {
      const i = frame * columns + column;
      const signed = halves[i] | (halves[count + i] << 8);
      sum += (signed >>> 1) ^ -(signed & 1);
      numbers[i] = sum + (frame ? numbers[i - columns] : 0);
    }
  }
  return { frames, columns, values: Float32Array.from(numbers, (number) => (number === MISSING ? NaN : step * number)) };
}

/** Value of a field between two frames; the nearest one if the other is missing. */
function readField(field, frame, column) {
  const first = Math.min(Math.max(Math.floor(frame), 0), field.frames - 1);
  const last = Math.min(first + 1, field.frames - 1);
  const [before, after] = [first, last].map((row) => field.values[row * field.columns + column]);
  const share = frame - first;
  return Number.isNaN(after) || share <= 0 ? before : before + share * (after - before);
}

/** Value of a curve between its points; null outside of them. */
function interpolate(x, y, at) {
  let low = 0;
  let high = x.length - 1;
  if (at < x[low] || at > x[high]) return null;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (x[middle] <= at) low = middle;
    else high = middle;
  }
  return y[low] + ((y[high] - y[low]) * (at - x[low])) / (x[high] - x[low]);
}

/** Curve of a wire at rest as a function of the position [m]; outside of it its last height. */
function restHeight(curve) {
  return (place) => interpolate(curve.x_m, curve.y_m, Math.min(Math.max(place, curve.x_m[0]), curve.x_m.at(-1)));
}

/** Moving picture on a line with its fields decoded: wires, droppers and pantographs as functions of the frame. */
async function decodePassage(shownCase) {
  const { motion, line_shape: shape } = shownCase;
  const wires = await Promise.all(
    motion.wires.map(async (wire) => {
      const curve = shape.side.curves[wire.curve];
      return { kind: curve.kind, curve, x: wire.x_m, rest: restHeight(curve), rise: await decodeField(wire.rise_mm) };
    }),
  );
  const nearest = (place, height) =>
    wires
      .filter((wire) => place >= wire.x[0] - 1 && place <= wire.x.at(-1) + 1)
      .sort((first, second) => Math.abs(first.rest(place) - height) - Math.abs(second.rest(place) - height))[0];
  const { x_m: places, lower_m: lower, upper_m: upper } = shape.side.droppers;
  const droppers = places
    .map((x, i) => ({ x, lower: nearest(x, lower[i]), upper: nearest(x, upper[i]), column: motion.dropper_m.findIndex((d) => Math.abs(d - x) < 0.03) }))
    .filter((dropper) => dropper.lower && dropper.upper);
  const points = shape.side.points.map((point) => ({ ...point, wire: nearest(point.x_m, point.y_m) }));
  const slack = motion.slack && (await decodeField(motion.slack));
  const pantographs = await Promise.all(
    motion.pantographs.map(async (part) => ({
      ...part,
      height: await decodeField(part.height_mm),
      force: await decodeField(part.force_N),
      band: part.band_N && (await decodeField(part.band_N)),
    })),
  );
  for (const part of pantographs) part.rest = meanClosings(part.height);
  return { ...motion, shape, wires, droppers, points, slack, pantographs, frames: wires[0].rise.frames };
}

/** Mean height of each mass over the head [mm]. */
function meanClosings({ frames, columns, values }) {
  return Array.from({ length: columns }, (_, column) => {
    let sum = 0;
    for (let frame = 0; frame < frames; frame++) sum += values[frame * columns + column] - values[(frame + 1) * columns - 1];
    return sum / frames;
  });
}

/** Rise of a wire at a place [m, m]. */
function riseAt(wire, frame, place) {
  const { x } = wire;
  let low = 0;
  let high = x.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (x[middle] <= place) low = middle;
    else high = middle;
  }
  const share = Math.min(Math.max((place - x[low]) / (x[high] - x[low]), 0), 1);
  return ((1 - share) * readField(wire.rise, frame, low) + share * readField(wire.rise, frame, high)) / 1000;
}

// Curves of the spans of a section, laid over each other from the support at the start of each span.

/** Points of a span on its common axis. */
const POINTS_PER_SPAN = 240;

/**
 * Curves of the complete spans of a section.
 *
 * @param {number[]} position Positions of the samples along the track [m].
 * @param {number[]} force Force at these positions [N].
 * @param {number[]} supports Positions of the supports [m].
 * @returns {{distance: number[], spans: {start: number, end: number, force: (number|null)[]}[]}} Distances from the
 *   support at the start of a span [m], and the force of each span there [N]; a shorter span ends with null.
 */
function laySpans(position, force, supports) {
  const sorted = [...supports].sort((first, second) => first - second);
  const slack = 2 * ((position.at(-1) - position[0]) / position.length);
  const spans = sorted
    .slice(1)
    .map((end, i) => ({ start: sorted[i], end }))
    .filter(({ start, end }) => start >= position[0] - slack && end <= position.at(-1) + slack);
  const longest = Math.max(0, ...spans.map(({ start, end }) => end - start));
  const distance = Array.from({ length: POINTS_PER_SPAN + 1 }, (_, i) => (longest * i) / POINTS_PER_SPAN);
  for (const span of spans) {
    span.force = distance.map((d) => (span.start + d > span.end ? null : interpolate(position, force, span.start + d)));
  }
  return { distance, spans };
}

// Signals of a record: unpacked samples, filters, statistics, bands, and all quantities and curves that follow.
const EXTENDED_HZ = 50, RATE_SHARE = 0.4, SAME_CUTOFF = 0.001, RUN_OUT_M = 5, UPLIFT_M = 60, SUPPORT_M = 0.5;
const BANDS = [[0, 5, "rms_0_5_N"], [5, 20, "rms_5_20_N"], [20, 50, "rms_20_50_N"]];
const OUTSIDE = ["mean_force_N", "std_force_N", "std_force_50_N", "max_force_N", "min_force_N", "contact_loss_pct"];
const UPLIFT = "max_uplift_at_support_mm", MOST_POINTS = 1500, MOST_SAMPLES = 500000;

const FORCE_NAMES = "mean_force|std_force(_50)?|rms_\\d+_\\d+|statistical_m..|m.._force|contact_loss|longest_contact_loss";
const SIGNAL_NAME = new RegExp(`^(${FORCE_NAMES}|contact_height_range|long_contact_loss|arc_share|max_uplift_at_support)` +
  "(_outside_overlaps)?_(N|mm|pct|s)$|^cov_[25]0$|^contact_loss_events$");

class Unavailable extends Error {}
class Damaged extends Error {}

async function unpack(packed) {
  const bytes = fromBase64(packed.data), n = packed.samples;
  const shuffled = await inflate(bytes, 8 * n + 1).catch((error) => {
    throw new Damaged(`the samples cannot be unpacked (${error.message})`);
  });
  if (bytes.length !== packed.packed_bytes || shuffled.length !== 8 * n) {
    throw new Damaged(`${n} samples in ${packed.packed_bytes} bytes stated, but the data have others`);
  }
  const ordered = new Uint8Array(8 * n);
  for (let i = 0; i < n; i++) for (let k = 0; k < 8; k++) ordered[8 * i + k] = shuffled[k * n + i];
  const numbers = new BigUint64Array(ordered.buffer);
  let first = 0n, second = 0n;
  for (let i = 0; i < n; i++) {
    first = BigInt.asUintN(64, first + ((numbers[i] >> 1n) ^ -(numbers[i] & 1n)));
    second = BigInt.asUintN(64, second + first);
    numbers[i] = second;
  }
  const digest = await sha256(ordered);
  if (digest !== null && digest !== packed.sha256) throw new Damaged("the samples do not have the stated SHA-256");
  return new Float64Array(ordered.buffer);
}

// Filters.
function singleRun(filter, rate) {
  const runs = filter.phase === "zero" ? 2 : 1, attenuation = filter.attenuation_dB ?? 3;
  const gain = attenuation === 3 ? Math.SQRT2 : 2;
  const edge = (gain ** (2 / runs) - 1) ** (runs / (2 * filter.order));
  return { runs, order: Math.floor(filter.order / runs), edge: runs === 1 && attenuation === 3 ? 1 : edge };
}

// Sections [b0, b1, b2, a1, a2] of one run of a low-pass, by the bilinear transform of each pair of poles.
function lowPass(filter, rate) {
  const { order, edge } = singleRun(filter, rate), k = Math.tan((Math.PI * filter.cutoff_Hz) / rate) / edge;
  const sections = order % 2 ? [[k / (1 + k), k / (1 + k), 0, (k - 1) / (1 + k), 0]] : [];
  for (let i = 0; i < Math.floor(order / 2); i++) {
    const a = 2 * Math.sin((Math.PI * (2 * i + 1)) / (2 * order)), d = 1 + a * k + k * k;
    sections.push([(k * k) / d, (2 * k * k) / d, (k * k) / d, (2 * (k * k - 1)) / d, (1 - a * k + k * k) / d]);
  }
  return sections;
}

// Sections of one run of a band-pass: each pole p of the low-pass gives the roots of s^2 - p w s + l h = 0.
function bandPass(filter, rate, low) {
  const { order, edge } = singleRun(filter, rate);
  const [l, h] = [low, filter.cutoff_Hz].map((f) => Math.tan((Math.PI * f) / rate)), w = (h - l) / edge;
  const sections = [];
  for (let i = 0; i < order; i++) {
    const angle = (Math.PI * (2 * i + 1 + order)) / (2 * order), p = [w * Math.cos(angle) / 2, w * Math.sin(angle) / 2];
    const re = p[0] * p[0] - p[1] * p[1] - l * h, im = 2 * p[0] * p[1], size = Math.hypot(re, im);
    const root = [Math.sqrt((size + re) / 2), Math.sign(im || 1) * Math.sqrt((size - re) / 2)];
    for (const sign of [1, -1]) {
      const s = [p[0] + sign * root[0], p[1] + sign * root[1]];
      if (s[1] < -1e-15) continue;  // the other one of a pair
      if (Math.abs(s[1]) <= 1e-15) throw new Unavailable("a band-pass with real poles is not supported");
      const d = (1 - s[0]) ** 2 + s[1] ** 2, z = [(1 - s[0] ** 2 - s[1] ** 2) / d, (2 * s[1]) / d];
      sections.push([1, 0, -1, -2 * z[0], z[0] ** 2 + z[1] ** 2]);
    }
  }
  // The gain is 1 at the geometric mean of the edges on the warped axis.
  const centre = 2 * Math.atan(Math.sqrt(l * h)), cos = [Math.cos(centre), Math.cos(2 * centre)];
  const sin = [Math.sin(centre), Math.sin(2 * centre)];
  let gain = [1, 0];
  for (const [b0, b1, b2, a1, a2] of sections) {
    const up = [b0 + b1 * cos[0] + b2 * cos[1], -(b1 * sin[0] + b2 * sin[1])];
    const down = [1 + a1 * cos[0] + a2 * cos[1], -(a1 * sin[0] + a2 * sin[1])], d = down[0] ** 2 + down[1] ** 2;
    const ratio = [(up[0] * down[0] + up[1] * down[1]) / d, (up[1] * down[0] - up[0] * down[1]) / d];
    gain = [gain[0] * ratio[0] - gain[1] * ratio[1], gain[0] * ratio[1] + gain[1] * ratio[0]];
  }
  for (let i = 0; i < 3; i++) sections[0][i] /= gain[0];
  return sections;
}

// One run over a signal whose past is constant at its first sample.
function runSections(sections, signal) {
  let y = signal, level = signal[0];
  for (const [b0, b1, b2, a1, a2] of sections) {
    const settled = (level * (b0 + b1 + b2)) / (1 + a1 + a2), out = new Float64Array(y.length);
    let z2 = b2 * level - a2 * settled, z1 = b1 * level - a1 * settled + z2;
    for (let i = 0; i < y.length; i++) {
      const x = y[i], value = b0 * x + z1;
      z1 = b1 * x - a1 * value + z2;
      z2 = b2 * x - a2 * value;
      out[i] = value;
    }
    [y, level] = [out, settled];
  }
  return y;
}

function applyFilter(filter, signal, rate, low = 0) {
  if (filter.cutoff_Hz > RATE_SHARE * rate) throw new Unavailable("the sampling rate is too low for the filter");
  const sections = low ? bandPass(filter, rate, low) : lowPass(filter, rate), n = signal.length;
  if (filter.phase === "causal") return runSections(sections, signal);
  const pad = Math.min(n - 1, Math.ceil((2 * rate) / (low || filter.cutoff_Hz)));
  const extended = new Float64Array(n + 2 * pad);
  extended.set(signal, pad);
  for (let i = 0; i < pad; i++) {
    extended[i] = 2 * signal[0] - signal[pad - i];
    extended[n + pad + i] = 2 * signal[n - 1] - signal[n - 2 - i];
  }
  const back = runSections(sections, runSections(sections, extended).reverse()).reverse();
  return back.slice(pad, pad + n);
}

function filterOnce(filter, force, rate, applied) {
  if (applied !== null && applied <= (1 + SAME_CUTOFF) * filter.cutoff_Hz) {
    if (applied < (1 - SAME_CUTOFF) * filter.cutoff_Hz) throw new Unavailable("the force was filtered before delivery");
    return force;
  }
  return applyFilter(filter, force, rate);
}

// Discrete Fourier transform of any length (Bluestein), as real and imaginary parts.
function transform(signal) {
  const n = signal.length, m = 2 ** Math.ceil(Math.log2(2 * n - 1));
  const make = () => [new Float64Array(m), new Float64Array(m)], a = make(), b = make();
  const cos = new Float64Array(n), sin = new Float64Array(n);
  for (let i = 0, square = 0; i < n; square = (square + 2 * i + 1) % (2 * n), i++) {
    [cos[i], sin[i]] = [Math.cos((Math.PI * square) / n), Math.sin((Math.PI * square) / n)];
    [a[0][i], a[1][i]] = [signal[i] * cos[i], -signal[i] * sin[i]];
    for (const j of i ? [i, m - i] : [0]) [b[0][j], b[1][j]] = [cos[i], sin[i]];
  }
  radix2(...a);
  radix2(...b);
  for (let i = 0; i < m; i++) {
    [a[0][i], a[1][i]] = [a[0][i] * b[0][i] - a[1][i] * b[1][i], -(a[0][i] * b[1][i] + a[1][i] * b[0][i])];
  }
  radix2(...a);  // of the conjugate: the inverse transform
  const re = new Float64Array(n), im = new Float64Array(n);
  for (let i = 0; i < n; i++) {
    const [x, y] = [a[0][i] / m, -a[1][i] / m];
    [re[i], im[i]] = [x * cos[i] + y * sin[i], y * cos[i] - x * sin[i]];
  }
  return [re, im];
}

function radix2(re, im) {
  const n = re.length;
  for (let i = 1, j = 0; i < n; i++) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) [re[i], re[j], im[i], im[j]] = [re[j], re[i], im[j], im[i]];
  }
  for (let size = 2; size <= n; size *= 2) {
    for (let k = 0; k < size / 2; k++) {
      const angle = (-2 * Math.PI * k) / size, c = Math.cos(angle), s = Math.sin(angle);
      for (let i = k; i < n; i += size) {
        const j = i + size / 2, x = re[j] * c - im[j] * s, y = re[j] * s + im[j] * c;
        [re[j], im[j], re[i], im[i]] = [re[i] - x, im[i] - y, re[i] + x, im[i] + y];
      }
    }
  }
}

// Statistics.
const mean = (x) => x.reduce((sum, value) => sum + value, 0) / x.length;
const deviation = (x, m = mean(x)) => Math.sqrt(x.reduce((sum, value) => sum + (value - m) ** 2, 0) / x.length);
const largest = (x) => x.reduce((most, value) => Math.max(most, value), -Infinity);
const smallest = (x) => x.reduce((least, value) => Math.min(least, value), Infinity);

function findLosses(force) {
  const losses = [];
  for (let i = 0; i < force.length; i++) {
    if (force[i] > 0) continue;
    const start = i;
    while (i + 1 < force.length && force[i + 1] <= 0) i++;
    losses.push([start, i + 1]);
  }
  return losses;
}

const lowerBound = (x, value) => {
  let [low, high] = [0, x.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
};

// Signals of one pantograph over an analysis section; a missing one throws `Unavailable`.
class PantographSignals {
  constructor(part, samples, filter, section) {
    Object.assign(this, part, { rate: samples.rate_Hz, filter, section, shortest: samples.shortest_loss_s ?? null });
    const x = part.position, step = x.reduce((most, _, i) => (i ? Math.max(most, x[i] - x[i - 1]) : 0), 0);
    const [start, end] = section;
    this.covered = x[0] <= start + step && x[x.length - 1] >= end - step;
    this.inside = [lowerBound(x, start - 1e-9), lowerBound(x, end - 1e-9)];
    this.kept = null;
    this.cache = new Map();
  }
  cut(channel) {
    if (!this.covered) throw new Unavailable("the record does not cover the analysis section");
    const part = channel.slice(...this.inside);
    return this.kept ? part.filter((_, i) => this.kept[i]) : part;
  }
  leaveOut(stretches) {
    const other = Object.assign(Object.create(PantographSignals.prototype), this);
    other.kept = this.position.slice(...this.inside).map((x) => (stretches.some(([a, b]) => a <= x && x < b) ? 0 : 1));
    return other;
  }
  get delivered() { return this.cut(this.force); }
  filtered(cutoff) {
    const [first, last] = this.inside;
    const seconds = this.kept ? mean(this.kept) * (last - first) / this.rate : (last - first) / this.rate;
    const whole = (last - first) / this.rate;
    if (Math.min(whole, this.kept ? whole : seconds) < 4 / cutoff) throw new Unavailable("the section is too short");
    if (!this.cache.has(cutoff)) {
      this.cache.set(cutoff, filterOnce({ ...this.filter, cutoff_Hz: cutoff }, this.force, this.rate, this.applied));
    }
    return this.cut(this.cache.get(cutoff));
  }
  get graded() { return this.filtered(this.filter.cutoff_Hz); }
  get extended() { return this.filtered(EXTENDED_HZ); }
  get power() {
    if (!this.cache.has("power")) {
      const force = this.delivered, m = mean(force), [re, im] = transform(force.map((value) => value - m));
      const lines = Math.floor(force.length / 2) + 1;
      this.cache.set("power", Array.from({ length: lines }, (_, i) => 2 * (re[i] ** 2 + im[i] ** 2) / force.length ** 2));
    }
    return this.cache.get("power");
  }
  band(low, high) {
    if (this.kept) throw new Unavailable("a band needs one uninterrupted stretch");
    const n = this.delivered.length, seconds = n / this.rate;
    if (high > RATE_SHARE * this.rate || (high - low) * seconds < 4) throw new Unavailable("the band is not observable");
    if (this.applied !== null && this.applied < (1 - SAME_CUTOFF) * high) throw new Unavailable("filtered");
    if ((this.filter.bands ?? "spectral lines") === "spectral lines") {
      const inside = (i) => (i * this.rate) / n > low && (i * this.rate) / n <= high;
      return Math.sqrt(this.power.reduce((sum, value, i) => (inside(i) ? sum + value : sum), 0));
    }
    const filter = { ...this.filter, cutoff_Hz: high };
    if (this.applied !== null && this.applied <= (1 + SAME_CUTOFF) * high) throw new Unavailable("filtered");
    return deviation(this.cut(applyFilter(filter, this.force, this.rate, low)));
  }
  unfiltered() {
    this.extended;  // a rate for 50 Hz
    if (this.applied !== null) throw new Unavailable("contact losses need the unfiltered force");
    return this.delivered;
  }
  ratio(value) {
    const m = mean(this.delivered);
    if (m <= 0) throw new Unavailable("no mean force");
    return value / m;
  }
  quantities() {
    const found = {}, seconds = (loss) => (loss[1] - loss[0]) / this.rate, of = {
      mean_force_N: () => mean(this.delivered),
      std_force_N: () => deviation(this.graded),
      std_force_50_N: () => deviation(this.extended),
      cov_20: () => this.ratio(deviation(this.graded)),
      cov_50: () => this.ratio(deviation(this.extended)),
      ...Object.fromEntries(BANDS.map(([low, high, name]) => [name, () => {
        if (high > 20) this.extended;
        return this.band(low, high);
      }])),
      statistical_max_N: () => mean(this.delivered) + 3 * deviation(this.graded),
      statistical_min_N: () => mean(this.delivered) - 3 * deviation(this.graded),
      max_force_N: () => largest(this.graded),
      min_force_N: () => smallest(this.graded),
      contact_loss_pct: () => 100 * mean(this.unfiltered().map((value) => (value <= 0 ? 1 : 0))),
      longest_contact_loss_s: () => Math.max(0, ...findLosses(this.unfiltered()).map(seconds)),
      contact_loss_events: () => findLosses(this.unfiltered()).length,
      contact_height_range_mm: () => {
        if (!this.height) throw new Unavailable("no contact height");
        const height = this.cut(this.height);
        return 1e3 * (largest(height) - smallest(height));
      },
    };
    if (this.shortest !== null) {
      of.long_contact_loss_pct = () => {
        const force = this.unfiltered(), long = findLosses(force).filter((l) => seconds(l) >= this.shortest * (1 - 1e-9));
        return (100 * long.reduce((sum, [a, b]) => sum + b - a, 0)) / force.length;
      };
    }
    if (this.arcs) {
      of.arc_share_pct = () => {
        const [arcs, loaded] = [this.cut(this.arcs), this.cut(this.loaded)];
        if (![...arcs, ...loaded].every(Number.isFinite) || !loaded.some((x) => x)) throw new Unavailable("no arcs");
        return (100 * mean(arcs.map((x, i) => x * loaded[i]))) / mean(loaded);
      };
    }
    for (const [name, compute] of Object.entries(of)) {
      try {
        const value = compute();
        if (Number.isFinite(value) && Math.abs(value) <= 1e15) found[name] = value;
      } catch (error) {
        if (!(error instanceof Unavailable)) throw error;
      }
    }
    return found;
  }
}

async function unpackSignals(samples) {
  const optional = async (packed) => (packed ? unpack(packed) : null), pantographs = {};
  const check = (values) => {
    if (!values.every((value) => Math.abs(value) <= 1e9)) throw new Damaged("a sample is missing or impossible");
    return values;
  };
  for (const [key, part] of Object.entries(samples.pantographs)) {
    const position = check(await unpack(part.position_m));
    if (!position.every((x, i) => !i || x > position[i - 1])) {
      throw new Damaged("the positions of a pantograph do not increase");
    }
    pantographs[key] = {
      position, force: check(await unpack(part.force_N)), height: await optional(part.contact_height_m),
      arcs: await optional(part.arcs), loaded: await optional(part.loaded), applied: part.filter_applied_Hz,
    };
  }
  const supports = [], last = await optional(samples.last_position_m);
  for (const part of samples.uplift) {
    const own = part.last_position_m ? check(await unpack(part.last_position_m)) : last;
    supports.push({ x: part.support_m, first: part.first, uplift: await unpack(part.uplift_m), last: own });
  }
  return { pantographs, supports, time: await optional(samples.time_s) };
}

// Largest uplift that counts, with its support and sample; null if it is not available.
function findUplift(samples, signals, [start, end]) {
  const within = (x) => x >= start - SUPPORT_M && x <= end + SUPPORT_M;
  const inside = signals.supports.filter((support) => {
    const known = support.uplift.filter(Number.isFinite);
    return within(support.x) && known.length && largest(known) > smallest(known);
  });
  const counted = ({ x, first, uplift, last }) => uplift.filter((_, i) => last[first + i] <= x + UPLIFT_M);
  if (!inside.length || !samples.line_supports_m || inside.some((s) => !counted(s).every(Number.isFinite))) return null;
  const missing = samples.line_supports_m.filter(within).some((x) => !inside.some((s) => Math.abs(s.x - x) <= SUPPORT_M));
  if (missing || inside.some((s) => !(s.last[s.last.length - 1] >= s.x + RUN_OUT_M))) return null;
  let best = null;
  for (const support of inside) {
    counted(support).forEach((value, i) => {
      if (!best || value > best.value) best = { value, x: support.x, sample: support.first + i };
    });
  }
  return best;
}

// Quantities by owner over an analysis section.
function evaluateSignals(samples, signals, filter, section) {
  const found = {}, parts = {};
  for (const [key, part] of Object.entries(signals.pantographs)) {
    parts[key] = new PantographSignals(part, samples, filter, section);
    const excluded = samples.excluded_m ?? [], overlaps = samples.overlaps_m ?? [];
    found[key] = (excluded.length ? parts[key].leaveOut(excluded) : parts[key]).quantities();
    if (overlaps.some(([a, b]) => a < section[1] && b > section[0])) {
      const values = parts[key].leaveOut(overlaps).quantities();
      for (const name of OUTSIDE) {
        if (name in values) found[key][name.replace(/_([^_]*)$/, "_outside_overlaps_$1")] = values[name];
      }
    }
  }
  const uplift = signals.supports.length ? findUplift(samples, signals, section) : null;
  if (signals.supports.length) found["0"] = uplift ? { [UPLIFT]: 1e3 * uplift.value } : {};
  return { found, parts, uplift };
}

// Curves: short, rounded series.
const thin = (x) => {
  const step = Math.max(1, Math.ceil(x.length / MOST_POINTS));
  return Array.from(x).filter((_, i) => i % step === 0).map(round6);
};

function buildTraces(signals, supports) {
  const force = signals.delivered, position = signals.cut(signals.position), n = force.length;
  let graded = null;
  try { graded = signals.graded; } catch (error) { if (!(error instanceof Unavailable)) throw error; }
  let drawn = force.map((_, i) => i);
  if (n > 10 * MOST_POINTS) {
    const step = Math.ceil(n / (MOST_POINTS / 2)), chosen = new Set();
    for (let i = 0; i < n; i += step) {
      const part = force.slice(i, i + step);
      for (const extreme of [smallest(part), largest(part)]) chosen.add(i + part.indexOf(extreme));
    }
    drawn = [...chosen].sort((a, b) => a - b);
  }
  const pick = (x) => thin(Array.from(drawn, (i) => x[i]));
  const highest = Math.min(EXTENDED_HZ, RATE_SHARE * signals.rate, signals.applied || Infinity);
  let lines = signals.power.map((value, i) => [(i * signals.rate) / n, Math.sqrt(2 * value)]);
  lines = lines.filter(([frequency]) => frequency > 0 && frequency <= highest);
  const step = Math.max(1, Math.ceil(lines.length / MOST_POINTS)), peaks = [];
  for (let i = 0; i < lines.length; i += step) {
    peaks.push(lines.slice(i, i + step).reduce((best, line) => (line[1] > best[1] ? line : best)));
  }
  const [start, end] = signals.section;
  return {
    position_m: pick(position), force_N: pick(force), force_20_N: graded && pick(graded),
    mean_N: mean(force), std_N: graded && deviation(graded),
    supports_m: supports.filter((x) => x >= start - SUPPORT_M && x <= end + SUPPORT_M),
    spectrum: { frequency_Hz: thin(peaks.map((p) => p[0])), amplitude_N: thin(peaks.map((p) => p[1])) },
    histogram: graded && buildHistogram(graded),
  };
}

function buildHistogram(force) {
  const low = smallest(force), high = largest(force), raw = Math.max(high - low, 1) / 30;
  const decade = 10 ** Math.floor(Math.log10(raw)), width = decade * [1, 2, 5, 10].find((s) => s * decade >= raw * (1 - 1e-9));
  const first = Math.floor(low / width), count = Math.floor(high / width) + 1 - first;
  const edges = Array.from({ length: count + 1 }, (_, i) => (first + i) * width), share = new Array(count).fill(0);
  for (const value of force) {
    let i = Math.min(count - 1, Math.max(0, Math.floor(value / width) - first));
    while (i > 0 && value < edges[i]) i--;
    while (i < count - 1 && value >= edges[i + 1]) i++;
    share[i] += 100 / force.length;
  }
  return { edges_N: edges.map(round6), share_pct: share.map(round6) };
}

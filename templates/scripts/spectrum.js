// Amplitude spectrum of a part of a force curve, by the definition of the report.

/** Upper edge of the extended band [Hz]. */
const HIGHEST_HZ = 50;

/** Highest known frequency as a share of the sampling rate, as in the report. */
const HIGHEST_SHARE_OF_RATE = 0.4;

/** Fewest samples of a spectrum. */
const FEWEST_SAMPLES = 16;

/** Largest deviation of a step between samples from the mean one: positions are rounded, a curve of extremes is not even. */
const EVEN_SHARE = 0.2;

/** Mean step of a series [its unit], or null if its steps differ. */
function evenStep(series) {
  const step = (series.at(-1) - series[0]) / (series.length - 1);
  const even = series.every((value, i) => i === 0 || Math.abs(value - series[i - 1] - step) <= EVEN_SHARE * step);
  return even ? step : null;
}

/**
 * Single-sided amplitude spectrum of a force about its mean, as `amplitude_spectrum` of the suite.
 *
 * The sums of the Fourier transform are written out: a few hundred lines of at most some thousand samples.
 *
 * @param {number[]} force Force [N].
 * @param {number} step Time between two samples [s].
 * @returns {{frequency: number[], amplitude: number[]}} Frequencies above 0 [Hz] and amplitudes [N].
 */
function amplitudeSpectrum(force, step) {
  const mean = force.reduce((sum, value) => sum + value, 0) / force.length;
  const highest = Math.min(HIGHEST_HZ, HIGHEST_SHARE_OF_RATE / step);
  const frequency = [];
  const amplitude = [];
  for (let line = 1; line / (force.length * step) <= highest * (1 + 1e-9); line++) {
    let real = 0;
    let imaginary = 0;
    for (let i = 0; i < force.length; i++) {
      const angle = (2 * Math.PI * ((line * i) % force.length)) / force.length;
      real += (force[i] - mean) * Math.cos(angle);
      imaginary -= (force[i] - mean) * Math.sin(angle);
    }
    frequency.push(line / (force.length * step));
    amplitude.push((2 * Math.hypot(real, imaginary)) / force.length);
  }
  return { frequency, amplitude };
}

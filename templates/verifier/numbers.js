// Numbers and texts: tolerance, formats of Python, digests, and JSON text written as Python writes it.
const EXACT = 1e-9, ROUNDED = 2e-5;

const sameNumber = (a, b, tolerance = EXACT) => {
  if (a === null || a === undefined || b === null || b === undefined) return (a ?? null) === (b ?? null);
  return a === b || Math.abs(a - b) <= Math.max(tolerance * Math.max(Math.abs(a), Math.abs(b)), tolerance);
};

// Number as Python's format "g" with so many significant digits.
function formatG(value, digits) {
  if (value === null || value === undefined) return "nothing";
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "nan" : value > 0 ? "inf" : "-inf";
  if (value === 0) return Object.is(value, -0) ? "-0" : "0";
  const [mantissa, power] = value.toExponential(digits - 1).split("e");
  const exponent = Number(power), strip = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  if (exponent >= -4 && exponent < digits) return strip(value.toFixed(Math.max(0, digits - 1 - exponent)));
  return `${strip(mantissa)}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
}

const exact = (value) => formatG(value, 10);
const round6 = (value) => Number(value.toPrecision(6));
const isTable = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

// Differences of two trees of numbers and texts; a number in a list is compared relative to the largest of the list.
function compareTrees(stated, computed, tolerance, path = "", scale = null) {
  const place = (key) => (path ? `${path}, ${key}` : String(key));
  if (isTable(stated) && isTable(computed)) {
    return [...new Set([...Object.keys(stated), ...Object.keys(computed)])].flatMap((key) => {
      if (!(key in computed)) return [`${place(key)}: stated, but does not follow from the embedded signals`];
      if (!(key in stated)) return [`${place(key)}: missing in the document`];
      return compareTrees(stated[key], computed[key], tolerance, place(key));
    });
  }
  if (Array.isArray(stated) && Array.isArray(computed)) {
    if (stated.length !== computed.length) return [`${path}: ${stated.length} values stated, ${computed.length} follow`];
    const largest = computed.reduce((most, x) => (typeof x === "number" ? Math.max(most, Math.abs(x)) : most), 0) || 1;
    return computed.flatMap((value, i) => compareTrees(stated[i], value, tolerance, place(`value ${i + 1}`), largest));
  }
  if (typeof stated === "number" && typeof computed === "number") {
    const change = Math.abs(stated - computed) / (scale ?? (Math.abs(computed) || 1));
    const agree = stated === computed || change <= tolerance;
    return agree ? [] : [`${path}: ${exact(stated)} stated, ${exact(computed)} follows from the embedded signals`];
  }
  return (stated ?? null) === (computed ?? null) ? [] : [`${path}: '${stated}' stated, '${computed}' follows`];
}

const shorten = (lines) => (lines.length > 12 ? [...lines.slice(0, 12), `and ${lines.length - 12} more`] : lines);

async function sha256(bytes) {
  if (!globalThis.crypto?.subtle) return null;  // some browsers offer no digests to a local file
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes));
  return `sha256:${[...digest].map((byte) => byte.toString(16).padStart(2, "0")).join("")}`;
}

async function inflate(bytes, limit) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate")).getReader();
  const parts = [];
  for (let size = 0; ; ) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > limit) throw new Error("the data are larger than stated");
    parts.push(value);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

const fromBase64 = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0));

// Attachment of a certificate, written from its data block: numbers keep their digits, the times are null.
function writeAttachment(text) {
  const token = /\s*("(?:[^"\\]|\\.)*"|[{}[\],:]|[^\s{}[\],:"]+)/gy;
  const next = () => {
    const match = token.exec(text);
    if (!match) throw new Error("the data block is no JSON text");
    return match[1];
  };
  const restore = (name) => name.replace(/\\u00(3c|3e|26)/g, (_, code) => String.fromCharCode(parseInt(code, 16)));
  const write = (first, path) => {
    const indent = "\n" + " ".repeat(path.length + 1), end = "\n" + " ".repeat(path.length);
    if (first === "{" || first === "[") {
      const parts = [], close = first === "{" ? "}" : "]";
      let key = next();
      while (key !== close) {
        if (first === "{") {
          next();
          parts.push(`${restore(key)}: ${write(next(), [...path, key])}`);
        } else parts.push(write(key, [...path, 0]));
        key = next();
        if (key === ",") key = next();
      }
      return parts.length ? `${first}${indent}${parts.join("," + indent)}${end}${close}` : first + close;
    }
    const name = path.join(" ");
    return name === '"started"' || name === '"cases" 0 "run" "wall_s"' ? "null" : restore(first);
  };
  return `${write(next(), [])}\n`;
}

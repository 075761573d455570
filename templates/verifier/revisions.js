// Revisions of a PDF: each one behind the first must add one signature, and nothing else.
const FIELD_KEYS = "Type Subtype FT T TU V F Ff Rect P AP".split(" "), FORM_KEYS = ["Fields", "SigFlags"];
const CHANGED_KEYS = { catalog: ["AcroForm", "Extensions", "Version"], page: ["Annots"], form: FORM_KEYS };
const BOXES = ["51,812,209,834", "218,812,376,834", "386,812,544,834"], MOST_SIGNATURES = 50;
const BLANK = String.raw`(?:[\s\0]|%[^\r\n]*)*`;
const TOKEN = new RegExp(
  String.raw`${BLANK}(<<|>>|[\[\]()]|<[0-9A-Fa-f\s]*>|\d+\s+\d+\s+R(?![^\s\0()<>[\]{}/%])|/?[^\s\0()<>[\]{}/%]+|/)`, "y");

// Object at a place of a PDF: dictionaries as maps, lists as arrays, anything else as its text; and its end.
function parseObject(text, start) {
  let place = start;
  const next = () => {
    TOKEN.lastIndex = place;
    const token = TOKEN.exec(text)?.[1];
    if (token === undefined) throw new Error("an object is damaged");
    place = TOKEN.lastIndex;
    return token;
  };
  const collect = (end, depth) => {
    const items = [];
    for (let token = next(); token !== end; token = next()) items.push(read(token, depth + 1));
    return items;
  };
  const read = (token, depth) => {
    if (depth > 60) throw new Error("too deeply nested");
    if (token === "<<") {
      const items = collect(">>", depth), found = new Map();
      for (let i = 0; i < items.length; i += 2) {
        const key = String(items[i]).slice(1);
        if (found.has(key) || i + 1 === items.length) throw new Error("a dictionary is damaged");
        found.set(key, items[i + 1]);
      }
      return found;
    }
    if (token === "[") return collect("]", depth);
    if (token !== "(") return token.replace(/\s+/g, " ");
    const from = place;
    for (let open = 1; open; place++) {
      if (place >= text.length) throw new Error("a text is damaged");
      if (text[place] === "\\") place++;
      else open += { "(": 1, ")": -1 }[text[place]] ?? 0;
    }
    const escaped = (_, code, other) => (code ? String.fromCharCode(parseInt(code, 8)) : other);
    return `(${text.slice(from, place - 1).replace(/\\(?:([0-7]{1,3})|([^]))/g, escaped)})`;
  };
  return { value: read(next(), 0), end: place };
}

const freeze = (value) => JSON.stringify(value, (_, item) => (item instanceof Map ? Object.fromEntries([...item].sort()) : item));
const sameObject = (a, b) => freeze(a ?? null) === freeze(b ?? null);

// Table, trailer and end of one revision; the objects of a revision lie inside of it.
function readRevision(text, from, end) {
  const place = Number(/startxref\s+(\d+)\s+%%EOF\s*$/.exec(text.slice(from, end))[1]), entries = new Map();
  if (place < from || place >= end || !/^xref\s/.test(text.slice(place, place + 6))) throw new Error("a table of objects is missing");
  let at = place + 4;
  for (let head; (head = /^\s*(\d+) (\d+)\s+/.exec(text.slice(at, at + 40))); ) {
    at += head[0].length;
    for (let i = 0; i < Number(head[2]); i++, at += 20) {
      const entry = /^(\d{10}) (\d{5}) ([nf])/.exec(text.slice(at, at + 20));
      if (!entry) throw new Error("a table of objects is damaged");
      entries.set(Number(head[1]) + i, { offset: Number(entry[1]), generation: Number(entry[2]), used: entry[3] === "n" });
    }
  }
  const word = /^\s*trailer/.exec(text.slice(at, at + 40)), trailer = word && parseObject(text, at + word[0].length).value;
  if (!(trailer instanceof Map) || trailer.has("XRefStm") || trailer.has("Encrypt")) throw new Error("a trailer cannot be read");
  return { from, end, place, entries, trailer };
}

// Objects as they are after a revision.
function buildResolver(text, revisions) {
  const cache = new Map();
  const find = (number) => {
    const revision = revisions.findLast(({ entries }) => entries.has(number)), entry = revision?.entries.get(number);
    if (!entry?.used) return undefined;
    const head = new RegExp(String.raw`^${number}\s+${entry.generation}\s+obj`).exec(text.slice(entry.offset, entry.offset + 40));
    if (!head || entry.offset < revision.from || entry.offset >= revision.end) throw new Error(`object ${number} is not at its place`);
    const { value, end } = parseObject(text, entry.offset + head[0].length);
    const stream = /^\s*stream/.test(text.slice(end, end + 40));
    if (stream) return { stream: text.slice(entry.offset, text.indexOf("endstream", end)) };
    if (!/^\s*endobj/.test(text.slice(end, end + 40))) throw new Error(`object ${number} is damaged`);
    return value;
  };
  const resolve = (value) => {
    const reference = typeof value === "string" && /^(\d+) \d+ R$/.exec(value);
    if (!reference) return value;
    const number = Number(reference[1]);
    if (!cache.has(number)) cache.set(number, find(number));
    return cache.get(number);
  };
  const { trailer } = revisions.at(-1), catalog = resolve(trailer.get("Root")), form = resolve(catalog?.get("AcroForm")) ?? new Map();
  return { resolve, trailer, catalog, form, fields: resolve(form.get("Fields")) ?? [] };
}

const joinKeys = (keys) => keys.map((key) => `/${key}`).sort().join(", ");

function* findRedefinitions(old, now, numbers, field) {
  for (const number of numbers) {
    const reference = `${number} 0 R`, [before, after] = [old.resolve(reference), now.resolve(reference)];
    if ([old.trailer.get("Info"), old.catalog.get("Metadata")].includes(reference)) {
      yield "the metadata are changed";
    } else if (Array.isArray(before) && Array.isArray(after)) {
      if (!sameObject(after, [...before, field])) yield "a list of the document is changed";
    } else {
      const kind = !(before instanceof Map) ? "other" : before.has("Fields") ? "form"
        : { "/Catalog": "catalog", "/Page": "page" }[before.get("Type")] ?? "other";
      if (kind === "other" || !(after instanceof Map)) {
        yield "an object of the document is replaced";
        continue;
      }
      const changed = [...new Set([...before.keys(), ...after.keys()])].filter((key) => !sameObject(before.get(key), after.get(key)));
      const others = changed.filter((key) => !CHANGED_KEYS[kind].includes(key));
      if (others.length) yield `${joinKeys(others)} of the ${kind} changed`;
      for (const key of changed.filter((name) => ["Annots", "Fields"].includes(name))) {
        const [items, more] = [old.resolve(before.get(key)) ?? [], now.resolve(after.get(key))];
        if (!sameObject(more, [...items, field])) yield `/${key} of the ${kind} has more than the signature`;
      }
    }
  }
}

// Changes by one revision other than a signature.
function* findProblems(text, old, now, revision) {
  const numbers = [...revision.entries.keys()].sort((a, b) => a - b).filter((number) => number > 0);
  const redefined = numbers.filter((number) => old.resolve(`${number} 0 R`) !== undefined);
  if (numbers.some((number) => !revision.entries.get(number).used)) yield "objects are deleted";
  if (numbers.some((number) => revision.entries.get(number).generation)) throw new Error("an object has a generation");
  for (const [key, name] of [["Root", "catalog"], ["Info", "table of metadata"]]) {
    if (!sameObject(old.trailer.get(key), now.trailer.get(key))) yield `the ${name} is replaced`;
  }
  const added = numbers.filter((number) => !redefined.includes(number)), earlier = text.slice(0, revision.from);
  const open = added.find((number) => new RegExp(String.raw`[\s[]${number}\s+0\s+R\b`).test(earlier));
  if (open) throw new Error(`object ${open} is missing in an earlier revision`);
  if (now.fields.length !== old.fields.length + 1 || !sameObject(now.fields.slice(0, -1), old.fields)) {
    yield "it does not add exactly one signature field";
    return;
  }
  const field = now.fields.at(-1), entries = now.resolve(field), without = (map, keys) => [...map.keys()].filter((key) => !keys.includes(key));
  const [more, foreign] = [without(now.form, FORM_KEYS), without(entries, FIELD_KEYS)];
  if (more.length) yield `the form has ${joinKeys(more)}`;
  if (entries.get("FT") !== "/Sig" || foreign.length) yield `the field has ${joinKeys(foreign) || "another type"}`;
  const [left, bottom, right, top] = now.resolve(entries.get("Rect")).map(Number);
  if ((left !== right || bottom !== top) && !BOXES.includes([left, bottom, right, top].join())) {
    yield "the box of the signature is not at a place that reports leave free";
  }
  yield* findRedefinitions(old, now, redefined, field);
}

// Signature of a revision: the bytes that it covers, its message, and the time that the document states.
function readSignature(bytes, text, { signature, range }, number, end, found) {
  const [start, length, after, rest] = range;
  const gap = text.slice(start + length, after), hex = signature.get("Contents").replace(/\s/g, "");
  const add = (problem) => found.push(`signature ${number}: ${problem}`);
  if (start !== 0 || !/^<[0-9A-Fa-f]*>$/.test(gap) || gap.toLowerCase() !== hex.toLowerCase()) add("it does not cover everything but itself");
  else if (after + rest !== end) add("it does not cover its whole revision");
  if ((signature.get("Type") ?? "/Sig") !== "/Sig") add("it is a time stamp of the document, which is not checked");
  const covered = new Uint8Array(length + rest);
  covered.set(bytes.subarray(0, length));
  covered.set(bytes.subarray(after, after + rest), length);
  const date = /^\(D:(\d{4})(\d\d)(\d\d)(\d\d)(\d\d)(\d\d)(?:([+-]\d\d)'(\d\d))?/.exec(signature.get("M") ?? "");
  const time = date && new Date(`${date.slice(1, 4).join("-")}T${date.slice(4, 7).join(":")}${date[7] ?? "+00"}:${date[8] ?? "00"}`);
  return { content: covered, message: Uint8Array.from(hex.slice(1, -1).match(/../g) ?? [], (byte) => parseInt(byte, 16)), time };
}

// Signatures of a PDF in the order of signing, and its other changes.
function readRevisions(bytes) {
  const text = latin(bytes), changes = [], signatures = [], revisions = [];
  for (const match of text.matchAll(/startxref\s+\d+\s+%%EOF(\r\n|\n|\r)?/g)) {
    revisions.push(readRevision(text, revisions.at(-1)?.end ?? 0, match.index + match[0].length));
  }
  revisions.forEach(({ trailer }, i) => {
    if (trailer.get("Prev") !== (i ? String(revisions[i - 1].place) : undefined)) throw new Error("the revisions do not follow each other");
  });
  const states = revisions.map((_, i) => buildResolver(text, revisions.slice(0, i + 1))), { resolve, fields } = states.at(-1);
  const listed = fields.map((field) => resolve(resolve(field).get("V"))).filter(Boolean)
    .map((signature) => ({ signature, range: resolve(signature.get("ByteRange")).map(Number) }));
  listed.sort((a, b) => a.range[2] - b.range[2]);
  const count = listed.length;
  if (count > MOST_SIGNATURES) throw new Error(`${count} signatures; at most ${MOST_SIGNATURES} are checked`);
  if (revisions.length !== count + 1) changes.push(`${revisions.length - 1} revisions were added to the document, ${count} of them by a signature`);
  for (let i = 1; i < revisions.length; i++) {
    const problems = [...findProblems(text, states[i - 1], states[i], revisions[i])];
    changes.push(...problems.map((problem) => `revision ${i} of the document is more than a signature: ${problem}`));
  }
  const { end } = revisions.at(-1);
  if (end !== bytes.length) changes.push(`${bytes.length - end} bytes follow the last signature`);
  listed.forEach((item, i) => signatures.push(readSignature(bytes, text, item, i + 1, revisions[i + 1]?.end, changes)));
  return { signatures, changes };
}

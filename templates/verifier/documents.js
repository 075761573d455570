// Documents of unknown origin: results.json, HTML page with a data block, PDF with an attachment.
const latin = (bytes) => {
  let text = "";
  for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
  return text;
};

// Attachment of the first revision of a PDF, and the number of bytes behind this revision.
async function readPdf(bytes) {
  const text = latin(bytes), end = /startxref\s+\d+\s+%%EOF(\r\n|\n|\r)?/.exec(text);
  const length = end ? end.index + end[0].length : text.length, original = text.slice(0, length);
  if (!text.startsWith("%PDF-") || !end) throw new Error("the PDF is damaged");
  const targets = [...original.matchAll(/\/EF\s*<<\s*\/F\s+(\d+)\s+\d+\s+R/g)].filter(({ index }) => {
    const start = original.lastIndexOf(" obj", index), object = original.slice(start, original.indexOf("endobj", index));
    const number = /(\d+) \d+$/.exec(original.slice(Math.max(0, start - 20), start))?.[1];
    const named = new RegExp(`/Names\\s*\\[[^\\]]*[)>]\\s*${number}\\s+\\d+\\s+R`).test(original);  // not removed from the list
    return named && object.replace(/\\(\d{3})/g, (_, code) => String.fromCharCode(parseInt(code, 8))).includes("(results.json)");
  });
  if (targets.length !== 1) throw new Error(`the PDF holds ${targets.length || "no"} attachments named results.json`);
  const head = new RegExp(`[\r\n]${targets[0][1]} \\d+ obj[^]*?stream\r?\n`).exec(original);
  const size = /\/Length\s+(\d+)(?!\s+\d+\s+R)/.exec(head?.[0] ?? ""), from = head && head.index + head[0].length;
  if (!size) throw new Error("the attachment of the PDF cannot be read");
  const raw = bytes.slice(from, from + Number(size[1]));
  const content = /FlateDecode/.test(head[0]) ? await inflate(raw, 64 * 2 ** 20) : raw;
  return { content, added: text.slice(length).trim() ? text.length - length : 0, signed: text.includes("/ByteRange") };
}

const BLOCK = /<script type="application\/json" id="pantocheck-results">([^<>]*)<\/script>/g;

async function readDocument(bytes) {
  const start = latin(bytes.subarray(0, 1024)), beginning = start.replace(/^\xef\xbb\xbf/, "").trimStart().toLowerCase();
  const decode = (content) => new TextDecoder("utf-8", { fatal: true }).decode(content);
  if (start.includes("%PDF-")) {
    const { content, added, signed } = await readPdf(bytes);
    const language = /\/Lang\s*\(([a-z]+)/.exec(latin(bytes))?.[1];
    return { kind: "PDF", language, text: decode(content), added, signed, digest: await sha256(content) };
  }
  if (beginning.startsWith("<!doctype") || beginning.startsWith("<html")) {
    const page = decode(bytes), blocks = [...page.matchAll(BLOCK)];
    if (blocks.length !== 1) throw new Error(`the page holds ${blocks.length || "no"} embedded results`);
    const digest = await sha256(new TextEncoder().encode(writeAttachment(blocks[0][1])));
    return { kind: "HTML", language: /<html lang="(\w+)"/.exec(page)?.[1], text: blocks[0][1], page, digest };
  }
  if (!beginning.startsWith("{")) throw new Error("the file is neither a PDF nor an HTML page nor JSON");
  const text = decode(bytes);
  return { kind: "JSON", text, digest: await sha256(new TextEncoder().encode(writeAttachment(text))) };
}

// English words of a page by their words in the language of the page.
const LANGUAGES = "@languages@";

const findNumbers = (text) =>
  (text.replace(/[\u2009\u00a0]/g, "").match(/[-−+]?\d+(\.\d+)?(e[-+]?\d+)?/gi) ?? []).map((number) => number.replace("−", "-"));

// Whether a printed number is a value, rounded to its last digit.
function isRounded(text, value) {
  const [digits] = findNumbers(text), power = /e/i.test(digits), places = (digits.split(".")[1] ?? "").length;
  const step = power ? Math.abs(Number(digits)) * 0.05 : 10 ** -places;
  return Math.abs(Number(digits) - value) <= step * (0.5 + 1e-6) + 1e-9 * Math.abs(value);
}

// Whether a cell prints one of some values, each of a short list, or the number and the range of a long list.
function isPrinted(text, stated, values) {
  const numbers = findNumbers(text), range = (list) => [list.length, smallest(list), largest(list)];
  const lists = stated.filter((value) => Array.isArray(value) && numbers.length === 3);
  if (lists.some((list) => range(list).every((value, i) => isRounded(numbers[i], value)))) return true;
  const parts = text.split(", ").filter((part) => findNumbers(part).length);
  return parts.every((part) => values.some((value) => value !== null && isRounded(part, value)));
}

// English word of a printed verdict behind its symbol; of a badge, both must belong together.
function readVerdict(text, english) {
  const shown = text.trim(), { symbol, word } = Object.values(PRINTED.verdict).find((mark) =>
    english(shown.slice(mark.symbol.length).trim().toUpperCase()) === mark.word && shown.startsWith(mark.symbol)) ?? {};
  return symbol ? word : english(shown.toUpperCase());
}

// Values and verdicts in the tables of a case, or in that of page 1: rows with the name of a quantity and a cell "Value".
function checkTables(section, result, english) {
  const found = [];
  let count = 0;
  for (const line of section?.querySelectorAll("tr") ?? []) {
    const [, name, item] = /^(.*?)(?:\[(\d+)\])?$/.exec(line.querySelector("th code")?.textContent ?? ""), cells = {};
    for (const cell of line.querySelectorAll("td[data-label]")) cells[english(cell.dataset.label)] = cell.textContent.trim();
    if (!name || (cells.Case !== undefined && !cells.Case.endsWith(result.id)) || cells.Value === undefined || !findNumbers(cells.Value).length) continue;
    const anyone = cells.Pantograph === undefined, owner = /^\d+$/.test(cells.Pantograph ?? "") ? cells.Pantograph : "0";
    const stated = Object.keys(result.quantities).filter((key) => anyone || key === owner)
      .map((key) => result.quantities[key][name]).filter((value) => value !== undefined);
    const values = stated.flatMap((value) => (item ? selectItem(value, Number(item)) : value));
    if (!values.length) continue;
    count += 1;
    if (!isPrinted(cells.Value, item ? [] : stated, values)) {
      const follows = values.length > 6 ? `${values.length} values, ${exact(smallest(values))} to ${exact(largest(values))}`
        : values.map(exact).join(" or ");
      found.push(`${name}: '${cells.Value}' is printed, ${follows} follows from the results`);
    }
    const rows = [...result.criteria, ...(result.verification?.criteria ?? [])]
      .filter((row) => row.quantity === name && (anyone || String(row.pantograph) === owner));
    if (cells.Verdict && rows.length && !rows.some((row) => readVerdict(cells.Verdict, english) === markRows(row.verdict, [row]))) {
      found.push(`${name}: the verdict '${cells.Verdict}' is printed, ${markRows(rows[0].verdict, [rows[0]])} follows from the results`);
    }
  }
  return { found: found.map((text) => `${result.id}, ${text}`), count };
}

// Numbers printed on an HTML page against the results: title, digest, and the tables of graded values.
function checkPage(page, digest, results) {
  const shown = new DOMParser().parseFromString(page, "text/html"), found = [], word = markRun(results);
  const language = LANGUAGES[shown.documentElement.lang] ?? {}, english = (text) => language[text] ?? text;
  const verdicts = [["title", shown.title.split(" – ")[0]], ["heading", shown.querySelector("h1")?.textContent.split(": ").pop() ?? ""]];
  for (const [place, text] of verdicts) {
    if (readVerdict(text, english) !== word) found.push(`the ${place} does not print the verdict ${word}: '${text}'`);
  }
  const facts = [...shown.querySelectorAll("dl div")].map((row) => [...row.children].map((cell) => cell.textContent.trim()));
  const printed = facts.find(([label]) => english(label) === "Digest of the results")?.[1];
  if (digest !== null && printed !== digest) {
    found.push(`the digest of the results is ${printed ?? "not printed"}; computed is ${digest}`);
  }
  const tables = results.cases.flatMap((result, i) => ["result", `case-${i + 1}`].map((anchor) =>
    checkTables(shown.getElementById(anchor)?.closest("section"), result, english)));
  const count = tables.reduce((sum, table) => sum + table.count, 0);
  return { found: [...found, ...tables.flatMap((table) => table.found)], count };
}

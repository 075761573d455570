// Signatures by PKI.js: content, chain of certificates, validity, key usage, time stamp; in the words of `verify`.
const ATTRIBUTES = { stamp: "1.2.840.113549.1.9.16.2.14", time: "1.2.840.113549.1.9.5", role: "0.4.0.19122.1.1" };
const EXTENSIONS = { usage: "2.5.29.15", purposes: "2.5.29.37", limits: "2.5.29.19" };
const NO_ROOT = "no trust root given", NO_CHAIN = "its chain does not lead to a given trust root";
const STAMPING = "1.3.6.1.5.5.7.3.8", PURPOSES = {
  "1.3.6.1.5.5.7.3.1": "server auth", "1.3.6.1.5.5.7.3.3": "code signing", [STAMPING]: "time stamping", "1.3.6.1.5.5.7.3.9": "ocsp signing",
};
const ALGORITHMS = /^(1\.2\.840\.113549\.1\.1\.(1|10|11|12|13)|1\.2\.840\.10045\.4\.3\.[234])$/;  // RSA, PSS, ECDSA with SHA-2
const DIGESTS = /^2\.16\.840\.1\.101\.3\.4\.2\.[123]$/, CURVES = /^(1\.2\.840\.10045\.3\.1\.7|1\.3\.132\.0\.3[45])$/;

class Unchecked extends Error {}

// Bytes of a DER file, or of each block of a PEM file with a label.
function decodeBlocks(bytes, label) {
  const text = latin(bytes), blocks = [...text.matchAll(new RegExp(`-----BEGIN (${label})-----([^-]*)-----END \\1-----`, "g"))];
  return text.includes("-----BEGIN ") ? blocks.map((block) => fromBase64(block[2].replace(/\s/g, ""))) : [bytes];
}

function readRoots(bytes, name) {
  let roots;
  try {
    roots = decodeBlocks(bytes, "CERTIFICATE").map((block) => pkijs.Certificate.fromBER(block));
  } catch {
    throw new Error(`trust roots '${name}': holds a damaged certificate`);
  }
  if (!roots.length) throw new Error(`trust roots '${name}': holds no certificate`);
  return roots;
}

// Signed data without their content; other content than that of the document must not be checked.
function readMessage(bytes) {
  const message = pkijs.ContentInfo.fromBER(bytes.slice());
  if (message.contentType !== pkijs.ContentInfo.SIGNED_DATA) throw new Error("it is no CMS signature");
  return new pkijs.SignedData({ schema: message.content });
}

const cleanText = (text) => text.replace(/[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]/g, "").replace(/[\p{Cc}\s]+/gu, " ").trim();
function readName({ typesAndValues: parts }) {
  const common = parts.find((part) => part.type === "2.5.4.3"), all = parts.map((part) => part.value.valueBlock.value).join(", ");
  const name = cleanText(common?.value.valueBlock.value || all);
  return name.length > 120 ? `${name.slice(0, 119)}…` : name;
}
const formatMoment = (time) => `${time.toISOString().slice(0, 19).replace("T", " ")} UTC`;
const sameBytes = (a, b) => a.length === b.length && a.every((byte, i) => byte === b[i]);
const sameCertificate = (a, b) => sameBytes(a.tbsView, b.tbsView);
const findExtension = (certificate, id) => certificate.extensions?.find((extension) => extension.extnID === id)?.parsedValue;

function findValidityProblem({ notBefore, notAfter }, moment) {
  if (moment < notBefore.value) return `is not valid before ${formatMoment(notBefore.value)}`;
  return moment > notAfter.value ? `expired on ${formatMoment(notAfter.value)}` : "";
}

function findUsageProblem(certificate) {
  const usage = findExtension(certificate, EXTENSIONS.usage), purposes = findExtension(certificate, EXTENSIONS.purposes)?.keyPurposes;
  if (usage && !(usage.valueBlock.valueHexView[0] & 0xc0)) return "lacks the key usage 'digital signature' or 'non repudiation'";
  const foreign = purposes?.every((id) => id in PURPOSES);
  return foreign ? `is for other purposes (${purposes.map((id) => PURPOSES[id]).join(", ")})` : "";
}

function isWeak({ subjectPublicKeyInfo: { algorithm, parsedKey } }) {
  if (algorithm.algorithmId === "1.2.840.113549.1.1.1") return parsedKey.modulus.valueBlock.valueHexView.length < 256;
  if (!CURVES.test(algorithm.algorithmParams?.valueBlock?.toString() ?? "")) throw new Unchecked("the algorithm of a key is not known here");
  return false;
}

// Certificates from the signer to a trust root, or the reason why there is none.
async function findPath(signer, others, roots, moment) {
  const certs = [...others.filter((other) => !sameCertificate(other, signer)), signer];
  if (roots.some((root) => sameCertificate(root, signer))) return { path: [signer] };
  const engine = new pkijs.CertificateChainValidationEngine({ certs, trustedCerts: roots, checkDate: moment });
  const { result, resultCode, certificatePath: path = [] } = await engine.verify({ passedWhenNotRevValues: true });
  for (let i = 1, authority = signer; i < 9 && !result; i++) {
    authority = [...roots, ...others].find((other) => other.subject.isEqual(authority.issuer)) ?? authority;
    const problem = resultCode === 8 && findValidityProblem(authority, moment);
    if (problem) return { problem: `the certificate of the authority ${readName(authority.subject)} ${problem}` };
  }
  // The library checks neither the strength of keys nor the length of a path.
  const limit = (certificate) => findExtension(certificate, EXTENSIONS.limits)?.pathLenConstraint ?? Infinity;
  const long = path.some((certificate, i) => i - 1 > limit(certificate)), invalid = resultCode === 14 || long;
  const isStrong = (certificate) => !isWeak(certificate) && ALGORITHMS.test(certificate.signatureAlgorithm.algorithmId);
  if (result && !long && sameCertificate(path[0], signer) && path.every(isStrong)) return { path };
  return { problem: invalid ? "its chain of certificates is not valid (certificate chain general failure)" : NO_CHAIN };
}

// Role that the signer states in a signed attribute; empty without one.
function readRole(attribute) {
  const search = (node) => {
    if (node.idBlock.tagClass === 3 && node.idBlock.tagNumber === 6 && !node.idBlock.isConstructed) return latin(node.valueBlock.valueHexView);
    return [node.valueBlock.value].flat().filter((item) => item?.idBlock).map(search).find(Boolean);
  };
  try {
    return cleanText(decodeURIComponent(search(attribute.values[0]).replace("urn:pantocheck:role:", "")));
  } catch {
    return "";
  }
}

// Time stamp of a signature: its moment, if its authority leads to a trust root; else the reason.
async function checkStamp(attribute, signature, roots, now) {
  try {
    const stamp = new pkijs.SignedData({ schema: new pkijs.ContentInfo({ schema: attribute.values[0] }).content }), data = signature.slice().buffer;
    const { date, signatureVerified, signerCertificate } = await stamp.verify({ signer: 0, data, extendedMode: true });
    const typed = stamp.encapContentInfo.eContentType === "1.2.840.113549.1.9.16.1.4";
    if (!typed || !signatureVerified) return { problem: "it belongs to other content" };
    const { path } = await findPath(signerCertificate, stamp.certificates, roots ?? [], now);
    const purposes = findExtension(signerCertificate, EXTENSIONS.purposes)?.keyPurposes ?? [];
    if (path && !findValidityProblem(signerCertificate, now) && purposes.includes(STAMPING)) return { moment: date };
    const reason = roots ? "no valid chain to a trust root" : NO_ROOT;
    return { problem: `its authority ${readName(signerCertificate.subject)} is not trusted (${reason})` };
  } catch (error) {
    return { problem: error.signerCertificate ? "it belongs to other content" : "it is damaged" };
  }
}

// One signature of some content; no trust root is known by default.
async function checkSignature(content, signed, number, roots, time) {
  const now = new Date(), info = signed.signerInfos[number], attributes = info.signedAttrs?.attributes ?? [];
  const find = (list, id) => list.find((attribute) => attribute.type === id);
  const facts = { signer: "unknown", issuer: "unknown", role: "", damage: "", distrust: "", root: "", time, checkedAt: now };
  if (signed.encapContentInfo.eContent) return { ...facts, damage: "the signature is damaged (it contains its content)" };
  const known = ALGORITHMS.test(info.signatureAlgorithm.algorithmId) && DIGESTS.test(info.digestAlgorithm.algorithmId);
  if (!known) throw new Unchecked("the algorithm of a signature is weak or not known here");
  let outcome;
  try {
    outcome = await signed.verify({ signer: number, data: content.slice().buffer, extendedMode: true });
  } catch (error) {
    outcome = error;
  }
  const { signerCertificate: certificate, signatureVerified: intact, message } = outcome, others = signed.certificates ?? [];
  if (!certificate) return { ...facts, damage: `the signature is damaged (${cleanText(message)})` };
  isWeak(certificate);
  Object.assign(facts, { signer: readName(certificate.subject), issuer: readName(certificate.issuer), role: readRole(find(attributes, ATTRIBUTES.role)) });
  if (!(intact && attributes.length)) facts.damage = "the content was changed after signing";
  facts.time = find(attributes, ATTRIBUTES.time)?.values[0].toDate?.() ?? time;
  const attribute = find(info.unsignedAttrs?.attributes ?? [], ATTRIBUTES.stamp);
  const stamp = attribute ? await checkStamp(attribute, info.signature.valueBlock.valueHexView, roots, now) : {};
  const moment = stamp.moment ?? now, when = stamp.moment ? "" : " (no trusted time stamp)";
  const validity = findValidityProblem(certificate, moment), usage = findUsageProblem(certificate);
  const { path, problem = "" } = roots && !validity && !usage ? await findPath(certificate, others, roots, moment) : {};
  const late = problem.startsWith("the certificate of the authority") ? when : "";
  facts.distrust = !roots ? NO_ROOT : validity ? `the signing certificate ${validity}${when}` : usage ? `the signing certificate ${usage}` : `${problem}${late}`;
  if (path && !facts.damage) facts.root = readName(path.at(-1).subject);
  return { ...facts, stamped: stamp.moment, stampProblem: stamp.problem, checkedAt: moment };
}

// Signatures inside a PDF and in a signature file, and what they show of the origin of the document.
async function checkOrigin(bytes, document, signatureFile, roots) {
  const facts = [], changes = [], found = [], given = roots !== null;
  let note = "";
  try {
    if (!globalThis.crypto?.subtle) throw new Unchecked("this browser offers no cryptography to a local file");
    if (document.signed) {
      try {
        const revisions = readRevisions(bytes);
        changes.push(...revisions.changes);
        found.push(...revisions.signatures.map((signature) => ({ ...signature, signed: readMessage(signature.message) })));
      } catch (error) {
        changes.push(`its signatures cannot be analysed (${cleanText(error.message)})`);
        found.length = 0;
      }
    }
    if (signatureFile) {
      const signed = readMessage(decodeBlocks(signatureFile, "CMS|PKCS7")[0]), count = signed.signerInfos.length;
      if (count < 1 || count > MOST_SIGNATURES) throw new Error(`the signature file has ${count} signatures`);
      found.push(...signed.signerInfos.map((_, number) => ({ content: bytes, signed, number, time: null })));
    }
    for (const { content, signed, number = 0, time } of found) facts.push(await checkSignature(content, signed, number, roots, time));
  } catch (error) {
    if (!(error instanceof Unchecked)) throw new Error(`the signature file is damaged (${cleanText(error.message)})`);
    note = `signatures were not checked: ${error.message}.`;
  }
  const names = facts.map(({ signer }, i) => `signature ${i + 1} (${signer})`);
  const damages = facts.flatMap(({ damage }, i) => (damage ? [`${names[i]}: ${damage}`] : []));
  const lines = facts.flatMap((part, i) => {
    const { signer, issuer, role, damage, distrust, root, time, stamped, stampProblem } = part, trusted = !damage && !distrust;
    const trust = damage ? `invalid: ${damage}` : distrust ? `not trusted: ${distrust}` : `trusted: its chain leads to ${root}`;
    const stated = time ? `${formatMoment(time)} by the signer's clock` : "no time stated";
    const stamp = stampProblem ? `time stamp not used: ${stampProblem}` : "no time stamp";
    const checked = stamped ? `Time stamp: ${formatMoment(stamped)}; validity was checked at this time.`
      : `Time: ${stated}, ${stamp}; validity was checked at the present time.`;
    return [`signature ${i + 1}: ${trusted ? "signed by" : "claims to be signed by"} ${signer}${role ? ` as ${role}` : ""} (${trust}).`,
      `Signing certificate issued by ${issuer}. ${checked}`];
  });
  if (!facts.length) lines.push(note || "unsigned: nothing shows who made this document.");
  if (!facts.length && !note && given) lines.push("The document has no signature to compare with the trust roots.");
  if (facts.length) lines.push("Revocation of certificates was not checked: verification uses no network.");
  const authentic = facts.length > 0 && !note && !changes.length && facts.every(({ damage, distrust }) => !damage && !distrust);
  return { authentic, changes, damages, note, signers: facts.map(({ signer }) => signer), lines };
}

// Folded sections: all of them stand open on paper, and a link into a folded section opens it.

/** Open every folded section for printing; the sections that were folded are folded again afterwards. */
function unfoldForPrint() {
  const folded = [...document.querySelectorAll("details:not([open])")];
  for (const section of folded) section.open = true;
  window.addEventListener("afterprint", () => folded.forEach((section) => (section.open = false)), { once: true });
}

/** Open the folded sections around the target of the address. */
function unfoldTarget() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (let part = target; part; part = part.parentElement) if (part.localName === "details") part.open = true;
}

window.addEventListener("beforeprint", unfoldForPrint);
window.addEventListener("hashchange", unfoldTarget);
unfoldTarget();

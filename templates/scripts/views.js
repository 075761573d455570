// Views in place of the static figures, and links from criteria to the places of their extremes.

/** Makers of views by the curves of a figure. */
const VIEWS = { force: (figure) => new ForceView(figure), uplift: (figure) => viewUplift(figure), measured: (figure) => viewMeasured(figure), passage: (figure) => new PassageView(figure) };

/** Views of the page by the figures that they stand for. */
const views = new Map();

/** Put a view into its figure; on paper, and by its button, the static figure stands there. */
function addView(figure) {
  const view = VIEWS[figure.dataset.curves](figure);
  const still = element("button", { type: "button", "aria-pressed": "false" }, translate("Static figure"));
  still.addEventListener("click", () => {
    still.setAttribute("aria-pressed", String(!figure.classList.toggle("viewed")));
  });
  const hint = view.hint ?? translate("Drag to zoom, with shift to move; two fingers zoom on a touch screen.");
  const tools = element("div", { class: "tools" }, ...view.tools, still, element("span", { class: "hint" }, hint));
  figure.prepend(tools, element("div", { class: "view" }, ...view.parts));
  figure.classList.add("viewed");
  views.set(figure.id, view);
}

/** Draw views when they come near to the screen: a report of many cases has many. */
const nearScreen = new IntersectionObserver(
  (entries) => entries.filter((entry) => entry.isIntersecting).forEach(({ target }) => drawView(target)),
  { rootMargin: "400px" },
);

/** Draw the view of a figure once. */
function drawView(figure) {
  nearScreen.unobserve(figure);
  const view = views.get(figure.id);
  if (!view.plot.canvas) view.draw();
}

/** Place of a quantity in a case: of its pantograph, or of the line. */
function findPlace(shownCase, owner, quantity) {
  const places = Object.values(shownCase.places ?? {});
  return shownCase.places?.[owner]?.[quantity] ?? places.find((owned) => quantity in owned)?.[quantity];
}

/** Show the place of an extreme when its link in a row or item of criteria is followed, and give its plot the keys. */
function followPlace(link) {
  const figure = document.getElementById(link.hash.slice(1));
  const quantity = link.closest("tr, li").querySelector("code").textContent;
  const place = findPlace(caseOf(figure), figure.dataset.owner, quantity);
  const view = views.get(figure.id);
  location.hash = link.hash;
  if (!view || !place) return;
  drawView(figure);
  figure.scrollIntoView();
  view.showPlace(place, link.textContent, quantity);
  view.plot.area.focus({ preventScroll: true });
}

for (const figure of document.querySelectorAll("figure[data-curves]")) {
  addView(figure);
  nearScreen.observe(figure);
  for (const link of document.querySelectorAll(`:is(td, th, li) a[href="#${figure.id}"]`)) {
    link.addEventListener("click", (event) => {
      event.preventDefault();
      followPlace(link);
    });
  }
}

followInstant();
addEventListener("hashchange", followInstant);

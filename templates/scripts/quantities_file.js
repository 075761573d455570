// Button that saves the quantities of all cases.

/** Quantities of all cases with their uncertainties; a quantity with several values has a row for each. */
function quantityRows() {
  return results.cases.flatMap((shownCase) =>
    Object.entries(shownCase.quantities).flatMap(([owner, quantities]) =>
      Object.entries(quantities).flatMap(([name, value]) => {
        const width = shownCase.uncertainty[owner]?.[name];
        if (!Array.isArray(value)) return [[shownCase.id, owner, name, "", value, width]];
        return value.map((item, i) => [shownCase.id, owner, name, i + 1, item, Array.isArray(width) ? width[i] : width]);
      }),
    ),
  );
}

const QUANTITY_HEADINGS = ["case", "pantograph", "quantity", "item", "value", "uncertainty"];

document
  .querySelector("main > header")
  .after(
    element("div", { class: "tools" }, saveButton(translate("Quantities as CSV"), "quantities", QUANTITY_HEADINGS, quantityRows)),
  );

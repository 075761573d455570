// A view with one plot, its buttons and its file.

/** View of one plot; `table` has the `name`, the `headings` and the rows of its file. */
class CurvesView {
  constructor(content, table) {
    this.plot = new Plot(content);
    this.tools = [...this.plot.makeButtons(), saveButton(translate("Curves as CSV"), table.name, table.headings, table.makeRows)];
    this.parts = [this.plot.element];
  }

  /** Draw the plot. */
  draw() {
    this.plot.draw();
  }
}

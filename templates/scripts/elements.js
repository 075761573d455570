// Making parts of a page.

/** An element with attributes and children; a text becomes a text node, never markup. */
function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** A text with its arguments, such as `{n}`. Writing a page replaces each call of `translate` by the text in its language. */
function fill(text, values) {
  return text.replace(/\{(\w+)\}/g, (_, name) => values[name]);
}

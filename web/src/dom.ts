// The elements of index.html, by id; and the few things done to them everywhere.

/// The element with this id. Throws if the page has none of that kind: then page and script do not match.
export function element<T extends HTMLElement>(id: string, kind: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`the page has no ${kind.name} "${id}"`);
  return found;
}

/// Sets the text, and leaves the document alone if it is the same: screen readers and layout notice.
export function setText(target: Element, text: string): void {
  if (target.textContent !== text) target.textContent = text;
}

/// Shows the text in the element, or hides the element if there is none.
export function showText(target: HTMLElement, text: string): void {
  setText(target, text);
  target.hidden = text === "";
}

// Building the page. Text is always set as text, never as HTML: names of runs may contain anything.

type Child = Node | string | null;
type Attributes = Record<string, string | number | boolean | ((event: never) => void)>;

/// An element with attributes ("onclick" and the like: listeners; false: left out) and children.
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") node.addEventListener(name.slice(2), value as EventListener);
    else if (value !== false) node.setAttribute(name, value === true ? "" : String(value));
  }
  for (const child of children) if (child !== null) node.append(child);
  return node;
}

/// A section of the page, which the navigation names. It can be folded.
export function section(id: string, title: string, ...children: Child[]): HTMLElement {
  return element(
    "details",
    { id, class: "section", open: true },
    element("summary", {}, element("h2", {}, title)),
    ...children,
  );
}

export function button(text: string, title: string, action: () => void, attributes: Attributes = {}): HTMLButtonElement {
  return element("button", { type: "button", title, onclick: action, ...attributes }, text);
}

export function describe(facts: { name: string; value: string }[]): HTMLElement {
  const list = element("dl", { class: "facts" });
  for (const fact of facts) list.append(element("div", {}, element("dt", {}, fact.name), element("dd", {}, fact.value)));
  return list;
}

/// A number for reading: four digits, no exponent where it can be avoided.
export function format(value: number | null | undefined, digits = 4): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(digits - 1).replace("-", "−").replace("e−", "e-");
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(decimals, 6)).replace("-", "−");
}

/// The same for an axis, where zeros at the end only take space.
export function formatTick(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-3 ? value.toExponential() : String(Number(value.toPrecision(6)));
  return text.replace(/^-/, "−");
}

// Tables of runs: sorted by a click on a header, filtered by words, used by keyboard, saved as CSV. A row selects its
// run; a box in it adds the run to those that are compared.
import type { Cell, Table } from "./data";
import { button, element } from "./dom";
import { saveCsv } from "./download";
import { swatch } from "./legend";
import { MOST_COMPARED, type State } from "./state";
import { colourOf, dashOf } from "./theme";

interface Row {
  runs: number[];
  cells: Cell[];
  text: string; // lower case, for the filter
  element: HTMLTableRowElement;
  colour: HTMLElement;
  box: HTMLInputElement | null;
}

function textOf(cell: Cell): string {
  return typeof cell === "string" ? cell : cell.text;
}

/// Numbers by value; what has none is null and goes last.
function sortValue(cell: Cell | undefined, number: boolean): number | string | null {
  if (cell === undefined) return null;
  if (typeof cell !== "string" && typeof cell.value === "number") return cell.value;
  if (!number) return textOf(cell);
  const value = Number(textOf(cell).replace("−", "-"));
  return textOf(cell).trim() === "" || Number.isNaN(value) ? null : value;
}

const collator = new Intl.Collator(undefined, { numeric: true });

function compareCells(a: Cell | undefined, b: Cell | undefined, number: boolean, direction: number): number {
  const [x, y] = [sortValue(a, number), sortValue(b, number)];
  if (x === null || y === null) return Number(x === null) - Number(y === null);
  if (typeof x === "number" && typeof y === "number") return direction * (x - y);
  return direction * collator.compare(String(x), String(y));
}

function cellElement(cell: Cell, number: boolean, first: boolean): HTMLElement {
  const parts: (Node | string)[] = [];
  const text = textOf(cell);
  parts.push(typeof cell !== "string" && cell.best ? element("strong", {}, text) : text);
  if (typeof cell !== "string" && cell.detail) parts.push(" ", element("span", { class: "detail" }, cell.detail));
  const name = /^(lost|failed|degraded)/.exec(text)?.[1];
  return element(first ? "th" : "td", { class: `${number ? "number" : ""} ${name ? `state-${name}` : ""}`, ...(first ? { scope: "row" } : {}) }, ...parts);
}

export function tableElement(state: State, table: Table): HTMLElement {
  const single = table.rows.some((row) => row.runs.length === 1);
  const body = element("tbody");
  const rows = table.rows.map((row): Row => makeRow(state, table, row.runs, row.cells, single));
  body.append(...rows.map((row) => row.element));
  let order = [...rows];
  let sorted: { column: number; direction: number } | null = null;

  const headers = table.columns.map((column, index) => {
    const sort = button(column.header, column.key ? `Sort by ${column.header} (${column.key})` : `Sort by ${column.header}`, () => {
      // First the best on top or the alphabet, then the other way round, then as the report has it.
      sorted = sorted?.column !== index ? { column: index, direction: 1 } : sorted.direction === 1 ? { column: index, direction: -1 } : null;
      const by = sorted;
      order = by ? [...rows].sort((a, b) => compareCells(a.cells[by.column], b.cells[by.column], column.number, by.direction)) : [...rows];
      body.append(...order.map((row) => row.element));
      headers.forEach((header, i) => {
        header.setAttribute("aria-sort", by?.column !== i ? "none" : by.direction === 1 ? "ascending" : "descending");
      });
    });
    return element("th", { scope: "col", "aria-sort": "none", class: column.number ? "number" : "" }, sort);
  });

  const count = element("span", { class: "count", role: "status" });
  const filter = element("input", {
    type: "search",
    placeholder: "filter rows",
    title: "Rows with all words; -word: without it; \"two words\": as they are",
    "aria-label": `Filter the rows of ${table.title}`,
    oninput: () => update(),
  });
  const group = element("span", { class: "group", hidden: true });

  function update(): void {
    const words = wordsOf(filter.value.toLowerCase());
    let shown = 0;
    for (const row of rows) {
      const matches = words.every(({ word, not }) => row.text.includes(word) !== not);
      const grouped = state.group === null || row.runs.some((run) => state.group?.includes(run));
      row.element.hidden = !(matches && grouped);
      if (!row.element.hidden) ++shown;
    }
    count.textContent = shown === rows.length ? `${rows.length} rows` : `${shown} of ${rows.length} rows`;
    group.hidden = state.group === null;
    group.replaceChildren(`Only runs of ${state.groupName} `, button("show all", "Show all rows again", () => state.clearGroup()));
  }

  function mark(): void {
    const shown = state.shown;
    for (const row of rows) {
      const focused = row.runs.includes(state.focus);
      row.element.classList.toggle("focused", focused);
      row.element.setAttribute("aria-selected", String(focused));
      row.element.tabIndex = focused ? 0 : -1;
      const run = row.runs.length === 1 ? (row.runs[0] ?? -1) : -1;
      const slot = shown.indexOf(run);
      row.colour.replaceChildren(...(slot >= 0 ? [swatch(colourOf(slot), dashOf(slot))] : []));
      if (row.box) {
        const foreign = state.payload.runs[run]?.sequence !== state.run?.sequence;
        const full = state.compared.size >= MOST_COMPARED && !state.compared.has(run);
        row.box.checked = state.compared.has(run) || run === state.focus;
        row.box.disabled = run === state.focus || foreign || full;
        row.box.title = foreign
          ? "Of another sequence than the selected run: select this run to draw it"
          : full
            ? `${MOST_COMPARED} runs can be compared at a time`
            : "Draw this run together with the selected one";
      }
    }
    if (!rows.some((row) => row.element.tabIndex === 0) && order[0]) order[0].element.tabIndex = 0;
  }

  body.addEventListener("keydown", (event) => moveByKeys(event, order));
  state.on("selection", () => {
    mark();
    update();
  });
  state.on("theme", mark);
  mark();
  update();

  const save = (): void => {
    const visible = order.filter((row) => !row.element.hidden);
    saveCsv([table.columns.map((column) => column.header), ...visible.map((row) => row.cells.map(csvCell))], table.file);
  };
  return element(
    "div",
    { class: "table-block" },
    element(
      "div",
      { class: "chart-head" },
      element("h3", {}, table.title),
      element("span", { class: "tools" }, filter, count, button("CSV", `Save “${table.title}” as CSV: the rows shown, in this order`, save)),
    ),
    group,
    element(
      "div",
      { class: "scroll", tabindex: -1 },
      element(
        "table",
        { class: "runs", role: "grid", "aria-label": table.title },
        element("thead", {}, element("tr", {}, element("th", { class: "pick" }, element("span", { class: "unseen" }, single ? "compare" : "")), ...headers)),
        body,
      ),
    ),
    single ? element("p", { class: "note screen" }, "Click a row, or Enter: show this run everywhere. Box, or Space: compare it with the selected run.") : null,
    ...table.notes.map((note) => element("p", { class: "note" }, note)),
  );
}

/// Numbers unrounded, with their details in a text only where there is no number.
function csvCell(cell: Cell): string | number | null {
  if (typeof cell === "string") return cell;
  return cell.value ?? (cell.detail ? `${cell.text} ${cell.detail}` : cell.text);
}

function makeRow(state: State, table: Table, runs: number[], cells: Cell[], single: boolean): Row {
  const run = runs.length === 1 ? (runs[0] ?? -1) : -1;
  const colour = element("span", { class: "colour" });
  const box =
    single && run >= 0
      ? element("input", {
          type: "checkbox",
          tabindex: -1,
          "aria-label": `Compare ${state.payload.runs[run]?.name ?? ""}`,
          onclick: (event: Event) => event.stopPropagation(),
          onchange: (event: Event) => state.compare(run, (event.target as HTMLInputElement).checked),
        })
      : null;
  const row = element(
    "tr",
    { tabindex: -1, class: runs.length > 0 ? "selectable" : "" },
    element("td", { class: "pick" }, box, colour),
    ...cells.map((cell, i) => cellElement(cell, table.columns[i]?.number ?? false, i === 0)),
  );
  const select = (): void => {
    if (runs.length === 1) state.select(run);
    else state.selectGroup(runs, cells.filter((cell) => textOf(cell) !== "").slice(0, 3).map(textOf).join(", "));
  };
  row.addEventListener("click", select);
  row.addEventListener("keydown", (event) => {
    if (event.target !== row) return;
    if (event.key === "Enter") select();
    else if (event.key === " " && box && !box.disabled) state.compare(run, !box.checked);
    else return;
    event.preventDefault();
  });
  const text = [...cells.map((cell) => (typeof cell === "string" ? cell : `${cell.text} ${cell.detail ?? ""}`)), ...runs.map((i) => state.payload.runs[i]?.name ?? "")]
    .join(" ")
    .toLowerCase();
  return { runs, cells, text, element: row, colour, box };
}

/// Words, "several words" in quotes, and each of these after a minus.
function wordsOf(text: string): { word: string; not: boolean }[] {
  return [...text.matchAll(/(-?)(?:"([^"]*)"?|(\S+))/g)]
    .map(([, minus, quoted, plain]) => ({ word: quoted ?? plain ?? "", not: minus === "-" }))
    .filter(({ word }) => word !== "" && word !== "-");
}

function moveByKeys(event: KeyboardEvent, order: Row[]): void {
  const visible = order.filter((row) => !row.element.hidden);
  const at = visible.findIndex((row) => row.element === document.activeElement);
  if (at < 0) return;
  const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: visible.length - 1 }[event.key];
  const next = to === undefined ? undefined : visible[to];
  if (!next) return;
  event.preventDefault();
  for (const row of order) row.element.tabIndex = -1;
  next.element.tabIndex = 0;
  next.element.focus();
}

// The values of a figure as a table: what the keyboard has in place of clicks on points.
import type { Figure, NamedFigure } from "./data";
import { button, element, format } from "./dom";
import { saveCsv } from "./download";
import type { State } from "./state";

interface Point {
  series: string;
  panel: string;
  x: number | null;
  y: number | null;
  low: number | null;
  high: number | null;
  runs: number[];
}

/// All marks with values as a table.
function pointsOf(figure: Figure): Point[] {
  return figure.panels.flatMap((panel) =>
    panel.marks
      .filter((mark) => mark.kind !== "line" && mark.kind !== "steps")
      .flatMap((mark) => {
        const series = `${figure.series[mark.series]?.label ?? ""} (${mark.kind})`;
        const length = Math.max(mark.x.length, mark.y.length, mark.low.length);
        return Array.from({ length }, (_, i): Point => {
          const box = mark.kind === "box";
          const x = box ? (mark.y[i] ?? null) : (mark.x[i] ?? null);
          const y = box ? null : (mark.y[i] ?? null);
          const where = panel.title || (box ? panel.x.label : panel.y.label);
          return { series, panel: where, x, y, low: mark.low[i] ?? null, high: mark.high[i] ?? null, runs: mark.runs?.[i] ?? [] };
        });
      }),
  );
}

export function pointsTable(state: State, { figure, file }: NamedFigure): HTMLElement {
  const details = element("details", { class: "points" }, element("summary", {}, "Values of this figure"));
  details.addEventListener(
    "toggle",
    () => {
      const points = pointsOf(figure);
      const body = element("tbody");
      for (const point of points) {
        const name = `${point.series} at ${format(point.x)}`;
        const select = button(point.runs.length === 1 ? "show run" : `show ${point.runs.length} runs`, `Select the runs of ${name}`, () =>
          state.selectGroup(point.runs, name),
        );
        const numbers = [point.x, point.y, point.low, point.high].map((value) => element("td", { class: "number" }, format(value)));
        body.append(
          element("tr", {}, element("td", {}, point.panel), element("td", {}, point.series), ...numbers, element("td", {}, point.runs.length > 0 ? select : null)),
        );
      }
      const headers = ["panel", "series", "x", "y", "low", "high", "runs"];
      const save = (): void =>
        saveCsv(
          [headers, ...points.map((p) => [p.panel, p.series, p.x, p.y, p.low, p.high, p.runs.map((run) => state.payload.runs[run]?.name ?? "").join("; ")])],
          file,
        );
      details.append(
        button("CSV", "Save these values as CSV", save),
        element(
          "div",
          { class: "scroll" },
          element("table", { class: "plain" }, element("thead", {}, element("tr", {}, ...headers.map((header) => element("th", {}, header)))), body),
        ),
      );
    },
    { once: true },
  );
  return details;
}

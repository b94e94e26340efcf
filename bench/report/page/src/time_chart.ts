// Panels over time, one below the other. All charts of this kind share the zoom, the time cursor and the marks of the
// run's events: what happened at a time can be seen in all of them.
import { Chart, type Drawing } from "./chart";
import { lastUpTo, valueAt } from "./decode";
import { element, format } from "./dom";
import { swatch } from "./legend";
import { eventButtons } from "./run_events";
import type { State } from "./state";
import type { Colours } from "./theme";
import { drawPanels, LEFT, legendItems, RIGHT, type TimePanel } from "./time_panels";

export class TimeChart {
  readonly chart: Chart;
  private panels: TimePanel[] = [];
  private readonly marks = element("div", { class: "marks" });
  private readonly cursor = element("div", { class: "cursor" });
  private readonly hover = element("div", { class: "hover", hidden: true });
  private readonly selection = element("div", { class: "zoom-selection", hidden: true });
  private readonly tip = element("div", { class: "tip", hidden: true });
  private readonly legend = element("div", { class: "legend" });

  constructor(
    private readonly state: State,
    title: string,
    /// The panels at present; empty: there is nothing to draw, and the hint is shown.
    private readonly make: (of: Colours) => TimePanel[],
    hint: string,
    height: number, // [px] about
    extra?: HTMLElement,
  ) {
    const file = (): string => `${title} ${this.state.run?.name ?? ""}`;
    this.chart = new Chart(title, file, (width, of, complete) => this.drawing(width, of, complete), { hint, height, ...(extra ? { extra } : {}) });
    this.chart.plot.classList.add("time-plot");
    this.chart.plot.append(this.marks, this.hover, this.cursor, this.selection, this.tip);
    this.chart.plot.before(this.legend);
    this.chart.onDrawn = () => this.drawn();
    this.chart.plot.tabIndex = 0;
    this.chart.plot.setAttribute("role", "group");
    this.chart.plot.setAttribute(
      "aria-label",
      `${title} over time. Arrow keys move the time, plus and minus zoom, 0 shows all.`,
    );
    this.listen();
    for (const topic of ["selection", "zoom", "theme", "estimate"] as const) {
      state.on(topic, () => this.chart.view.invalidate());
    }
    state.on("time", () => this.moveCursor());
  }

  private place(t: number): number | null {
    const [low, high] = this.state.window;
    return t >= low && t <= high ? (t - low) / (high - low) : null;
  }

  private timeAt(clientX: number): number {
    const box = this.chart.plot.getBoundingClientRect();
    const [low, high] = this.state.window;
    const share = (clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
    return low + Math.min(1, Math.max(0, share)) * (high - low);
  }

  private moveCursor(): void {
    if (!this.chart.view.visible) return;
    const share = this.place(this.state.time);
    this.cursor.hidden = share === null;
    if (share !== null) this.cursor.style.left = `calc(${LEFT}px + (100% - ${LEFT + RIGHT}px) * ${share})`;
  }

  private drawn(): void {
    this.marks.style.left = `${LEFT}px`;
    this.marks.style.right = `${RIGHT}px`;
    this.marks.replaceChildren(...eventButtons(this.state, (t) => this.place(t)));
    this.moveCursor();
    this.legend.replaceChildren(...legendItems(this.panels));
  }

  private drawing(width: number, of: Colours, complete: boolean): Drawing | null {
    const panels = this.make(of).filter((panel) => panel.series.length > 0 || (panel.bars?.length ?? 0) > 0);
    if (!complete) this.panels = panels;
    if (panels.length === 0) {
      this.legend.replaceChildren();
      return null;
    }
    return drawPanels(this.state, panels, width, of, complete);
  }

  private showTip(clientX: number): void {
    const t = this.timeAt(clientX);
    const share = this.place(t) ?? 0;
    this.hover.hidden = false;
    this.hover.style.left = `calc(${LEFT}px + (100% - ${LEFT + RIGHT}px) * ${share})`;
    const rows = this.panels.flatMap((panel) =>
      panel.series
        .filter((series) => !series.hidden)
        .map((series) => {
          const value = series.steps
            ? (series.y[lastUpTo(series.t, t)] ?? NaN)
            : series.points
              ? (series.y[Math.max(0, lastUpTo(series.t, t))] ?? NaN)
              : valueAt(series.t, series.y, t);
          return { label: panel.label, series, value };
        })
        .filter((row) => Number.isFinite(row.value)),
    );
    if (rows.length === 0) {
      this.tip.hidden = true;
      return;
    }
    const table = element("table", {});
    for (const row of rows) {
      table.append(
        element(
          "tr",
          {},
          element("td", {}, swatch(row.series.colour, row.series.dash)),
          element("td", {}, row.series.name),
          element("td", {}, row.label),
          element("td", { class: "number" }, format(row.value)),
        ),
      );
    }
    this.tip.replaceChildren(element("div", {}, `t = ${format(t, 5)} s`), table);
    this.tip.hidden = false;
    const box = this.chart.plot.getBoundingClientRect();
    const left = clientX - box.left;
    this.tip.style.left = left > box.width / 2 ? "" : `${left + 14}px`;
    this.tip.style.right = left > box.width / 2 ? `${box.width - left + 14}px` : "";
  }

  private listen(): void {
    const { plot } = this.chart;
    let start: number | null = null;
    plot.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || (event.target as HTMLElement).closest("button")) return;
      start = event.clientX;
      plot.setPointerCapture(event.pointerId);
    });
    plot.addEventListener("pointermove", (event) => {
      if (event.pointerType !== "touch") this.showTip(event.clientX);
      if (start === null) return;
      const box = plot.getBoundingClientRect();
      const [a, b] = [Math.min(start, event.clientX), Math.max(start, event.clientX)];
      this.selection.hidden = b - a < 6;
      this.selection.style.left = `${a - box.left}px`;
      this.selection.style.width = `${b - a}px`;
    });
    plot.addEventListener("pointerup", (event) => {
      if (start === null) return;
      const wide = Math.abs(event.clientX - start) >= 6;
      const [a, b] = [this.timeAt(start), this.timeAt(event.clientX)];
      start = null;
      this.selection.hidden = true;
      if (wide) this.state.setZoom([a, b]);
      else this.state.setTime(b);
    });
    plot.addEventListener("pointercancel", () => {
      start = null;
      this.selection.hidden = true;
    });
    plot.addEventListener("pointerleave", () => {
      this.tip.hidden = true;
      this.hover.hidden = true;
    });
    plot.addEventListener("dblclick", () => this.state.setZoom(null));
    plot.addEventListener("keydown", (event) => timeKeys(this.state, event));
    plot.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
        event.preventDefault();
        const t = this.timeAt(event.clientX);
        const [low, high] = this.state.window;
        const factor = event.deltaY > 0 ? 1.25 : 0.8;
        this.state.setZoom([t + (low - t) * factor, t + (high - t) * factor]);
      },
      { passive: false },
    );
  }
}

/// Keys of everything that shows time.
export function timeKeys(state: State, event: KeyboardEvent): void {
  const [low, high] = state.window;
  const step = (high - low) / (event.shiftKey ? 10 : 200);
  const actions: Record<string, () => void> = {
    ArrowLeft: () => state.setTime(state.time - step),
    ArrowRight: () => state.setTime(state.time + step),
    Home: () => state.setTime(low),
    End: () => state.setTime(high),
    "+": () => state.zoomBy(0.5),
    "=": () => state.zoomBy(0.5),
    "-": () => state.zoomBy(2),
    "0": () => state.setZoom(null),
  };
  const action = event.ctrlKey || event.metaKey || event.altKey ? undefined : actions[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}

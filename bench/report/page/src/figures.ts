// Figures of sweeps: the same marks as `evbench figure` draws with matplotlib (bench/figures/figure.py), on the same
// data. Where marks name runs, a click on a point selects them; a table of the points does the same by keyboard.
import { Chart, type Drawing, type Option } from "./chart";
import type { Figure, NamedFigure } from "./data";
import { element, format } from "./dom";
import { axisOption, cellAxes, failureRows, layout, namesAxis } from "./figure_layout";
import { failuresOption, gridOption, markOption, type SeriesOption } from "./figure_marks";
import { pointsTable } from "./figure_values";
import { legendOption, swatch, type LegendEntry } from "./legend";
import type { State } from "./state";
import { colourOf, colours, dashOf, type Colours } from "./theme";

function drawFigure(state: State, figure: Figure, width: number, of: Colours, complete: boolean): Drawing {
  const marks = figure.panels.flatMap((panel) => panel.marks);
  const names = figure.series.map((series, i): [string, LegendEntry] => [
    series.label,
    {
      colour: series.truth ? of.truth : colourOf(series.number, of),
      filled: marks.some((mark) => mark.series === i && (mark.kind === "points" || mark.kind === "box")),
    },
  ]);
  const letters = names.reduce((sum, [name]) => sum + name.length + 8, 0);
  const top = complete && figure.legend ? 10 + 18 * Math.max(1, Math.ceil((letters * 6.4) / (width - 20))) : 0;
  const { places, height } = layout(figure, width, top);
  const xs: object[] = [];
  const ys: object[] = [];
  const titles: object[] = [];
  const series: SeriesOption[] = [];
  for (const place of places) {
    const { panel } = place;
    if (panel.marks.some((mark) => mark.kind === "cells")) {
      const axes = cellAxes(place, of);
      xs.push(axes.x);
      ys.push(axes.y);
    } else {
      xs.push(axisOption(panel.x, place.xs, of, place, 28));
      ys.push(panel.names.length > 0 ? namesAxis(place, of) : axisOption(panel.y, place.ys, of, place, 46));
    }
    if (panel.title) titles.push({ text: panel.title, left: place.x, top: place.y - 24 - (failureRows(panel) ? 12 * failureRows(panel) + 2 : 0), textStyle: { color: of.text, fontSize: 12 } });
    series.push(gridOption(place, of));
    for (const mark of panel.marks) series.push(...markOption(state, figure, place, mark, of));
    series.push(...failuresOption(figure, place, of));
  }
  let below = 0;
  if (complete && figure.caption) {
    const lines = Math.ceil((figure.caption.length * 5.6) / (width - 24)) + 1;
    below = 14 * lines;
    const textStyle = { color: of.faint, fontSize: 10.5, fontWeight: "normal", width: width - 24, overflow: "break", lineHeight: 14 };
    titles.push({ text: figure.caption, left: 6, top: height, textStyle });
  }
  const option = {
    grid: places.map(({ x, y, width: across, height: up }) => ({ left: x, top: y, width: across, height: up })),
    xAxis: xs,
    yAxis: ys,
    series,
    title: titles,
    ...(complete && figure.legend ? legendOption(names, of, width) : {}),
    ...(complete ? {} : { tooltip: { trigger: "item", confine: true, formatter: (item: unknown) => tip(state, item), ...tipStyle(of) } }),
  } as Option;
  return { option, height: height + below };
}

function tipStyle(of: Colours): object {
  return { backgroundColor: of.page, borderColor: of.faint, textStyle: { color: of.text, fontSize: 12 } };
}

interface Clicked {
  data?: { value?: number[]; runs?: number[] };
  seriesName?: string;
}

/// An element, not HTML: names of runs may contain anything.
function tip(state: State, item: unknown): HTMLElement {
  const { data, seriesName } = item as Clicked;
  const runs = data?.runs ?? [];
  const [x, y] = data?.value ?? [];
  const names = runs.slice(0, 6).map((run) => element("li", {}, state.payload.runs[run]?.name ?? ""));
  return element(
    "div",
    { class: "figure-tip" },
    element("strong", {}, seriesName ?? ""),
    element("div", {}, `${format(x)}, ${format(y)}`),
    element("ul", {}, ...names, runs.length > 6 ? element("li", {}, `and ${runs.length - 6} more`) : null),
    runs.length > 0 ? element("em", {}, runs.length > 1 ? "click: select these runs" : "click: select this run") : null,
  );
}

function legend(figure: Figure, of: Colours): HTMLElement[] {
  return figure.series.map((series) =>
    element(
      "span",
      {},
      swatch(series.truth ? of.truth : colourOf(series.number, of), series.truth ? [3, 2] : dashOf(series.number)),
      series.label,
    ),
  );
}

export function figureElement(state: State, named: NamedFigure): HTMLElement {
  const { figure } = named;
  const chart = new Chart(named.title, () => named.file, (width, of, complete) => drawFigure(state, figure, width, of, complete), { height: 260 });
  const legendBox = element("div", { class: "legend" });
  if (figure.legend) chart.plot.before(legendBox);
  chart.onCreated = (instance) => {
    instance.on("click", (event) => {
      const { data, seriesName } = event as Clicked;
      const runs = data?.runs ?? [];
      if (runs.length > 0) state.selectGroup(runs, `${seriesName ?? ""} at ${format(data?.value?.[0])} in “${named.title}”`);
    });
  };
  chart.onDrawn = () => legendBox.replaceChildren(...legend(figure, colours()));
  let { focus } = state;
  state.on("selection", () => {
    if (focus !== state.focus) chart.view.invalidate(); // nothing else of the selection is drawn
    focus = state.focus;
  });
  state.on("theme", () => chart.view.invalidate());
  chart.element.append(element("figcaption", {}, figure.caption), pointsTable(state, named));
  return chart.element;
}

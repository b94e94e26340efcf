// Figures of sweeps: the same marks as `evbench figure` draws with matplotlib (bench/figures/figure.py), on the same
// data. Where marks name runs, a click on a point selects them; a table of the points does the same by keyboard.
import type { CustomSeriesOption, LineSeriesOption, ScatterSeriesOption } from "echarts/charts";
import type { CustomSeriesRenderItemReturn } from "echarts/types/dist/shared";
import { Chart, type Drawing, type Option } from "./chart";
import type { Figure, Mark, NamedFigure, Panel } from "./data";
import { button, element, format, formatTick } from "./dom";
import { saveCsv } from "./download";
import type { State } from "./state";
import { colourOf, colours, dashOf, MARKERS, type Colours } from "./theme";
import { legendOption, swatch, type LegendEntry } from "./time_chart";

const LEFT = 64;
const RIGHT = 22;
const NAMES = 190; // [px] left of boxes
const LARGEST_RATIO = 8; // of cells: where colours end
const DARK_RATIO = 4; // from where on they are dark

type SeriesOption = object; // of ECharts; its own types refuse typed arrays and runs beside values

interface Place {
  panel: Panel;
  index: number; // of the panel
  x: number;
  y: number;
  width: number;
  height: number;
  xs: [number, number]; // limits of the axes
  ys: [number, number];
}

interface Point {
  series: string;
  panel: string;
  x: number | null;
  y: number | null;
  low: number | null;
  high: number | null;
  runs: number[];
}

function finite(values: (number | null | undefined)[]): number[] {
  return values.filter((value): value is number => typeof value === "number" && Number.isFinite(value));
}

/// Quartiles as in evbench's tables: linear between neighbours.
function quantile(sorted: number[], share: number): number {
  const place = share * (sorted.length - 1);
  const below = sorted[Math.floor(place)] ?? NaN;
  const above = sorted[Math.ceil(place)] ?? NaN;
  return below + (place - Math.floor(place)) * (above - below);
}

function limitsOf(panel: Panel, axis: "x" | "y"): [number, number] {
  const { scale, share, ends } = panel[axis];
  const values: number[] = axis === "x" ? finite(ends) : [];
  for (const mark of panel.marks) {
    if (mark.kind === "box") values.push(...finite(axis === "x" ? mark.y : mark.x));
    else if (axis === "x") values.push(...finite(mark.x));
    else if (mark.kind !== "failures" && mark.kind !== "cells") values.push(...finite([...mark.y, ...mark.low, ...mark.high]));
  }
  const usable = scale === "log" ? values.filter((value) => value > 0) : values;
  if (axis === "y" && share) return [0, 1.02];
  if (usable.length === 0) return scale === "log" ? [0.1, 10] : [0, 1];
  let low = Math.min(...usable);
  let high = Math.max(...usable);
  if (scale === "log") {
    const margin = Math.max((high / low) ** 0.05, 1.05);
    return [low / margin, high * margin];
  }
  if (low === high) {
    low -= 0.5 * Math.abs(low || 1);
    high += 0.5 * Math.abs(high || 1);
  }
  const margin = 0.05 * (high - low);
  return [low - margin, high + margin];
}

/// Ticks of a logarithmic axis at 1, 2, 5 of each decade: ECharts labels decades only, of which there may be none.
function logTicks(low: number, high: number): number[] {
  const factors = high / low > 300 ? [1] : high / low > 8 ? [1, 2, 5] : [1, 1.5, 2, 3, 5, 7];
  const ticks: number[] = [];
  for (let decade = Math.floor(Math.log10(low)); decade <= Math.ceil(Math.log10(high)); ++decade) {
    for (const factor of factors) {
      const value = Number((factor * 10 ** decade).toPrecision(6));
      if (value >= low && value <= high) ticks.push(value);
    }
  }
  return ticks;
}

function axisOption(axis: Panel["x"], limits: [number, number], of: Colours, place: Place, gap: number): object {
  const ticks = axis.scale === "log" ? logTicks(...limits) : null;
  const common = {
    gridIndex: place.index,
    name: axis.label + (axis.scale === "log" ? " (logarithmic)" : ""),
    nameLocation: "middle",
    nameGap: gap,
    nameTextStyle: { color: of.text, fontSize: 12, width: gap > 30 ? place.height + 30 : place.width, overflow: "break" },
    axisLine: { show: true, onZero: false, lineStyle: { color: of.faint } },
    splitLine: { lineStyle: { color: of.grid } },
    min: limits[0],
    max: limits[1],
  };
  if (!ticks) {
    const inside = (value: number): string => (value === limits[0] || value === limits[1] ? "" : formatTick(value));
    return { ...common, type: "value", axisLabel: { color: of.faint, formatter: inside, hideOverlap: true } };
  }
  return {
    ...common,
    type: "log",
    axisTick: { customValues: ticks, lineStyle: { color: of.faint } },
    axisLabel: { customValues: ticks, color: of.faint, formatter: formatTick, hideOverlap: true },
    splitLine: { show: false },
  };
}

/// Places of the panels, in rows. Narrow pages have one column.
function layout(figure: Figure, width: number, top: number): { places: Place[]; height: number } {
  const columns = width < 560 ? 1 : Math.max(1, Math.min(figure.columns, Math.floor(width / 260)));
  const rows = Math.ceil(figure.panels.length / columns);
  const cell = width / columns;
  const wanted = (figure.height_mm / Math.ceil(figure.panels.length / figure.columns) / figure.width_mm) * Math.min(width, 900);
  const places: Place[] = [];
  let y = top;
  for (let row = 0; row < rows; ++row) {
    const panels = figure.panels.slice(row * columns, (row + 1) * columns);
    const failures = Math.max(0, ...panels.map((panel) => failureRows(panel)));
    const above = 12 * failures + (panels.some((panel) => panel.title) ? 22 : 8) + (failures ? 4 : 0);
    const height = Math.max(170, Math.min(420, wanted - 50));
    panels.forEach((panel, column) => {
      const names = panel.names.length > 0;
      const left = !names ? LEFT : panel.names.some((name) => name.trim() !== "") ? Math.min(NAMES, 0.4 * cell) : 24;
      places.push({
        panel,
        index: row * columns + column,
        x: column * cell + left,
        y: y + above,
        width: cell - left - RIGHT,
        height,
        xs: limitsOf(panel, "x"),
        ys: limitsOf(panel, "y"),
      });
    });
    y += above + height + 52;
  }
  spread(figure, places);
  return { places, height: y };
}

/// Axes of metres: as long on both axes, and in all panels.
function spread(figure: Figure, places: Place[]): void {
  const widen = (limits: [number, number], span: number): [number, number] => {
    const middle = (limits[0] + limits[1]) / 2;
    return [middle - span / 2, middle + span / 2];
  };
  const scale = (place: Place): number =>
    Math.max(place.panel.equal ? (place.xs[1] - place.xs[0]) / place.width : 0, (place.ys[1] - place.ys[0]) / place.height);
  const largest = Math.max(...places.map(scale));
  for (const place of places) {
    if (!place.panel.equal && !figure.alike) continue;
    const metres = figure.alike ? largest : scale(place);
    place.ys = widen(place.ys, metres * place.height);
    if (place.panel.equal) place.xs = widen(place.xs, metres * place.width);
  }
}

function failureRows(panel: Panel): number {
  return new Set(panel.marks.filter((mark) => mark.kind === "failures").map((mark) => mark.series)).size;
}

function once(index: number, render: CustomSeriesOption["renderItem"], z: number): CustomSeriesOption {
  return { type: "custom", xAxisIndex: index, yAxisIndex: index, silent: true, data: [[0, 0]], clip: true, z, renderItem: render as never };
}

/// Lines at the ticks of logarithmic axes: ECharts has them at decades only.
function gridOption(place: Place, of: Colours): CustomSeriesOption {
  return once(
    place.index,
    (_, api) => {
      const children: unknown[] = [];
      const style = { stroke: of.grid, lineWidth: 1 };
      if (place.panel.x.scale === "log") {
        for (const tick of logTicks(...place.xs)) {
          const x = api.coord([tick, place.ys[0]])[0] ?? NaN;
          children.push({ type: "line", shape: { x1: x, y1: place.y, x2: x, y2: place.y + place.height }, style });
        }
      }
      if (place.panel.y.scale === "log" && place.panel.names.length === 0) {
        for (const tick of logTicks(...place.ys)) {
          const y = api.coord([place.xs[0], tick])[1] ?? NaN;
          children.push({ type: "line", shape: { x1: place.x, y1: y, x2: place.x + place.width, y2: y }, style });
        }
      }
      return { type: "group", children } as CustomSeriesRenderItemReturn;
    },
    0,
  );
}

function markOption(state: State, figure: Figure, place: Place, mark: Mark, of: Colours): SeriesOption[] {
  const series = figure.series[mark.series];
  if (!series) return [];
  const number = series.number;
  const colour = series.truth ? of.truth : colourOf(number, of);
  const axes = { xAxisIndex: place.index, yAxisIndex: place.index };
  const shape = series.truth ? [3, 2] : dashOf(number);
  if (mark.kind === "line" || mark.kind === "steps" || mark.kind === "points") {
    const dense = mark.kind === "line";
    const points = mark.kind === "points";
    return [
      {
        ...axes,
        type: "line",
        name: series.label,
        data: mark.x.map((x, i) => ({ value: [x ?? NaN, mark.y[i] ?? NaN], runs: mark.runs?.[i] ?? [] })),
        step: mark.kind === "steps" ? "end" : false,
        showSymbol: points,
        symbol: MARKERS[number % MARKERS.length] ?? "circle",
        symbolSize: 9,
        cursor: points && mark.runs ? "pointer" : "default",
        lineStyle: { color: colour, width: dense ? 1.2 : 2, type: dense && !series.truth ? "solid" : shape },
        itemStyle: { color: colour, borderColor: of.page, borderWidth: 1 },
        silent: !points,
        z: series.truth ? 6 : 4,
      },
      ...(points ? [ringOption(state, place, mark, of)] : []),
    ];
  }
  if (mark.kind === "band") {
    return [
      once(
        place.index,
        (_, api) => {
          const upper = mark.x.flatMap((x, i) => (finite([x, mark.low[i], mark.high[i]]).length === 3 ? [api.coord([x ?? 0, mark.high[i] ?? 0])] : []));
          const lower = mark.x.flatMap((x, i) => (finite([x, mark.low[i], mark.high[i]]).length === 3 ? [api.coord([x ?? 0, mark.low[i] ?? 0])] : []));
          return { type: "polygon", shape: { points: [...upper, ...lower.reverse()] }, style: { fill: colour, opacity: 0.2 } };
        },
        2,
      ),
    ];
  }
  if (mark.kind === "level") {
    return [
      once(
        place.index,
        (_, api) => {
          const at = (y: number | null | undefined): number => api.coord([place.xs[0], y ?? NaN])[1] ?? NaN;
          const children: unknown[] = [];
          if (finite([mark.low[0], mark.high[0]]).length === 2) {
            children.push({
              type: "rect",
              shape: { x: place.x, y: at(mark.high[0]), width: place.width, height: at(mark.low[0]) - at(mark.high[0]) },
              style: { fill: colour, opacity: 0.2 },
            });
          }
          if (finite([mark.y[0]]).length === 1) {
            children.push({
              type: "line",
              shape: { x1: place.x, y1: at(mark.y[0]), x2: place.x + place.width, y2: at(mark.y[0]) },
              style: { stroke: colour, lineWidth: 2, lineDash: shape === "solid" ? null : shape },
            });
          }
          return { type: "group", children } as CustomSeriesRenderItemReturn;
        },
        3,
      ),
      legendOnly(place, series.label, colour, shape),
    ];
  }
  if (mark.kind === "box") return boxOption(state, place, mark, series.label, colour, of);
  if (mark.kind === "cells") return [cellsOption(place, mark, of)];
  return [];
}

/// A line without data: the legend of a saved picture shows its colour and dash.
function legendOnly(place: Place, name: string, colour: string, dash: number[] | "solid"): LineSeriesOption {
  return {
    type: "line",
    name,
    xAxisIndex: place.index,
    yAxisIndex: place.index,
    data: [],
    lineStyle: { color: colour, type: dash },
    itemStyle: { color: colour },
  };
}

/// A ring around the points that the run in focus belongs to.
function ringOption(state: State, place: Place, mark: Mark, of: Colours): ScatterSeriesOption {
  const data = mark.x.flatMap((x, i) => (mark.runs?.[i]?.includes(state.focus) ? [[x ?? NaN, mark.y[i] ?? NaN]] : []));
  return {
    type: "scatter",
    xAxisIndex: place.index,
    yAxisIndex: place.index,
    data,
    silent: true,
    symbol: "circle",
    symbolSize: 17,
    itemStyle: { color: "transparent", borderColor: of.text, borderWidth: 2 },
    z: 8,
  };
}

function boxOption(state: State, place: Place, mark: Mark, name: string, colour: string, of: Colours): SeriesOption[] {
  const sorted = finite(mark.y).sort((a, b) => a - b);
  const row = mark.x[0] ?? 0;
  const [low, lower, median, upper, high] = [0, 0.25, 0.5, 0.75, 1].map((share) => quantile(sorted, share));
  const box = once(
    place.index,
    (_, api) => {
      if (sorted.length === 0) return { type: "group", children: [] };
      const x = (value: number | undefined): number => api.coord([value ?? NaN, row])[0] ?? NaN;
      const y = api.coord([low ?? NaN, row])[1] ?? NaN;
      const half = Math.min(14, (0.3 * place.height) / Math.max(1, place.panel.names.length));
      const line = (x1: number, y1: number, x2: number, y2: number, lineWidth = 1.5): unknown => ({
        type: "line",
        shape: { x1, y1, x2, y2 },
        style: { stroke: colour, lineWidth },
      });
      return {
        type: "group",
        children: [
          line(x(low), y, x(lower), y),
          line(x(upper), y, x(high), y),
          line(x(low), y - half / 2, x(low), y + half / 2),
          line(x(high), y - half / 2, x(high), y + half / 2),
          {
            type: "rect",
            shape: { x: x(lower), y: y - half, width: Math.max(1, x(upper) - x(lower)), height: 2 * half },
            style: { fill: colour, fillOpacity: 0.25, stroke: colour, lineWidth: 1.5 },
          },
          line(x(median), y - half, x(median), y + half, 3),
        ],
      } as CustomSeriesRenderItemReturn;
    },
    3,
  );
  const values: ScatterSeriesOption = {
    type: "scatter",
    name,
    xAxisIndex: place.index,
    yAxisIndex: place.index,
    data: mark.y.map((value, i) => ({
      value: [value ?? NaN, row],
      runs: mark.runs?.[i] ?? [],
      itemStyle: mark.runs?.[i]?.includes(state.focus) ? { borderColor: of.text, borderWidth: 2.5, opacity: 1 } : {},
    })),
    symbolSize: 9,
    itemStyle: { color: colour, opacity: 0.75 },
    z: 5,
  };
  return [box, values];
}

/// Red above 1, blue below, white at 1, as matplotlib's RdBu_r; the number is written in each cell.
function cellColour(ratio: number): string {
  const share = Math.max(-1, Math.min(1, Math.log(ratio) / Math.log(LARGEST_RATIO)));
  const end = share > 0 ? [178, 24, 43] : [33, 102, 172];
  const size = Math.abs(share);
  return `rgb(${end.map((value) => Math.round(247 + size * (value - 247))).join(",")})`;
}

function cellsOption(place: Place, mark: Mark, of: Colours): CustomSeriesOption {
  const columns = [...new Set(finite(mark.x))].sort((a, b) => a - b);
  const rows = [...new Set(finite(mark.y))].sort((a, b) => a - b);
  const width = place.width / columns.length;
  const height = place.height / rows.length;
  return {
    type: "custom",
    xAxisIndex: place.index,
    yAxisIndex: place.index,
    data: mark.x.map((x, i) => ({ value: [columns.indexOf(x ?? NaN), rows.indexOf(mark.y[i] ?? NaN)], runs: mark.runs?.[i] ?? [] })),
    renderItem: (parameters, api) => {
      const ratio = mark.low[parameters.dataIndex] ?? NaN;
      const left = place.x + width * Number(api.value(0));
      const top = place.y + place.height - height * (Number(api.value(1)) + 1);
      const known = Number.isFinite(ratio);
      const dark = known && !(ratio > 1 / DARK_RATIO && ratio < DARK_RATIO);
      return {
        type: "group",
        children: [
          {
            type: "rect",
            shape: { x: left, y: top, width, height },
            style: { fill: known ? cellColour(ratio) : "#bbbbbb", stroke: of.page, lineWidth: 1 },
          },
          {
            type: "text",
            style: {
              x: left + width / 2,
              y: top + height / 2,
              text: known ? String(Number(ratio.toPrecision(ratio < 99.5 ? 2 : 3))) : "fails",
              align: "center",
              verticalAlign: "middle",
              fontSize: 11,
              fill: dark ? "#ffffff" : "#000000",
            },
          },
        ],
      };
    },
  };
}

/// Above the panel, a row for each series: how many of how many runs failed at each x.
function failuresOption(figure: Figure, place: Place, of: Colours): CustomSeriesOption[] {
  const numbers = [...new Set(place.panel.marks.filter((mark) => mark.kind === "failures").map((mark) => mark.series))].sort((a, b) => b - a);
  if (numbers.length === 0) return [];
  return [
    {
      ...once(
        place.index,
        (_, api) => {
          const children: unknown[] = [];
          const write = (text: string, x: number, row: number, series: number, align: "left" | "center" | "right"): void => {
            const { truth = false, number = 0 } = figure.series[series] ?? {};
            const style = { x, y: place.y - 3 - 12 * row, text, align, verticalAlign: "bottom", fontSize: 10, fill: truth ? of.truth : colourOf(number, of) };
            children.push({ type: "text", style });
          };
          numbers.forEach((series, row) => {
            write("failed", place.x - 4, row, series, "right");
            for (const mark of place.panel.marks) {
              if (mark.kind !== "failures" || mark.series !== series) continue;
              if (mark.x.length === 0) write(`${mark.low[0] ?? "?"}/${mark.high[0] ?? "?"}`, place.x + 2, row, series, "left");
              mark.x.forEach((x, i) => {
                const at = api.coord([x ?? NaN, place.ys[0]])[0] ?? NaN;
                write(`${mark.low[i] ?? "?"}/${mark.high[i] ?? "?"}`, at, row, series, "center");
              });
            }
          });
          return { type: "group", children } as CustomSeriesRenderItemReturn;
        },
        9,
      ),
      clip: false,
    },
  ];
}

function cellAxes(place: Place, of: Colours): { x: object; y: object } {
  const cells = place.panel.marks.find((mark) => mark.kind === "cells");
  const values = (list: (number | null)[] | undefined): string[] => [...new Set(finite(list ?? []))].sort((a, b) => a - b).map(formatTick);
  const axis = (from: Panel["x"], data: string[], gap: number): object => ({
    gridIndex: place.index,
    type: "category",
    data,
    name: from.label,
    nameLocation: "middle",
    nameGap: gap,
    nameTextStyle: { color: of.text, fontSize: 12 },
    axisLine: { lineStyle: { color: of.faint } },
    axisLabel: { color: of.faint },
  });
  return { x: axis(place.panel.x, values(cells?.x), 28), y: axis(place.panel.y, values(cells?.y), 44) };
}

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

function namesAxis(place: Place, of: Colours): object {
  const { names } = place.panel;
  return {
    gridIndex: place.index,
    type: "value",
    inverse: true,
    min: -0.5,
    max: names.length - 0.5,
    axisTick: { show: false },
    axisLine: { show: true, onZero: false, lineStyle: { color: of.faint } },
    splitLine: { show: false },
    axisLabel: {
      customValues: names.map((_, i) => i),
      formatter: (value: number) => names[Math.round(value)] ?? "",
      color: of.text,
      fontSize: 11,
      lineHeight: 13,
    },
  };
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

function pointsTable(state: State, { figure, file }: NamedFigure): HTMLElement {
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

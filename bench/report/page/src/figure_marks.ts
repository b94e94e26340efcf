// Marks of a figure as series of ECharts: lines, points, bands, levels, boxes, cells, failures.
import type { CustomSeriesOption, LineSeriesOption, ScatterSeriesOption } from "echarts/charts";
import type { CustomSeriesRenderItemReturn } from "echarts/types/dist/shared";
import type { Figure, Mark } from "./data";
import { finite, logTicks, type Place } from "./figure_layout";
import type { State } from "./state";
import { colourOf, dashOf, MARKERS, type Colours } from "./theme";

const LARGEST_RATIO = 8; // of cells: where colours end
const DARK_RATIO = 4; // from where on they are dark

export type SeriesOption = object; // of ECharts; its own types refuse typed arrays and runs beside values

/// Quartiles as in evbench's tables: linear between neighbours.
function quantile(sorted: number[], share: number): number {
  const place = share * (sorted.length - 1);
  const below = sorted[Math.floor(place)] ?? NaN;
  const above = sorted[Math.ceil(place)] ?? NaN;
  return below + (place - Math.floor(place)) * (above - below);
}

function once(index: number, render: CustomSeriesOption["renderItem"], z: number): CustomSeriesOption {
  return { type: "custom", xAxisIndex: index, yAxisIndex: index, silent: true, data: [[0, 0]], clip: true, z, renderItem: render as never };
}

/// Lines at the ticks of logarithmic axes: ECharts has them at decades only.
export function gridOption(place: Place, of: Colours): CustomSeriesOption {
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

export function markOption(state: State, figure: Figure, place: Place, mark: Mark, of: Colours): SeriesOption[] {
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
export function failuresOption(figure: Figure, place: Place, of: Colours): CustomSeriesOption[] {
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

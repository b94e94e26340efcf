// What panels over time show: lines, bands, bars, and the run's periods and events behind them.
import type { CustomSeriesOption } from "echarts/charts";
import type { Drawing, Option } from "./chart";
import { lastUpTo } from "./decode";
import { element, formatTick } from "./dom";
import { legendOption, swatch, type LegendEntry } from "./legend";
import type { State } from "./state";
import type { Colours } from "./theme";

export const LEFT = 66; // [px] beside the panels
export const RIGHT = 14;
const TOP = 8;
const GAP = 16;
const BELOW = 40;
const LEGEND = 26;
const BUCKETS = 700; // as many as a plot has pixels across, about

export interface TimeSeries {
  name: string;
  t: Float64Array;
  y: Float64Array;
  colour: string;
  dash?: number[] | "solid";
  width?: number;
  steps?: boolean;
  points?: boolean;
  band?: { low: Float64Array; high: Float64Array }; // around y, at the same times
  hidden?: boolean; // the line: only the band is drawn
}

/// A horizontal bar from t0 to t1 in a row.
export interface TimeBars {
  name: string;
  from: Float64Array;
  to: Float64Array;
  row: Float64Array;
  colour: string;
  width: number; // [px]
}

export interface TimePanel {
  label: string; // with its unit
  series: TimeSeries[];
  bars?: TimeBars[];
  log?: boolean;
  zero?: boolean; // the axis includes 0
  height?: number; // [px]
}

export function legendItems(panels: TimePanel[]): HTMLElement[] {
  const seen = new Set<string>();
  const items: HTMLElement[] = [];
  for (const part of panels.flatMap((panel) => [...panel.series, ...(panel.bars ?? [])])) {
    if (seen.has(part.name) || ("hidden" in part && part.hidden)) continue;
    seen.add(part.name);
    items.push(element("span", {}, swatch(part.colour, "dash" in part ? part.dash : "solid"), part.name));
  }
  return items;
}

/// Indices of a series within a window, with a sample on both sides.
function indices({ t }: TimeSeries, low: number, high: number): [number, number] {
  return [Math.max(0, lastUpTo(t, low)), Math.min(t.length - 1, lastUpTo(t, high) + 1)];
}

/// Pairs t, y of a series within a window, as ECharts takes them. Of many samples only those that can be seen: the
/// least and the greatest in each of many parts. Zooming in shows the others.
function pairs(series: TimeSeries, low: number, high: number): Float64Array {
  const [first, last] = indices(series, low, high);
  if (last - first > 3 * BUCKETS) return extremes(series, first, last);
  const data = new Float64Array(2 * Math.max(0, last - first + 1));
  for (let i = first; i <= last; ++i) {
    data[2 * (i - first)] = series.t[i] ?? NaN;
    data[2 * (i - first) + 1] = series.y[i] ?? NaN;
  }
  return data;
}

function extremes({ t, y }: TimeSeries, first: number, last: number): Float64Array {
  const picked: number[] = [];
  const size = (last - first + 1) / BUCKETS;
  for (let bucket = 0; bucket < BUCKETS; ++bucket) {
    let least = -1;
    let most = -1;
    let missing = -1;
    for (let i = first + Math.floor(bucket * size); i < first + Math.floor((bucket + 1) * size); ++i) {
      const value = y[i] ?? NaN;
      if (Number.isNaN(value)) missing = i;
      else {
        if (least < 0 || value < (y[least] ?? NaN)) least = i;
        if (most < 0 || value > (y[most] ?? NaN)) most = i;
      }
    }
    const found = [...new Set([least, most, missing])].filter((i) => i >= 0);
    picked.push(...found.sort((a, b) => a - b));
  }
  return Float64Array.from(picked.flatMap((i) => [t[i] ?? NaN, y[i] ?? NaN]));
}

function limits(panel: TimePanel, low: number, high: number): [number, number] {
  let least = Infinity;
  let most = -Infinity;
  const include = (value: number | undefined): void => {
    if (value === undefined || !Number.isFinite(value) || (panel.log && value <= 0)) return;
    least = Math.min(least, value);
    most = Math.max(most, value);
  };
  const each = (series: TimeSeries, use: (i: number) => void): void => {
    const last = Math.min(series.t.length - 1, lastUpTo(series.t, high) + 1);
    for (let i = Math.max(0, lastUpTo(series.t, low)); i <= last; ++i) use(i);
  };
  for (const series of panel.series) if (!series.hidden) each(series, (i) => include(series.y[i]));
  for (const bars of panel.bars ?? []) bars.row.forEach(include);
  // A band that is much wider than all lines, as before an estimate has converged, does not flatten them.
  const room = most > least ? most - least : Infinity;
  const [lineLeast, lineMost] = [least, most];
  for (const series of panel.series) {
    const { band } = series;
    if (!band) continue;
    each(series, (i) => {
      include(Math.max(band.low[i] ?? NaN, lineLeast - room));
      include(Math.min(band.high[i] ?? NaN, lineMost + room));
    });
  }
  if (panel.zero) include(0);
  if (!(most >= least)) return panel.log ? [0.1, 10] : [0, 1];
  if (panel.log) return [10 ** Math.floor(Math.log10(least) + 1e-9), 10 ** Math.ceil(Math.log10(most) - 1e-9)];
  if (most === least) return [least - 0.5 * Math.abs(least || 1), most + 0.5 * Math.abs(most || 1)];
  const margin = 0.06 * (most - least);
  return [panel.zero && least === 0 ? 0 : least - margin, most + margin];
}

export function drawPanels(state: State, panels: TimePanel[], width: number, of: Colours, complete: boolean): Drawing {
  const [low, high] = state.window;
  const names = new Map<string, LegendEntry>();
  for (const part of panels.flatMap((panel) => [...panel.series, ...(panel.bars ?? [])])) {
    if (!("hidden" in part && part.hidden)) names.set(part.name, { colour: part.colour, filled: !("y" in part) });
  }
  let top = TOP + (complete ? LEGEND * Math.max(1, Math.ceil(names.size / 4)) : 0);
  const grids: object[] = [];
  const xs: object[] = [];
  const ys: object[] = [];
  const series: object[] = []; // of ECharts, whose own types refuse typed arrays
  panels.forEach((panel, index) => {
    const height = panel.height ?? (panels.length > 1 ? 112 : 170);
    const [least, most] = limits(panel, low, high);
    const last = index === panels.length - 1;
    grids.push({ left: LEFT, right: RIGHT, top, height });
    xs.push({
      gridIndex: index,
      type: "value",
      min: low,
      max: high,
      name: last ? "time [s]" : "",
      nameLocation: "middle",
      nameGap: 24,
      nameTextStyle: { color: of.faint },
      axisLine: { lineStyle: { color: of.faint }, onZero: false },
      axisTick: { show: last, lineStyle: { color: of.faint } },
      axisLabel: { show: last, color: of.faint, formatter: formatTick, showMinLabel: false, showMaxLabel: false, hideOverlap: true },
      splitLine: { lineStyle: { color: of.grid } },
    });
    ys.push({
      gridIndex: index,
      type: panel.log ? "log" : "value",
      min: least,
      max: most,
      splitNumber: height > 140 ? 5 : 3,
      name: panel.label,
      nameLocation: "middle",
      nameGap: 46,
      nameTextStyle: { color: of.text, fontSize: 11, lineHeight: 13 },
      axisLine: { show: true, lineStyle: { color: of.faint } },
      axisLabel: { color: of.faint, formatter: formatTick, showMinLabel: panel.log ?? false, showMaxLabel: panel.log ?? false, fontSize: 11 },
      splitLine: { lineStyle: { color: of.grid } },
    });
    const axes = { xAxisIndex: index, yAxisIndex: index };
    series.push(occasions(state, axes, of));
    for (const one of panel.series) {
      if (one.band) series.push(bandOf(one, one.band, axes, indices(one, low, high)));
      if (one.hidden) continue;
      const data = pairs(one, low, high);
      series.push({
        ...axes,
        type: "line",
        name: one.name,
        data: data as never, // a typed array, which its type does not have
        dimensions: ["t", "y"],
        silent: true,
        showSymbol: one.points ?? false,
        symbol: "circle",
        symbolSize: 3,
        step: one.steps ? "end" : false,
        lineStyle: { color: one.colour, width: one.width ?? 1.6, type: one.dash ?? "solid", join: "round" },
        itemStyle: { color: one.colour },
        emphasis: { disabled: true },
        clip: true,
      });
    }
    for (const bars of panel.bars ?? []) series.push(barsOf(bars, axes, low, high));
    top += height + GAP;
  });
  const option: Option = {
    grid: grids,
    xAxis: xs,
    yAxis: ys,
    series,
    ...(complete ? legendOption([...names], of, width) : {}),
  };
  return { option, height: top - GAP + BELOW };
}

interface Axes {
  xAxisIndex: number;
  yAxisIndex: number;
}

interface CoordinateSystem {
  x: number;
  y: number;
  width: number;
  height: number;
}

/// Periods as grey bands and events as dotted lines, behind everything else.
function occasions(state: State, axes: Axes, of: Colours): CustomSeriesOption {
  return {
    ...axes,
    type: "custom",
    silent: true,
    clip: true,
    z: 0,
    data: [[0, 0]],
    renderItem: (parameters) => {
      const box = parameters.coordSys as unknown as CoordinateSystem;
      const [low, high] = state.window;
      const x = (t: number): number => box.x + (box.width * (t - low)) / (high - low);
      const periods = (state.run?.periods ?? []).map((period) => ({
        type: "rect" as const,
        shape: { x: x(period.from), y: box.y, width: Math.max(1, x(period.to) - x(period.from)), height: box.height },
        style: { fill: period.kind === "stationary" ? of.faint : of.warn, opacity: 0.16 },
      }));
      const lines = (state.run?.events ?? [])
        .filter((event) => event.t >= low && event.t <= high)
        .map((event) => ({
          type: "line" as const,
          shape: { x1: x(event.t), y1: box.y, x2: x(event.t), y2: box.y + box.height },
          style: {
            stroke: event.kind === "lost" ? of.warn : of.faint,
            lineWidth: event.kind === "lost" ? 1.5 : 1,
            lineDash: [2, 3],
            opacity: 0.8,
          },
        }));
      return { type: "group", children: [...periods, ...lines] };
    },
  };
}

function bandOf(series: TimeSeries, band: { low: Float64Array; high: Float64Array }, axes: Axes, [first, last]: [number, number]): CustomSeriesOption {
  return {
    ...axes,
    type: "custom",
    silent: true,
    clip: true,
    z: 1,
    data: [[0, 0]],
    renderItem: (_, api) => {
      const upper: number[][] = [];
      const lower: number[][] = [];
      const step = Math.max(1, Math.floor((last - first) / BUCKETS));
      for (let i = first; i <= last; i += step) {
        const [t, a, b] = [series.t[i] ?? NaN, band.low[i] ?? NaN, band.high[i] ?? NaN];
        if (!(b >= a)) continue;
        upper.push(api.coord([t, b]));
        lower.push(api.coord([t, a]));
      }
      return {
        type: "polygon",
        shape: { points: [...upper, ...lower.reverse()] },
        style: { fill: series.colour, opacity: 0.22 },
      };
    },
  };
}

function barsOf(bars: TimeBars, axes: Axes, low: number, high: number): CustomSeriesOption {
  return {
    ...axes,
    type: "custom",
    name: bars.name,
    silent: true,
    clip: true,
    z: 2,
    data: [[0, 0]],
    renderItem: (_, api) => {
      // One path for all: thousands of separate bars would be slow.
      let path = "";
      for (let i = 0; i < bars.row.length; ++i) {
        const [from, to, row] = [bars.from[i] ?? NaN, bars.to[i] ?? NaN, bars.row[i] ?? NaN];
        if (!(to >= low && from <= high)) continue;
        const a = api.coord([Math.max(from, low), row]);
        const b = api.coord([Math.min(to, high), row]);
        const x = a[0] ?? 0;
        path += `M${x.toFixed(1)} ${(a[1] ?? 0).toFixed(1)}H${Math.max(b[0] ?? 0, x + 0.7).toFixed(1)}`;
      }
      return {
        type: "path",
        shape: { pathData: path || "M0 0" },
        style: { stroke: bars.colour, fill: "none", lineWidth: bars.width },
      };
    },
  };
}

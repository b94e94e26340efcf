// The trajectory from three sides: orthographic views on x-y, x-z and y-z, at one scale. They can be printed and saved
// as SVG, which the view in 3D can't.
import type { LineSeriesOption, ScatterSeriesOption } from "echarts/charts";
import { Chart, type Drawing, type Option } from "./chart";
import type { Columns3, Trajectory } from "./data";
import { columns3, numbers, vectorAt, type Vector3 } from "./decode";
import { element, formatTick } from "./dom";
import { legendOption, type LegendEntry } from "./legend";
import type { State } from "./state";
import { colourOf, dashOf, type Colours } from "./theme";
import { estimatesOf } from "./time_plots";

const SIDES: [number, number][] = [
  [0, 1],
  [0, 2],
  [1, 2],
];
const NAMES = ["x [m]", "y [m]", "z [m]"];

interface Box {
  least: Vector3;
  most: Vector3;
}

/// Of all trajectories that are shown; landmarks may lie far away and do not count.
function bounds(trajectories: Trajectory[]): Box {
  const box: Box = { least: [Infinity, Infinity, Infinity], most: [-Infinity, -Infinity, -Infinity] };
  for (const { p } of trajectories) {
    columns3(p).forEach((values, axis) => {
      for (const value of values) {
        if (!Number.isFinite(value)) continue;
        box.least[axis] = Math.min(box.least[axis] ?? Infinity, value);
        box.most[axis] = Math.max(box.most[axis] ?? -Infinity, value);
      }
    });
  }
  return box;
}

function line(points: Columns3, [across, up]: [number, number]): Float64Array {
  const columns = columns3(points);
  const [x, y] = [columns[across], columns[up]];
  const data = new Float64Array(2 * (x?.length ?? 0));
  for (let i = 0; 2 * i < data.length; ++i) {
    data[2 * i] = x?.[i] ?? NaN;
    data[2 * i + 1] = y?.[i] ?? NaN;
  }
  return data;
}

function positionNow(state: State, index: number): Vector3 | null {
  const run = state.payload.runs[index];
  if (!run) return null;
  for (const { estimate } of estimatesOf(run, state.estimate)) {
    const p = vectorAt(numbers(estimate.t), estimate.p, state.time);
    if (p.every((value) => Number.isFinite(value))) return p;
  }
  return null;
}

/// Where the run in focus was lost: its last position before.
export function lossesOf(state: State): { t: number; p: Vector3 }[] {
  const { run } = state;
  if (!run) return [];
  return run.events
    .filter((event) => event.kind === "lost")
    .flatMap((event) => {
      let best: { t: number; p: Vector3 } | null = null;
      for (const { estimate } of estimatesOf(run, state.estimate)) {
        const t = numbers(estimate.t);
        const [x, y, z] = columns3(estimate.p);
        for (let i = 0; i < t.length && (t[i] ?? Infinity) <= event.t + 0.05; ++i) {
          if (Number.isFinite(x[i]) && (t[i] ?? 0) > (best?.t ?? -Infinity)) best = { t: t[i] ?? 0, p: [x[i] ?? NaN, y[i] ?? NaN, z[i] ?? NaN] };
        }
      }
      return best ? [{ t: event.t, p: best.p }] : [];
    });
}

export function sideViews(state: State): HTMLElement {
  let grids: { x: number; y: number; width: number; height: number; xs: [number, number]; ys: [number, number] }[] = [];
  const dots = element("div", { class: "dots" });
  const legend = element("span", { class: "note" }, "dots: at the time of the cursor; ✕: tracking lost; grey: landmarks");

  const draw = (width: number, of: Colours, complete: boolean): Drawing | null => {
    const truth = state.sequence?.ground_truth ?? null;
    const shown = state.shown.flatMap((index) => {
      const run = state.payload.runs[index];
      return run ? estimatesOf(run, state.estimate).map((part) => ({ ...part, name: run.name, slot: state.slot(index) })) : [];
    });
    const all = [...shown.map(({ estimate }) => estimate), ...(truth ? [truth] : [])];
    const box = bounds(all);
    if (!box.most.every((value, i) => value >= (box.least[i] ?? NaN))) return null;
    const columns = width < 560 ? 1 : 3;
    const [left, right, gap, below] = [52, 10, 14, 42];
    const top = complete ? 10 + 20 * Math.ceil((shown.length + 1) / 3) : 10;
    const cell = width / columns;
    const across = cell - left - right;
    const up = columns === 1 ? Math.min(240, 0.7 * across) : Math.min(300, Math.max(170, 0.95 * across));
    const metres = SIDES.map(([a, b]) => Math.max((box.most[a] ?? 0) - (box.least[a] ?? 0), 1e-6) / across + 0 * b);
    const needed = SIDES.map(([, b]) => Math.max((box.most[b] ?? 0) - (box.least[b] ?? 0), 1e-6) / up);
    const scale = 1.12 * Math.max(...metres, ...needed); // [m] a pixel, of all views
    const places = SIDES.map(([a, b], i) => {
      const middle = (axis: number): number => ((box.most[axis] ?? 0) + (box.least[axis] ?? 0)) / 2;
      const around = (axis: number, size: number): [number, number] => [middle(axis) - (scale * size) / 2, middle(axis) + (scale * size) / 2];
      const row = Math.floor(i / columns);
      return { x: (i % columns) * cell + left, y: top + row * (up + gap + below), width: across, height: up, xs: around(a, across), ys: around(b, up) };
    });
    if (!complete) grids = places;
    const axis = (index: number, name: string, limits: [number, number], nameGap: number): object => ({
      gridIndex: index,
      type: "value",
      min: limits[0],
      max: limits[1],
      name,
      nameLocation: "middle",
      nameGap,
      nameTextStyle: { color: of.text, fontSize: 11 },
      splitNumber: 4,
      axisLine: { show: true, onZero: false, lineStyle: { color: of.faint } },
      axisLabel: { color: of.faint, fontSize: 11, formatter: formatTick, showMinLabel: false, showMaxLabel: false, hideOverlap: true },
      splitLine: { lineStyle: { color: of.grid } },
    });
    const series: (LineSeriesOption | ScatterSeriesOption)[] = [];
    SIDES.forEach((side, index) => {
      const axes = { xAxisIndex: index, yAxisIndex: index, silent: true, clip: true };
      for (const segment of state.run?.segments ?? []) {
        series.push({
          ...axes,
          type: "scatter",
          data: line(segment.landmarks, side) as never,
          dimensions: ["x", "y"],
          symbolSize: 2.2,
          itemStyle: { color: of.faint, opacity: 0.55 },
          z: 1,
        });
      }
      for (const { estimate, scored, name, slot } of shown) {
        series.push({
          ...axes,
          type: "line",
          name,
          data: line(estimate.p, side) as never,
          dimensions: ["x", "y"],
          showSymbol: false,
          lineStyle: { color: colourOf(slot, of), width: 1.5, type: scored ? dashOf(slot) : [1, 3] },
          itemStyle: { color: colourOf(slot, of) },
          z: 3,
        });
      }
      if (truth) {
        series.push({
          ...axes,
          type: "line",
          name: "ground truth",
          data: line(truth.p, side) as never,
          dimensions: ["x", "y"],
          showSymbol: false,
          lineStyle: { color: of.truth, width: 1, type: [4, 3] },
          itemStyle: { color: of.truth },
          z: 4,
        });
      }
      const losses = lossesOf(state).map(({ p }) => [p[side[0]] ?? NaN, p[side[1]] ?? NaN]);
      series.push({ ...axes, type: "scatter", data: losses, symbol: "path://M0 0L8 8M8 0L0 8", symbolSize: 11, itemStyle: { color: "transparent", borderColor: of.warn, borderWidth: 2.5 }, z: 5 });
    });
    const names: [string, LegendEntry][] = shown.map(({ name, slot }) => [name, { colour: colourOf(slot, of) }]);
    if (truth) names.push(["ground truth", { colour: of.truth }]);
    const rows = Math.ceil(SIDES.length / columns);
    const option = {
      grid: places.map(({ x, y, width: w, height: h }) => ({ left: x, top: y, width: w, height: h })),
      xAxis: SIDES.map(([a], i) => axis(i, NAMES[a] ?? "", places[i]?.xs ?? [0, 1], 24)),
      yAxis: SIDES.map(([, b], i) => axis(i, NAMES[b] ?? "", places[i]?.ys ?? [0, 1], 36)),
      series,
      ...(complete ? legendOption([...new Map(names)], of, width) : {}),
    } as Option;
    return { option, height: top + rows * (up + gap + below) - gap };
  };

  const chart = new Chart("From three sides", () => `three sides ${state.run?.name ?? ""}`, draw, {
    hint: "The selected run has no trajectory.",
    extra: legend,
    height: 380,
  });
  chart.plot.append(dots);

  const moveDots = (): void => {
    if (!chart.view.visible) return;
    const marks: HTMLElement[] = [];
    for (const index of state.shown) {
      const p = positionNow(state, index);
      if (!p) continue;
      grids.forEach((grid, i) => {
        const [a, b] = SIDES[i] ?? [0, 1];
        const x = ((p[a] ?? NaN) - grid.xs[0]) / (grid.xs[1] - grid.xs[0]);
        const y = ((p[b] ?? NaN) - grid.ys[0]) / (grid.ys[1] - grid.ys[0]);
        if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1)) return;
        const dot = element("span", { class: "dot" });
        dot.style.left = `${grid.x + x * grid.width}px`;
        dot.style.top = `${grid.y + (1 - y) * grid.height}px`;
        dot.style.background = colourOf(state.slot(index));
        marks.push(dot);
      });
    }
    dots.replaceChildren(...marks);
  };
  chart.onDrawn = moveDots;
  state.on("time", moveDots);
  for (const topic of ["selection", "theme", "estimate"] as const) state.on(topic, () => chart.view.invalidate());
  return chart.element;
}

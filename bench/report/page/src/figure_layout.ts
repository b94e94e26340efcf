// Where the panels of a figure lie, and their axes.
import type { Figure, Panel } from "./data";
import { formatTick } from "./dom";
import type { Colours } from "./theme";

const LEFT = 64; // [px] beside the panels
const RIGHT = 22;
const NAMES = 190; // left of boxes

export interface Place {
  panel: Panel;
  index: number; // of the panel
  x: number;
  y: number;
  width: number;
  height: number;
  xs: [number, number]; // limits of the axes
  ys: [number, number];
}

export function finite(values: (number | null | undefined)[]): number[] {
  return values.filter((value): value is number => typeof value === "number" && Number.isFinite(value));
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
export function logTicks(low: number, high: number): number[] {
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

export function axisOption(axis: Panel["x"], limits: [number, number], of: Colours, place: Place, gap: number): object {
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

export function namesAxis(place: Place, of: Colours): object {
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

export function cellAxes(place: Place, of: Colours): { x: object; y: object } {
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

/// Places of the panels, in rows. Narrow pages have one column.
export function layout(figure: Figure, width: number, top: number): { places: Place[]; height: number } {
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

export function failureRows(panel: Panel): number {
  return new Set(panel.marks.filter((mark) => mark.kind === "failures").map((mark) => mark.series)).size;
}

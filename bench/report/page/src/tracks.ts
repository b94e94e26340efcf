// What the back-end worked with over time: tracks and their re-acquisitions, landmarks, update times, and the prior and
// noise that it learnt.
import type { Parameters } from "./data";
import { numbers } from "./decode";
import { element } from "./dom";
import type { State } from "./state";
import { colourOf, dashOf, type Colours } from "./theme";
import { TimeChart } from "./time_chart";
import type { TimePanel, TimeSeries } from "./time_panels";

function trackPanels(state: State, of: Colours): TimePanel[] {
  const tracks = state.run?.tracks;
  if (!tracks) return [];
  const [row, from, to, again] = [tracks.row, tracks.from, tracks.to, tracks.reacquired].map(numbers) as [Float64Array, Float64Array, Float64Array, Float64Array];
  const pieces = (reacquired: boolean): number[] => [...row.keys()].filter((i) => (again[i] ?? 0) > 0.5 === reacquired);
  const bars = (name: string, which: number[], colour: string, width: number): NonNullable<TimePanel["bars"]>[number] => ({
    name,
    row: Float64Array.from(which, (i) => row[i] ?? NaN),
    from: Float64Array.from(which, (i) => from[i] ?? NaN),
    to: Float64Array.from(which, (i) => to[i] ?? NaN),
    colour,
    width,
  });
  const found = pieces(true);
  return [
    {
      label: "track",
      series: [],
      bars: [bars("life of a track", pieces(false), colourOf(0, of), 1), ...(found.length > 0 ? [bars("re-acquired", found, colourOf(1, of), 2.5)] : [])],
      height: 240,
    },
  ];
}

function countPanels(state: State, of: Colours): TimePanel[] {
  const panels: TimePanel[] = [
    { label: "live tracks", series: [], zero: true },
    { label: "landmarks", series: [], zero: true },
    { label: "control states", series: [], zero: true },
  ];
  for (const index of state.shown) {
    const run = state.payload.runs[index];
    const slot = state.slot(index);
    const add = (axis: number, t: Float64Array, y: Float64Array): void => {
      panels[axis]?.series.push({ name: run?.name ?? "", t, y, colour: colourOf(slot, of), dash: dashOf(slot), steps: true });
    };
    if (run?.tracks) add(0, numbers(run.tracks.live_t), numbers(run.tracks.live));
    if (run?.updates) {
      add(1, numbers(run.updates.t), numbers(run.updates.landmarks));
      add(2, numbers(run.updates.t), numbers(run.updates.states));
    }
  }
  return panels;
}

function updatePanels(state: State, of: Colours): TimePanel[] {
  const series: TimeSeries[] = [];
  for (const index of state.shown) {
    const run = state.payload.runs[index];
    if (!run?.updates) continue;
    const slot = state.slot(index);
    const ms = numbers(run.updates.ms).map((value) => (value > 0 ? value : NaN));
    series.push({ name: run.name, t: numbers(run.updates.t), y: ms, colour: colourOf(slot, of), dash: "solid", width: 1 });
  }
  return series.length > 0 ? [{ label: "update [ms]", series, log: true, height: 180 }] : [];
}

/// Columns that differ in their axis alone share a panel: qc_rotation_x, _y, _z.
function parameterPanels(state: State, of: Colours): TimePanel[] {
  const { run } = state;
  const parameters: Parameters | null | undefined = run?.parameters;
  if (!parameters) return [];
  const t = numbers(parameters.t);
  const groups = new Map<string, { label: string; columns: Parameters["columns"] }>();
  for (const column of parameters.columns) {
    const name = column.name.replace(/_[xyz]$/, "");
    const group = groups.get(name) ?? { label: column.unit ? `${name}\n[${column.unit}]` : name, columns: [] };
    group.columns.push(column);
    groups.set(name, group);
  }
  return [...groups.values()].map(({ label, columns }) => {
    const series = columns.map((column, i): TimeSeries => {
      const axis = /_([xyz])$/.exec(column.name)?.[1];
      return { name: axis ?? column.name, t, y: numbers(column.values), colour: colourOf(columns.length > 1 ? i : 0, of), dash: columns.length > 1 ? dashOf(i) : "solid" };
    });
    const values = series.flatMap(({ y }) => [...y]).filter((value) => Number.isFinite(value));
    const wide = values.length > 0 && values.every((value) => value > 0) && values.reduce((a, b) => Math.max(a, b), 0) > 10 * values.reduce((a, b) => Math.min(a, b), Infinity);
    return { label, series, log: wide, height: 96 };
  });
}

export function trackPlots(state: State): HTMLElement {
  const tracks = new TimeChart(
    state,
    "Life of the tracks",
    (of) => trackPanels(state, of),
    "This run kept no tracks: evbench run --tracks does.",
    300,
    shareNote(state),
  );
  const counts = new TimeChart(state, "Live tracks and size of the problem", (of) => countPanels(state, of), "The selected run has no updates.", 440);
  const updates = new TimeChart(state, "Time of each update", (of) => updatePanels(state, of), "The selected run has no updates.", 240);
  const parameters = new TimeChart(
    state,
    "Learnt prior and noise",
    (of) => parameterPanels(state, of),
    "This back-end estimates no parameters.",
    600,
    element("span", { class: "note" }, "of the selected run, from estimated_parameters.csv"),
  );
  return element("div", { class: "charts" }, ...[tracks, updates, counts, parameters].map((chart) => chart.chart.element));
}

/// How many of all tracks are drawn.
function shareNote(state: State): HTMLElement {
  const note = element("span", { class: "note" });
  const update = (): void => {
    const tracks = state.run?.tracks;
    const drawn = tracks ? new Set(numbers(tracks.row)).size : 0;
    note.textContent = !tracks ? "" : drawn < tracks.total ? `${drawn} of ${tracks.total} tracks of the selected run` : `${tracks.total} tracks of the selected run`;
  };
  state.on("selection", update);
  update();
  return note;
}

// Position, orientation, velocity and errors over time, of all runs that are shown.
import type { Columns3, Estimate, Run, Trajectory } from "./data";
import { angles, columns3, numbers } from "./decode";
import { element } from "./dom";
import type { State } from "./state";
import { colourOf, dashOf, type Colours } from "./theme";
import { TimeChart } from "./time_chart";
import type { TimePanel, TimeSeries } from "./time_panels";

type Three = [Float64Array, Float64Array, Float64Array];
const DEGREES = 180 / Math.PI;

/// The estimates to draw: all trajectory segments of the smoothed one, or the causal one.
export function estimatesOf(run: Run, kind: State["estimate"]): { estimate: Estimate; scored: boolean }[] {
  if (kind === "causal") return run.causal ? [{ estimate: run.causal, scored: true }] : [];
  return run.segments.map(({ estimate, scored }) => ({ estimate, scored }));
}

function truthSeries(state: State, of: Colours, values: (truth: Trajectory) => Three | null): (TimeSeries | null)[] {
  const truth = state.sequence?.ground_truth;
  const three = truth ? values(truth) : null;
  if (!truth || !three) return [null, null, null];
  const t = numbers(truth.t);
  return three.map((y) => ({ name: "ground truth", t, y, colour: of.truth, dash: [4, 3], width: 1.1 }));
}

/// Three panels of a quantity: estimates of all shown runs, the band of the one in focus, ground truth on top.
function threePanels(
  state: State,
  of: Colours,
  labels: [string, string, string],
  values: (trajectory: Trajectory) => Three | null,
  bands: ((run: Run) => TimeSeries[] | null) | null,
): TimePanel[] {
  const panels: TimePanel[] = labels.map((label) => ({ label, series: [] }));
  const add = (axis: number, series: TimeSeries | null | undefined): void => {
    if (series) panels[axis]?.series.push(series);
  };
  for (const index of state.shown) {
    const run = state.payload.runs[index];
    if (!run) continue;
    const slot = state.slot(index);
    const colour = colourOf(slot, of);
    if (index === state.focus && bands) bands(run)?.forEach((series, axis) => add(axis, { ...series, colour }));
    for (const { estimate, scored } of estimatesOf(run, state.estimate)) {
      const three = values(estimate);
      if (!three) continue;
      const t = numbers(estimate.t);
      three.forEach((y, axis) => {
        const dash = scored ? dashOf(slot) : [1, 3];
        add(axis, { name: run.name + (scored ? "" : " (segment not scored)"), t, y, colour, dash });
      });
    }
  }
  truthSeries(state, of, values).forEach((series, axis) => add(axis, series));
  return panels.some((panel) => panel.series.length > 0) ? panels : [];
}

function band(name: string, t: Float64Array, centre: Three, sigma: Columns3): TimeSeries[] {
  return columns3(sigma).map((s, axis) => {
    const y = centre[axis] ?? new Float64Array();
    return {
      name,
      t,
      y,
      colour: "",
      hidden: true,
      band: { low: y.map((value, i) => value - 3 * (s[i] ?? NaN)), high: y.map((value, i) => value + 3 * (s[i] ?? NaN)) },
    };
  });
}

function scaled(columns: Columns3 | undefined, factor: number): Three | null {
  if (!columns) return null;
  return columns3(columns).map((values) => values.map((value) => factor * value)) as Three;
}

function errorPanels(state: State, of: Colours): TimePanel[] {
  const panels: TimePanel[] = [
    { label: "ATE [m]", series: [], zero: true },
    { label: "ATE [deg]", series: [], zero: true },
  ];
  for (const index of state.shown) {
    const run = state.payload.runs[index];
    if (!run) continue;
    const slot = state.slot(index);
    for (const { estimate } of estimatesOf(run, state.estimate)) {
      [estimate.error_m, estimate.error_deg].forEach((column, axis) => {
        if (!column) return;
        panels[axis]?.series.push({
          name: run.name,
          t: numbers(estimate.t),
          y: numbers(column),
          colour: colourOf(slot, of),
          dash: dashOf(slot),
        });
      });
    }
  }
  return panels;
}

/// Errors of the newest poses against their own uncertainty, of the run in focus.
function consistencyPanels(state: State, of: Colours): TimePanel[] {
  const { run } = state;
  const newest = run?.newest;
  if (!run || !newest?.error_m || !newest.error_deg) return [];
  const colour = colourOf(state.slot(state.focus), of);
  const t = numbers(newest.t);
  const none = new Float64Array(t.length);
  const panels: TimePanel[] = [];
  const add = (labels: string[], errors: Columns3, sigma: Columns3): void => {
    const bands = band("±3σ", t, [none, none, none], sigma);
    columns3(errors).forEach((y, axis) => {
      const around = bands[axis];
      panels.push({
        label: labels[axis] ?? "",
        series: [...(around ? [{ ...around, colour }] : []), { name: "error of the newest pose", t, y, colour }],
        height: 84,
      });
    });
  };
  add(["x [m]", "y [m]", "z [m]"], newest.error_m, newest.sigma_m);
  add(["roll [deg]", "pitch [deg]", "yaw [deg]"], newest.error_deg, newest.sigma_deg);
  return panels;
}

export function timePlots(state: State): HTMLElement {
  const none = "The selected run has no estimate to draw, nor ground truth.";
  const bandNote = element("span", { class: "note" }, "band: ±3σ of the newest causal pose");
  const position = new TimeChart(
    state,
    "Position",
    (of) =>
      threePanels(state, of, ["x [m]", "y [m]", "z [m]"], (trajectory) => columns3(trajectory.p), ({ newest }) =>
        newest ? band("±3σ", numbers(newest.t), columns3(newest.p), newest.sigma_m) : null,
      ),
    none,
    440,
    bandNote,
  );
  const orientation = new TimeChart(
    state,
    "Orientation",
    (of) =>
      threePanels(state, of, ["roll [deg]", "pitch [deg]", "yaw [deg]"], (trajectory) => angles(trajectory.q), ({ newest }) =>
        newest ? band("±3σ", numbers(newest.t), angles(newest.q), newest.sigma_deg) : null,
      ),
    none,
    440,
    bandNote.cloneNode(true) as HTMLElement,
  );
  const velocity = new TimeChart(
    state,
    "Velocity",
    (of) => threePanels(state, of, ["v_x [m/s]", "v_y [m/s]", "v_z [m/s]"], (trajectory) => scaled(trajectory.v, 1), null),
    "The selected run has no velocities.",
    440,
    element("span", { class: "note" }, "in the camera's frame"),
  );
  const angular = new TimeChart(
    state,
    "Angular velocity",
    (of) =>
      threePanels(state, of, ["ω_x [deg/s]", "ω_y [deg/s]", "ω_z [deg/s]"], (trajectory) => scaled(trajectory.w, DEGREES), null),
    "The selected run has no angular velocities.",
    440,
    element("span", { class: "note" }, "in the camera's frame"),
  );
  const errors = new TimeChart(
    state,
    "Absolute trajectory error",
    (of) => errorPanels(state, of),
    "No errors: the sequence has no ground truth, or the run no estimate.",
    300,
  );
  const consistency = new TimeChart(
    state,
    "Error of the newest pose and its 3σ",
    (of) => consistencyPanels(state, of),
    "This back-end gives no covariances, or the sequence has no ground truth.",
    640,
  );
  errors.chart.element.classList.add("wide");
  const all = [errors, position, orientation, velocity, angular, consistency];
  return element("div", { class: "charts" }, ...all.map((chart) => chart.chart.element));
}

// The data of the page: what `evbench report` writes, as JSON, into <script type="application/json" id="data">, with
// every "<" written as \u003c. JSON has no NaN and no infinity: see Column, Cell and Mark for what stands for them.
//
// Units: seconds, metres, radians and pixels, unless a comment or a name says otherwise. Poses are T_world_camera, the
// camera's z forward, quaternions Hamilton's. All poses, landmarks and velocities of a run are given as it was scored:
// aligned to the ground truth, with the scale of the alignment. Without ground truth they are as the back-end has them.

/// A series of numbers. Of one object's columns all have the same length.
///  - `f32`: base64 of little-endian Float32; NaN: missing.
///  - `i16`: base64 of little-endian Int16 k, standing for offset + scale * k; k = -32768: missing.
///  - `from`, `step`, `n`: equidistant, from + step * k.
///  - a list: as it is; null: missing.
export type Column =
  | { f32: string }
  | { i16: string; scale: number; offset: number }
  | { from: number; step: number; n: number }
  | (number | null)[];

export type Columns3 = [Column, Column, Column];
export type Columns4 = [Column, Column, Column, Column];

export interface Payload {
  format: "evbench.report";
  version: 1;
  title: string; // of the page: names of the experiments
  created: string; // ISO 8601, UTC
  program: string; // "evbench 0.1.0 (commit; build)"
  command: string; // that wrote the page
  about: Fact[]; // what was run: source, front-end, back-ends, host, ... in this order
  protocol: string[]; // sentences
  remarks: string[]; // what a reader should know, such as thinned series or runs left out
  tables: Table[];
  figures: NamedFigure[];
  sequences: Sequence[];
  runs: Run[]; // tables and figures name runs by their index in this list
}

export interface Fact {
  name: string;
  value: string;
}

// --- Tables: as `evbench table` prints them -------------------------------------------------------------------------

export interface Table {
  title: string;
  file: string; // name of its CSV file, without extension
  columns: { header: string; number: boolean; key?: string }[]; // key: of metrics.json
  rows: { runs: number[]; cells: Cell[] }[]; // runs: one in a table of runs, several in a summary, or none
  notes: string[]; // below the table, a sentence or more each; explain bold and its test
}

/// A cell: its text, or more. A cell of a number column without a `value` ("-", "fails") is sorted below all others.
export type Cell =
  | string
  | {
      text: string;
      value?: number | null; // unrounded, for sorting and CSV, in the header's unit
      detail?: string; // small, after the text: quartiles, a sentence
      best?: boolean; // bold
    };

// --- Figures: struct Figure of bench/figures/figure.hpp, as drawing_script() writes it -------------------------------

export interface NamedFigure {
  title: string;
  file: string; // name of its picture, without extension
  figure: Figure;
}

export interface Figure {
  width_mm: number;
  height_mm: number; // of the panels
  columns: number;
  legend: boolean;
  alike: boolean; // a metre is as long in all panels
  caption: string;
  series: { label: string; truth: boolean; number: number }[]; // number: of its colour
  panels: Panel[];
}

export interface Panel {
  x: PanelAxis;
  y: PanelAxis;
  names: string[]; // of boxes, from the top
  equal: boolean; // a metre is as long on both axes
  title: string;
  marks: Mark[];
}

export interface PanelAxis {
  label: string;
  scale: "linear" | "log";
  share: boolean; // from 0 to 1
  ends: (number | null)[]; // values with a tick
}

/// null: not finite, not drawn.
export interface Mark {
  kind: "line" | "points" | "band" | "level" | "steps" | "failures" | "box" | "cells";
  series: number;
  x: (number | null)[];
  y: (number | null)[];
  low: (number | null)[];
  high: (number | null)[];
  runs?: number[][]; // of each point (level: one list; box: of each value y; failures: those that failed)
}

// --- Sequences and runs ----------------------------------------------------------------------------------------------

/// What was seen: runs of one sequence can be compared over time and in space. A source with its settings and a seed.
export interface Sequence {
  name: string;
  from: number; // [s] the time that was run
  to: number; // [s]
  ground_truth: Trajectory | null; // between `from` and `to`
}

/// Poses over time. A missing value in `p` interrupts the line.
export interface Trajectory {
  t: Column; // [s], increasing
  p: Columns3; // [m] position
  q: Columns4; // orientation: x, y, z, w
  v?: Columns3; // [m/s] velocity of the camera, in the camera's frame
  w?: Columns3; // [rad/s] angular velocity, in the camera's frame
}

/// An estimated trajectory.
export interface Estimate extends Trajectory {
  error_m?: Column; // absolute trajectory error at t, as scored; missing where no ground truth is near
  error_deg?: Column;
}

/// Uncertainty of the newest pose as it was published, from covariance.txt, kind "newest".
export interface Uncertainty {
  t: Column;
  p: Columns3; // [m] that pose's position
  q: Columns4;
  sigma_m: Columns3; // standard deviations of the position, along the world's axes
  sigma_deg: Columns3; // of roll, pitch and yaw (see angles() in decode.ts)
  error_m?: Columns3; // position minus ground truth
  error_deg?: Columns3; // roll, pitch, yaw minus those of the ground truth, in (-180, 180]
}

/// A trajectory segment: part of the estimate in one world frame and scale.
export interface Segment {
  from: number; // [s]
  to: number;
  scored: boolean;
  note: string; // such as "not aligned: no ground truth"; empty: none
  poses: number; // how many there are, before thinning
  estimate: Estimate; // smoothed (final)
  landmarks: Columns3; // [m] of the final map, thinned; f32, since some are very far away
  landmarks_total: number;
}

export interface Run {
  name: string; // distinguishes it from all others: label and settings that vary
  label: string;
  experiment: string;
  folder: string;
  key: string;
  sequence: number; // index in Payload.sequences
  settings: Fact[]; // those in which runs differ, seed included
  state: "ok" | "degraded" | "lost" | "failed" | "not run";
  reason: string; // a sentence, or empty
  time: number | null; // [s] of the event that set the state
  alignment: string; // "Sim(3), scale 2.49"; empty: not aligned
  scores: Fact[]; // main scores with units: "ATE", "0.0245 m"
  segments: Segment[]; // in time order; empty: no estimate
  causal: Estimate | null; // each pose as first published
  newest: Uncertainty | null;
  control_times: Column | null; // [s] of control states (gp_map) or of batches' poses (bundle_adjustment)
  periods: Period[];
  events: RunEvent[]; // in time order
  tracks: Tracks | null; // only where the run kept its tracks (--tracks)
  updates: Updates | null; // timing.csv
  parameters: Parameters | null; // estimated_parameters.csv
  log: string; // log.txt, or its first and last lines
  config: string; // config.json, or ""
}

export interface Period {
  kind: "stationary" | "degraded" | "lost";
  from: number; // [s]
  to: number;
  text: string;
}

/// As in metrics.json, "events".
export interface RunEvent {
  t: number; // [s]
  kind: string;
  text: string;
}

/// Tracks in the image. A piece is what lies between a track's beginning, or its re-acquisition, and its end.
export interface Tracks {
  total: number; // tracks that there were; the columns below may have fewer of them
  row: Column; // number of the track that a piece belongs to, in order of their first observation
  from: Column; // [s] of a piece: first and last observation
  to: Column;
  reacquired: Column; // 1: the piece continues a track that had ended; else 0
  live_t: Column; // [s]
  live: Column; // number of live tracks, of all, at live_t
}

/// Updates of the estimate. Where they are thinned, each stands for some: the slowest one.
export interface Updates {
  total: number;
  t: Column; // [s]
  ms: Column; // [ms] duration
  states: Column; // size of the problem
  landmarks: Column;
}

export interface Parameters {
  t: Column; // [s]
  columns: { name: string; unit: string; values: Column }[]; // names as in the file
}

export function readPayload(): Payload {
  const text = document.getElementById("data")?.textContent ?? "";
  if (!text.trim().startsWith("{")) throw new Error("This page has no data: it is the template of evbench report.");
  const data: unknown = JSON.parse(text);
  const { format, version } = data as { format?: unknown; version?: unknown };
  if (format !== "evbench.report" || version !== 1) {
    throw new Error("The data of this page are of another version of evbench report.");
  }
  return data as Payload;
}

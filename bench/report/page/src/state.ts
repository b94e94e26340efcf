// What the reader has chosen: runs, time, zoom and theme. Every view listens to the topics that it shows.
import type { Payload, Run, Sequence } from "./data";
import { numbers } from "./decode";

export type Topic = "selection" | "time" | "zoom" | "theme" | "estimate";

export const MOST_COMPARED = 8; // as many colours as can be told apart

/// The smoothed (final) estimate, or each pose as first published.
export type EstimateKind = "final" | "causal";

export class State {
  readonly payload: Payload;
  focus = 0; // the run that is shown in full; -1: there is none
  readonly compared = new Set<number>(); // runs drawn with it, if they are of its sequence
  group: number[] | null = null; // runs of a point clicked in a figure: tables show these only
  groupName = "";
  time = 0; // [s]
  zoom: [number, number] | null = null; // [s] of all time plots; null: the whole sequence
  estimate: EstimateKind = "final";
  private readonly listeners = new Map<Topic, (() => void)[]>();

  constructor(payload: Payload) {
    this.payload = payload;
    // The first run of the first table that has an estimate: tables have an order that means something.
    const listed = payload.tables.flatMap((table) => table.rows.flatMap((row) => (row.runs.length === 1 ? row.runs : [])));
    const candidates = [...listed, ...payload.runs.keys()].filter((run) => payload.runs[run] !== undefined);
    this.focus = candidates.find((run) => payload.runs[run]?.segments.length) ?? candidates[0] ?? -1;
    this.time = this.end();
  }

  /// Where the estimate of the run in focus ends: there the whole trajectory is drawn.
  private end(): number {
    const ends = (this.run?.segments ?? []).map((segment) => numbers(segment.estimate.t).at(-1) ?? -Infinity);
    const last = Math.max(...ends);
    return Number.isFinite(last) ? last : (this.sequence?.to ?? 0);
  }

  on(topic: Topic, listener: () => void): void {
    const list = this.listeners.get(topic) ?? [];
    list.push(listener);
    this.listeners.set(topic, list);
  }

  emit(topic: Topic): void {
    for (const listener of this.listeners.get(topic) ?? []) listener();
  }

  get run(): Run | undefined {
    return this.payload.runs[this.focus];
  }

  get sequence(): Sequence | undefined {
    return this.payload.sequences[this.run?.sequence ?? -1];
  }

  /// Indices of the runs that are drawn: the one in focus, and those compared with it, in the order of the report.
  get shown(): number[] {
    const sequence = this.run?.sequence;
    const others = [...this.compared].filter((i) => i !== this.focus && this.payload.runs[i]?.sequence === sequence);
    return [...(this.focus < 0 ? [] : [this.focus]), ...others.slice(0, MOST_COMPARED - 1)].sort((a, b) => a - b);
  }

  /// The colour of a run: its place among those shown; -1: it is not shown.
  slot(run: number): number {
    return this.shown.indexOf(run);
  }

  get range(): [number, number] {
    const sequence = this.sequence;
    return sequence ? [sequence.from, sequence.to] : [0, 1];
  }

  get window(): [number, number] {
    return this.zoom ?? this.range;
  }

  select(run: number): void {
    if (run === this.focus || !this.payload.runs[run]) return;
    const before = this.run?.sequence;
    this.focus = run;
    if (this.run?.sequence !== before) {
      this.zoom = null;
      this.time = this.end();
    }
    this.emit("selection");
  }

  compare(run: number, also: boolean): void {
    if (also) this.compared.add(run);
    else this.compared.delete(run);
    this.emit("selection");
  }

  /// Selects the runs of a point in a figure.
  selectGroup(runs: number[], name: string): void {
    const first = runs[0];
    if (first === undefined) return;
    this.group = runs.length > 1 ? runs : null;
    this.groupName = name;
    if (this.focus === first) this.emit("selection");
    else this.select(first);
  }

  clearGroup(): void {
    this.group = null;
    this.emit("selection");
  }

  setTime(t: number): void {
    const [from, to] = this.range;
    this.time = Math.min(to, Math.max(from, t));
    this.emit("time");
  }

  setZoom(zoom: [number, number] | null): void {
    const [from, to] = this.range;
    if (zoom) {
      const shortest = 1e-4 * (to - from);
      const low = Math.max(from, Math.min(...zoom));
      const high = Math.min(to, Math.max(...zoom));
      this.zoom = high - low < shortest ? this.zoom : low <= from && high >= to ? null : [low, high];
    } else {
      this.zoom = null;
    }
    this.emit("zoom");
  }

  /// Zooms by a factor around the cursor, or around the middle where the cursor is not in view.
  zoomBy(factor: number): void {
    const [low, high] = this.window;
    const centre = this.time >= low && this.time <= high ? this.time : (low + high) / 2;
    this.setZoom([centre + (low - centre) * factor, centre + (high - centre) * factor]);
  }

  setEstimate(kind: EstimateKind): void {
    this.estimate = kind;
    this.emit("estimate");
  }
}

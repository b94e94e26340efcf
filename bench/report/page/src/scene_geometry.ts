// Points of trajectories as three.js takes them.
import { BufferAttribute, BufferGeometry } from "three";
import type { Columns3, Trajectory } from "./data";
import { columns3, numbers } from "./decode";

const MOST_POINTS = 2000; // of a trajectory, about: more cannot be seen, and take time without a graphics card

export function points(columns: Columns3): Float32Array {
  const [x, y, z] = columns3(columns);
  const values: number[] = [];
  for (let i = 0; i < x.length; ++i) {
    if (Number.isFinite(x[i])) values.push(x[i] ?? 0, y[i] ?? 0, z[i] ?? 0);
  }
  return Float32Array.from(values);
}

/// Runs of points without a missing one between them.
export function stretches(trajectory: Trajectory): { t: Float64Array; p: Float32Array }[] {
  const t = numbers(trajectory.t);
  const [x, y, z] = columns3(trajectory.p);
  const parts: { t: number[]; p: number[] }[] = [];
  let open: { t: number[]; p: number[] } | null = null;
  const step = Math.max(1, Math.floor(t.length / MOST_POINTS));
  for (let i = 0; i < t.length; ++i) {
    if (!Number.isFinite(x[i])) {
      open = null;
      continue;
    }
    if (open && i % step !== 0 && i !== t.length - 1) continue;
    if (!open) parts.push((open = { t: [], p: [] }));
    open.t.push(t[i] ?? NaN);
    open.p.push(x[i] ?? 0, y[i] ?? 0, z[i] ?? 0);
  }
  return parts.filter((part) => part.t.length > 1).map((part) => ({ t: Float64Array.from(part.t), p: Float32Array.from(part.p) }));
}

export function geometryOf(values: Float32Array): BufferGeometry {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(values, 3));
}

/// 1, 2 or 5 times a power of ten, not above `most`.
export function roundLength(most: number): number {
  const decade = 10 ** Math.floor(Math.log10(most));
  return decade * (most >= 5 * decade ? 5 : most >= 2 * decade ? 2 : 1);
}

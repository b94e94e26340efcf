// Columns as typed arrays, values between samples, and angles of orientations.
import type { Column, Columns3, Columns4 } from "./data";

const decoded = new WeakMap<object, Float64Array>();

/// The numbers of a column; NaN: missing. Decoded when first needed, since most runs of a report are never looked at.
export function numbers(column: Column): Float64Array {
  let values = decoded.get(column);
  if (!values) {
    values = decode(column);
    decoded.set(column, values);
  }
  return values;
}

function decode(column: Column): Float64Array {
  if (Array.isArray(column)) return Float64Array.from(column, (value) => value ?? NaN);
  if ("n" in column) return Float64Array.from({ length: column.n }, (_, k) => column.from + column.step * k);
  if ("f32" in column) {
    const view = bytes(column.f32);
    return Float64Array.from({ length: view.byteLength >> 2 }, (_, k) => view.getFloat32(4 * k, true));
  }
  const view = bytes(column.i16);
  return Float64Array.from({ length: view.byteLength >> 1 }, (_, k) => {
    const value = view.getInt16(2 * k, true);
    return value === -32768 ? NaN : column.offset + column.scale * value;
  });
}

function bytes(base64: string): DataView {
  const text = atob(base64);
  const array = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) array[i] = text.charCodeAt(i);
  return new DataView(array.buffer);
}

export type Vector3 = [number, number, number];
export type Quaternion = [number, number, number, number];

export function columns3(columns: Columns3): [Float64Array, Float64Array, Float64Array] {
  return [numbers(columns[0]), numbers(columns[1]), numbers(columns[2])];
}

/// Index of the last value of an increasing series that is at most t; -1: none.
export function lastUpTo(times: Float64Array, t: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((times[middle] ?? Infinity) <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/// Linear between samples; NaN outside of them.
export function valueAt(times: Float64Array, values: Float64Array, t: number): number {
  const i = lastUpTo(times, t);
  const t0 = times[i];
  if (t0 === undefined) return NaN;
  const a = values[i] ?? NaN;
  const t1 = times[i + 1];
  if (t1 === undefined) return t === t0 ? a : NaN;
  const b = values[i + 1] ?? NaN;
  return t === t0 ? a : a + ((t - t0) / (t1 - t0)) * (b - a);
}

export function vectorAt(times: Float64Array, columns: Columns3, t: number): Vector3 {
  const [x, y, z] = columns3(columns);
  return [valueAt(times, x, t), valueAt(times, y, t), valueAt(times, z, t)];
}

/// Normalised linear interpolation, which suffices between near samples.
export function orientationAt(times: Float64Array, columns: Columns4, t: number): Quaternion {
  const i = Math.max(0, lastUpTo(times, t));
  const j = Math.min(i + 1, times.length - 1);
  const t0 = times[i] ?? 0;
  const t1 = times[j] ?? 0;
  const share = t1 > t0 ? Math.min(1, Math.max(0, (t - t0) / (t1 - t0))) : 0;
  const q = columns.map(numbers);
  const at = (k: number): number[] => q.map((values) => values[k] ?? NaN);
  const a = at(i);
  const b = at(j);
  const sign = a.reduce((sum, value, k) => sum + value * (b[k] ?? 0), 0) < 0 ? -1 : 1;
  const mixed = a.map((value, k) => (1 - share) * value + share * sign * (b[k] ?? 0));
  const norm = Math.hypot(...mixed);
  return mixed.map((value) => value / norm) as Quaternion;
}

const DEGREES = 180 / Math.PI;

/// Roll, pitch and yaw [deg] of orientations: R = Rz(yaw) Ry(pitch) Rx(roll), unwrapped, so that lines do not jump.
export function angles(columns: Columns4): [Float64Array, Float64Array, Float64Array] {
  const known = angleCache.get(columns);
  if (known) return known;
  const [qx, qy, qz, qw] = columns.map(numbers) as [Float64Array, Float64Array, Float64Array, Float64Array];
  const roll = new Float64Array(qx.length);
  const pitch = new Float64Array(qx.length);
  const yaw = new Float64Array(qx.length);
  for (let i = 0; i < qx.length; ++i) {
    const [x, y, z, w] = [qx[i] ?? NaN, qy[i] ?? NaN, qz[i] ?? NaN, qw[i] ?? NaN];
    roll[i] = DEGREES * Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
    pitch[i] = DEGREES * Math.asin(Math.min(1, Math.max(-1, 2 * (w * y - z * x))));
    yaw[i] = DEGREES * Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  }
  unwrap(roll);
  unwrap(yaw);
  const result: [Float64Array, Float64Array, Float64Array] = [roll, pitch, yaw];
  angleCache.set(columns, result);
  return result;
}

const angleCache = new WeakMap<Columns4, [Float64Array, Float64Array, Float64Array]>();

function unwrap(degrees: Float64Array): void {
  let last = NaN;
  for (let i = 0; i < degrees.length; ++i) {
    const value = degrees[i] ?? NaN;
    if (Number.isNaN(value)) continue;
    if (!Number.isNaN(last)) degrees[i] = value - 360 * Math.round((value - last) / 360);
    last = degrees[i] ?? NaN;
  }
}

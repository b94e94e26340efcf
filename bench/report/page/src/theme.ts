// Colours and dashes, light and dark. Okabe and Ito's colours, and Tol's wine, as in evbench's figures: they can be told
// apart with any kind of colour vision. Lines differ by dash and marker, too.
import type { State } from "./state";

const LIGHT = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#B87F00", "#56B4E9", "#882255", "#777777"];
const DARK = ["#56B4E9", "#FF8A3D", "#2BC79A", "#E6A0C8", "#F0C04A", "#9BD3F5", "#D5749F", "#AAAAAA"];
export const DASHES: (number[] | "solid")[] = ["solid", [7, 3], [2, 2], [7, 2, 2, 2], [12, 3], [3, 2, 1, 2, 1, 2]];
export const MARKERS = ["circle", "rect", "diamond", "triangle", "arrow", "pin", "roundRect", "circle"];

export interface Colours {
  dark: boolean;
  text: string;
  faint: string; // captions, ticks
  grid: string;
  page: string;
  truth: string;
  series: string[];
  warn: string;
}

let choice: "light" | "dark" | null = null;
let printing = false;

function prefersDark(): boolean {
  return matchMedia("(prefers-color-scheme: dark)").matches;
}

export function isDark(): boolean {
  return !printing && (choice === null ? prefersDark() : choice === "dark");
}

export function colours(light = false): Colours {
  const dark = isDark() && !light;
  return dark
    ? { dark, text: "#e8eaed", faint: "#a9b0b8", grid: "#343b43", page: "#171b20", truth: "#ffffff", series: DARK, warn: "#ffb454" }
    : { dark, text: "#1c2024", faint: "#59626b", grid: "#e4e7ea", page: "#ffffff", truth: "#000000", series: LIGHT, warn: "#a4480a" };
}

export function colourOf(slot: number, of = colours()): string {
  return of.series[((slot % of.series.length) + of.series.length) % of.series.length] ?? of.text;
}

export function dashOf(slot: number): number[] | "solid" {
  return DASHES[slot % DASHES.length] ?? "solid";
}

function apply(): void {
  document.documentElement.dataset.theme = isDark() ? "dark" : "light";
}

/// Follows the system until the reader chooses. Paper is white.
export function initTheme(state: State): void {
  apply();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    apply();
    state.emit("theme");
  });
}

export function toggleTheme(state: State): void {
  choice = isDark() ? "light" : "dark";
  apply();
  state.emit("theme");
}

export function setPrinting(now: boolean): void {
  printing = now;
  apply();
}

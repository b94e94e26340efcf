// The bar at the bottom: play, time, zoom and the runs that are shown. All views follow it.
import { button, element, format } from "./dom";
import { swatch } from "./legend";
import { eventButtons } from "./run_events";
import type { State } from "./state";
import { colourOf, dashOf } from "./theme";
import { timeKeys } from "./time_chart";

const STEPS = 2000; // of the slider
const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 20];

export function timeBar(state: State): HTMLElement {
  const playButton = button("▶", "Play (Space)", () => setPlaying(!playing), { class: "play", "aria-pressed": "false" });
  const slider = element("input", {
    type: "range",
    min: 0,
    max: STEPS,
    step: 1,
    "aria-label": "Time of the sequence",
    oninput: () => {
      const [low, high] = state.window;
      state.setTime(low + (Number(slider.value) / STEPS) * (high - low));
    },
  });
  slider.addEventListener("keydown", (event) => timeKeys(state, event));
  const marks = element("div", { class: "marks" });
  const clock = element("output", { class: "clock" });
  const speed = element(
    "select",
    { "aria-label": "Speed", title: "Data time per second" },
    ...SPEEDS.map((value) => element("option", { value, selected: value === 1 }, `${value}×`)),
  );
  const estimate = element(
    "select",
    {
      "aria-label": "Which estimate is drawn",
      title: "Smoothed: estimated after the whole sequence. Causal: each pose as first published.",
      onchange: () => state.setEstimate(estimate.value === "causal" ? "causal" : "final"),
    },
    element("option", { value: "final" }, "smoothed"),
    element("option", { value: "causal" }, "causal"),
  );
  const runs = element("div", { class: "shown-runs", "aria-label": "Runs shown" });
  const zoomText = element("span", { class: "zoom-text" });

  let playing = false;
  let last = 0;
  function setPlaying(now: boolean): void {
    playing = now;
    playButton.textContent = now ? "❚❚" : "▶";
    playButton.setAttribute("aria-pressed", String(now));
    if (!now) return;
    const [low, high] = state.window;
    if (state.time >= high || state.time < low) state.setTime(low);
    last = performance.now();
    requestAnimationFrame(tick);
  }
  function tick(now: number): void {
    if (!playing) return;
    const [, high] = state.window;
    state.setTime(Math.min(high, state.time + Number(speed.value) * Math.max(0, (now - last) / 1000)));
    last = now;
    if (state.time >= high) setPlaying(false);
    else requestAnimationFrame(tick);
  }

  function showTime(): void {
    const [low, high] = state.window;
    const text = `${state.time.toFixed(high - low < 10 ? 3 : 2)} s`;
    clock.textContent = text;
    slider.value = String(Math.round((STEPS * (state.time - low)) / (high - low)));
    slider.setAttribute("aria-valuetext", text);
  }
  function showZoom(): void {
    const [low, high] = state.window;
    zoomText.textContent = state.zoom ? `${format(low)} to ${format(high)} s` : "";
    marks.replaceChildren(...eventButtons(state, (t) => (t >= low && t <= high ? (t - low) / (high - low) : null)));
    showTime();
  }
  function showRuns(): void {
    const chips = state.shown.map((index) => {
      const name = state.payload.runs[index]?.name ?? "";
      const slot = state.slot(index);
      const focused = index === state.focus;
      const chip = button(name, focused ? `${name}: the selected run` : `Select ${name}`, () => state.select(index), {
        class: focused ? "chip focused" : "chip",
      });
      chip.prepend(swatch(colourOf(slot), dashOf(slot)));
      const remove = focused ? null : button("×", `Do not compare ${name}`, () => state.compare(index, false), { class: "chip-remove" });
      return element("span", {}, chip, remove);
    });
    runs.replaceChildren(...chips);
    showZoom();
  }

  state.on("time", showTime);
  state.on("zoom", showZoom);
  state.on("selection", showRuns);
  state.on("theme", showRuns);
  showRuns();

  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.key !== " " || target.closest("input, select, button, summary, textarea, tr, a")) return;
    event.preventDefault();
    setPlaying(!playing);
  });

  return element(
    "div",
    { class: "time-bar", role: "region", "aria-label": "Time and shown runs" },
    runs,
    element(
      "div",
      { class: "transport" },
      playButton,
      speed,
      element("div", { class: "slider" }, marks, slider),
      clock,
      button("−", "Zoom out (-)", () => state.zoomBy(2)),
      button("+", "Zoom in at the time cursor (+)", () => state.zoomBy(0.5)),
      button("all", "Show the whole sequence (0)", () => state.setZoom(null)),
      zoomText,
      estimate,
    ),
  );
}

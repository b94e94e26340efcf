// The page of `evbench report`: sections, in the order in which a reader asks.
import { printCharts, redrawCharts } from "./chart";
import { readPayload } from "./data";
import { button, element, section } from "./dom";
import { figureElement } from "./figures";
import { runDetails } from "./logs";
import { overview } from "./overview";
import { sceneElement } from "./scene";
import { sideViews } from "./sides";
import { State } from "./state";
import { tableElement } from "./tables";
import { initTheme, setPrinting, toggleTheme } from "./theme";
import { timeBar } from "./time_bar";
import { timePlots } from "./time_plots";
import { trackPlots } from "./tracks";
import { drawAll, isIdle } from "./view";

function build(): State {
  const payload = readPayload();
  const state = new State(payload);
  initTheme(state);
  document.title = `${payload.title} – evbench report`;
  const sections: HTMLElement[] = [section("overview", "What was run", ...overview(payload))];
  if (payload.tables.length > 0) sections.push(section("results", "Results", ...payload.tables.map((table) => tableElement(state, table))));
  if (payload.figures.length > 0) {
    sections.push(section("figures", "Figures", element("div", { class: "figures" }, ...payload.figures.map((figure) => figureElement(state, figure)))));
  }
  if (payload.runs.length > 0) {
    sections.push(
      section("trajectory", "Trajectory", selected(state), element("div", { class: "trajectory" }, sceneElement(state), sideViews(state))),
      section("time", "Over time", selected(state), help(), timePlots(state)),
      section("tracks", "Tracks, landmarks and updates", selected(state), trackPlots(state)),
      section("run", "Status, events and log", runDetails(state)),
    );
  }
  const navigation = element(
    "nav",
    { "aria-label": "Sections" },
    ...sections.map((part) => element("a", { href: `#${part.id}`, onclick: () => part.setAttribute("open", "") }, part.querySelector("h2")?.textContent ?? "")),
  );
  document.body.append(
    element(
      "header",
      {},
      element("h1", {}, payload.title),
      navigation,
      button("◐", "Light or dark", () => toggleTheme(state), { class: "theme", "aria-label": "Light or dark" }),
    ),
    element("main", {}, ...sections),
  );
  if (payload.runs.length > 0) document.body.append(timeBar(state));
  return state;
}

/// Names the run that a section is about.
function selected(state: State): HTMLElement {
  const note = element("p", { class: "selected" });
  const update = (): void => {
    const { run } = state;
    note.replaceChildren(run ? element("strong", {}, run.name) : "no run", run && run.state !== "ok" ? ` – ${run.state}${run.reason ? `: ${run.reason}` : ""}` : "");
  };
  state.on("selection", update);
  update();
  return note;
}

function help(): HTMLElement {
  const text = "Click: set the time. Drag: zoom, in all plots. Double click: show all. Signs above the plots are events of the run.";
  return element("p", { class: "note screen" }, text);
}

/// On paper: white, all sections unfolded, pictures as SVG.
function listenToPrint(): void {
  let folded: HTMLElement[] = [];
  const begin = (): void => {
    setPrinting(true);
    folded = [...document.querySelectorAll<HTMLElement>("details.section:not([open])")];
    for (const part of folded) part.setAttribute("open", "");
    drawAll();
    printCharts(true);
  };
  const end = (): void => {
    printCharts(false);
    for (const part of folded) part.removeAttribute("open");
    setPrinting(false);
    redrawCharts();
  };
  addEventListener("beforeprint", begin);
  addEventListener("afterprint", end);
}

try {
  const state = build();
  listenToPrint();
  // For the tests of this page (test/report.test.mjs).
  Object.assign(window, { evbenchReport: { state, isIdle } });
  requestAnimationFrame(() => setTimeout(() => performance.mark("evbench-report-drawn")));
} catch (error) {
  document.body.append(element("p", { class: "fatal", role: "alert" }, error instanceof Error ? error.message : String(error)));
  throw error;
}

// The run in focus in words: status and reason, scores, settings, events, log and config.
import { button, describe, element, format } from "./dom";
import { fileName, saveCsv, saveText } from "./download";
import type { Run } from "./data";
import { eventName, signOf } from "./run_events";
import type { State } from "./state";
import { View } from "./view";

export function statusText(run: Run): string {
  const when = run.time === null ? "" : ` at ${format(run.time)} s`;
  return `${run.state}${when}${run.reason ? `: ${run.reason}` : ""}`;
}

export function runDetails(state: State): HTMLElement {
  const box = element("div", { class: "run-details" });
  const view = new View(box, () => box.replaceChildren(...details(state)));
  state.on("selection", () => view.invalidate());
  return box;
}

function details(state: State): HTMLElement[] {
  const { run } = state;
  if (!run) return [element("p", { class: "empty" }, "No run is selected.")];
  const sequence = state.payload.sequences[run.sequence];
  const facts = [
    { name: "run", value: run.name },
    { name: "status", value: statusText(run) },
    ...run.scores,
    { name: "alignment", value: run.alignment || "none: the estimate is in its own frame and scale" },
    { name: "sequence", value: sequence ? `${sequence.name}, ${format(sequence.from)} to ${format(sequence.to)} s` : "" },
    ...run.settings,
    { name: "folder", value: run.folder },
  ].filter((fact) => fact.value !== "");
  const parts: HTMLElement[] = [element("div", { class: `banner state-${run.state.replace(" ", "-")}` }, statusText(run)), describe(facts)];
  if (run.segments.length > 1 || run.periods.length > 0) parts.push(element("h3", {}, "Trajectory segments and periods"), segmentTable(run));
  parts.push(...eventTable(state, run));
  parts.push(
    element(
      "div",
      { class: "chart-head" },
      element("h3", {}, "Log"),
      run.log ? button("save", "Save the log as text", () => saveText(run.log, `${fileName(run.name)}.log.txt`, "text/plain")) : null,
    ),
    run.log ? element("pre", { class: "log", tabindex: 0 }, run.log) : element("p", { class: "empty" }, "This run has no log."),
  );
  if (run.config) {
    parts.push(
      element(
        "details",
        { class: "config" },
        element("summary", {}, "Config with all defaults: it can be run again"),
        button("save", "Save the config as JSON", () => saveText(run.config, `${fileName(run.name)}.json`, "application/json")),
        element("pre", { class: "log", tabindex: 0 }, run.config),
      ),
    );
  }
  return parts;
}

function segmentTable(run: Run): HTMLElement {
  const body = element("tbody");
  const add = (what: string, from: number, to: number, text: string): void => {
    const times = [from, to].map((t) => element("td", { class: "number" }, format(t)));
    body.append(element("tr", {}, element("td", {}, what), ...times, element("td", {}, text)));
  };
  run.segments.forEach((segment, i) => {
    const scored = segment.scored ? "scored" : "not scored";
    const text = `${scored}, ${segment.poses} poses, ${segment.landmarks_total} landmarks${segment.note ? `; ${segment.note}` : ""}`;
    add(`segment ${i + 1}`, segment.from, segment.to, text);
  });
  for (const period of run.periods) add(period.kind, period.from, period.to, period.text);
  const headers = ["what", "from [s]", "to [s]", ""].map((text) => element("th", {}, text));
  return element("div", { class: "scroll" }, element("table", { class: "plain" }, element("thead", {}, element("tr", {}, ...headers)), body));
}

function eventTable(state: State, run: Run): HTMLElement[] {
  if (run.events.length === 0) return [element("h3", {}, "Events"), element("p", { class: "empty" }, "Nothing was reported.")];
  const rows = run.events.map((event) =>
    element(
      "tr",
      {},
      element("td", { class: "number" }, button(`${format(event.t)} s`, "Go to this time", () => state.setTime(event.t))),
      element("td", {}, `${signOf(event.kind)} ${eventName(event)}`),
      element("td", {}, event.text),
    ),
  );
  const save = (): void => saveCsv([["t_s", "kind", "text"], ...run.events.map((e) => [e.t, e.kind, e.text])], `${run.name} events`);
  return [
    element("div", { class: "chart-head" }, element("h3", {}, "Events"), button("CSV", "Save the events as CSV", save)),
    element("div", { class: "scroll" }, element("table", { class: "plain events" }, element("tbody", {}, ...rows))),
  ];
}

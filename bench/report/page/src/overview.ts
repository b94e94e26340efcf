// What was run, how, and with which protocol.
import { describe, element } from "./dom";
import type { Payload } from "./data";

export function overview(payload: Payload): HTMLElement[] {
  const counts = new Map<string, number>();
  for (const run of payload.runs) counts.set(run.state, (counts.get(run.state) ?? 0) + 1);
  const states = [...counts].map(([state, count]) => `${count} ${state}`).join(", ");
  const facts = [
    { name: "runs", value: `${payload.runs.length}${states ? ` (${states})` : ""}` },
    ...payload.about.filter((fact) => fact.value !== ""),
    { name: "program", value: payload.program },
    { name: "written", value: `${payload.created.replace("T", " ").replace("Z", " UTC")} by: ${payload.command}` },
  ];
  return [
    describe(facts),
    element("h3", {}, "Protocol"),
    ...payload.protocol.map((sentence) => element("p", {}, sentence)),
    ...(payload.remarks.length > 0 ? [element("h3", {}, "Remarks")] : []),
    ...payload.remarks.map((sentence) => element("p", {}, sentence)),
  ];
}

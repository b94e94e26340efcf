// A run's events, in words and as marks at their times.
import type { RunEvent } from "./data";
import { element, format } from "./dom";
import type { State } from "./state";

/// Events in words and with a sign of their own, so that they differ without colour.
export function signOf(kind: string): string {
  if (kind === "lost") return "✕";
  if (kind === "initialised") return "●";
  if (kind === "relocalised" || kind === "reinitialised") return "↻";
  if (kind.startsWith("hypothesis")) return "◆";
  return "▪";
}

export function eventName(event: RunEvent): string {
  const names: Record<string, string> = {
    initialised: "initialised",
    lost: "tracking lost",
    reinitialised: "re-initialised",
    relocalised: "relocalised (found again)",
    hypothesis_accepted: "hypothesis accepted",
    stationary_period_rejected: "stationary period rejected",
    final_estimate: "final estimate",
    validated: "final estimate validated",
  };
  return names[event.kind] ?? event.kind.replaceAll("_", " ");
}

/// Buttons at the times of a run's events; a click goes there. `place`: share of the width, or null outside.
export function eventButtons(state: State, place: (t: number) => number | null): HTMLElement[] {
  return (state.run?.events ?? []).flatMap((event) => {
    const share = place(event.t);
    if (share === null) return [];
    const title = `${format(event.t)} s: ${eventName(event)}: ${event.text}`;
    const mark = element(
      "button",
      {
        type: "button",
        class: `event ${event.kind === "lost" ? "event-lost" : ""}`,
        title,
        "aria-label": title,
        tabindex: -1,
        onclick: (click: MouseEvent) => {
          click.stopPropagation();
          state.setTime(event.t);
        },
      },
      signOf(event.kind),
    );
    mark.style.left = `${100 * share}%`;
    return [mark];
  });
}

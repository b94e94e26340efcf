// Legends: beside charts as elements, in saved pictures as an option of ECharts.
import type { Colours } from "./theme";

export function swatch(colour: string, dash: number[] | "solid" = "solid"): SVGElement {
  const space = "http://www.w3.org/2000/svg";
  const picture = document.createElementNS(space, "svg");
  picture.setAttribute("width", "26");
  picture.setAttribute("height", "8");
  picture.setAttribute("aria-hidden", "true");
  const line = document.createElementNS(space, "path");
  line.setAttribute("d", "M0 4H26");
  line.setAttribute("stroke", colour);
  line.setAttribute("stroke-width", "2.5");
  if (dash !== "solid") line.setAttribute("stroke-dasharray", dash.join(" "));
  picture.append(line);
  return picture;
}

export interface LegendEntry {
  colour: string;
  filled?: boolean; // a marker or a bar, not a line alone
}

/// For pictures that stand alone.
export function legendOption(names: [string, LegendEntry][], of: Colours, width: number): object {
  return {
    legend: {
      top: 2,
      left: 10,
      width: width - 20,
      itemWidth: 26,
      itemHeight: 8,
      textStyle: { color: of.text, fontSize: 11 },
      selectedMode: false,
      data: names.map(([name, { colour, filled }]) => ({ name, itemStyle: { color: colour, opacity: filled ? 1 : 0 } })),
    },
  };
}

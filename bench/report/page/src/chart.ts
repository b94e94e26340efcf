// A picture drawn by ECharts: on the screen on a canvas, which is fast; saved and printed as SVG, which is sharp.
import { CustomChart, LineChart, ScatterChart } from "echarts/charts";
import { GridComponent, LegendComponent, TitleComponent, TooltipComponent } from "echarts/components";
import { init, use, type EChartsType } from "echarts/core";
import { CanvasRenderer, SVGRenderer } from "echarts/renderers";
import type { EChartsOption } from "echarts/types/dist/shared";
import { button, element } from "./dom";
import { fileName, savePngOfSvg, saveText, svgAddress } from "./download";
import { colours, type Colours } from "./theme";
import { View } from "./view";

use([CustomChart, LineChart, ScatterChart, GridComponent, LegendComponent, TitleComponent, TooltipComponent, CanvasRenderer, SVGRenderer]);

export type Option = EChartsOption;

export interface Drawing {
  option: Option;
  height: number; // [px]
}

/// What a chart draws, for a width [px] and colours. `complete`: the picture stands alone, with legend and caption.
export type Draw = (width: number, of: Colours, complete: boolean) => Drawing | null;

const PRINT_WIDTH = 700; // [px] of a page's text
const SAVE_WIDTH = 960;

const charts = new Set<Chart>();

export class Chart {
  readonly element: HTMLElement; // the whole: title, plot, a sentence where there is nothing to draw
  readonly plot: HTMLElement; // in which the picture and marks on it lie
  readonly view: View;
  onDrawn: (() => void) | null = null;
  private readonly canvas: HTMLElement;
  private readonly empty: HTMLElement;
  private instance: EChartsType | null = null;
  private printed: HTMLImageElement | null = null;

  constructor(
    title: string,
    private readonly file: () => string,
    private readonly draw: Draw,
    /// hint: a sentence where there is nothing to draw; height: [px] about, kept free until the picture is drawn.
    options: { hint?: string; extra?: HTMLElement; height?: number } = {},
  ) {
    this.canvas = element("div", { class: "canvas" });
    this.plot = element("div", { class: "plot" }, this.canvas);
    this.empty = element("p", { class: "empty", hidden: true }, options.hint ?? "Nothing to draw.");
    this.element = element(
      "figure",
      { class: "chart" },
      element(
        "div",
        { class: "chart-head" },
        element("h3", {}, title),
        options.extra ?? null,
        element(
          "span",
          { class: "save" },
          button("SVG", `Save “${title}” as SVG`, () => this.save("svg")),
          button("PNG", `Save “${title}” as PNG`, () => this.save("png")),
        ),
      ),
      this.plot,
      this.empty,
    );
    if (options.height) this.plot.style.minHeight = `${options.height}px`;
    this.view = new View(this.element, () => this.render());
    charts.add(this);
  }

  get chart(): EChartsType | null {
    return this.instance;
  }

  private render(): void {
    const width = this.plot.clientWidth;
    if (width === 0) {
      // Nothing was drawn last time, and the plot is hidden: it is shown before its width is known.
      this.plot.hidden = false;
      if (this.plot.clientWidth === 0) return;
    }
    const drawing = this.draw(this.plot.clientWidth, colours(), false);
    this.plot.style.minHeight = "";
    this.plot.hidden = drawing === null;
    this.empty.hidden = drawing !== null;
    if (!drawing) return;
    if (this.canvas.clientHeight !== drawing.height) this.canvas.style.height = `${drawing.height}px`;
    if (!this.instance) {
      this.instance = init(this.canvas, null, { renderer: "canvas" });
      this.onCreated?.(this.instance);
    } else if (this.instance.getWidth() !== this.plot.clientWidth || this.instance.getHeight() !== drawing.height) {
      this.instance.resize();
    }
    this.instance.setOption({ animation: false, ...drawing.option }, { notMerge: true, silent: true });
    this.onDrawn?.();
  }

  onCreated: ((instance: EChartsType) => void) | null = null;

  private toSvg(width: number, complete: boolean): { svg: string; height: number } | null {
    const light = colours(true);
    const drawing = this.draw(width, light, complete);
    if (!drawing) return null;
    const instance = init(null, null, { renderer: "svg", ssr: true, width, height: drawing.height });
    instance.setOption({ animation: false, backgroundColor: light.page, ...drawing.option });
    const svg = instance.renderToSVGString();
    instance.dispose();
    return { svg, height: drawing.height };
  }

  private save(kind: "svg" | "png"): void {
    const picture = this.toSvg(SAVE_WIDTH, true);
    if (!picture) return;
    if (kind === "svg") saveText(picture.svg, `${fileName(this.file())}.svg`, "image/svg+xml");
    else savePngOfSvg(picture.svg, SAVE_WIDTH, picture.height, this.file());
  }

  print(now: boolean): void {
    this.printed?.remove();
    this.printed = null;
    this.plot.classList.toggle("printed", now);
    if (!now) return;
    const picture = this.toSvg(PRINT_WIDTH, true);
    this.plot.hidden = picture === null;
    this.empty.hidden = picture !== null;
    if (!picture) return;
    this.plot.style.minHeight = "";
    this.printed = element("img", { src: svgAddress(picture.svg), alt: "", class: "print-image" });
    this.plot.append(this.printed);
  }
}

export function printCharts(now: boolean): void {
  for (const chart of charts) chart.print(now);
}

export function redrawCharts(): void {
  for (const chart of charts) chart.view.invalidate();
}

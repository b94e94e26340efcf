// Saving tables and pictures. Nothing is sent anywhere: the browser saves what the page made.
import { element } from "./dom";

export function saveBlob(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  const link = element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export function saveText(text: string, name: string, type: string): void {
  saveBlob(new Blob([text], { type: `${type};charset=utf-8` }), name);
}

export function csv(rows: (string | number | null)[][]): string {
  const cell = (value: string | number | null): string => {
    const text = value === null ? "" : String(value);
    return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return rows.map((row) => row.map(cell).join(",") + "\n").join("");
}

export function saveCsv(rows: (string | number | null)[][], name: string): void {
  saveText(csv(rows), `${fileName(name)}.csv`, "text/csv");
}

/// A name that every file system takes.
export function fileName(text: string): string {
  return text.replaceAll(/[^\w.-]+/g, "_").replaceAll(/^[_.]+|_+$/g, "") || "report";
}

/// An SVG picture as PNG with twice as many pixels, for slides.
export function savePngOfSvg(svg: string, width: number, height: number, name: string): void {
  const image = new Image();
  image.onload = () => {
    const canvas = element("canvas", { width: 2 * width, height: 2 * height });
    canvas.getContext("2d")?.drawImage(image, 0, 0, 2 * width, 2 * height);
    canvas.toBlob((blob) => {
      if (blob) saveBlob(blob, `${fileName(name)}.png`);
    });
  };
  image.src = svgAddress(svg);
}

export function svgAddress(svg: string): string {
  return `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
}

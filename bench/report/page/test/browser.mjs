// The page in a browser, opened from a file. Needs Debian's chromium, and python3-numpy for the invented runs of
// generate.py.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL(".", import.meta.url));
const chromium = spawnSync("which", ["chromium"], { encoding: "utf8" }).stdout.trim();
const python = "/usr/bin/python3";
const numpy = spawnSync(python, ["-c", "import numpy"]).status === 0;
/// Why tests are skipped; false: they are not.
export const skip = !chromium
  ? "chromium is missing: apt-get install chromium"
  : !numpy
    ? "numpy is missing: apt-get install python3-numpy"
    : false;

let browser;
/// Of the pages.
export let folder;

before(async () => {
  if (skip) return;
  const { chromium: playwright } = await import("playwright-core");
  folder = mkdtempSync(join(tmpdir(), "evbench-report-"));
  execFileSync(python, [join(here, "generate.py"), "--out", folder]);
  browser = await playwright.launch({
    executablePath: chromium,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
});

after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true });
});

/// Opens a page and collects what must not happen: errors, and requests of anything but the file.
export async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, acceptDownloads: true, ...options });
  const page = await context.newPage();
  const faults = [];
  page.on("console", (message) => {
    // GPU stalls of the software renderer say nothing about the page.
    if (["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text())) faults.push(message.text());
  });
  page.on("pageerror", (error) => faults.push(String(error)));
  const address = `file://${join(folder, name)}`;
  page.on("request", (request) => {
    const url = request.url();
    if (url.split("#")[0] !== address && !url.startsWith("data:") && !url.startsWith("blob:")) faults.push(`request: ${url}`);
  });
  await page.goto(address);
  await idle(page);
  const close = async () => {
    await idle(page);
    assert.deepEqual(faults, []);
    await context.close();
  };
  return { page, close };
}

export async function idle(page) {
  await page.evaluate(async () => {
    const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
    await frame();
    await frame();
    while (!window.evbenchReport.isIdle()) await frame();
    await frame();
  });
}

export async function show(page, id) {
  await page.locator(`#${id}`).evaluate((part) => part.scrollIntoView());
  await idle(page);
}

export async function download(page, click) {
  const [file] = await Promise.all([page.waitForEvent("download"), click()]);
  return { name: file.suggestedFilename(), bytes: readFileSync(await file.path()) };
}

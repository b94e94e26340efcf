// What a reader does with the page. `npm test`.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { download, folder, idle, open, show, skip } from "./browser.mjs";

const firstCells = (page) => page.$$eval("table.runs tbody tr:not([hidden]) th", (cells) => cells.map((cell) => cell.textContent));
const rowsOf = (page) => page.locator("table.runs tbody tr:not([hidden])");

/// Pixels of a canvas that differ from its first one: something is drawn.
const drawnPixels = (locator) =>
  locator.evaluate((canvas) => {
    const copy = document.createElement("canvas");
    copy.width = canvas.width;
    copy.height = canvas.height;
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const data = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
    return data.reduce((count, pixel) => count + Number(pixel !== data[0]), 0);
  });

test("a table is sorted, filtered and saved", { skip }, async () => {
  const { page, close } = await open("many.html");
  assert.equal(await rowsOf(page).count(), 100);
  const header = page.getByRole("button", { name: "ATE [m]", exact: true });
  await header.click();
  await header.click();
  assert.equal(await page.locator("th[aria-sort=descending]").count(), 1);
  assert.equal((await firstCells(page))[0], "method 9");
  assert.equal(await page.locator("table.runs tbody tr").last().locator("td").nth(2).textContent(), "-", "what has no number is last");
  await page.getByRole("searchbox").fill("lost");
  assert.equal(await rowsOf(page).count(), 2);
  await page.getByRole("searchbox").fill("method -ok");
  assert.equal(await rowsOf(page).count(), 4);
  const { name, bytes } = await download(page, () => page.getByRole("button", { name: "CSV", exact: true }).first().click());
  assert.equal(name, "runs.csv");
  const lines = bytes.toString().trim().split("\n");
  assert.equal(lines.length, 5);
  assert.equal(lines[0].trim(), "run,sequence,ATE [m],ATE [deg],RPE [m],covered [%],real-time factor,status");
  await close();
});

test("a selected run is shown everywhere, others of its sequence can be compared", { skip }, async () => {
  const { page, close } = await open("many.html");
  await page.getByRole("searchbox").fill('"method 9"');
  await rowsOf(page).nth(3).click();
  await idle(page);
  const name = "method 9, sequence 3";
  for (const selected of await page.locator(".selected").allTextContents()) assert.match(selected, /^method 9, sequence 3 – lost: fewer than 3/);
  assert.match(await page.locator(".chip.focused").textContent(), new RegExp(name));
  await show(page, "run");
  assert.match(await page.locator("pre.log").first().textContent(), /message 0 of method 9, sequence 3\n/);
  assert.match(await page.locator(".banner").textContent(), /^lost at/);

  await page.getByRole("searchbox").fill("");
  await page.getByRole("checkbox", { name: "Compare method 2, sequence 3" }).check();
  await idle(page);
  assert.equal(await page.locator(".chip").count(), 2);
  assert.ok(await page.getByRole("checkbox", { name: "Compare method 2, sequence 4" }).isDisabled(), "of another sequence");
  await show(page, "time");
  assert.match(await page.locator("#time .legend").first().textContent(), /method 2, sequence 3.*method 9, sequence 3/s);
  await close();
});

test("the page is used by keyboard", { skip }, async () => {
  const { page, close } = await open("many.html");
  await page.locator("table.runs tbody tr.focused").focus();
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await idle(page);
  assert.match(await page.locator(".chip.focused").textContent(), /method 0, sequence 2/);
  const plot = page.locator("#time .time-plot").first();
  await plot.scrollIntoViewIfNeeded();
  await plot.focus();
  await page.keyboard.press("Home");
  assert.equal(await page.locator(".clock").textContent(), "0.00 s");
  await page.keyboard.press("Shift+ArrowRight");
  assert.equal(await page.locator(".clock").textContent(), "6.00 s");
  await page.keyboard.press("+");
  await idle(page);
  assert.deepEqual(await page.evaluate(() => window.evbenchReport.state.window), [3, 33]);
  await page.keyboard.press("0");
  assert.deepEqual(await page.evaluate(() => window.evbenchReport.state.window), [0, 60]);
  await close();
});

test("time is scrubbed, played, and set by events and plots", { skip }, async () => {
  const { page, close } = await open("many.html");
  const time = () => page.evaluate(() => window.evbenchReport.state.time);
  await page.getByLabel("Time of the sequence").evaluate((slider) => {
    slider.value = "1000";
    slider.dispatchEvent(new Event("input"));
  });
  assert.equal(await time(), 30);
  await page.locator("#trajectory .stage").scrollIntoViewIfNeeded();
  await idle(page);
  assert.match(await page.locator(".readout").textContent(), /at 30\.00 s/);
  assert.ok((await drawnPixels(page.locator(".stage canvas"))) > 500, "something is drawn in 3D");
  await page.locator(".time-bar .event").first().click();
  assert.equal(await time(), 0.4);
  await page.locator(".play").click();
  await page.waitForFunction(() => window.evbenchReport.state.time > 0.5);
  await page.locator(".play").click();

  const plot = page.locator("#time .time-plot").first();
  await plot.scrollIntoViewIfNeeded();
  await idle(page);
  const box = await plot.boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + 60);
  assert.ok(Math.abs((await time()) - 30) < 3);
  await page.mouse.move(box.x + 0.3 * box.width, box.y + 60);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 70, { steps: 4 });
  await page.mouse.up();
  await idle(page);
  const [low, high] = await page.evaluate(() => window.evbenchReport.state.window);
  assert.ok(low > 10 && high < 45 && high > low, "a drag zooms");
  await page.mouse.dblclick(box.x + 0.5 * box.width, box.y + 60);
  assert.equal(await page.evaluate(() => window.evbenchReport.state.zoom), null);
  await close();
});

test("a point of a figure selects its runs", { skip }, async () => {
  const { page, close } = await open("many.html");
  await show(page, "figures");
  await page.getByText("Values of this figure").click();
  await page.getByRole("button", { name: "show run" }).nth(14).click();
  await idle(page);
  const focus = await page.evaluate(() => window.evbenchReport.state.run.name);
  assert.notEqual(focus, "method 0, sequence 0");
  // By mouse: the pixel of the first point of the sixth method, as ECharts places it.
  const chart = page.locator("#figures .canvas");
  await chart.scrollIntoViewIfNeeded();
  const box = await chart.boundingBox();
  let found = false;
  for (let y = 30; y < 330 && !found; y += 6) {
    await page.mouse.click(box.x + 64 + 0.46 * (box.width - 86), box.y + y);
    found = (await page.evaluate(() => window.evbenchReport.state.run.name)) !== focus;
    for (let x = 64; x < 130 && !found; x += 8) {
      await page.mouse.click(box.x + x, box.y + y);
      found = (await page.evaluate(() => window.evbenchReport.state.run.name)) !== focus;
    }
  }
  assert.ok(found, "a click on a point selects its run");
  await close();
});

test("pictures are saved as SVG and PNG", { skip }, async () => {
  const { page, close } = await open("long.html");
  await show(page, "trajectory");
  const scene = await download(page, () => page.getByTitle("Save the view as PNG").click());
  assert.equal(scene.bytes.subarray(1, 4).toString(), "PNG");
  for (const title of ["From three sides", "Position", "Life of the tracks", "Learnt prior and noise"]) {
    const svg = await download(page, () => page.getByTitle(`Save “${title}” as SVG`).click());
    assert.match(svg.name, /\.svg$/);
    assert.match(svg.bytes.toString(), /^<svg[^]*<path[^]*<\/svg>\s*$/);
    assert.doesNotMatch(svg.bytes.toString(), /NaN/);
    const png = await download(page, () => page.getByTitle(`Save “${title}” as PNG`).click());
    assert.equal(png.bytes.subarray(1, 4).toString(), "PNG");
  }
  await close();
});

test("without ground truth there are no errors, and all else", { skip }, async () => {
  const { page, close } = await open("no_truth.html");
  await show(page, "time");
  assert.ok(await page.getByText("No errors: the sequence has no ground truth").isVisible());
  assert.ok(await page.locator("#time .canvas canvas").first().isVisible());
  await close();
});

test("a sweep of which all runs failed shows why", { skip }, async () => {
  const { page, close } = await open("failed.html");
  assert.match(await page.locator("#overview").textContent(), /3 \(3 failed\)/);
  await show(page, "run");
  assert.match(await page.locator(".banner").textContent(), /never initialised/);
  assert.match(await page.locator("pre.log").first().textContent(), /message 0 of gp_map/);
  await show(page, "trajectory");
  await close();
});

test("a report without runs, and one with every kind of mark", { skip }, async () => {
  await (await open("empty.html")).close();
  const { page, close } = await open("figures.html");
  for (const title of ["Lines, bands, levels, steps", "Cells", "Boxes"]) {
    const { bytes } = await download(page, () => page.getByTitle(`Save “${title}” as SVG`).click());
    assert.doesNotMatch(bytes.toString(), /NaN/);
  }
  await close();
});

test("names with HTML in them are text", { skip }, async () => {
  const { page, close } = await open("hostile.html");
  for (const id of ["results", "figures", "trajectory", "time", "tracks", "run"]) {
    await show(page, id);
  }
  const names = await firstCells(page);
  assert.equal(names[0], "<script>window.hacked=1</script>");
  for (let row = 0; row < names.length; ++row) {
    await rowsOf(page).nth(row).click();
    await idle(page);
    assert.equal(await page.evaluate(() => window.evbenchReport.state.run.name), names[row]);
  }
  const plot = page.locator("#time .time-plot").first();
  await plot.scrollIntoViewIfNeeded();
  await plot.hover();
  await show(page, "figures");
  const canvas = page.locator("#figures .canvas");
  const box = await canvas.boundingBox();
  for (let y = 20; y < box.height; y += 25) await page.mouse.move(box.x + 0.5 * box.width, box.y + y);
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.equal(await page.locator("main img, main script").count(), 0);
  await close();
});

test("print unfolds everything, on white paper", { skip }, async () => {
  const { page, close } = await open("long.html", { colorScheme: "dark" });
  await page.locator("#time > summary").click();
  const pdf = await page.pdf({ format: "A4" });
  assert.ok(pdf.length > 50_000);
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "light");
  assert.ok((await page.locator("img.print-image").count()) >= 8);
  assert.equal(await page.locator("details.section:not([open])").count(), 0);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark");
  assert.equal(await page.locator("details.section:not([open])").count(), 1);
  await close();
});

test("light, dark and narrow", { skip }, async () => {
  const { page, close } = await open("long.html", { colorScheme: "dark", viewport: { width: 390, height: 844 } });
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark");
  await page.getByRole("button", { name: "Light or dark" }).click();
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "light");
  for (const id of ["results", "trajectory", "time", "tracks", "run"]) {
    await show(page, id);
  }
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390, "nothing is wider than a phone");
  await close();
});

test("a hundred runs of 60 s are less than 5 MB", { skip }, () => {
  assert.ok(statSync(join(folder, "many.html")).size < 5e6);
});

// How fast the page opens and answers, on 100 runs of 60 s and on a run of 10 minutes: a benchmark, which asserts no time.
// `npm run speed`.
import { statSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { folder, idle, open, show, skip } from "./browser.mjs";

/// The best of some tries: the machine is shared.
async function best(tries, measure) {
  let least = Infinity;
  for (let i = 0; i < tries; ++i) least = Math.min(least, await measure(i));
  return least;
}

/// From the action until everything that can be seen has been drawn [ms]: the elapsed time, or, if that is less, the
/// processor's time of the page, since on a busy machine the page waits for its turn.
async function respond(page, session, action, argument) {
  const processor = async () => (await session.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
  await idle(page);
  const before = await processor();
  const elapsed = await page.evaluate(`(async (value) => {
    const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
    const { state, isIdle } = window.evbenchReport;
    // The frame before is on the screen: without a graphics card, painting goes on after drawing.
    await new Promise((resolve) => setTimeout(resolve, 80));
    await frame();
    await frame();
    const start = performance.now();
    ${action};
    do await frame();
    while (!isIdle());
    return performance.now() - start;
  })(${JSON.stringify(argument ?? null)})`);
  return Math.min(elapsed, 1000 * ((await processor()) - before));
}

for (const name of ["many.html", "long.html"]) {
  test(`${name}: time to open and to answer`, { skip }, async (context) => {
    const size = statSync(join(folder, name)).size / 2 ** 20;
    context.diagnostic(`${name}: ${size.toFixed(2)} MiB`);
    const opening = await best(3, async () => {
      const { page, close } = await open(name);
      const time = await page.evaluate(() => performance.getEntriesByName("evbench-report-drawn")[0].startTime);
      await close();
      return time;
    });
    context.diagnostic(`opens in ${opening.toFixed(0)} ms`);

    const { page, close } = await open(name);
    const session = await page.context().newCDPSession(page);
    await session.send("Performance.enable", { timeDomain: "threadTicks" });
    const answers = {};
    for (const id of ["results", "figures", "trajectory", "time", "tracks"]) {
      if ((await page.locator(`#${id}`).count()) === 0) continue;
      await show(page, id);
      const at = async (what, action, values) => {
        // Values take turns, so that each changes something; the slower of them counts, each at its best.
        const least = values.map(() => Infinity);
        for (let i = 0; i < 3 * values.length; ++i) {
          const k = i % values.length;
          least[k] = Math.min(least[k], await respond(page, session, action, values[k]));
        }
        answers[`${what} at #${id}`] = Math.max(...least);
      };
      await at("select", "state.select(value)", [1, 0]);
      await at("compare", "state.compare(1, value)", [true, false]);
      await at("scrub", "state.setTime(value)", [10, 20, 30]);
      await at("zoom", "state.setZoom(value)", [[5, 15], null]);
      await at("causal", "state.setEstimate(value)", ["causal", "final"]);
    }
    answers.sort = await best(4, () => respond(page, session, "document.querySelectorAll('table.runs thead button')[2].click()"));
    answers.filter = await best(4, (i) =>
      respond(page, session, "const box = document.querySelector('input[type=search]'); box.value = value; box.dispatchEvent(new Event('input'))", ["lost", ""][i % 2]),
    );
    answers.theme = await best(4, () => respond(page, session, "document.querySelector('.theme').click()"));
    for (const [what, time] of Object.entries(answers)) context.diagnostic(`${what}: ${time.toFixed(0)} ms`);
    const slowest = Object.entries(answers).sort((a, b) => b[1] - a[1])[0];
    context.diagnostic(`slowest: ${slowest[0]}, ${slowest[1].toFixed(0)} ms`);
    await close();
  });
}

// Bundles src/ into report.html, the template that evbench writes data into: it replaces @DATA@, once, by JSON in which
// every "<" is written as \u003c. Run by `npm run build`; the result is committed, so that building evbench needs no node.
import { build } from "esbuild";
import { readFile, writeFile } from "node:fs/promises";

const LIBRARIES = [
  ["three", "LICENSE"],
  ["echarts", "LICENSE"],
  ["echarts", "NOTICE"],
  ["zrender", "LICENSE"],
  ["tslib", "LICENSE.txt"],
];

const options = { bundle: true, minify: true, target: "es2022", charset: "ascii", legalComments: "none", write: false };
const script = await build({ ...options, entryPoints: ["src/main.ts"], format: "iife", metafile: true });
const style = await build({ ...options, entryPoints: ["src/style.css"] });

let licenses = "report.html contains these libraries, of which some have been changed by leaving out unused parts.\n";
for (const [name, file] of LIBRARIES) {
  const { version, license } = JSON.parse(await readFile(`node_modules/${name}/package.json`, "utf8"));
  const text = await readFile(`node_modules/${name}/${file}`, "utf8");
  licenses += `\n${"=".repeat(100)}\n${name} ${version} (${license}), ${file}\n${"=".repeat(100)}\n\n${text.trim()}\n`;
}

const bundled = new Set(Object.keys(script.metafile.inputs).flatMap((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1] ?? []));
const unlisted = [...bundled].filter((name) => !LIBRARIES.some(([listed]) => listed === name));
if (unlisted.length > 0) throw new Error(`bundled, but without a licence in build.mjs: ${unlisted.join(", ")}`);

const values = {
  LICENSES: licenses.replaceAll("--", "- -"), // as a comment of HTML must not contain it
  STYLE: style.outputFiles[0].text,
  SCRIPT: script.outputFiles[0].text.replaceAll("</script", "<\\/script"),
};
const template = await readFile("src/template.html", "utf8");
const page = template.replaceAll(/@(LICENSES|STYLE|SCRIPT)@/g, (_, name) => values[name].trim());
if (page.split("@DATA@").length !== 2) throw new Error("the template must contain @DATA@ exactly once");
await writeFile("report.html", page);
await writeFile("LICENSES.txt", licenses);
console.log(`report.html: ${(page.length / 1e3).toFixed(0)} kB`);

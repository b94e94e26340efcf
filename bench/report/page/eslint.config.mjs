import js from "@eslint/js";
import tseslint from "typescript-eslint";

const GLOBALS = ["process", "console", "URL", "Buffer", "window", "document", "performance", "requestAnimationFrame", "Event"];

export default tseslint.config(
  { ignores: ["node_modules/", "report.html"] },
  js.configs.recommended,
  {
    files: ["src/**/*.ts"],
    extends: [...tseslint.configs.strictTypeChecked, ...tseslint.configs.stylisticTypeChecked],
    languageOptions: { parserOptions: { projectService: true, tsconfigRootDir: import.meta.dirname } },
    rules: {
      "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
      "@typescript-eslint/no-confusing-void-expression": ["error", { ignoreArrowShorthand: true }],
      "@typescript-eslint/consistent-type-definitions": "off",
      // Text of a run is never HTML.
      "no-restricted-properties": [
        "error",
        { property: "innerHTML", message: "Data are set as text." },
        { property: "outerHTML", message: "Data are set as text." },
        { property: "insertAdjacentHTML", message: "Data are set as text." },
      ],
    },
  },
  {
    files: ["*.mjs", "test/**/*.mjs"],
    languageOptions: { globals: Object.fromEntries(GLOBALS.map((name) => [name, "readonly"])) },
  },
);

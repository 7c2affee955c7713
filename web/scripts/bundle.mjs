// Bundles the page into dist/: app.js and app.css minified, index.html and favicon.svg as they are.
import { build } from "esbuild";
import { copyFileSync, mkdirSync, rmSync } from "node:fs";
import { fileURLToPath } from "node:url";

const web = fileURLToPath(new URL("..", import.meta.url));
const dist = `${web}/dist`;

rmSync(dist, { recursive: true, force: true });
mkdirSync(dist);
await build({
  entryPoints: [
    { in: `${web}/src/main.ts`, out: "app" },
    { in: `${web}/src/app.css`, out: "app" },
  ],
  outdir: dist,
  bundle: true,
  minify: true,
  format: "esm",
  target: ["chrome108", "firefox112", "safari16.4"],
  legalComments: "none",
  logLevel: "warning",
});
for (const file of ["index.html", "favicon.svg"])
  copyFileSync(`${web}/src/${file}`, `${dist}/${file}`);

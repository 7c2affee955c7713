// Runs the unit tests of tests/web: bundles each *.test.ts (Node cannot run TypeScript by itself),
// hands them to node --test, and ends with the one line "N passed, N failed".
import { build } from "esbuild";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const tests = fileURLToPath(new URL("../../tests/web", import.meta.url));
const sources = readdirSync(tests).filter((name) => name.endsWith(".test.ts"));
const out = mkdtempSync(join(tmpdir(), "sweepcast-web-test-"));
try {
  await build({
    entryPoints: sources.map((name) => join(tests, name)),
    outdir: out,
    outExtension: { ".js": ".mjs" },
    bundle: true,
    platform: "node",
    format: "esm",
    target: "node18",
    sourcemap: "inline",
    // The tests are not under web/, its packages are.
    nodePaths: [fileURLToPath(new URL("../node_modules", import.meta.url))],
    logLevel: "warning",
    // Tests of the style sheet, and those with vectors, read them from here.
    define: {
      WEB_SOURCES: JSON.stringify(fileURLToPath(new URL("../src", import.meta.url))),
      VECTORS: JSON.stringify(fileURLToPath(new URL("../../tests/vectors", import.meta.url))),
    },
  });
  const files = readdirSync(out).map((name) => join(out, name));
  const run = spawnSync(
    process.execPath,
    ["--enable-source-maps", "--test", "--test-reporter=spec", ...files],
    { encoding: "utf8", stdio: ["ignore", "pipe", "inherit"], timeout: 120_000 },
  );
  process.stdout.write(run.stdout);
  const count = (word) =>
    Number(run.stdout.match(new RegExp(`^\\S+ ${word} (\\d+)$`, "m"))?.[1] ?? 0);
  const failed = count("fail") + count("cancelled");
  // A run that counted nothing, or died, has not passed.
  const ok = run.status === 0 && failed === 0 && count("pass") > 0;
  console.log(`${count("pass")} passed, ${ok ? 0 : Math.max(failed, 1)} failed`);
  process.exitCode = ok ? 0 : 1;
} finally {
  rmSync(out, { recursive: true, force: true });
}

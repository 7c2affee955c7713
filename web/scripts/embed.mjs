// Writes the C++ source behind web/assets.hpp: node embed.mjs OUTPUT.cpp. Each file of dist/ becomes an array
// of its bytes, plain and gzip'ed. The same files always give the same source.
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { extname } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const CONTENT_TYPES = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".svg": "image/svg+xml",
};

const dist = fileURLToPath(new URL("../dist", import.meta.url));
const files = readdirSync(dist).sort();
const arrays = [];
const entries = [];
files.forEach((name, k) => {
  const contentType = CONTENT_TYPES[extname(name)];
  if (!contentType) throw new Error(`no content type for ${name}`);
  const content = readFileSync(`${dist}/${name}`);
  const etag = createHash("sha256").update(content).digest("hex").slice(0, 16);
  arrays.push(array(`file_${k}`, content, name));
  arrays.push(array(`file_${k}_gzip`, gzipSync(content, { level: 9 }), `${name}, gzip`));
  entries.push(
    `    Asset{"/${name}", "${contentType}", "\\"${etag}\\"", file_${k}, file_${k}_gzip},`,
  );
});

function array(variable, content, what) {
  return `constexpr std::uint8_t ${variable}[] = {\n${lines([...content])}\n};  // ${what}`;
}

function lines(bytes) {
  const rows = [];
  for (let k = 0; k < bytes.length; k += 32) rows.push(bytes.slice(k, k + 32).join(","));
  return rows.join(",\n");
}

writeFileSync(
  process.argv[2],
  `// The page's files; made by web/scripts/embed.mjs.
#include "web/assets.hpp"

#include <array>

namespace sweepcast::web {
namespace {

${arrays.join("\n")}

constexpr std::array<Asset, ${files.length}> all_assets{{
${entries.join("\n")}
}};

}  // namespace

std::span<const Asset> assets() { return all_assets; }

}  // namespace sweepcast::web
`,
);

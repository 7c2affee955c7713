// Compiles the schema (../proto) to TypeScript in gen/, with protoc and the protoc-gen-es plugin.
import { execFileSync } from "node:child_process";
import { mkdirSync } from "node:fs";
import { fileURLToPath } from "node:url";

const web = fileURLToPath(new URL("..", import.meta.url));
const schema = ["lidar", "scan", "stream", "api"].map((name) => `sweepcast/v1/${name}.proto`);

mkdirSync(`${web}/gen`, { recursive: true });
execFileSync(
  process.env.PROTOC ?? "protoc",
  [
    `--plugin=protoc-gen-es=${web}/node_modules/.bin/protoc-gen-es`,
    `-I${web}/../proto`,
    `--es_out=${web}/gen`,
    "--es_opt=target=ts,import_extension=none",
    ...schema,
  ],
  { stdio: "inherit" },
);

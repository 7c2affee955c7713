// Scans on file (tests/vectors/scans) against what the vendor's decoder made of the same bytes.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { fromBinary } from "@bufbuild/protobuf";
import { ScanSchema } from "../../web/gen/sweepcast/v1/scan_pb";
import { decodeScan } from "../../web/src/scan";

declare const VECTORS: string;
const read = (path: string) => JSON.parse(readFileSync(join(VECTORS, path), "utf8"));

for (const name of ["81_room", "82_room", "83_room", "84_room", "85_room", "86_room"]) {
  test(`the scan of ${name} is, sample by sample, what the vendor's decoder gives`, () => {
    const { first, count, scan } = read(`scans/${name}.json`);
    const nodes: number[][] = read(`${name}.json`).nodes.slice(first, first + count);
    const columns = decodeScan(fromBinary(ScanSchema, Buffer.from(scan, "hex")));
    const vendors = (units: number) =>
      columns.angleUnitsPerTurn === 23040 ? Math.floor((units * 256) / 90) : units;
    const seen = nodes.map((_, k) => [
      vendors(columns.angle[k]!),
      (columns.distance[k]! * columns.distanceUnitUm) / 250,
      columns.quality[k]!,
    ]);
    assert.deepEqual(
      seen,
      nodes.map((node) => node.slice(0, 3)),
    );
  });
}

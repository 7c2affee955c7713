// Scan messages to columns: the running sums of scan.proto.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { ScanSchema } from "../../web/gen/sweepcast/v1/scan_pb";
import { decodeScan } from "../../web/src/scan";

function decode(fields: MessageInitShape<typeof ScanSchema>) {
  return decodeScan(
    create(ScanSchema, {
      angleUnitsPerTurn: 65536,
      distanceUnitUm: 1000,
      ...fields,
    }),
  );
}

const noEchoes = (count: number) => Array.from({ length: count }, () => 0n);

test("angles are the running sum of their differences", () => {
  const { angle } = decode({ angle: [100, 50, 0, -30], distance: noEchoes(4) });
  assert.deepEqual([...angle], [100, 150, 150, 120]);
});

test("angles wrap forwards and backwards at a full turn", () => {
  const { angle } = decode({
    angleUnitsPerTurn: 23040,
    angle: [23000, 100, -80, -23039],
    distance: noEchoes(4),
  });
  assert.deepEqual([...angle], [23000, 60, 23020, 23021]);
});

test("a first angle of a whole turn and more is taken into the circle", () => {
  const { angle } = decode({ angle: [65536 + 5], distance: noEchoes(1) });
  assert.deepEqual([...angle], [5]);
});

test("distances add zigzag differences to the last sample that had an echo", () => {
  // +1000, none, +5, -5, none, none, -999
  const tokens = [2001n, 0n, 11n, 10n, 0n, 0n, 1998n];
  const { distance } = decode({ angle: Array(7).fill(0), distance: tokens });
  assert.deepEqual([...distance], [1000, 0, 1005, 1000, 0, 0, 1]);
});

test("the longest distance and the way back from it are exact", () => {
  const longest = 0xffffffffn;
  const { distance } = decode({
    angle: [0, 0],
    distance: [2n * longest + 1n, 2n * (longest - 1n)],
  });
  assert.deepEqual([...distance], [0xffffffff, 1]);
});

for (const [name, tokens] of [
  ["above 32 bits", [2n * 0x100000000n + 1n]],
  ["below zero", [2n]],
  ["beyond what a double can tell", [0xffffffffffffffffn]],
] as const) {
  test(`a distance ${name} is refused`, () => {
    assert.throws(() => decode({ angle: [0], distance: [...tokens] }), /out of range/);
  });
}

test("an empty quality column means one quality for all echoes and 0 without an echo", () => {
  const columns = decode({
    angle: [0, 0],
    distance: [3n, 0n],
    echoQuality: 188,
  });
  assert.deepEqual([...columns.quality], [188, 0]);
  assert.equal(columns.qualityMeasured, false);
});

test("a quality column is taken as it is", () => {
  const columns = decode({
    angle: [0, 0],
    distance: [3n, 0n],
    quality: Uint8Array.of(7, 255),
  });
  assert.deepEqual([...columns.quality], [7, 255]);
  assert.equal(columns.qualityMeasured, true);
});

test("a scan without samples has empty columns", () => {
  const columns = decode({});
  assert.equal(columns.angle.length, 0);
  assert.equal(columns.qualityMeasured, false);
});

const refused: [string, MessageInitShape<typeof ScanSchema>][] = [
  ["fewer distances than angles", { angle: [0, 0], distance: [0n] }],
  ["fewer qualities than angles", { angle: [0], distance: [0n], quality: new Uint8Array(2) }],
  ["no unit of angle", { angleUnitsPerTurn: 0, angle: [1], distance: [0n] }],
];
for (const [name, fields] of refused) {
  test(`${name}: the scan is refused`, () => {
    assert.throws(() => decode(fields));
  });
}

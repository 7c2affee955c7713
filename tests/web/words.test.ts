// Numbers and moments in words.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create } from "@bufbuild/protobuf";
import { LidarSchema, ScanModeSchema } from "../../web/gen/sweepcast/v1/lidar_pb";
import { Lidar_State } from "../../web/src/lidars";
import { sweepOf } from "../../web/src/sweep";
import {
  decimal,
  duration,
  metres,
  modeOption,
  modeWords,
  sinceWords,
  summary,
  virtualWords,
} from "../../web/src/words";
import { scanOf } from "./scan_builder";

const lidar = create(LidarSchema, { id: "a", state: Lidar_State.SCANNING });
const sweep = sweepOf(
  scanOf([
    [10, 1500],
    [143, 820],
  ]),
);

for (const [seconds, words] of [
  [0, "0 s"],
  [99.9, "99 s"],
  [100, "1 min"],
  [5999, "99 min"],
  [7300, "2 h"],
  [200_000, "2 d"],
] as const) {
  test(`${seconds} seconds are ${words}`, () => {
    assert.equal(duration(seconds), words);
  });
}

for (const [fields, words] of [
  [{}, ""],
  [{ since: { seconds: 100n } }, "for 12 s"],
  [{ since: { seconds: 110n }, failingSince: { seconds: 100n } }, "for 12 s"],
  [{ since: { seconds: 110n }, nextAttempt: { seconds: 115n } }, "for 2 s, next try in 3 s"],
  [{ since: { seconds: 110n }, nextAttempt: { seconds: 112n } }, "for 2 s"],
] as const) {
  test(`the state's time is told as "${words}" (${JSON.stringify(Object.keys(fields))})`, () => {
    assert.equal(sinceWords(create(LidarSchema, fields), 112), words);
  });
}

test("near distances have centimetres, far ones decimetres", () => {
  assert.equal(metres(0.816), "0.82 m");
  assert.equal(metres(23.46), "23.5 m");
});

test("what is not known is a dash", () => {
  assert.equal(decimal(undefined, 1), "–");
  assert.equal(decimal(Infinity, 1), "–");
  assert.equal(decimal(9.96, 1), "10.0");
});

test("a mode is told by its rate and reach, as far as they are known", () => {
  const mode = { name: "Express", samplesPerSecond: 4032.3, maxDistanceM: 12 };
  assert.equal(modeWords(create(ScanModeSchema, mode)), "4,032 samples/s, up to 12 m");
  assert.equal(modeWords(create(ScanModeSchema, { ...mode, maxDistanceM: 0 })), "4,032 samples/s");
  assert.equal(modeWords(create(ScanModeSchema)), "");
});

test("the typical mode is marked, whatever else is known of it", () => {
  const mode = { name: "Express", samplesPerSecond: 4000, maxDistanceM: 12, typical: true };
  assert.equal(modeOption(create(ScanModeSchema, mode)), "Express – 4 kHz, 12 m (typical)");
  const bare = create(ScanModeSchema, { name: "Express", typical: true });
  assert.equal(modeOption(bare), "Express (typical)");
});

test("a mode that is not the typical one is listed by its facts alone", () => {
  const mode = { name: "Boost", samplesPerSecond: 15873.02 };
  assert.equal(modeOption(create(ScanModeSchema, mode)), "Boost – 15.9 kHz");
  assert.equal(modeOption(create(ScanModeSchema, { name: "Boost" })), "Boost");
});

test("a live sweep is summed up by its nearest obstacle and rate", () => {
  assert.equal(
    summary(true, lidar, sweep, true, 9.97),
    "Nearest obstacle 0.82 m at 143°. 10.0 sweeps/s.",
  );
});

test("an old sweep is said to be one", () => {
  const stopped = create(LidarSchema, { state: Lidar_State.IDLE });
  assert.equal(
    summary(true, stopped, sweep, false, undefined),
    "Ready, motor off. In the last sweep: nearest obstacle 0.82 m at 143°.",
  );
});

test("an empty room is said to be empty", () => {
  assert.match(summary(true, lidar, sweepOf(scanOf([[0, 0]])), true, 10), /^No obstacle in sight/);
});

test("without a lidar or a sweep that is said", () => {
  assert.equal(summary(true, undefined, undefined, false, undefined), "No lidar to show.");
  assert.equal(summary(true, lidar, undefined, false, undefined), "Scanning. No sweep yet.");
});

test("without a connection the state is not claimed to be known", () => {
  assert.match(
    summary(false, lidar, sweep, false, undefined),
    /^Not connected\. In the last sweep/,
  );
});

test("a virtual lidar that stands in for one says that no scanner was found", () => {
  const standIn = create(LidarSchema, { isVirtual: true, isStandIn: true });
  assert.match(virtualWords(standIn), /no scanner was found/);
});

test("a virtual lidar that was asked for does not say so", () => {
  assert.equal(virtualWords(create(LidarSchema, { isVirtual: true })), "this is a simulated room.");
  assert.equal(virtualWords(lidar), "");
  assert.equal(virtualWords(undefined), "");
});

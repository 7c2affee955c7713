// The speed of the rotation: what is said of it, and what may be wished for.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { RotationSchema } from "../../web/gen/sweepcast/v1/lidar_pb";
import { Rotation_Control } from "../../web/src/lidars";
import { parseSpeed, rangeWords, speedWords } from "../../web/src/speed";

const rotation = (fields: MessageInitShape<typeof RotationSchema>) =>
  create(RotationSchema, fields);

const regulated = { control: Rotation_Control.DUTY, wantedHz: 10, usualHz: 10 };
const ranged = rotation({ ...regulated, minHz: 5.02, maxHz: 15 });

test("a speed that is reached is told with its figure in Hz and rpm", () => {
  const words = speedWords(rotation({ ...regulated, measuredHz: 10.017, settled: true }), true);
  assert.equal(words.measured, "10.02 Hz");
  assert.equal(words.rpm, "601 rpm");
  assert.deepEqual([words.aim, words.mark], ["Settled at 10.0 Hz", "ok"]);
  assert.ok(words.settable);
});

for (const [name, fields, scanning, aim, mark] of [
  ["on its way", { ...regulated, measuredHz: 7 }, true, "Settling at 10.0 Hz", "busy"],
  ["not yet measured", regulated, true, "Measuring, 10.0 Hz wanted", "busy"],
  ["of a lidar at rest", regulated, false, "Wanted: 10.0 Hz", "rest"],
  [
    "not reached",
    { ...regulated, measuredHz: 7, warning: "x" },
    true,
    "Not as wanted: 10.0 Hz",
    "warning",
  ],
  [
    "without a known aim",
    { control: Rotation_Control.RPM },
    false,
    "Wanted: its usual speed",
    "rest",
  ],
  ["fixed", { control: Rotation_Control.FIXED }, true, "Fixed: this lidar sets it itself", "rest"],
] as const) {
  test(`a speed that is ${name} is said to be so`, () => {
    const words = speedWords(rotation(fields), scanning);
    assert.deepEqual([words.aim, words.mark], [aim, mark]);
  });
}

test("without a scan no speed is claimed, whatever was measured last", () => {
  const words = speedWords(rotation({ ...regulated, measuredHz: 10, settled: true }), false);
  assert.deepEqual([words.measured, words.rpm], ["–", ""]);
});

test("a fixed speed is not offered to be set, and a wish for one can be withdrawn", () => {
  const fixed = rotation({ control: Rotation_Control.FIXED, warning: "it cannot be changed" });
  const words = speedWords(fixed, true);
  assert.equal(words.settable, false);
  assert.equal(words.withdrawable, true);
  assert.equal(words.mark, "warning");
  assert.equal(words.warning, "it cannot be changed");
  assert.equal(speedWords(rotation({ control: Rotation_Control.FIXED }), true).withdrawable, false);
});

test("a lidar that is not yet known has no speed to set", () => {
  for (const unknown of [undefined, rotation({})]) {
    assert.equal(speedWords(unknown, false).settable, false);
    assert.equal(speedWords(unknown, false).known, false);
    assert.equal(speedWords(unknown, false).aim, "Not known yet");
  }
});

test("the range is told as far as the lidar tells it", () => {
  assert.equal(rangeWords(ranged), "5.1 to 15.0 Hz, usually 10.0");
  assert.equal(rangeWords(rotation(regulated)), "usually 10.0");
  assert.equal(rangeWords(rotation({})), "");
  assert.equal(rangeWords(undefined), "");
});

for (const [text, hz] of [
  ["7", 7],
  [" 7.5 ", 7.5],
  ["7,5", 7.5],
  ["7.", 7],
  ["0", 0],
  ["0.0", 0],
  ["5.1", 5.1],
  ["15", 15],
] as const) {
  test(`"${text}" is a wish for ${hz} Hz`, () => {
    assert.deepEqual(parseSpeed(text, ranged), { hz });
  });
}

for (const [text, problem] of [
  ["", /such as 7/],
  ["  ", /such as 7/],
  ["fast", /not a number/],
  ["-7", /not a number/],
  ["1e1", /not a number/],
  ["7 Hz", /not a number/],
  ["7.5.5", /not a number/],
  ["Infinity", /not a number/],
  ["9999999", /not a number/],
  ["5", /5\.1 to 15\.0 Hz/],
  ["15.01", /5\.1 to 15\.0 Hz/],
] as const) {
  test(`"${text}" is refused, and it is said why`, () => {
    const wish = parseSpeed(text, ranged);
    assert.ok("problem" in wish);
    assert.match(wish.problem, problem);
  });
}

test("where the lidar tells no range only what no lidar can is refused", () => {
  assert.deepEqual(parseSpeed("2", rotation(regulated)), { hz: 2 });
  assert.ok("problem" in parseSpeed("51", rotation(regulated)));
  assert.ok("problem" in parseSpeed("51", undefined));
});

test("every speed that is shown as possible is accepted", () => {
  for (const edge of ["5.1", "15.0"]) assert.ok("hz" in parseSpeed(edge, ranged));
});

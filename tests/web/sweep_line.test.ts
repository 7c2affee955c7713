// The sweep line between frames.
import assert from "node:assert/strict";
import { test } from "node:test";
import { follow, turnAt } from "../../web/src/sweep_line";

const near = (a: number | undefined, b: number) =>
  assert.ok(a !== undefined && Math.abs(a - b) < 1e-9, `${a} is not ${b}`);

test("the line starts where the sweep ended and turns at the measured speed", () => {
  const line = follow(undefined, 0.9, 0.1, 5)!;
  near(turnAt(line, 5), 0.9);
  near(turnAt(line, 5.05), 0.4);
});

test("a late frame does not make the line jump: it is right again a turn later", () => {
  const first = follow(undefined, 0, 0.1, 0)!;
  const second = follow(first, 0, 0.1, 0.12)!;
  near(turnAt(second, 0.12), 0.2);
  near(turnAt(second, 0.22), 0);
});

test("a line that is ahead slows down and never turns back", () => {
  const line = follow(follow(undefined, 0, 0.1, 0), 0, 0.1, 0.12)!;
  assert.ok(line.turnsPerS > 0 && line.turnsPerS < 10);
});

test("a correction across the front is the short way", () => {
  const first = follow(undefined, 0.95, 0.1, 0)!;
  const second = follow(first, 0.05, 0.1, 0)!;
  near(second.turnsPerS, 11);
});

test("a line that is far off jumps", () => {
  const line = follow(follow(undefined, 0, 0.1, 0), 0.5, 0.1, 0)!;
  near(turnAt(line, 0), 0.5);
});

test("without news the line is gone after a few turns, and returns with the next sweep", () => {
  const line = follow(undefined, 0, 0.1, 0)!;
  near(turnAt(line, 0.24), 0.4);
  assert.equal(turnAt(line, 0.26), undefined);
  near(turnAt(follow(line, 0.3, 0.1, 9)!, 9), 0.3);
});

test("without a speed there is no line", () => {
  assert.equal(follow(undefined, 0, 0, 0), undefined);
  assert.equal(follow(undefined, 0, NaN, 0), undefined);
});

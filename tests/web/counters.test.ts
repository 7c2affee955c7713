// Frames missed and sweeps per second.
import assert from "node:assert/strict";
import { test } from "node:test";
import { RateMeter, SequenceCounter } from "../../web/src/counters";

function missed(...sequences: number[]): number {
  const counter = new SequenceCounter();
  sequences.forEach((sequence) => counter.see(BigInt(sequence)));
  return counter.missed;
}

test("gaps in the sequence are counted", () => {
  assert.equal(missed(7, 8, 11, 12, 14), 3);
});

test("the first frame opens no gap", () => {
  assert.equal(missed(1000), 0);
});

test("a sequence that begins anew opens no gap", () => {
  assert.equal(missed(500, 501, 1, 2), 0);
});

test("what went by while nothing was asked for is no gap", () => {
  const counter = new SequenceCounter();
  counter.see(1n);
  counter.resume();
  counter.see(50n);
  counter.see(52n);
  assert.equal(counter.missed, 1);
});

test("the rate is that of the last seconds", () => {
  const meter = new RateMeter();
  for (let k = 0; k <= 100; ++k) meter.tick(k * 0.5);
  for (let k = 1; k <= 40; ++k) meter.tick(50 + k * 0.1);
  assert.ok(Math.abs(meter.rate(54)! - 10) < 1e-6);
});

test("once is no rate", () => {
  const meter = new RateMeter();
  meter.tick(1);
  assert.equal(meter.rate(1), undefined);
});

test("a burst is no rate", () => {
  const meter = new RateMeter();
  for (let k = 0; k < 10; ++k) meter.tick(k * 0.01);
  assert.equal(meter.rate(0.1), undefined);
});

test("what has ended has no rate", () => {
  const meter = new RateMeter();
  meter.tick(1);
  meter.tick(2);
  assert.equal(meter.rate(2.1), 1);
  assert.equal(meter.rate(5.1), undefined);
});

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
  for (let k = 0; k <= 100; ++k) meter.see(k * 0.5);
  for (let k = 1; k <= 40; ++k) meter.see(50 + k * 0.1);
  assert.ok(Math.abs(meter.rate! - 10) < 1e-6);
});

test("nothing and once are no rate", () => {
  const meter = new RateMeter();
  assert.equal(meter.rate, undefined);
  meter.see(1000);
  assert.equal(meter.rate, undefined);
});

test("less than a second says nothing", () => {
  const meter = new RateMeter();
  for (let k = 0; k < 10; ++k) meter.see(k * 0.1);
  assert.equal(meter.rate, undefined);
  meter.see(1);
  assert.equal(meter.rate, 10);
});

test("sweeps that were missed make the rate smaller", () => {
  const meter = new RateMeter();
  for (const time of [0, 0.5, 1.5, 2]) meter.see(time);
  assert.equal(meter.rate, 1.5);
});

test("after a pause, and with a clock that begins anew, so does the count", () => {
  const meter = new RateMeter();
  for (let k = 0; k < 30; ++k) meter.see(100 + k * 0.1);
  meter.see(200);
  assert.equal(meter.rate, undefined);
  for (let k = 0; k <= 10; ++k) meter.see(k * 0.2);
  assert.equal(meter.rate, 5);
});

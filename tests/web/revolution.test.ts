// Sectors put together to whole sweeps, and to the newest echoes all around.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Revolution, type Place } from "../../web/src/revolution";
import { sweepOf, type Sweep } from "../../web/src/sweep";
import { scanOf } from "./scan_builder";

const QUARTERS = [0, 1, 2, 3] as const;

/// A quarter of a turn, echoes every 10 degrees, all as far away as told.
function quarter(index: number, metres: number): Sweep {
  const angles = Array.from({ length: 9 }, (_, k) => index * 90 + k * 10);
  return sweepOf(scanOf(angles.map((angle) => [angle, metres * 1000] as const)));
}

const place = (sequence: number, sector: number): Place => ({
  sequence: BigInt(sequence),
  sector,
  last: sector === 3,
});

const distances = (sweep: Sweep) => [...new Set(sweep.distanceM)].sort();

test("the sectors of a turn make its sweep, in their order", () => {
  const revolution = new Revolution();
  const seen = QUARTERS.map((k) => revolution.add(place(1, k), quarter(k, 1 + k)));
  assert.deepEqual(
    seen.map(({ complete }) => complete !== undefined),
    [false, false, false, true],
  );
  const { complete } = seen[3]!;
  assert.equal(complete?.samples, 36);
  assert.deepEqual(
    [...complete!.angleDeg].map(Math.round),
    Array.from({ length: 36 }, (_, k) => k * 10),
  );
});

test("until it is seen again, a direction keeps the echoes of the turn before", () => {
  const revolution = new Revolution();
  for (const k of QUARTERS) revolution.add(place(1, k), quarter(k, 1));
  const { drawn } = revolution.add(place(2, 0), quarter(0, 2));
  assert.equal(drawn.x.length, 36);
  assert.equal([...drawn.distanceM].filter((metres) => metres === 2).length, 9);
  const last = [1, 2, 3].map((k) => revolution.add(place(2, k), quarter(k, 2)))[2]!;
  assert.deepEqual(distances(last.drawn), [2]);
});

test("where the borders of sectors differ from turn to turn there is neither gap nor double", () => {
  const revolution = new Revolution();
  for (const k of QUARTERS) revolution.add(place(1, k), quarter(k, 1));
  const angles = Array.from({ length: 13 }, (_, k) => k * 10);
  const longer = sweepOf(scanOf(angles.map((angle) => [angle, 2000] as const)));
  const { drawn } = revolution.add(place(2, 0), longer);
  assert.equal(drawn.x.length, 36);
  assert.equal([...drawn.distanceM].filter((metres) => metres === 2).length, 13);
});

test("a turn of which a sector was missed is drawn, but is no sweep", () => {
  const revolution = new Revolution();
  revolution.add(place(1, 0), quarter(0, 1));
  const seen = revolution.add(place(1, 2), quarter(2, 1));
  assert.equal(seen.drawn.x.length, 18);
  assert.equal(revolution.add(place(1, 3), quarter(3, 1)).complete, undefined);
});

test("a turn that was joined halfway is no sweep, the next one is", () => {
  const revolution = new Revolution();
  revolution.add(place(1, 2), quarter(2, 1));
  assert.equal(revolution.add(place(1, 3), quarter(3, 1)).complete, undefined);
  const seen = QUARTERS.map((k) => revolution.add(place(2, k), quarter(k, 1)));
  assert.equal(seen[3]!.complete?.samples, 36);
});

test("a turn that begins anew under its number makes void what came before", () => {
  const revolution = new Revolution();
  for (const k of QUARTERS) revolution.add(place(1, k), quarter(k, 1));
  revolution.add(place(2, 0), quarter(0, 2));
  revolution.add(place(2, 1), quarter(1, 2));
  const { drawn } = revolution.add(place(2, 0), quarter(0, 3));
  assert.deepEqual(distances(drawn), [1, 3]);
  const last = [1, 2, 3].map((k) => revolution.add(place(2, k), quarter(k, 3)))[2]!;
  assert.deepEqual(distances(last.complete!), [3]);
});

test("the period is that of the last turn that told it", () => {
  const revolution = new Revolution();
  for (const k of QUARTERS) {
    revolution.add(place(1, k), { ...quarter(k, 1), periodS: k === 3 ? 0.1 : 0 });
  }
  assert.equal(revolution.add(place(2, 0), quarter(0, 1)).drawn.periodS, 0.1);
});

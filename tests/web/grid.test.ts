// The polar grid: ring spacing, labels, spokes.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  clipSpoke,
  direction,
  gridFor,
  labelDirection,
  ringLabel,
  ringStep,
} from "../../web/src/grid";
import type { View } from "../../web/src/view";

const view = (fields: Partial<View>): View => ({
  centreX: 0,
  centreY: 0,
  scale: 50,
  width: 800,
  height: 600,
  ...fields,
});

for (const [scale, step] of [
  [1, 100],
  [10, 10],
  [32, 2],
  [64, 1],
  [65, 1],
  [63, 2],
  [640, 0.1],
  [4000, 0.02],
] as const) {
  test(`at ${scale} pixels a metre rings are ${step} m apart`, () => {
    assert.ok(Math.abs(ringStep(scale) - step) < 1e-9);
  });
}

test("at every zoom rings are far enough apart, and not much farther", () => {
  for (let scale = 1; scale <= 4000; scale *= 1.07) {
    const pixels = ringStep(scale) * scale;
    assert.ok(pixels >= 63.9 && pixels <= 165, `${pixels} px at ${scale}`);
  }
});

for (const [radius, step, label] of [
  [12, 1, "12 m"],
  [100, 100, "100 m"],
  [0.5, 0.5, "0.5 m"],
  [0.30000000000000004, 0.1, "0.3 m"],
  [1.02, 0.02, "1.02 m"],
] as const) {
  test(`the ring at ${radius} is labelled ${label}`, () => {
    assert.equal(ringLabel(radius, step), label);
  });
}

test("with the lidar in sight there are rings from it to the corners and twelve spokes", () => {
  const grid = gridFor(view({}));
  assert.deepEqual(grid.rings, [2, 4, 6, 8, 10]);
  assert.deepEqual(
    grid.spokes,
    Array.from({ length: 12 }, (_, k) => 30 * k),
  );
});

test("with the lidar out of sight only the rings and spokes that cross the screen remain", () => {
  const grid = gridFor(view({ centreX: 20, scale: 100 }));
  assert.deepEqual(grid.rings, [16, 17, 18, 19, 20, 21, 22, 23, 24]);
  assert.deepEqual(grid.spokes, [80, 85, 90, 95, 100]);
});

test("however close and far out, the grid stays small and not empty", () => {
  const grid = gridFor(view({ centreX: 150, centreY: -130, scale: 4000 }));
  assert.ok(grid.rings.length > 0 && grid.rings.length < 30);
  assert.ok(grid.spokes.length < 30);
});

test("a spoke is clipped to the screen less its inset", () => {
  assert.deepEqual(clipSpoke(view({}), 90, 16), [0, 384]);
  assert.deepEqual(clipSpoke(view({}), 0, 16), [0, 284]);
});

test("a spoke that starts outside enters and leaves", () => {
  const [enter, leave] = clipSpoke(view({ centreX: 20 }), 90, 0)!;
  assert.ok(Math.abs(enter - 600) < 1e-9 && Math.abs(leave - 1400) < 1e-9);
});

test("a spoke that passes by the screen has no part on it", () => {
  assert.equal(clipSpoke(view({ centreX: 20 }), 270, 0), undefined);
  assert.equal(clipSpoke(view({ centreX: 20 }), 0, 0), undefined);
});

test("directions are clockwise from the top", () => {
  const right = direction(90);
  assert.ok(Math.abs(right.x - 1) < 1e-12 && Math.abs(right.y) < 1e-12);
  assert.deepEqual(direction(0), { x: 0, y: -1 });
});

test("rings are labelled to the right, or towards the screen if the lidar is out of sight", () => {
  assert.equal(labelDirection(view({})), 90);
  assert.equal(labelDirection(view({ centreY: 20 })), 0);
  assert.equal(labelDirection(view({ centreY: -20 })), 180);
});

// The view: floor to screen and back, pan, zoom, fit.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  fitted,
  initialView,
  needsRefit,
  panned,
  resized,
  toFloor,
  toScreen,
  zoomed,
  type View,
} from "../../web/src/view";

const view: View = {
  centreX: 1,
  centreY: 2,
  scale: 50,
  width: 800,
  height: 600,
};

const near = (a: number, b: number) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);

test("the centre of the view is in the middle of the screen", () => {
  assert.deepEqual(toScreen(view, 1, 2), { x: 400, y: 300 });
});

test("the front is up and the right is right", () => {
  assert.deepEqual(toScreen(view, 2, 3), { x: 450, y: 250 });
});

test("from screen to floor is the way back", () => {
  const place = toScreen(view, -3.25, 0.5);
  const floor = toFloor(view, place.x, place.y);
  near(floor.x, -3.25);
  near(floor.y, 0.5);
});

test("a dragged floor follows the pointer", () => {
  const before = toFloor(view, 100, 100);
  const after = toFloor(panned(view, 30, -20), 130, 80);
  near(after.x, before.x);
  near(after.y, before.y);
});

for (const factor of [1.25, 0.3]) {
  test(`what is under the pointer stays there when magnified ${factor} times`, () => {
    const before = toFloor(view, 620, 90);
    const after = toFloor(zoomed(view, 620, 90, factor), 620, 90);
    near(after.x, before.x);
    near(after.y, before.y);
  });
}

test("zoom ends at both ends", () => {
  const closest = zoomed(view, 0, 0, 1e9);
  assert.equal(zoomed(closest, 0, 0, 2).scale, closest.scale);
  const farthest = zoomed(view, 0, 0, 1e-9);
  assert.equal(zoomed(farthest, 0, 0, 0.5).scale, farthest.scale);
  assert.ok(closest.scale > farthest.scale);
});

test("the lidar cannot be lost by panning", () => {
  const far = panned(view, -1e9, 1e9);
  assert.ok(Math.abs(far.centreX) <= 200 && Math.abs(far.centreY) <= 200);
});

test("a fitted view has the lidar in the middle and all of the extent in sight", () => {
  const fit = fitted(view, { x: 6, y: 2, radius: 6.2 });
  assert.deepEqual(toScreen(fit, 0, 0), { x: 400, y: 300 });
  for (const [x, y] of [
    [6, 2],
    [-6, -2],
  ] as const) {
    const place = toScreen(fit, x, y);
    assert.ok(place.x > 0 && place.x < 800 && place.y > 0 && place.y < 600);
  }
  near(toScreen(fit, 6, 0).x, 800 - 28);
});

test("a fit to a single echo at the lidar is still a view", () => {
  const fit = fitted(view, { x: 0, y: 0, radius: 0 });
  assert.ok(Number.isFinite(fit.scale) && fit.scale > 0);
});

test("a following view is refitted when the room outgrows it or is much smaller, not when it trembles", () => {
  const fit = fitted(view, { x: 4, y: 3, radius: 4 });
  assert.equal(needsRefit(fit, { x: 4.05, y: 3.05, radius: 4.05 }), false);
  assert.equal(needsRefit(fit, { x: 3.5, y: 2.6, radius: 3.5 }), false);
  assert.equal(needsRefit(fit, { x: 8, y: 3, radius: 8 }), true);
  assert.equal(needsRefit(fit, { x: 1, y: 1, radius: 1 }), true);
});

test("another size of screen keeps centre and scale", () => {
  const other = resized(view, 300, 900);
  assert.deepEqual(toScreen(other, 1, 2), { x: 150, y: 450 });
  assert.equal(other.scale, view.scale);
});

test("at first five metres are in sight in every direction", () => {
  const place = toScreen(initialView(360, 640), 5, 0);
  assert.ok(place.x <= 360 && place.x > 300);
});

// Points as pixels.
import assert from "node:assert/strict";
import { test } from "node:test";
import { drawPoints, type Raster } from "../../web/src/points";
import { sweepOf } from "../../web/src/sweep";
import type { View } from "../../web/src/view";
import { scanOf } from "./scan_builder";

const RED = 0xff0000ff;
const palette = new Uint32Array(256).fill(RED);
const view: View = { centreX: 0, centreY: 0, scale: 10, width: 40, height: 20 };

function draw(samples: [number, number][], ratio = 1): Raster {
  const width = view.width * ratio;
  const height = view.height * ratio;
  const raster = {
    pixels: new Uint32Array(width * height).fill(7),
    width,
    height,
    ratio,
  };
  const sweep = sweepOf(scanOf(samples));
  drawPoints(raster, view, sweep, palette, new Uint8Array(sweep.x.length));
  return raster;
}

const lit = (raster: Raster) =>
  [...raster.pixels.keys()]
    .filter((k) => raster.pixels[k] !== 0)
    .map((k) => [k % raster.width, Math.floor(k / raster.width)] as const);

test("a point is a small disc about its place, and the rest is clear", () => {
  const raster = draw([[90, 1000]]);
  const places = lit(raster);
  assert.ok(places.length >= 9 && places.length <= 16, `${places.length} pixels`);
  for (const [x, y] of places) {
    assert.ok(Math.hypot(x + 0.5 - 30, y + 0.5 - 10) <= 2.5);
    assert.equal(raster.pixels[y * raster.width + x], RED);
  }
});

test("on a dense screen the same point has more pixels", () => {
  const middle = lit(draw([[90, 1000]], 3));
  assert.ok(middle.length > 70 && middle.length < 110, `${middle.length} pixels`);
  const x = middle.reduce((sum, place) => sum + place[0] + 0.5, 0) / middle.length;
  assert.ok(Math.abs(x - 90) < 1);
});

test("a point on an edge is cut off there and does not appear on the other side", () => {
  const places = lit(draw([[90, 2000]]));
  assert.ok(places.length > 0);
  assert.ok(places.every(([x]) => x > 36));
});

test("points out of sight draw nothing", () => {
  assert.equal(
    lit(
      draw([
        [0, 5000],
        [90, 90_000],
        [180, 1200],
        [270, 2300],
      ]),
    ).length,
    0,
  );
});

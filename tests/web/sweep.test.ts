// A sweep as it is drawn: places on the floor, nearest echoes, extent.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create } from "@bufbuild/protobuf";
import { ScanSchema } from "../../web/gen/sweepcast/v1/scan_pb";
import { echoNear, extentOf, nearestObstacle, sweepOf } from "../../web/src/sweep";
import { scanOf } from "./scan_builder";

const near = (a: number, b: number) => assert.ok(Math.abs(a - b) < 1e-3, `${a} is not ${b}`);

test("0 degrees is to the front and 90 degrees to the right", () => {
  const sweep = sweepOf(
    scanOf([
      [0, 1000],
      [90, 2000],
      [180, 3000],
      [270, 4000],
    ]),
  );
  const expected = [
    [0, 1],
    [2, 0],
    [0, -3],
    [-4, 0],
  ];
  expected.forEach(([x, y], k) => {
    near(sweep.x[k]!, x!);
    near(sweep.y[k]!, y!);
  });
});

test("samples without an echo are counted but not drawn", () => {
  const sweep = sweepOf(
    scanOf([
      [0, 1000],
      [10, 0],
      [20, 1500],
    ]),
  );
  assert.equal(sweep.samples, 3);
  assert.deepEqual([...sweep.distanceM], [1, 1.5]);
  near(sweep.angleDeg[1]!, 20);
});

test("quarter millimetres are told by the scan's own unit", () => {
  const scan = create(ScanSchema, {
    angleUnitsPerTurn: 65536,
    angle: [0],
    distanceUnitUm: 250,
    distance: [2n * 4001n + 1n],
  });
  near(sweepOf(scan).distanceM[0]!, 1.00025);
});

test("speed and end of the sweep come from its period and last sample", () => {
  const scan = scanOf([
    [0, 1000],
    [270, 0],
  ]);
  scan.periodUs = 125_000;
  const sweep = sweepOf(scan);
  assert.equal(sweep.periodS, 0.125);
  assert.equal(sweep.endTurn, 0.75);
});

test("the nearest obstacle is the shortest distance", () => {
  const sweep = sweepOf(
    scanOf([
      [0, 0],
      [10, 900],
      [20, 800],
      [30, 850],
    ]),
  );
  assert.equal(nearestObstacle(sweep)?.index, 1);
});

test("without echoes there is neither an obstacle nor an extent", () => {
  const sweep = sweepOf(scanOf([[0, 0]]));
  assert.equal(nearestObstacle(sweep), undefined);
  assert.equal(extentOf(sweep), undefined);
});

test("the echo under the pointer is the nearest within reach", () => {
  const sweep = sweepOf(
    scanOf([
      [0, 1000],
      [0, 1200],
      [90, 1000],
    ]),
  );
  assert.equal(echoNear(sweep, 0.01, 1.15, 0.1)?.index, 1);
  assert.equal(echoNear(sweep, 0.5, 0.5, 0.1), undefined);
});

test("the extent holds every echo of an ordinary room", () => {
  const extent = extentOf(
    sweepOf(
      scanOf([
        [0, 3000],
        [90, 4000],
        [180, 2000],
      ]),
    ),
  )!;
  near(extent.x, 4);
  near(extent.y, 3);
  near(extent.radius, 4);
});

test("one stray echo far beyond the room does not count", () => {
  const room = Array.from({ length: 199 }, (_, k): [number, number] => [k, 2000]);
  const extent = extentOf(sweepOf(scanOf([...room, [200, 40_000]])))!;
  near(extent.radius, 2);
});

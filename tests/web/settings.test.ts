// What the page keeps in its address.
import assert from "node:assert/strict";
import { test } from "node:test";
import { formatSettings, parseSettings } from "../../web/src/settings";

test("settings survive the address", () => {
  const settings = { lidar: "ttyUSB0 & more#1", colourBy: "quality" } as const;
  assert.deepEqual(parseSettings(formatSettings(settings)), settings);
});

test("nothing to remember leaves the address alone", () => {
  assert.equal(formatSettings({ lidar: "", colourBy: "range" }), "");
});

for (const hash of ["", "#", "#colour=red", "#%%%", "#x=1&&="]) {
  test(`of the address "${hash}" nothing is taken`, () => {
    assert.deepEqual(parseSettings(hash), { lidar: "", colourBy: "range" });
  });
}

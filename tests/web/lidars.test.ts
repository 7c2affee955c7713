// The lidars of the gateway and the one that is looked at.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { LidarSchema } from "../../web/gen/sweepcast/v1/lidar_pb";
import { inTrouble, Lidar_State, lidarName, lidarTitle, Lidars } from "../../web/src/lidars";

const lidar = (fields: MessageInitShape<typeof LidarSchema>) => create(LidarSchema, fields);

const first = lidar({ number: 1, id: "ttyUSB0", state: Lidar_State.IDLE });
const second = lidar({ number: 2, id: "ttyUSB1", state: Lidar_State.SCANNING });

function lidars(...list: (typeof first)[]): Lidars {
  const all = new Lidars();
  all.replace(list);
  return all;
}

test("lidars are listed in the gateway's order", () => {
  const ids = lidars(second, first)
    .all()
    .map((each) => each.id);
  assert.deepEqual(ids, ["ttyUSB0", "ttyUSB1"]);
});

test("a lidar that is identified keeps its place and answers to both ids", () => {
  const all = lidars(first, second);
  all.put(lidar({ number: 1, id: "8a5b9cf1" }));
  assert.equal(all.all().length, 2);
  assert.equal(all.find("ttyUSB0")?.id, "8a5b9cf1");
  assert.equal(all.find("8a5b9cf1")?.number, 1);
});

test("a lidar that changes its id again and again answers to the last two", () => {
  const all = lidars(first);
  for (let k = 0; k < 5; ++k) all.put(lidar({ number: 1, id: `id${k}` }));
  const found = ["ttyUSB0", "id0", "id2", "id3", "id4"].filter((id) => all.find(id));
  assert.deepEqual(found, ["id3", "id4"]);
});

test("lidars beyond the bound are left out, those known go on", () => {
  const all = lidars(...Array.from({ length: 300 }, (_, k) => lidar({ number: k, id: `id${k}` })));
  assert.equal(all.all().length, 256);
  all.put(lidar({ number: 0, id: "renamed" }));
  assert.equal(all.find("renamed")?.number, 0);
});

test("a new greeting forgets what was before", () => {
  const all = lidars(first, second);
  all.replace([second]);
  assert.equal(all.find("ttyUSB0"), undefined);
});

test("a lidar is in trouble for as long as the gateway says that it is failing", () => {
  const failing = { failingSince: { seconds: 100n } };
  assert.ok(inTrouble(lidar({ state: Lidar_State.IDENTIFYING, ...failing })));
  assert.ok(!inTrouble(lidar({ state: Lidar_State.IDENTIFYING })));
  assert.ok(!inTrouble(lidar({ state: Lidar_State.SCANNING })));
  assert.ok(inTrouble(lidar({ state: Lidar_State.DISCONNECTED })));
});

test("the lidar wished for is chosen", () => {
  assert.equal(lidars(first, second).choose("ttyUSB0", "ttyUSB1")?.number, 1);
});

test("while the one wished for is not there the one looked at stays", () => {
  assert.equal(lidars(first, second).choose("gone", "ttyUSB0")?.number, 1);
});

test("at first one that scans is chosen", () => {
  assert.equal(lidars(first, second).choose("", "")?.number, 2);
});

test("if none scans the first is chosen", () => {
  assert.equal(lidars(first).choose("", "")?.number, 1);
});

test("where there is none, none is chosen", () => {
  assert.equal(lidars().choose("x", "y"), undefined);
});

for (const [name, fields] of [
  ["/dev/ttyUSB0", { id: "ttyUSB0", url: "/dev/ttyUSB0" }],
  ["A1M8 · 8a5b9cf1", { id: "8a5b9cf1", url: "/dev/ttyUSB0", device: { model: "A1M8" } }],
  ["A1M8 · 8a5b9cf1 (virtual)", { id: "8a5b9cf1", isVirtual: true, device: { model: "A1M8" } }],
] as const) {
  test(`a lidar is called ${name}`, () => {
    assert.equal(lidarName(lidar(fields)), name);
  });
}

test("in the list a lidar is its model, and then which one", () => {
  const known = { id: "8a5b9cf1", device: { model: "A1M8" } };
  assert.deepEqual(lidarTitle(lidar(known)), {
    title: "A1M8",
    place: "8a5b9cf1",
  });
  assert.deepEqual(lidarTitle(lidar({ ...known, isVirtual: true })).place, "8a5b9cf1, virtual");
  const unknown = { id: "ttyUSB0", url: "/dev/ttyUSB0" };
  assert.deepEqual(lidarTitle(lidar(unknown)), {
    title: "/dev/ttyUSB0",
    place: "",
  });
});

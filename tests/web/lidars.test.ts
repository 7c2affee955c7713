// The lidars of the gateway and the one that is looked at.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { LidarSchema } from "../../web/gen/sweepcast/v1/lidar_pb";
import { Lidar_State, lidarName, lidarTitle, Lidars } from "../../web/src/lidars";

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

test("a new greeting forgets what was before", () => {
  const all = lidars(first, second);
  all.replace([second]);
  assert.equal(all.find("ttyUSB0"), undefined);
});

test("a failed lidar that is tried again stays failed, with its cause, since it first did", () => {
  const all = lidars();
  const failed = { number: 1, state: Lidar_State.FAILED, cause: "no port", hint: "plug it in" };
  all.put(lidar({ ...failed, since: { seconds: 100n } }));
  all.put(lidar({ number: 1, state: Lidar_State.IDENTIFYING, since: { seconds: 102n } }));
  const meanwhile = all.all()[0]!;
  assert.equal(meanwhile.state, Lidar_State.FAILED);
  assert.deepEqual([meanwhile.cause, meanwhile.hint], ["no port", "plug it in"]);
  all.put(lidar({ ...failed, cause: "no answer", since: { seconds: 104n } }));
  assert.equal(all.all()[0]!.cause, "no answer");
  assert.equal(all.all()[0]!.since?.seconds, 100n);
});

test("a lidar is in trouble from its failure until it is well again", () => {
  const all = lidars();
  const troubled = [
    Lidar_State.STARTING,
    Lidar_State.FAILED,
    Lidar_State.IDENTIFYING,
    Lidar_State.STARTING,
    Lidar_State.SCANNING,
    Lidar_State.PROTECTION_STOP,
    Lidar_State.IDLE,
  ].map((state) => {
    all.put(lidar({ number: 1, state }));
    return all.inTrouble(all.all()[0]!);
  });
  assert.deepEqual(troubled, [false, true, true, true, false, true, false]);
});

test("a failed lidar that is reset, or found, is no longer failed", () => {
  const all = lidars();
  all.put(lidar({ number: 1, state: Lidar_State.FAILED, cause: "no port" }));
  all.put(lidar({ number: 1, state: Lidar_State.IDENTIFYING, cause: "resetting" }));
  assert.equal(all.all()[0]!.state, Lidar_State.IDENTIFYING);
  all.put(lidar({ number: 1, state: Lidar_State.FAILED, cause: "no port" }));
  all.put(lidar({ number: 1, state: Lidar_State.STARTING, since: { seconds: 9n } }));
  assert.equal(all.all()[0]!.state, Lidar_State.STARTING);
  assert.equal(all.all()[0]!.cause, "");
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
  assert.deepEqual(lidarTitle(lidar(known)), { title: "A1M8", place: "8a5b9cf1" });
  assert.deepEqual(lidarTitle(lidar({ ...known, isVirtual: true })).place, "8a5b9cf1, virtual");
  const unknown = { id: "ttyUSB0", url: "/dev/ttyUSB0" };
  assert.deepEqual(lidarTitle(lidar(unknown)), { title: "/dev/ttyUSB0", place: "" });
});

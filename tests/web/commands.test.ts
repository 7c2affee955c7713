// Commands under way, and what becomes of them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create } from "@bufbuild/protobuf";
import { LidarSchema } from "../../web/gen/sweepcast/v1/lidar_pb";
import type { Trouble } from "../../web/src/api";
import { Commands } from "../../web/src/commands";

const first = create(LidarSchema, { number: 1, id: "a" });
const second = create(LidarSchema, { number: 2, id: "b" });
const stuck = { message: "The motor is stuck.", hint: "Free it." };

// A command whose end is in the test's hands.
function held() {
  let end!: (trouble: Trouble | undefined) => void;
  const result = new Promise<Trouble | undefined>((resolve) => (end = resolve));
  return { run: () => result, end };
}

function watched() {
  const troubles: string[] = [];
  let changes = 0;
  const commands = new Commands<string>((lidar, trouble) => {
    ++changes;
    if (trouble) troubles.push(`${lidar.id}: ${trouble.message}`);
  });
  return { commands, troubles, changes: () => changes };
}

test("a command is under way from its start to its end", async () => {
  const { commands, changes } = watched();
  const command = held();
  const given = commands.give(first, "start", command.run);
  assert.equal(commands.of(first), "start");
  assert.equal(changes(), 1);
  command.end(undefined);
  await given;
  assert.equal(commands.of(first), undefined);
  assert.equal(changes(), 2);
});

test("trouble is told with the lidar it came from", async () => {
  const { commands, troubles } = watched();
  await commands.give(second, "stop", () => Promise.resolve(stuck));
  assert.deepEqual(troubles, ["b: The motor is stuck."]);
});

test("the lidars' commands are their own", () => {
  const { commands } = watched();
  void commands.give(first, "start", held().run);
  assert.equal(commands.of(second), undefined);
  assert.equal(commands.of(undefined), undefined);
});

test("a lidar whose id changes meanwhile keeps its command", () => {
  const { commands } = watched();
  void commands.give(first, "start", held().run);
  assert.equal(commands.of(create(LidarSchema, { number: 1, id: "8a5b9cf1" })), "start");
});

test("the end of a command that was replaced is no news, even by one of its kind", async () => {
  const { commands, troubles } = watched();
  const [before, after] = [held(), held()];
  const replaced = commands.give(first, "mode", before.run);
  void commands.give(first, "mode", after.run);
  before.end(stuck);
  await replaced;
  assert.equal(commands.of(first), "mode");
  assert.deepEqual(troubles, []);
});

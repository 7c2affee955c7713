// What the page says of each state, and what it offers in it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { buttonsFor, stateWords, type Action } from "../../web/src/lidar_state";
import { Lidar_State } from "../../web/src/lidars";

const STATES = Object.values(Lidar_State).filter(
  (state): state is Lidar_State => typeof state === "number",
);

function offered(
  state: Lidar_State,
  more: Partial<Parameters<typeof buttonsFor>[0]> = {},
): Action[] {
  const buttons = buttonsFor({
    state,
    connected: true,
    pending: undefined,
    ...more,
  });
  return (["start", "stop", "reset"] as const).filter((action) => buttons[action].enabled);
}

for (const [state, actions] of [
  [Lidar_State.UNKNOWN, []],
  [Lidar_State.DISCONNECTED, []],
  [Lidar_State.IDENTIFYING, []],
  [Lidar_State.IDLE, ["start", "reset"]],
  [Lidar_State.STARTING, ["stop"]],
  [Lidar_State.SCANNING, ["stop", "reset"]],
  [Lidar_State.STOPPING, []],
  [Lidar_State.PROTECTION_STOP, ["reset"]],
  [Lidar_State.FAILED, ["reset"]],
  [Lidar_State.ABSENT, []],
  [Lidar_State.OPENING, []],
  [Lidar_State.STALLED, ["stop"]],
  [Lidar_State.RESETTING, []],
  [Lidar_State.BACKING_OFF, []],
] as const) {
  test(`in ${Lidar_State[state]} the user may ${actions.join(" or ") || "only wait"}`, () => {
    assert.deepEqual(offered(state), actions);
  });
}

test("a lidar that is tried again and again is in one state for who looks at it", () => {
  const words = [Lidar_State.OPENING, Lidar_State.IDENTIFYING, Lidar_State.BACKING_OFF].map(
    (state) => stateWords(state, true).word,
  );
  assert.deepEqual(new Set(words), new Set(["Trying again"]));
  assert.equal(stateWords(Lidar_State.IDENTIFYING).word, "Identifying");
});

test("without a connection nothing may be done", () => {
  for (const state of STATES) assert.deepEqual(offered(state, { connected: false }), []);
});

test("while a command runs no other may be given, but a start may be called off", () => {
  for (const state of STATES) {
    assert.deepEqual(offered(state, { pending: "stop" }), []);
    assert.deepEqual(offered(state, { pending: "reset" }), []);
  }
  assert.deepEqual(offered(Lidar_State.STARTING, { pending: "start" }), ["stop"]);
  assert.deepEqual(offered(Lidar_State.IDLE, { pending: "start" }), []);
});

test("while the mode is being changed the scan can be stopped, and that is all", () => {
  assert.deepEqual(offered(Lidar_State.SCANNING, { pending: "mode" }), ["stop"]);
  assert.deepEqual(offered(Lidar_State.IDLE, { pending: "mode" }), []);
});

test("a command under way shows on its button", () => {
  const { start, stop } = buttonsFor({
    state: Lidar_State.STARTING,
    connected: true,
    pending: "start",
  });
  assert.deepEqual(start, { label: "Starting…", enabled: false, busy: true });
  assert.deepEqual(stop, { label: "Stop", enabled: true, busy: false });
});

test("a state that someone else brought about shows as well", () => {
  const { stop } = buttonsFor({
    state: Lidar_State.STOPPING,
    connected: true,
    pending: undefined,
  });
  assert.deepEqual(stop, { label: "Stopping…", enabled: false, busy: true });
});

test("every state has words of its own", () => {
  const words = STATES.map((state) => stateWords(state).word);
  assert.equal(new Set(words).size, STATES.length);
});

test("a state that this page does not know is called unknown", () => {
  assert.equal(stateWords(99 as Lidar_State).word, "Unknown");
});

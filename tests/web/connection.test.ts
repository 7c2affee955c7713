// The connection's life, without network or time.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Connection, type ConnectionState } from "../../web/src/connection";
import { encodeSubscribe, type ServerMessage } from "../../web/src/messages";
import { FakeSurroundings } from "./fake_surroundings";

function setUp() {
  const surroundings = new FakeSurroundings();
  const states: ConnectionState[] = [];
  const messages: ServerMessage[] = [];
  const connection = new Connection(surroundings, {
    connectionChanged: (state) => states.push(state),
    messageReceived: (message) => messages.push(message),
  });
  const kinds = () => states.map((state) => state.kind);
  const lossReason = () => (connection.state.kind === "lost" ? connection.state.reason : undefined);
  connection.connect();
  return { surroundings, connection, states, messages, kinds, lossReason };
}

test("the connection is open once the gateway has greeted", () => {
  const { surroundings, kinds, messages } = setUp();
  assert.deepEqual(kinds(), ["connecting"]);
  surroundings.socket.hello();
  assert.deepEqual(kinds(), ["connecting", "open"]);
  assert.equal(messages[0]?.message.case, "hello");
});

test("nothing is sent before the greeting", () => {
  const { surroundings, connection } = setUp();
  connection.send(encodeSubscribe("a"));
  assert.equal(surroundings.socket.sent.length, 0);
  surroundings.socket.hello();
  connection.send(encodeSubscribe("a"));
  assert.equal(surroundings.socket.sent.length, 1);
});

test("a lost connection is opened again after the wait it tells", async () => {
  const { surroundings, connection, kinds } = setUp();
  surroundings.socket.hello();
  surroundings.socket.drop();
  assert.deepEqual(connection.state, {
    kind: "lost",
    reason: "",
    retryAt: 500,
  });
  await surroundings.pass(499);
  assert.equal(surroundings.sockets.length, 1);
  await surroundings.pass(1);
  assert.equal(surroundings.sockets.length, 2);
  assert.deepEqual(kinds(), ["connecting", "open", "lost", "connecting"]);
});

test("waits grow while the gateway is away and begin anew after it was there for a while", async () => {
  const { surroundings, connection } = setUp();
  const waits = [];
  for (let k = 0; k < 4; ++k) {
    if (k === 3) {
      surroundings.socket.hello();
      await surroundings.pass(5000);
    }
    surroundings.socket.drop();
    assert.equal(connection.state.kind, "lost");
    const retryAt = connection.state.kind === "lost" ? connection.state.retryAt : NaN;
    waits.push(retryAt - surroundings.now());
    await surroundings.pass(waits[k]!);
  }
  assert.deepEqual(waits, [500, 1000, 2000, 500]);
});

test("waits go on growing if the gateway greets and turns us away", async () => {
  const { surroundings } = setUp();
  for (let k = 0; k < 4; ++k) {
    surroundings.socket.hello();
    surroundings.socket.drop();
    await surroundings.pass(500 * 2 ** k - 1);
    assert.equal(surroundings.sockets.length, k + 1);
    await surroundings.pass(1);
    assert.equal(surroundings.sockets.length, k + 2);
  }
});

test("the user need not sit out the wait", async () => {
  const { surroundings, connection } = setUp();
  surroundings.socket.drop();
  connection.connect();
  assert.equal(surroundings.sockets.length, 2);
  await surroundings.pass(600);
  assert.equal(surroundings.sockets.length, 2);
});

test("asking to connect while connected changes nothing", () => {
  const { surroundings, connection } = setUp();
  surroundings.socket.hello();
  connection.connect();
  assert.equal(surroundings.sockets.length, 1);
});

test("a gateway that does not greet is given up", async () => {
  const { surroundings, lossReason } = setUp();
  await surroundings.pass(8000);
  assert.equal(lossReason(), "The gateway does not answer.");
  assert.equal(surroundings.sockets[0]?.closed, true);
});

test("the gateway's reason for closing is told", () => {
  const { surroundings, lossReason, messages } = setUp();
  surroundings.socket.hello();
  surroundings.socket.hear({
    case: "closing",
    value: { reason: "the gateway is ending" },
  });
  surroundings.socket.drop("ignored");
  assert.equal(lossReason(), "the gateway is ending");
  assert.equal(messages.length, 1);
});

test("a silent gateway that still answers over HTTP is kept", async () => {
  const { surroundings, connection } = setUp();
  surroundings.socket.hello();
  await surroundings.pass(40_000);
  assert.equal(surroundings.probes, 2);
  assert.equal(connection.state.kind, "open");
});

test("a silent gateway that no longer answers is lost", async () => {
  const { surroundings, lossReason } = setUp();
  surroundings.socket.hello();
  surroundings.alive = false;
  await surroundings.pass(15_000);
  assert.equal(lossReason(), "The gateway does not answer.");
});

test("a gateway that talks is not probed", async () => {
  const { surroundings } = setUp();
  surroundings.socket.hello();
  for (let k = 0; k < 10; ++k) {
    await surroundings.pass(5000);
    surroundings.socket.hear({ case: "stats", value: {} });
  }
  assert.equal(surroundings.probes, 0);
});

test("bytes that are no message end the connection", () => {
  const { surroundings, connection } = setUp();
  surroundings.socket.hello();
  surroundings.socket.hearRaw(Uint8Array.of(0x0a, 0xff, 0xff, 0xff).buffer);
  assert.equal(connection.state.kind, "lost");
  assert.equal(surroundings.socket.closed, true);
});

test("a gateway of another protocol version is not listened to", () => {
  const { surroundings, messages, lossReason } = setUp();
  surroundings.socket.hello(2);
  assert.match(lossReason() ?? "", /version 2/);
  assert.equal(messages.length, 0);
});

// What is asked of the HTTP API, and its errors in words.
import assert from "node:assert/strict";
import { test } from "node:test";
import { command, diagnose, troubleOf, update } from "../../web/src/api";

const BASE = "http://robot:8080/lidar/";

// Takes the place of the network: answers as told, and keeps what was asked.
async function answering<Value>(
  answer: (asked: { url: string; init: RequestInit }) => Response | Promise<Response>,
  run: () => Promise<Value>,
): Promise<{ asked: { url: string; init: RequestInit }; result: Value }> {
  const real = globalThis.fetch;
  let asked = { url: "", init: {} as RequestInit };
  globalThis.fetch = async (url, init) => {
    asked = { url: String(url), init: init ?? {} };
    return answer(asked);
  };
  try {
    const result = await run();
    return { asked, result };
  } finally {
    globalThis.fetch = real;
  }
}

test("a command is a request to the lidar, below the page's address", async () => {
  const { asked, result } = await answering(
    () => new Response("{}"),
    () => command(BASE, "a/b", "stop"),
  );
  assert.equal(asked.url, "http://robot:8080/lidar/api/v1/lidars/a%2Fb/stop");
  assert.equal(asked.init.method, "POST");
  assert.equal(result, undefined);
});

test("an update changes what is given, and nothing else", async () => {
  const { asked, result } = await answering(
    () => new Response("{}"),
    () => update(BASE, "x", { speed_hz: 0 }),
  );
  assert.equal(asked.url, "http://robot:8080/lidar/api/v1/lidars/x");
  assert.equal(asked.init.method, "PATCH");
  assert.deepEqual(JSON.parse(String(asked.init.body)), { speed_hz: 0 });
  assert.equal(result, undefined);
});

test("a refusal is told in the gateway's words", async () => {
  const error = { code: "fixed_speed", message: "it is fixed", hint: "0 withdraws the wish" };
  const { result } = await answering(
    () => Response.json({ error }, { status: 409 }),
    () => update(BASE, "x", { speed_hz: 7 }),
  );
  assert.deepEqual(result, { message: error.message, hint: error.hint });
});

test("a gateway that cannot be reached is told as such", async () => {
  const { result } = await answering(
    () => Promise.reject(new TypeError("fetch failed")),
    () => command(BASE, "x", "start"),
  );
  assert.match(result!.message, /cannot be reached/);
});

test("a diagnosis is asked for and read", async () => {
  const { asked, result } = await answering(
    () => Response.json({ port: "/dev/ttyUSB0", verdict: "OK" }),
    () => diagnose(BASE, "x", new AbortController().signal),
  );
  assert.equal(asked.url, "http://robot:8080/lidar/api/v1/lidars/x/diagnosis");
  assert.ok("value" in result);
  assert.equal(result.value.port, "/dev/ttyUSB0");
});

test("a diagnosis that is called off ends its request", async () => {
  const cancel = new AbortController();
  const { result } = await answering(
    ({ init }) =>
      new Promise((_, reject) => {
        init.signal!.addEventListener("abort", () => reject(init.signal!.reason));
        cancel.abort();
      }),
    () => diagnose(BASE, "x", cancel.signal),
  );
  assert.ok("trouble" in result);
});

for (const [name, status, code] of [
  ["knows no such request", 404, "not_found"],
  ["knows it only in another form", 405, "method_not_allowed"],
] as const) {
  test(`a gateway that ${name} is said to be older than the page`, () => {
    const body = JSON.stringify({ error: { code, message: "there is nothing at /x" } });
    assert.match(troubleOf(status, body).hint, /update it/);
  });
}

test("a gateway that has not built it yet is said to be older than the page", () => {
  assert.match(troubleOf(501, "").hint, /update it/);
});

test("a lidar that is missing is not taken for an old gateway", () => {
  const body = { error: { code: "lidar_not_found", message: "there is no lidar", hint: "look" } };
  assert.equal(troubleOf(404, JSON.stringify(body)).message, "there is no lidar");
});

test("the gateway's own error is told with its hint", () => {
  const body = {
    error: {
      code: "busy",
      message: "The port is taken.",
      hint: "Close the other.",
    },
  };
  assert.deepEqual(troubleOf(409, JSON.stringify(body)), {
    message: "The port is taken.",
    hint: "Close the other.",
  });
});

test("an error with fields of a later version is still told", () => {
  const body = { error: { message: "No.", retry_after: 3 }, trace: "x" };
  assert.equal(troubleOf(500, JSON.stringify(body)).message, "No.");
});

for (const [name, body] of [
  ["a proxy's page", "<html>Bad gateway</html>"],
  ["nothing", ""],
  ["JSON of another kind", "[1]"],
  ["an error without a message", '{"error":{}}'],
  ["a message that is no text", '{"error":{"message":{}}}'],
] as const) {
  test(`if the answer is ${name} its status is told`, () => {
    assert.match(troubleOf(502, body).message, /502/);
  });
}

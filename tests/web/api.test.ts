// Errors of the HTTP API in words.
import assert from "node:assert/strict";
import { test } from "node:test";
import { troubleOf } from "../../web/src/api";

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

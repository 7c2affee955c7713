// The schedule of attempts to reconnect.
import assert from "node:assert/strict";
import { test } from "node:test";
import { retryDelay } from "../../web/src/backoff";

test("the wait doubles from half a second to ten seconds", () => {
  const delays = [0, 1, 2, 3, 4, 5, 6, 1000].map((attempt) => retryDelay(attempt, 0.5));
  assert.deepEqual(delays, [500, 1000, 2000, 4000, 8000, 10_000, 10_000, 10_000]);
});

test("the wait is spread by a quarter either way", () => {
  assert.equal(retryDelay(2, 0), 1500);
  assert.equal(retryDelay(2, 0.999999), 2500);
});

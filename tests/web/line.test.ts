// The quality of the line in words.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { LineSchema } from "../../web/gen/sweepcast/v1/lidar_pb";
import { baudWords, byteWords, lineWords } from "../../web/src/line";

const line = (fields: MessageInitShape<typeof LineSchema>) =>
  create(LineSchema, { samples: 4000n, ...fields });

for (const [fields, words, mark] of [
  [{}, "Clean", "ok"],
  [{ checksumErrors: 1n }, "1 packet damaged", "warning"],
  [{ checksumErrors: 1200n }, "1,200 packets damaged", "warning"],
  [{ lostPackets: 2n }, "2 packets lost", "warning"],
  [{ checksumErrors: 3n, lostPackets: 1n }, "3 packets damaged, 1 lost", "warning"],
  [{ samples: 0n }, "No samples yet", "rest"],
] as const) {
  test(`a line is told as: ${words}`, () => {
    assert.deepEqual(lineWords(line(fields)), { words, mark });
  });
}

test("without a line nothing is claimed of it", () => {
  assert.equal(lineWords(undefined).mark, "rest");
  assert.equal(baudWords(undefined), "–");
});

test("the line speed is told in baud, and a network is none", () => {
  assert.equal(baudWords(line({ baud: 1_000_000 })), "1,000,000 baud");
  assert.equal(baudWords(line({ baud: 0 })), "network");
});

for (const [bytes, words] of [
  [0n, "0 B"],
  [999n, "999 B"],
  [1000n, "1.0 kB"],
  [999_940n, "999.9 kB"],
  [999_960n, "1.0 MB"],
  [12_345_678_901n, "12.3 GB"],
  [12_345_678_901_234n, "12345.7 GB"],
] as const) {
  test(`${bytes} bytes are ${words}`, () => {
    assert.equal(byteWords(bytes), words);
  });
}

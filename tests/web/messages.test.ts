// Messages of the stream as bytes.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { Column } from "../../web/gen/sweepcast/v1/scan_pb";
import {
  ClientMessageSchema,
  Compression,
  FrameSchema,
  Kind,
  ServerMessageSchema,
} from "../../web/gen/sweepcast/v1/stream_pb";
import {
  decodeServerMessage,
  encodeSubscribe,
  LARGEST_SCAN_BYTES,
  openFrame,
} from "../../web/src/messages";

// A Scan of 60 angles, and the same through `zstd -3`.
const RAW = Buffer.from(
  "08808004123c020202020202020202020202020202020202020202020202020202020202020202020202020202020202020202020202020202020202020202020202",
  "hex",
);
const ZSTD = Buffer.from("28b52ffd20426d00003808808004123c020100908011", "hex");

function frame(fields: { body: Uint8Array; compression?: number; rawSize?: number }) {
  return create(FrameSchema, {
    rawSize: RAW.length,
    compression: Compression.ZSTD,
    ...fields,
  });
}

test("the subscription asks for one lidar's sectors, without what is not drawn", () => {
  const { message } = fromBinary(ClientMessageSchema, encodeSubscribe("8a5b9cf1"));
  assert.equal(message.case, "subscribe");
  assert.equal(message.value?.lidar, "8a5b9cf1");
  assert.equal(message.value?.kind, Kind.SECTOR);
  assert.equal(message.value?.sectorDeg, 30);
  assert.deepEqual(message.value?.leaveOut, [Column.FLAG, Column.TIME]);
  assert.equal(message.value?.compression, Compression.ZSTD);
});

test("a server message is read", () => {
  const bytes = toBinary(
    ServerMessageSchema,
    create(ServerMessageSchema, {
      message: { case: "closing", value: { reason: "done" } },
    }),
  );
  assert.equal(decodeServerMessage(bytes).message.case, "closing");
});

test("a frame compressed with zstd is opened", () => {
  const scan = openFrame(frame({ body: ZSTD }));
  assert.equal(scan.angleUnitsPerTurn, 65536);
  assert.deepEqual(scan.angle, Array(60).fill(1));
});

test("a zstd body need not tell its size", () => {
  const body = Buffer.from("28b52ffd00586d00003808808004123c020100908011", "hex");
  assert.equal(openFrame(frame({ body })).angle.length, 60);
});

test("a frame that is not compressed is opened", () => {
  const scan = openFrame(frame({ body: RAW, compression: Compression.NONE }));
  assert.equal(scan.angle.length, 60);
});

for (const [name, fields] of [
  ["whose body is cut off", { body: ZSTD.subarray(0, ZSTD.length - 3) }],
  ["whose body is not zstd", { body: RAW }],
  ["that claims less than it holds", { body: ZSTD, rawSize: 10 }],
  ["that claims more than it holds", { body: ZSTD, rawSize: RAW.length + 5 }],
  ["that claims more than a scan can be", { body: ZSTD, rawSize: LARGEST_SCAN_BYTES + 1 }],
  ["of an unknown compression", { body: RAW, compression: 9 }],
] as const) {
  test(`a frame ${name} is refused`, () => {
    assert.throws(() => openFrame(frame(fields)));
  });
}

// The stream's messages as bytes: what the page says, and what it hears.
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { decompress } from "fzstd";
import { Column, ScanSchema, type Scan } from "../gen/sweepcast/v1/scan_pb";
import {
  ClientMessageSchema,
  Compression,
  Kind,
  ServerMessageSchema,
  type Frame,
  type ServerMessage,
} from "../gen/sweepcast/v1/stream_pb";

export type { Frame, Hello, ServerMessage } from "../gen/sweepcast/v1/stream_pb";
export type { Scan } from "../gen/sweepcast/v1/scan_pb";

/// The version of the stream that this page speaks (Hello.protocol_version).
export const PROTOCOL_VERSION = 1;

/// Far more than the longest revolution needs; a frame that claims more is refused unread.
export const LARGEST_SCAN_BYTES = 4 * 1024 * 1024;

/// Reads one binary WebSocket message. Throws if it is not a ServerMessage.
export function decodeServerMessage(bytes: Uint8Array): ServerMessage {
  return fromBinary(ServerMessageSchema, bytes);
}

/// How much of a turn is drawn at a time, in degrees: at ten turns a second, 120 times a second.
const SECTOR_DEG = 30;

/// The message that asks for one lidar's sectors, without what is not drawn. The gateway always serves
/// exactly this request, however many others there are (Variants::is_plain). fzstd needs no wasm, and
/// takes no dictionary.
export function encodeSubscribe(lidar: string): Uint8Array {
  const subscribe = {
    lidar,
    kind: Kind.SECTOR,
    compression: Compression.ZSTD,
    sectorDeg: SECTOR_DEG,
    leaveOut: [Column.FLAG, Column.TIME],
  };
  return toBinary(
    ClientMessageSchema,
    create(ClientMessageSchema, { message: { case: "subscribe", value: subscribe } }),
  );
}

/// The scan in a frame's body. Throws if the body is not what the frame's header says.
export function openFrame(frame: Frame): Scan {
  return fromBinary(ScanSchema, rawBody(frame));
}

function rawBody(frame: Frame): Uint8Array {
  if (frame.compression === Compression.NONE) return frame.body;
  if (frame.compression !== Compression.ZSTD) {
    throw new Error(`unknown compression ${frame.compression}`);
  }
  if (frame.rawSize > LARGEST_SCAN_BYTES) {
    throw new Error(`a scan of ${frame.rawSize} bytes is too long`);
  }
  const size = contentSize(frame.body);
  if (size !== undefined && size !== frame.rawSize) {
    throw new Error(`the body holds ${size} bytes and not ${frame.rawSize}`);
  }
  // With a buffer given, fzstd allocates what the frame says and not what its body claims; but it leaves
  // rubbish in a buffer that is too large, hence the check above.
  return decompress(frame.body, new Uint8Array(frame.rawSize));
}

// The size that a zstd body says it has; undefined if it does not say (RFC 8878, 3.1.1.1).
function contentSize(body: Uint8Array): number | undefined {
  const descriptor = body[4] ?? 0;
  const singleSegment = (descriptor & 0x20) !== 0;
  const sizeBytes = [singleSegment ? 1 : 0, 2, 4, 8][descriptor >> 6]!;
  const dictionaryBytes = [0, 1, 2, 4][descriptor & 3]!;
  const offset = 5 + (singleSegment ? 0 : 1) + dictionaryBytes;
  if (sizeBytes === 0 || body.length < offset + sizeBytes) return undefined;
  let size = 0;
  for (let k = sizeBytes - 1; k >= 0; --k) size = size * 256 + body[offset + k]!;
  return sizeBytes === 2 ? size + 256 : size;
}

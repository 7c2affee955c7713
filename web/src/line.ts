// The line between lidar and gateway: how good it is, in words and numbers. Pure.
import type { MarkKind } from "./marks";
import type { Line } from "./lidars";
import { NONE, whole } from "./words";

export interface LineWords {
  words: string;
  mark: MarkKind;
}

/// The quality of the line since its port was opened: "Clean", "3 damaged packets, 1 lost".
export function lineWords(line: Line | undefined): LineWords {
  if (!line || line.samples === 0n) return { words: "No samples yet", mark: "rest" };
  const damaged = line.checksumErrors;
  const lost = line.lostPackets;
  if (damaged === 0n && lost === 0n) return { words: "Clean", mark: "ok" };
  const parts = [];
  if (damaged > 0n) parts.push(`${packets(damaged)} damaged`);
  if (lost > 0n) parts.push(`${damaged > 0n ? whole(Number(lost)) : packets(lost)} lost`);
  return { words: parts.join(", "), mark: "warning" };
}

function packets(count: bigint): string {
  return `${whole(Number(count))} packet${count === 1n ? "" : "s"}`;
}

/// "115,200 baud", or that it is no serial line; a dash if there is no line.
export function baudWords(line: Line | undefined): string {
  if (!line) return NONE;
  return line.baud === 0 ? "network" : `${whole(line.baud)} baud`;
}

/// A number of bytes: "812 B", "4.1 kB", "12.0 MB".
export function byteWords(count: bigint): string {
  const bytes = Number(count);
  if (bytes < 1000) return `${bytes} B`;
  for (const [unit, size] of [
    ["kB", 1e3],
    ["MB", 1e6],
    ["GB", 1e9],
  ] as const) {
    if (bytes < size * 999.95 || unit === "GB") return `${(bytes / size).toFixed(1)} ${unit}`;
  }
  return NONE;
}

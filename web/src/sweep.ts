// A sweep, or a sector of one, as it is drawn: its echoes as points on the floor, in metres around the lidar.
import type { Scan } from "./messages";
import { decodeScan } from "./scan";

export interface Sweep {
  /// The echoes, in the order they were measured: angle clockwise from the front, distance, quality,
  /// and the place on the floor: x to the right, y to the front.
  angleDeg: Float32Array;
  distanceM: Float32Array;
  quality: Uint8Array;
  x: Float32Array;
  y: Float32Array;
  /// Samples measured, with an echo or without.
  samples: number;
  qualityMeasured: boolean;
  /// Angles of the first and the last sample in turns, [0, 1): where the lidar was looking when the
  /// sweep began and ended.
  startTurn: number;
  endTurn: number;
  /// When the first sample was taken, in seconds on a clock that never steps.
  startS: number;
  /// Duration of the revolution in seconds; 0 if not known.
  periodS: number;
  mode: string;
}

export interface Echo {
  index: number;
  angleDeg: number;
  distanceM: number;
  quality: number;
}

/// Decodes a scan and places its echoes. Throws if the scan's columns contradict each other.
export function sweepOf(scan: Scan): Sweep {
  const columns = decodeScan(scan);
  const samples = columns.angle.length;
  const echoes = columns.distance.reduce((count, distance) => count + (distance > 0 ? 1 : 0), 0);
  const sweep: Sweep = {
    angleDeg: new Float32Array(echoes),
    distanceM: new Float32Array(echoes),
    quality: new Uint8Array(echoes),
    x: new Float32Array(echoes),
    y: new Float32Array(echoes),
    samples,
    qualityMeasured: columns.qualityMeasured,
    startTurn: samples > 0 ? columns.angle[0]! / columns.angleUnitsPerTurn : 0,
    endTurn: samples > 0 ? columns.angle[samples - 1]! / columns.angleUnitsPerTurn : 0,
    startS: Number(scan.firstMonotonicNs) / 1e9,
    periodS: scan.periodUs / 1e6,
    mode: scan.mode,
  };
  for (let k = 0, echo = 0; k < samples; ++k) {
    const distance = columns.distance[k]! * columns.distanceUnitUm * 1e-6;
    if (distance === 0) continue;
    const turn = columns.angle[k]! / columns.angleUnitsPerTurn;
    sweep.angleDeg[echo] = turn * 360;
    sweep.distanceM[echo] = distance;
    sweep.quality[echo] = columns.quality[k]!;
    sweep.x[echo] = distance * Math.sin(turn * 2 * Math.PI);
    sweep.y[echo] = distance * Math.cos(turn * 2 * Math.PI);
    ++echo;
  }
  return sweep;
}

/// Parts, at least one, of a sweep or of several, one after the other, as one. What a sweep has but once
/// is that of the last part; it began when the first part did.
export function joined(parts: readonly Sweep[]): Sweep {
  const first = parts[0]!;
  const last = parts[parts.length - 1]!;
  return {
    ...last,
    angleDeg: concatenated(
      parts.map((part) => part.angleDeg),
      Float32Array,
    ),
    distanceM: concatenated(
      parts.map((part) => part.distanceM),
      Float32Array,
    ),
    quality: concatenated(
      parts.map((part) => part.quality),
      Uint8Array,
    ),
    x: concatenated(
      parts.map((part) => part.x),
      Float32Array,
    ),
    y: concatenated(
      parts.map((part) => part.y),
      Float32Array,
    ),
    samples: parts.reduce((sum, part) => sum + part.samples, 0),
    qualityMeasured: parts.some((part) => part.qualityMeasured),
    startTurn: first.startTurn,
    startS: first.startS,
  };
}

/// The part of a sweep after so many turns since its first sample, [0, 1).
export function after(sweep: Sweep, turns: number): Sweep {
  // Angles of echoes are rounded: the first may lie a little before the sample that it is of.
  const little = 1e-6;
  const passed = (degrees: number) =>
    turned(sweep.startTurn - little, degrees / 360) <= turns + 2 * little;
  let first = 0;
  while (first < sweep.x.length && passed(sweep.angleDeg[first]!)) ++first;
  return {
    ...sweep,
    angleDeg: sweep.angleDeg.subarray(first),
    distanceM: sweep.distanceM.subarray(first),
    quality: sweep.quality.subarray(first),
    x: sweep.x.subarray(first),
    y: sweep.y.subarray(first),
  };
}

/// From one angle forward to another, in turns, [0, 1).
export function turned(from: number, to: number): number {
  return (((to - from) % 1) + 1) % 1;
}

function concatenated<Column extends Float32Array | Uint8Array>(
  columns: readonly Column[],
  make: new (length: number) => Column,
): Column {
  const all = new make(columns.reduce((sum, column) => sum + column.length, 0));
  let at = 0;
  for (const column of columns) {
    all.set(column, at);
    at += column.length;
  }
  return all;
}

/// The echo at `index`.
export function echoAt(sweep: Sweep, index: number): Echo {
  return {
    index,
    angleDeg: sweep.angleDeg[index]!,
    distanceM: sweep.distanceM[index]!,
    quality: sweep.quality[index]!,
  };
}

/// The echo nearest to the lidar; undefined if there is none.
export function nearestObstacle(sweep: Sweep): Echo | undefined {
  let best = -1;
  for (let k = 0; k < sweep.distanceM.length; ++k) {
    if (best < 0 || sweep.distanceM[k]! < sweep.distanceM[best]!) best = k;
  }
  return best < 0 ? undefined : echoAt(sweep, best);
}

/// The echo nearest to a place on the floor, if one is within `reach` metres of it.
export function echoNear(sweep: Sweep, x: number, y: number, reach: number): Echo | undefined {
  let best = -1;
  let bestSquare = reach * reach;
  for (let k = 0; k < sweep.x.length; ++k) {
    const square = (sweep.x[k]! - x) ** 2 + (sweep.y[k]! - y) ** 2;
    if (square <= bestSquare) {
      best = k;
      bestSquare = square;
    }
  }
  return best < 0 ? undefined : echoAt(sweep, best);
}

const STRAY_RATIO = 1.5;

export interface Extent {
  /// How far to either side, to the front or back, and in any direction the echoes reach, in metres.
  x: number;
  y: number;
  radius: number;
}

/// How far the sweep reaches. If its farthest hundredth lies far beyond the rest it is left out: a few
/// stray echoes through a window must not shrink the room to a dot. Undefined without echoes.
export function extentOf(sweep: Sweep): Extent | undefined {
  if (sweep.distanceM.length === 0) return undefined;
  const sorted = Float32Array.from(sweep.distanceM).sort();
  const farthest = sorted[sorted.length - 1]!;
  const room = sorted[Math.floor((sorted.length - 1) * 0.99)]!;
  const radius = farthest > room * STRAY_RATIO ? room : farthest;
  const extent = { x: 0, y: 0, radius };
  for (let k = 0; k < sweep.x.length; ++k) {
    if (sweep.distanceM[k]! > radius) continue;
    extent.x = Math.max(extent.x, Math.abs(sweep.x[k]!));
    extent.y = Math.max(extent.y, Math.abs(sweep.y[k]!));
  }
  return extent;
}

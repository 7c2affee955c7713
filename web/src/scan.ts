// A Scan message (scan.proto) to plain columns: the running sums, and nothing else.
import { rampAngles } from "./angle_ramps";
import type { Scan } from "./messages";

/// One entry a sample in each column, in the order they were measured.
export interface Columns {
  /// Full circle in units of `angle`.
  angleUnitsPerTurn: number;
  /// Clockwise from the front, [0, angleUnitsPerTurn).
  angle: Uint32Array;
  /// In units of `distanceUnitUm`; 0: no echo.
  distance: Float64Array;
  distanceUnitUm: number;
  quality: Uint8Array;
  /// False if the scan mode gives every echo the same quality, so that it says nothing.
  qualityMeasured: boolean;
}

/// Decodes a scan. Throws if its columns contradict each other.
export function decodeScan(scan: Scan): Columns {
  const count = scan.distance.length;
  if (!scan.ramps && scan.angle.length !== count) {
    throw new Error("angle and distance differ in length");
  }
  if (scan.quality.length !== 0 && scan.quality.length !== count) {
    throw new Error("distance and quality differ in length");
  }
  if (scan.angleUnitsPerTurn === 0) throw new Error("no unit of angle");
  const distance = decodeDistance(scan.distance);
  const qualityMeasured = scan.quality.length === count && count > 0;
  return {
    angleUnitsPerTurn: scan.angleUnitsPerTurn,
    angle: scan.ramps
      ? rampAngles(
          scan.ramps,
          count,
          scan.angleUnitsPerTurn,
          (k) => (distance[k]! * scan.distanceUnitUm) / 250,
        )
      : decodeAngle(scan.angle, scan.angleUnitsPerTurn),
    distance,
    distanceUnitUm: scan.distanceUnitUm,
    quality: qualityMeasured ? scan.quality : impliedQuality(distance, scan.echoQuality),
    qualityMeasured,
  };
}

function decodeAngle(deltas: readonly number[], unitsPerTurn: number): Uint32Array {
  const angle = new Uint32Array(deltas.length);
  let sum = 0;
  deltas.forEach((delta, k) => {
    sum = (sum + delta) % unitsPerTurn;
    if (sum < 0) sum += unitsPerTurn;
    angle[k] = sum;
  });
  return angle;
}

// A distance is 32 bits, so a difference and its zigzag stay well within a double's 53.
function decodeDistance(tokens: readonly bigint[]): Float64Array {
  const distance = new Float64Array(tokens.length);
  let last = 0;
  tokens.forEach((token, k) => {
    const zigzag = Number(token) - 1;
    if (zigzag < 0) return;
    last += zigzag % 2 === 0 ? zigzag / 2 : -(zigzag + 1) / 2;
    if (last < 0 || last > 0xffffffff) throw new Error("a distance is out of range");
    distance[k] = last;
  });
  return distance;
}

function impliedQuality(distance: Float64Array, echoQuality: number): Uint8Array {
  return Uint8Array.from(distance, (value) => (value > 0 ? echoQuality : 0));
}

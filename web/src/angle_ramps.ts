// The short form of a scan's angles (scan.proto, AngleRamps): ramps, less parallax or corrections.
import type { AngleRamps } from "../gen/sweepcast/v1/scan_pb";

/// Parts of a unit that a ramp is reckoned in.
const PARTS = 1024;
/// Units of a correction.
const CORRECTION = 8;

/// The angle of each sample in units of `unitsPerTurn`, [0, unitsPerTurn). `quarterMm` gives a sample's
/// distance in quarters of a millimetre, 0 without echo. Throws if the message contradicts itself.
export function rampAngles(
  ramps: AngleRamps,
  count: number,
  unitsPerTurn: number,
  quarterMm: (k: number) => number,
): Uint32Array {
  const { length, skip } = ramps;
  if (length === 0 || skip >= length) throw new Error("ramps without length");
  const begun = Math.ceil((skip + count) / length);
  if (ramps.start.length !== begun + 1) throw new Error("ramps and distances differ in length");
  if (ramps.correction.length !== 0 && ramps.correction.length !== count) {
    throw new Error("corrections and distances differ in length");
  }
  const start = runningSums(ramps.start);
  const correction = runningSums(ramps.correction);
  const fixes = fixesOf(ramps, count);
  const angle = new Uint32Array(count);
  for (let k = 0; k < count; ++k) {
    const ramp = Math.floor((skip + k) / length);
    const from = start[ramp]! * PARTS;
    const step = Math.floor((start[ramp + 1]! * PARTS - from) / length);
    const raw = from + ((skip + k) % length) * step;
    const seen = Math.floor((raw - (ramps.parallax ? parallax(quarterMm(k)) : 0)) / PARTS);
    const units = seen - CORRECTION * (correction[k] ?? 0) + (fixes.get(k) ?? 0);
    angle[k] = ((units % unitsPerTurn) + unitsPerTurn) % unitsPerTurn;
  }
  return angle;
}

/// By how much a beam that starts beside the axis is seen before its place, in parts of a unit.
function parallax(quarterMm: number): number {
  const near = Math.floor(98361 / quarterMm);
  const radians =
    quarterMm < 200 ? 8578 : 9150 - 64 * near - Math.floor((near * near * near) / 98304);
  return Math.trunc((radians * 180) / 3.14159265);
}

function runningSums(differences: readonly number[]): number[] {
  let sum = 0;
  return differences.map((difference) => (sum += difference));
}

function fixesOf(ramps: AngleRamps, count: number): Map<number, number> {
  if (ramps.fixIndex.length !== ramps.fix.length) throw new Error("a fix without its place");
  const places = runningSums(ramps.fixIndex);
  if (places.some((place) => place >= count))
    throw new Error("a fix for a sample that is not there");
  return new Map(places.map((place, k) => [place, ramps.fix[k]!]));
}

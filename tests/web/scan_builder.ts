// Makes Scan messages for the tests, as the gateway would.
import { create } from "@bufbuild/protobuf";
import { ScanSchema, type Scan } from "../../web/gen/sweepcast/v1/scan_pb";

/// A scan of samples given as [degrees, millimetres], 0 mm for no echo.
export function scanOf(samples: readonly (readonly [number, number])[]): Scan {
  const angle: number[] = [];
  const distance: bigint[] = [];
  let lastAngle = 0;
  let lastDistance = 0;
  for (const [degrees, millimetres] of samples) {
    const units = Math.round((degrees / 360) * 65536);
    angle.push(units - lastAngle);
    lastAngle = units;
    if (millimetres === 0) {
      distance.push(0n);
      continue;
    }
    const difference = millimetres - lastDistance;
    distance.push(BigInt(difference >= 0 ? 2 * difference : -2 * difference - 1) + 1n);
    lastDistance = millimetres;
  }
  return create(ScanSchema, {
    angleUnitsPerTurn: 65536,
    angle,
    distanceUnitUm: 1000,
    distance,
    echoQuality: 188,
  });
}

// The polar grid: rings at round distances and spokes at round angles, at every zoom.
import { toScreen, type Point, type View } from "./view";

/// Rings are at least this many CSS pixels apart.
const RING_SPACING_PX = 64;
const SPOKE_STEPS_DEG = [30, 15, 10, 5, 1, 0.5, 0.1];

export interface Grid {
  /// Radii in metres, and the distance between two.
  rings: number[];
  ringStep: number;
  /// Degrees clockwise from the front.
  spokes: number[];
}

/// The distance between rings for a scale of `pixelsPerMetre`: 1, 2 or 5 times a power of ten, in metres.
export function ringStep(pixelsPerMetre: number): number {
  const least = RING_SPACING_PX / pixelsPerMetre;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].find((digit) => digit * power >= least * 0.999) ?? 10;
  return step * power;
}

/// A ring's label, with as many decimals as the step between rings needs: "0.05 m", "12 m".
export function ringLabel(radius: number, step: number): string {
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return `${radius.toFixed(decimals)} m`;
}

/// The rings and spokes to be seen in a view.
export function gridFor(view: View): Grid {
  const step = ringStep(view.scale);
  const { nearest, farthest, span } = reachOf(view);
  const rings = [];
  for (let k = Math.max(1, Math.ceil(nearest / step)); k * step <= farthest; ++k) {
    rings.push(k * step);
  }
  const spokeStep = SPOKE_STEPS_DEG.find((degrees) => degrees * 3 <= span) ?? 0.1;
  const spokes = Array.from({ length: Math.round(360 / spokeStep) }, (_, k) => k * spokeStep);
  return { rings, ringStep: step, spokes: spokes.filter((angle) => crosses(view, angle)) };
}

/// Unit vector on the screen of a direction, in degrees clockwise from the front.
export function direction(angleDeg: number): Point {
  const radians = (angleDeg * Math.PI) / 180;
  return { x: Math.sin(radians), y: -Math.cos(radians) };
}

/// Where a spoke enters and leaves the screen less `inset` pixels on each side, as distances in CSS
/// pixels from the lidar; undefined if it passes by.
export function clipSpoke(
  view: View,
  angleDeg: number,
  inset: number,
): [number, number] | undefined {
  const lidar = toScreen(view, 0, 0);
  const along = direction(angleDeg);
  let enter = 0;
  let leave = Infinity;
  const sides = [
    [lidar.x, along.x, view.width],
    [lidar.y, along.y, view.height],
  ] as const;
  for (const [from, slope, size] of sides) {
    if (Math.abs(slope) < 1e-9) {
      if (from < inset || from > size - inset) return undefined;
      continue;
    }
    const a = (inset - from) / slope;
    const b = (size - inset - from) / slope;
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter < leave ? [enter, leave] : undefined;
}

/// The direction along which the rings are labelled: to the right, or towards the middle of the screen if
/// the lidar is out of sight.
export function labelDirection(view: View): number {
  const lidar = toScreen(view, 0, 0);
  const inSight =
    lidar.x >= 0 && lidar.x < view.width - 80 && lidar.y >= 20 && lidar.y <= view.height - 20;
  if (inSight) return 90;
  return (Math.atan2(view.centreX, view.centreY) * 180) / Math.PI;
}

function crosses(view: View, angleDeg: number): boolean {
  return clipSpoke(view, angleDeg, 0) !== undefined;
}

// Distance in metres from the lidar to the nearest and farthest places in sight, and the angle in degrees
// that the view spans as seen from it.
function reachOf(view: View): { nearest: number; farthest: number; span: number } {
  const halfWidth = view.width / 2 / view.scale;
  const halfHeight = view.height / 2 / view.scale;
  const awayX = Math.max(0, Math.abs(view.centreX) - halfWidth);
  const awayY = Math.max(0, Math.abs(view.centreY) - halfHeight);
  const nearest = Math.hypot(awayX, awayY);
  const farthest = Math.hypot(
    Math.abs(view.centreX) + halfWidth,
    Math.abs(view.centreY) + halfHeight,
  );
  if (nearest === 0) return { nearest, farthest, span: 360 };
  const halfDiagonal = Math.hypot(halfWidth, halfHeight);
  const away = Math.hypot(view.centreX, view.centreY);
  return { nearest, farthest, span: (2 * Math.atan2(halfDiagonal, away) * 180) / Math.PI };
}

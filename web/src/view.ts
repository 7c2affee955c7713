// The view: which part of the floor is on the screen, and how large. Values in, values out.
import type { Extent } from "./sweep";

export interface View {
  /// The place on the floor, in metres, in the middle of the screen: x right, y front.
  centreX: number;
  centreY: number;
  /// CSS pixels a metre.
  scale: number;
  /// Size on the screen in CSS pixels.
  width: number;
  height: number;
}

export interface Point {
  x: number;
  y: number;
}

// From 400 m across a phone to a pixel of a quarter millimetre, the lidar's own resolution.
const SMALLEST_SCALE = 1;
const LARGEST_SCALE = 4000;
const FARTHEST_M = 200;
// Room around the fitted sweep for the degree labels.
const FIT_MARGIN_PX = 28;

/// The view before anything is known: the lidar in the middle, 5 m to the nearer edge.
export function initialView(width: number, height: number): View {
  return fitted({ centreX: 0, centreY: 0, scale: 1, width, height }, { x: 5, y: 5, radius: 5 });
}

/// The place on the screen, in CSS pixels from the top left, of a place on the floor.
export function toScreen(view: View, x: number, y: number): Point {
  return {
    x: view.width / 2 + (x - view.centreX) * view.scale,
    y: view.height / 2 - (y - view.centreY) * view.scale,
  };
}

/// The place on the floor at a place on the screen.
export function toFloor(view: View, x: number, y: number): Point {
  return {
    x: view.centreX + (x - view.width / 2) / view.scale,
    y: view.centreY - (y - view.height / 2) / view.scale,
  };
}

/// The view after the floor was dragged by so many CSS pixels.
export function panned(view: View, dx: number, dy: number): View {
  return moved(view, view.centreX - dx / view.scale, view.centreY + dy / view.scale);
}

/// The view magnified by `factor`, with the place under (x, y) on the screen staying where it is.
export function zoomed(view: View, x: number, y: number, factor: number): View {
  const under = toFloor(view, x, y);
  const scale = clamp(view.scale * factor, SMALLEST_SCALE, LARGEST_SCALE);
  const ratio = view.scale / scale;
  return moved(
    { ...view, scale },
    under.x + (view.centreX - under.x) * ratio,
    under.y + (view.centreY - under.y) * ratio,
  );
}

/// The view with the lidar in the middle and the whole extent in sight.
export function fitted(view: View, extent: Extent): View {
  const half = (size: number) => Math.max(size / 2 - FIT_MARGIN_PX, 1);
  const scale = Math.min(
    half(view.width) / Math.max(extent.x, 0.1),
    half(view.height) / Math.max(extent.y, 0.1),
  );
  return {
    ...view,
    centreX: 0,
    centreY: 0,
    scale: clamp(scale, SMALLEST_SCALE, LARGEST_SCALE),
  };
}

/// True if `view` no longer suits the extent: it does not hold it, or holds far more than it. The slack
/// between the two keeps a view that follows the sweep from twitching.
export function needsRefit(view: View, extent: Extent): boolean {
  const ratio = fitted(view, extent).scale / view.scale;
  return ratio < 0.97 || ratio > 1.4;
}

/// The same view on a screen of another size.
export function resized(view: View, width: number, height: number): View {
  return { ...view, width, height };
}

function moved(view: View, centreX: number, centreY: number): View {
  return {
    ...view,
    centreX: clamp(centreX, -FARTHEST_M, FARTHEST_M),
    centreY: clamp(centreY, -FARTHEST_M, FARTHEST_M),
  };
}

function clamp(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

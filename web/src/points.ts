// The points as pixels: each a small disc, written straight into an image.
import type { Sweep } from "./sweep";
import type { View } from "./view";

/// Diameter of a point in CSS pixels.
export const POINT_PX = 3.5;

export interface Raster {
  /// One entry a device pixel, as ImageData keeps them.
  pixels: Uint32Array;
  width: number;
  height: number;
  /// Device pixels a CSS pixel.
  ratio: number;
}

/// Clears the raster and draws each echo in the palette's colour number `index[k]`. Points outside of it
/// cost a comparison; none is written beyond its edges.
export function drawPoints(
  raster: Raster,
  view: View,
  sweep: Sweep,
  palette: Uint32Array,
  index: Uint8Array,
): void {
  raster.pixels.fill(0);
  const disc = discRows(POINT_PX * raster.ratio);
  const scale = view.scale * raster.ratio;
  const left = (view.width * raster.ratio) / 2 - view.centreX * scale;
  const top = (view.height * raster.ratio) / 2 + view.centreY * scale;
  const reach = disc.length;
  for (let k = 0; k < sweep.x.length; ++k) {
    const x = left + sweep.x[k]! * scale;
    const y = top - sweep.y[k]! * scale;
    if (x < -reach || y < -reach || x > raster.width + reach || y > raster.height + reach) continue;
    stamp(raster, disc, x, y, palette[index[k]!]!);
  }
}

// Half the width of each row of a disc, from the top row to the bottom one.
function discRows(diameter: number): number[] {
  const rows = Math.max(2, Math.round(diameter));
  const radius = rows / 2;
  return Array.from({ length: rows }, (_, row) => {
    const offset = row + 0.5 - radius;
    return Math.sqrt(Math.max(radius * radius - offset * offset, 0));
  });
}

function stamp(raster: Raster, disc: number[], x: number, y: number, colour: number): void {
  const top = Math.round(y - disc.length / 2);
  for (let row = 0; row < disc.length; ++row) {
    const line = top + row;
    if (line < 0 || line >= raster.height) continue;
    const from = Math.max(0, Math.round(x - disc[row]!));
    const to = Math.min(raster.width, Math.round(x + disc[row]!));
    if (from < to) raster.pixels.fill(colour, line * raster.width + from, line * raster.width + to);
  }
}

// Colours of the points: a part of viridis, which reads the same to colour-blind eyes, chosen for each
// theme so that every colour of it stands out from the background.

export type Theme = "light" | "dark";
export type Rgb = readonly [number, number, number];

/// What the colour of a point stands for.
export type ColourBy = "range" | "quality";

// Viridis at eighths.
const VIRIDIS: readonly Rgb[] = [
  [0x44, 0x01, 0x54],
  [0x47, 0x2d, 0x7b],
  [0x3b, 0x52, 0x8b],
  [0x2c, 0x72, 0x8e],
  [0x21, 0x91, 0x8c],
  [0x28, 0xae, 0x80],
  [0x5e, 0xc9, 0x62],
  [0xad, 0xdc, 0x30],
  [0xfd, 0xe7, 0x25],
];

/// The colour for `salience` in [0, 1]: 1 (near, or a strong echo) stands out the most.
export function ramp(theme: Theme, salience: number): Rgb {
  const level = Math.min(Math.max(salience, 0), 1);
  return viridis(theme === "dark" ? 0.42 + 0.58 * level : 0.52 * (1 - level));
}

/// 256 colours of the ramp as pixels for ImageData, whatever the machine's byte order.
export function palette(theme: Theme): Uint32Array {
  const bytes = new Uint8ClampedArray(256 * 4);
  for (let k = 0; k < 256; ++k) bytes.set([...ramp(theme, k / 255), 255], k * 4);
  return new Uint32Array(bytes.buffer);
}

/// The range in metres that the farthest colour stands for: `radius` rounded up to a round number. Keeps
/// `current` while that still suits, so that the colours do not flicker.
export function colourRange(radius: number, current: number): number {
  if (radius <= current && radius > current * 0.55) return current;
  const power = 10 ** Math.floor(Math.log10(Math.max(radius, 0.1)));
  const digit = [1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((digit) => digit * power >= radius) ?? 10;
  return digit * power;
}

/// Palette index of each echo.
export function colourIndex(
  by: ColourBy,
  distanceM: Float32Array,
  quality: Uint8Array,
  range: number,
): Uint8Array {
  if (by === "quality") return quality;
  return Uint8Array.from(distanceM, (distance) => 255 - Math.min(255, (distance / range) * 255));
}

function viridis(position: number): Rgb {
  const at = position * (VIRIDIS.length - 1);
  const below = VIRIDIS[Math.floor(at)]!;
  const above = VIRIDIS[Math.min(Math.floor(at) + 1, VIRIDIS.length - 1)]!;
  const part = at - Math.floor(at);
  const mix = (k: 0 | 1 | 2) => Math.round(below[k] + (above[k] - below[k]) * part);
  return [mix(0), mix(1), mix(2)];
}

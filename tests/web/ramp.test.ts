// The colours of the points, and that they and the texts stand out from their grounds.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { colourIndex, colourRange, palette, ramp, type Rgb, type Theme } from "../../web/src/ramp";

declare const WEB_SOURCES: string;

// The custom properties of the style sheet: the first block is light, the second dark.
function colours(theme: Theme): Map<string, string> {
  const sheet = readFileSync(`${WEB_SOURCES}/app.css`, "utf8");
  const blocks = [...sheet.matchAll(/:root\s*\{([^}]*)\}/g)].map((match) => match[1]!);
  const block = blocks[theme === "light" ? 0 : 1]!;
  return new Map(
    [...block.matchAll(/--([a-z-]+):\s*(#[0-9a-f]{6})/g)].map((match) => [match[1]!, match[2]!]),
  );
}

function rgb(hex: string): Rgb {
  const value = parseInt(hex.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}

// WCAG 2.2, relative luminance and contrast ratio.
function luminance(colour: Rgb): number {
  const [r, g, b] = colour.map((channel) => {
    const part = channel / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  }) as [number, number, number];
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(a: Rgb, b: Rgb): number {
  const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y) as [number, number];
  return (high + 0.05) / (low + 0.05);
}

for (const theme of ["light", "dark"] as const) {
  const ground = colours(theme);

  test(`every point stands out from the ${theme} canvas`, () => {
    for (let k = 0; k <= 255; ++k) {
      const ratio = contrast(ramp(theme, k / 255), rgb(ground.get("canvas")!));
      assert.ok(ratio >= 3, `colour ${k}: ${ratio}`);
    }
  });

  test(`the more salient a point, the more it stands out from the ${theme} canvas`, () => {
    const canvas = rgb(ground.get("canvas")!);
    const ratios = [0, 0.25, 0.5, 0.75, 1].map((level) => contrast(ramp(theme, level), canvas));
    assert.deepEqual(
      ratios,
      [...ratios].sort((a, b) => a - b),
    );
  });

  for (const [text, backgrounds] of [
    ["text", ["page", "card", "canvas", "note-ground", "bad-ground"]],
    ["quiet", ["page", "card"]],
    ["bad", ["card", "bad-ground"]],
    ["grid-label", ["canvas"]],
    ["on-accent", ["accent"]],
  ] as const) {
    test(`text in "${text}" is readable in the ${theme} theme`, () => {
      for (const background of backgrounds) {
        const ratio = contrast(rgb(ground.get(text)!), rgb(ground.get(background)!));
        assert.ok(ratio >= 4.5, `on ${background}: ${ratio}`);
      }
    });
  }

  for (const sign of ["good", "busy", "bad", "control-edge", "accent"]) {
    test(`the sign "${sign}" can be told from its ground in the ${theme} theme`, () => {
      for (const background of ["page", "card"]) {
        const ratio = contrast(rgb(ground.get(sign)!), rgb(ground.get(background)!));
        assert.ok(ratio >= 3, `on ${background}: ${ratio}`);
      }
    });
  }
}

test("the palette holds the ramp as opaque pixels", () => {
  const bytes = new Uint8Array(palette("dark").buffer);
  assert.deepEqual([...bytes.slice(0, 4)], [...ramp("dark", 0), 255]);
  assert.deepEqual([...bytes.slice(255 * 4)], [...ramp("dark", 1), 255]);
});

test("by range the near is salient and what is beyond the scale is not", () => {
  const index = colourIndex("range", Float32Array.of(0, 5, 10, 99), new Uint8Array(4), 10);
  assert.deepEqual([...index], [255, 127, 0, 0]);
});

test("by quality the strong is salient", () => {
  const index = colourIndex("quality", Float32Array.of(1, 2), Uint8Array.of(3, 255), 10);
  assert.deepEqual([...index], [3, 255]);
});

for (const [radius, current, expected] of [
  [4.1, 0, 5],
  [5, 0, 5],
  [0.13, 0, 0.15],
  [11, 0, 15],
  [4.1, 5, 5],
  [3, 5, 5],
  [5.1, 5, 6],
  [2, 5, 2],
  [0, 0, 0.1],
] as const) {
  test(`a room of ${radius} m coloured to ${current} m so far is coloured to ${expected} m`, () => {
    assert.ok(Math.abs(colourRange(radius, current) - expected) < 1e-9);
  });
}

// Compares what is drawn with what window.sweepcast says. Runs in the page, handed over by evaluate().

/// Looks at every pixel of the points' canvas. Returns counts: `points` in sight, `unlit` ones of them that
/// have no pixel at their place, `miscoloured` ones whose pixel has no colour of a point around there, and
/// `stray` pixels that belong to no point.
export function comparePoints() {
  const canvas = document.getElementById("points");
  const ratio = canvas.width / canvas.clientWidth;
  const { width, height } = canvas;
  const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
  const reach = Math.ceil((3.5 * ratio) / 2) + 1;
  const points = [];
  for (let k = 0; k < window.sweepcast.points; ++k) {
    const { x, y, colour } = window.sweepcast.point(k);
    points.push({ x: Math.floor(x * ratio), y: Math.floor(y * ratio), colour });
  }
  const visible = points.filter(({ x, y }) => x >= 0 && y >= 0 && x < width && y < height);
  const coloursAt = new Map();
  for (const { x, y, colour } of points) {
    for (let row = y - reach; row <= y + reach; ++row) {
      for (let column = x - reach; column <= x + reach; ++column) {
        if (row < 0 || column < 0 || row >= height || column >= width) continue;
        const place = row * width + column;
        if (!coloursAt.has(place)) coloursAt.set(place, new Set());
        coloursAt.get(place).add(colour.join());
      }
    }
  }
  const result = { points: visible.length, unlit: 0, miscoloured: 0, stray: 0, colours: 0 };
  for (const { x, y } of visible) {
    const at = (y * width + x) * 4;
    if (data[at + 3] !== 255) ++result.unlit;
    else if (!coloursAt.get(y * width + x).has(data.slice(at, at + 3).join())) ++result.miscoloured;
  }
  for (let place = 0; place < width * height; ++place) {
    if (data[place * 4 + 3] !== 0 && !coloursAt.has(place)) ++result.stray;
  }
  result.colours = new Set(visible.map(({ colour }) => colour.join())).size;
  return result;
}

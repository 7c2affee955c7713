// Paints what moves over the points: the lidar, its sweep line, and the echo looked at.
import { direction } from "./grid";
import type { Colours } from "./scene";
import type { Echo } from "./sweep";
import { toScreen, type Point, type View } from "./view";

// The glow behind the sweep line.
const TRAIL_DEG = 40;

/// Paints into a cleared canvas whose unit is the CSS pixel. `turn` is where the lidar looks, in turns;
/// undefined: no line.
export function paintOverlay(
  context: CanvasRenderingContext2D,
  view: View,
  colours: Colours,
  turn: number | undefined,
  echo: Echo | undefined,
): void {
  const lidar = toScreen(view, 0, 0);
  if (turn !== undefined) paintLine(context, view, lidar, colours, turn);
  if (echo) paintEcho(context, view, lidar, colours, echo);
  paintLidar(context, lidar, colours);
}

function paintLine(
  context: CanvasRenderingContext2D,
  view: View,
  lidar: Point,
  colours: Colours,
  turn: number,
): void {
  const length = Math.hypot(
    view.width / 2 + Math.abs(view.centreX) * view.scale,
    view.height / 2 + Math.abs(view.centreY) * view.scale,
  );
  // Canvas angles start to the right, ours at the top.
  const head = turn * 2 * Math.PI - Math.PI / 2;
  const trail = (TRAIL_DEG * Math.PI) / 180;
  // The accent colour without opacity: "transparent" is black, and would darken the glow.
  const clear = `${colours.accent}00`;
  const glow = context.createConicGradient(head - trail, lidar.x, lidar.y);
  glow.addColorStop(0, clear);
  glow.addColorStop(TRAIL_DEG / 360, colours.accent);
  glow.addColorStop(Math.min(TRAIL_DEG / 360 + 0.001, 1), clear);
  context.globalAlpha = 0.16;
  context.fillStyle = glow;
  context.beginPath();
  context.moveTo(lidar.x, lidar.y);
  context.arc(lidar.x, lidar.y, length, head - trail, head);
  context.fill();

  const along = direction(turn * 360);
  context.globalAlpha = 0.7;
  context.strokeStyle = colours.accent;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(lidar.x, lidar.y);
  context.lineTo(lidar.x + along.x * length, lidar.y + along.y * length);
  context.stroke();
  context.globalAlpha = 1;
}

function paintEcho(
  context: CanvasRenderingContext2D,
  view: View,
  lidar: Point,
  colours: Colours,
  echo: Echo,
): void {
  const along = direction(echo.angleDeg);
  const distance = echo.distanceM * view.scale;
  const x = lidar.x + along.x * distance;
  const y = lidar.y + along.y * distance;
  context.strokeStyle = colours.mark;
  context.lineWidth = 1;
  context.setLineDash([3, 4]);
  context.beginPath();
  context.moveTo(lidar.x, lidar.y);
  context.lineTo(x - along.x * 8, y - along.y * 8);
  context.stroke();
  context.setLineDash([]);
  context.lineWidth = 2;
  context.beginPath();
  context.arc(x, y, 8, 0, 2 * Math.PI);
  context.stroke();
}

// A disc with a notch to the front, so that its orientation is seen.
function paintLidar(context: CanvasRenderingContext2D, lidar: Point, colours: Colours): void {
  context.fillStyle = colours.background;
  context.strokeStyle = colours.mark;
  context.lineWidth = 2;
  context.beginPath();
  context.arc(lidar.x, lidar.y, 7, 0, 2 * Math.PI);
  context.fill();
  context.moveTo(lidar.x, lidar.y - 2);
  context.lineTo(lidar.x, lidar.y - 11);
  context.stroke();
}

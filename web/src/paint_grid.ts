// Paints the polar grid and its labels.
import { clipSpoke, direction, labelDirection, ringLabel, type Grid } from "./grid";
import type { Colours } from "./scene";
import { toScreen, type Point, type View } from "./view";

const FONT = "12px system-ui, sans-serif";
// Degree labels stand this far inside the edge.
const EDGE_PX = 20;
// A label nearer than this to another's place is left out.
const CLEAR_PX = 44;

/// A part of the canvas, in CSS pixels.
export interface Area {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/// Paints into a cleared canvas whose unit is the CSS pixel; no label is put in `covered`, where the
/// buttons are.
export function paintGrid(
  context: CanvasRenderingContext2D,
  view: View,
  grid: Grid,
  colours: Colours,
  covered: Area,
): void {
  const lidar = toScreen(view, 0, 0);
  context.lineWidth = 1;
  context.strokeStyle = colours.line;
  context.beginPath();
  for (const radius of grid.rings) {
    context.moveTo(lidar.x + radius * view.scale, lidar.y);
    context.arc(lidar.x, lidar.y, radius * view.scale, 0, 2 * Math.PI);
  }
  for (const angle of grid.spokes) addSpoke(context, view, lidar, angle);
  context.stroke();

  context.font = FONT;
  context.textAlign = "center";
  context.textBaseline = "middle";
  // The halo keeps labels readable where lines cross them.
  context.lineWidth = 4;
  context.lineJoin = "round";
  context.strokeStyle = colours.background;
  context.fillStyle = colours.label;
  const label = (text: string, at: Point) => {
    if (within(covered, at)) return;
    context.strokeText(text, at.x, at.y);
    context.fillText(text, at.x, at.y);
  };
  for (const angle of grid.spokes) {
    const at = spokeLabelPlace(view, lidar, angle);
    if (at) label(`${Number(angle.toFixed(1))}°`, at);
  }
  for (const radius of grid.rings) {
    const at = ringLabelPlace(view, lidar, radius);
    if (at) label(ringLabel(radius, grid.ringStep), at);
  }
}

function addSpoke(
  context: CanvasRenderingContext2D,
  view: View,
  lidar: Point,
  angle: number,
): void {
  const reach = clipSpoke(view, angle, 0);
  if (!reach) return;
  const along = direction(angle);
  context.moveTo(lidar.x + along.x * reach[0], lidar.y + along.y * reach[0]);
  context.lineTo(lidar.x + along.x * reach[1], lidar.y + along.y * reach[1]);
}

function spokeLabelPlace(view: View, lidar: Point, angle: number): Point | undefined {
  const reach = clipSpoke(view, angle, EDGE_PX);
  if (!reach || reach[1] < CLEAR_PX) return undefined;
  const along = direction(angle);
  return { x: lidar.x + along.x * reach[1], y: lidar.y + along.y * reach[1] };
}

function ringLabelPlace(view: View, lidar: Point, radius: number): Point | undefined {
  const along = direction(labelDirection(view));
  const x = lidar.x + along.x * radius * view.scale;
  const y = lidar.y + along.y * radius * view.scale;
  const inside =
    x >= EDGE_PX &&
    x <= view.width - CLEAR_PX - EDGE_PX &&
    y >= EDGE_PX &&
    y <= view.height - EDGE_PX;
  return inside ? { x, y } : undefined;
}

function within(area: Area, at: Point): boolean {
  return (
    at.x > area.left - EDGE_PX &&
    at.x < area.right + EDGE_PX &&
    at.y > area.top - EDGE_PX / 2 &&
    at.y < area.bottom + EDGE_PX / 2
  );
}

// Mouse, touch and keyboard on the drawing, as wishes: pan, zoom, fit, look at a point.

export interface GestureListener {
  /// The floor is dragged by so many CSS pixels.
  pan(dx: number, dy: number): void;
  /// Magnify about a place on the drawing.
  zoom(x: number, y: number, factor: number): void;
  /// Magnify about the middle.
  zoomMiddle(factor: number): void;
  fit(): void;
  /// The pointer rests on a place; undefined: it has left.
  pointAt(place: { x: number; y: number } | undefined): void;
}

export const ZOOM_STEP = 1.25;
const KEY_PAN_PX = 48;
/// A touch that moves less is a tap.
const TAP_SLACK_PX = 8;

interface Pointer {
  x: number;
  y: number;
  startX: number;
  startY: number;
  dragging: boolean;
}

/// Listens to the element for as long as the page lives.
export function listenToGestures(element: HTMLElement, listener: GestureListener): void {
  listenToPointers(element, listener);
  element.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      listener.zoom(event.offsetX, event.offsetY, wheelFactor(event));
    },
    { passive: false },
  );
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (applyKey(event.key, listener)) event.preventDefault();
  });
}

function listenToPointers(element: HTMLElement, listener: GestureListener): void {
  const pointers = new Map<number, Pointer>();
  element.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    element.setPointerCapture(event.pointerId);
    const { offsetX: x, offsetY: y } = event;
    pointers.set(event.pointerId, { x, y, startX: x, startY: y, dragging: false });
    // Two fingers never tap.
    if (pointers.size > 1) pointers.forEach((pointer) => (pointer.dragging = true));
  });
  element.addEventListener("pointermove", (event) => {
    const { offsetX: x, offsetY: y } = event;
    const pointer = pointers.get(event.pointerId);
    if (!pointer) {
      if (event.pointerType === "mouse") listener.pointAt({ x, y });
      return;
    }
    const slack = Math.hypot(x - pointer.startX, y - pointer.startY);
    pointer.dragging ||= slack > TAP_SLACK_PX || event.pointerType === "mouse";
    if (!pointer.dragging) return;
    const other = [...pointers.values()].find((each) => each !== pointer);
    if (other) pinch(listener, other, pointer, x, y);
    else listener.pan(x - pointer.x, y - pointer.y);
    pointer.x = x;
    pointer.y = y;
  });
  element.addEventListener("pointerup", (event) => {
    const pointer = pointers.get(event.pointerId);
    pointers.delete(event.pointerId);
    if (pointer && !pointer.dragging) listener.pointAt({ x: pointer.x, y: pointer.y });
  });
  element.addEventListener("pointercancel", (event) => pointers.delete(event.pointerId));
  element.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "mouse") listener.pointAt(undefined);
  });
}

// One finger of two moves: the floor under both stays under both.
function pinch(
  listener: GestureListener,
  still: Pointer,
  moving: Pointer,
  x: number,
  y: number,
): void {
  const before = Math.hypot(moving.x - still.x, moving.y - still.y);
  const after = Math.hypot(x - still.x, y - still.y);
  listener.pan((x - moving.x) / 2, (y - moving.y) / 2);
  if (before > 0 && after > 0) {
    listener.zoom((x + still.x) / 2, (y + still.y) / 2, after / before);
  }
}

// Wheels report pixels, lines or pages; a pinch on a touch pad comes as a wheel with ctrl and small steps.
function wheelFactor(event: WheelEvent): number {
  const unit = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : 33;
  const delta = Math.min(Math.max(event.deltaY * unit, -200), 200);
  return Math.exp(-delta * (event.ctrlKey ? 0.01 : 0.002));
}

function applyKey(key: string, listener: GestureListener): boolean {
  switch (key) {
    case "+":
    case "=":
      listener.zoomMiddle(ZOOM_STEP);
      return true;
    case "-":
      listener.zoomMiddle(1 / ZOOM_STEP);
      return true;
    case "0":
      listener.fit();
      return true;
    case "ArrowLeft":
      listener.pan(KEY_PAN_PX, 0);
      return true;
    case "ArrowRight":
      listener.pan(-KEY_PAN_PX, 0);
      return true;
    case "ArrowUp":
      listener.pan(0, KEY_PAN_PX);
      return true;
    case "ArrowDown":
      listener.pan(0, -KEY_PAN_PX);
      return true;
    default:
      return false;
  }
}

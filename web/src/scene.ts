// The drawing: three canvases on top of each other, so that each is redrawn only when it changes: the grid
// with the view, the points with the sweep, and over them the sweep line and the point looked at.
import { element } from "./dom";
import { gridFor } from "./grid";
import { paintGrid, type Area } from "./paint_grid";
import { paintOverlay } from "./paint_overlay";
import { drawPoints, type Raster } from "./points";
import { colourIndex, colourRange, palette as paletteOf, type ColourBy, type Theme } from "./ramp";
import { echoNear, extentOf, type Echo, type Extent, type Sweep } from "./sweep";
import { follow, turnAt, type SweepLine } from "./sweep_line";
import {
  fitted,
  initialView,
  needsRefit,
  panned,
  resized,
  toFloor,
  zoomed,
  type Point,
  type View,
} from "./view";

/// The colours of the drawing, from the style sheet.
export interface Colours {
  theme: Theme;
  line: string;
  label: string;
  accent: string;
  mark: string;
  background: string;
}

/// What is on the screen now: a sweep, where it is seen from, and the colour of each of its echoes as an
/// index into the palette.
export interface Drawn {
  sweep: Sweep;
  view: View;
  index: Uint8Array;
  palette: Uint32Array;
}

/// How near to a point the pointer must be to look at it, in CSS pixels.
const REACH_PX = 24;

export class Scene {
  /// Called when the echo under the pointer changes.
  onEcho: (echo: Echo | undefined) => void = () => {};
  /// Called when the range that the colours stand for changes.
  onColourRange: (metres: number) => void = () => {};

  private readonly stage = element("stage", HTMLElement);
  private readonly buttons = element("zoom", HTMLElement);
  private readonly grid = element("grid", HTMLCanvasElement);
  private readonly points = element("points", HTMLCanvasElement);
  private readonly overlay = element("overlay", HTMLCanvasElement);
  private readonly reducedMotion = matchMedia("(prefers-reduced-motion: reduce)");
  private readonly darkTheme = matchMedia("(prefers-color-scheme: dark)");

  private ratio = 1;
  private image: ImageData | undefined;
  private view_: View = initialView(1, 1);
  private following = true;
  private sweep_: Sweep | undefined;
  private drawn_: Drawn | undefined;
  private colourBy: ColourBy = "range";
  private range = 0;
  /// A whole sweep of this lidar was seen; before that the colours suit what was drawn so far.
  private suited = false;
  private colours: Colours = readColours();
  private palette = paletteOf(this.colours.theme);
  private line: SweepLine | undefined;
  private pointer: Point | undefined;
  private echo: Echo | undefined;
  private stale = { grid: true, points: true, overlay: true };
  private requested = false;

  constructor() {
    new ResizeObserver(() => this.resize()).observe(this.stage);
    this.darkTheme.addEventListener("change", () => this.recolour());
    this.reducedMotion.addEventListener("change", () => this.invalidate("overlay"));
    this.watchRatio();
  }

  get view(): View {
    return this.view_;
  }

  get drawn(): Drawn | undefined {
    return this.drawn_;
  }

  /// Shows the newest echoes, which have just arrived; undefined: none (another lidar was chosen).
  /// `complete` is the sweep that they complete, if any: the view is chosen to suit it.
  show(sweep: Sweep | undefined, complete?: Sweep): void {
    this.sweep_ = sweep;
    this.line = sweep && follow(this.line, sweep.endTurn, sweep.periodS, seconds());
    if (complete) this.suit(complete);
    else if (sweep && !this.suited) this.scaleColours(extentOf(sweep));
    if (!sweep) {
      this.drawn_ = undefined;
      this.following = true;
      this.range = 0;
      this.suited = false;
    }
    this.look();
    this.invalidate("points");
    this.invalidate("overlay");
  }

  /// Ends the sweep line: the lidar no longer turns, or is no longer heard.
  halt(): void {
    this.line = undefined;
    this.invalidate("overlay");
  }

  setColourBy(by: ColourBy): void {
    this.colourBy = by;
    this.invalidate("points");
  }

  fit(): void {
    this.following = true;
    const extent = this.sweep_ && extentOf(this.sweep_);
    const view = this.view_;
    this.move(extent ? fitted(view, extent) : initialView(view.width, view.height));
  }

  pan(dx: number, dy: number): void {
    this.following = false;
    this.move(panned(this.view_, dx, dy));
  }

  zoom(x: number, y: number, factor: number): void {
    this.following = false;
    this.move(zoomed(this.view_, x, y, factor));
  }

  zoomMiddle(factor: number): void {
    this.zoom(this.view_.width / 2, this.view_.height / 2, factor);
  }

  pointAt(place: Point | undefined): void {
    this.pointer = place;
    this.look();
  }

  private move(view: View): void {
    this.view_ = view;
    this.look();
    this.invalidate("grid");
    this.invalidate("points");
    this.invalidate("overlay");
  }

  private suit(sweep: Sweep): void {
    const extent = extentOf(sweep);
    if (!extent) return;
    this.suited = true;
    this.scaleColours(extent);
    if (this.following && needsRefit(this.view_, extent)) this.move(fitted(this.view_, extent));
  }

  private scaleColours(extent: Extent | undefined): void {
    if (!extent) return;
    const range = colourRange(extent.radius, this.range);
    if (range !== this.range) this.onColourRange(range);
    this.range = range;
  }

  private look(): void {
    const at = this.pointer && toFloor(this.view_, this.pointer.x, this.pointer.y);
    const reach = REACH_PX / this.view_.scale;
    const echo = at && this.sweep_ && echoNear(this.sweep_, at.x, at.y, reach);
    if (!echo && !this.echo) return;
    this.echo = echo;
    this.onEcho(echo);
    this.invalidate("overlay");
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.stage;
    if (width === 0 || height === 0) return;
    this.ratio = devicePixelRatio || 1;
    for (const canvas of [this.grid, this.points, this.overlay]) {
      canvas.width = Math.round(width * this.ratio);
      canvas.height = Math.round(height * this.ratio);
    }
    this.image = undefined;
    this.view_ = resized(this.view_, width, height);
    if (this.following) this.fit();
    else this.move(this.view_);
    // Sizing a canvas clears it: draw in the same frame, so that nothing flickers.
    this.draw();
  }

  // The ratio changes when the window moves to another screen, or the page is magnified.
  private watchRatio(): void {
    const query = matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    query.addEventListener(
      "change",
      () => {
        this.resize();
        this.watchRatio();
      },
      { once: true },
    );
  }

  private recolour(): void {
    this.colours = readColours();
    this.palette = paletteOf(this.colours.theme);
    this.move(this.view_);
  }

  private invalidate(layer: "grid" | "points" | "overlay"): void {
    this.stale[layer] = true;
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame(() => {
      this.requested = false;
      this.draw();
    });
  }

  private draw(): void {
    if (this.stale.grid) {
      this.stale.grid = false;
      const context = contextOf(this.grid, this.ratio);
      paintGrid(context, this.view_, gridFor(this.view_), this.colours, this.covered());
    }
    if (this.stale.points) this.drawSweep();
    if (this.stale.overlay) this.drawOverlay();
  }

  private covered(): Area {
    const { offsetLeft: left, offsetTop: top, offsetWidth, offsetHeight } = this.buttons;
    return { left, top, right: left + offsetWidth, bottom: top + offsetHeight };
  }

  private drawSweep(): void {
    this.stale.points = false;
    const context = this.points.getContext("2d")!;
    const { width, height } = this.points;
    if (!this.sweep_) {
      context.clearRect(0, 0, width, height);
      return;
    }
    const image = (this.image ??= context.createImageData(width, height));
    const raster: Raster = {
      pixels: new Uint32Array(image.data.buffer),
      width,
      height,
      ratio: this.ratio,
    };
    const { distanceM, quality } = this.sweep_;
    const index = colourIndex(this.colourBy, distanceM, quality, this.range);
    drawPoints(raster, this.view_, this.sweep_, this.palette, index);
    context.putImageData(image, 0, 0);
    this.drawn_ = { sweep: this.sweep_, view: this.view_, index, palette: this.palette };
  }

  private drawOverlay(): void {
    this.stale.overlay = false;
    const turn = this.reducedMotion.matches ? undefined : this.line && turnAt(this.line, seconds());
    paintOverlay(contextOf(this.overlay, this.ratio), this.view_, this.colours, turn, this.echo);
    if (turn !== undefined) this.invalidate("overlay");
  }
}

function contextOf(canvas: HTMLCanvasElement, ratio: number): CanvasRenderingContext2D {
  const context = canvas.getContext("2d")!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, canvas.width, canvas.height);
  return context;
}

function readColours(): Colours {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  return {
    theme: matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light",
    line: colour("--grid-line"),
    label: colour("--grid-label"),
    accent: colour("--accent"),
    mark: colour("--text"),
    background: colour("--canvas"),
  };
}

function seconds(): number {
  return performance.now() / 1000;
}

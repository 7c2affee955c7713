// Marks: a shape for each tone, so that nothing rests on colour alone.
import type { Tone } from "./lidar_state";

/// What a mark says: a state's tone, or the outcome of a check.
export type MarkKind = Tone | "ok" | "warning" | "failed" | "not_run";

// In a box of 24 by 24, filled by the even-odd rule. Tones: disc, part of a ring, ring, triangle. Outcomes:
// tick, triangle with an exclamation mark, cross, dash.
const SHAPES: Record<MarkKind, string> = {
  good: "M12 3a9 9 0 1 0 0 18a9 9 0 1 0 0-18z",
  busy: "M12 2a10 10 0 1 1-10 10h4a6 6 0 1 0 6-6z",
  rest: "M12 2a10 10 0 1 0 0 20a10 10 0 1 0 0-20zm0 4a6 6 0 1 1 0 12a6 6 0 1 1 0-12z",
  bad: "M12 2l11 20h-22z",
  ok: "M9.5 20.5l-8-8l3-3l5 5l10.5-10.5l3 3z",
  warning: "M12 2l11 20h-22zM10.8 9v6.5h2.4v-6.5zM10.8 17v2.4h2.4v-2.4z",
  failed: "M4 1.5l8 8l8-8l2.5 2.5l-8 8l8 8l-2.5 2.5l-8-8l-8 8l-2.5-2.5l8-8l-8-8z",
  not_run: "M4 10.5h16v3h-16z",
};

const SVG = "http://www.w3.org/2000/svg";

/// A mark that screen readers pass over: what it says must stand beside it in words.
export class Mark {
  readonly element = document.createElementNS(SVG, "svg");
  private readonly path = document.createElementNS(SVG, "path");

  constructor(kind: MarkKind) {
    this.element.setAttribute("viewBox", "0 0 24 24");
    this.element.setAttribute("aria-hidden", "true");
    this.element.classList.add("mark");
    this.path.setAttribute("fill-rule", "evenodd");
    this.element.append(this.path);
    this.show(kind);
  }

  show(kind: MarkKind): void {
    if (this.element.dataset["kind"] === kind) return;
    this.element.dataset["kind"] = kind;
    this.path.setAttribute("d", SHAPES[kind]);
  }
}

// What the points' colours mean: a strip of the ramp with its two ends, and the choice of what it shows.
import { element, setText, showText } from "./dom";
import { ramp, type ColourBy, type Theme } from "./ramp";
import { metres } from "./words";

export interface LegendState {
  by: ColourBy;
  theme: Theme;
  /// Distance that the far end stands for, in metres; 0: not known yet.
  range: number;
  qualityMeasured: boolean;
}

export class Legend {
  private readonly strip = element("ramp", HTMLCanvasElement);
  private readonly low = element("ramp-low", HTMLElement);
  private readonly high = element("ramp-high", HTMLElement);
  private readonly note = element("colour-note", HTMLElement);
  private readonly choices = {
    range: element("colour-range", HTMLInputElement),
    quality: element("colour-quality", HTMLInputElement),
  };

  constructor(onChoice: (by: ColourBy) => void) {
    this.choices.range.addEventListener("change", () => onChoice("range"));
    this.choices.quality.addEventListener("change", () => onChoice("quality"));
  }

  show(state: LegendState): void {
    this.choices[state.by].checked = true;
    const byRange = state.by === "range";
    setText(this.low, byRange ? "0 m" : "0");
    setText(this.high, byRange ? (state.range > 0 ? shortMetres(state.range) : "–") : "255");
    const dull = !byRange && !state.qualityMeasured;
    showText(this.note, dull ? "In this scan mode every echo has the same quality." : "");
    this.paint(state.theme, byRange);
  }

  // The far end, and the weak echo, stand out the least.
  private paint(theme: Theme, nearFirst: boolean): void {
    const context = this.strip.getContext("2d")!;
    for (let x = 0; x < this.strip.width; ++x) {
      const part = x / (this.strip.width - 1);
      context.fillStyle = `rgb(${ramp(theme, nearFirst ? 1 - part : part).join(",")})`;
      context.fillRect(x, 0, 1, this.strip.height);
    }
  }
}

function shortMetres(value: number): string {
  return Number.isInteger(value) ? `${value} m` : metres(value).replace(/0 m$/, " m");
}

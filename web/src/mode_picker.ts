// The choice of the scan mode: the lidar's modes with their rate and reach. Choosing changes the running
// scan, or the next one.
import { element, showText } from "./dom";
import type { Lidar } from "./lidars";
import { modeOption, modeWords } from "./words";

export class ModePicker {
  private readonly row = element("mode-row", HTMLElement);
  private readonly picker = element("mode-picker", HTMLSelectElement);
  private readonly note = element("mode-note", HTMLElement);

  /// `onPick` is called with the name of a mode.
  constructor(onPick: (mode: string) => void) {
    this.picker.addEventListener("change", () => onPick(this.picker.value));
  }

  /// `changing`: another mode was asked for, and is not yet in use.
  show(lidar: Lidar | undefined, connected: boolean, changing: boolean): void {
    this.row.hidden = !lidar || lidar.modes.length === 0;
    this.picker.disabled = !connected;
    setOptions(this.picker, lidar?.modes.map((mode) => [mode.name, modeOption(mode)]) ?? []);
    // What the user picked stays while it is on its way.
    if (lidar && !changing) this.picker.value = lidar.mode;
    const shown = lidar?.modes.find((mode) => mode.name === this.picker.value);
    const words = shown ? modeWords(shown) : "";
    showText(this.note, changing ? `Changing to ${this.picker.value}…` : words);
  }
}

// Rebuilds the options only if they differ: an open list would close.
function setOptions(
  select: HTMLSelectElement,
  options: readonly (readonly [string, string])[],
): void {
  const same =
    select.options.length === options.length &&
    options.every(([value, text], k) => {
      const option = select.options[k]!;
      return option.value === value && option.text === text;
    });
  if (same) return;
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
}

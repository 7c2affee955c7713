// The controls: which lidar, which mode, and the three buttons.
import { command, type Trouble } from "./api";
import { element, setText, showText } from "./dom";
import { buttonsFor, type Action } from "./lidar_state";
import { Lidar_State, lidarName, type Lidar } from "./lidars";
import { modeWords } from "./words";

export class Controls {
  private readonly pickerRow = element("lidar-row", HTMLElement);
  private readonly picker = element("lidar-picker", HTMLSelectElement);
  private readonly modeRow = element("mode-row", HTMLElement);
  private readonly modes = element("mode-picker", HTMLSelectElement);
  private readonly modeNote = element("mode-note", HTMLElement);
  private readonly trouble = element("trouble", HTMLElement);
  private readonly troubleMessage = element("trouble-message", HTMLElement);
  private readonly troubleHint = element("trouble-hint", HTMLElement);
  private readonly buttons: Record<Action, HTMLButtonElement> = {
    start: element("start", HTMLButtonElement),
    stop: element("stop", HTMLButtonElement),
    reset: element("reset", HTMLButtonElement),
  };

  private lidar: Lidar | undefined;
  private connected = false;
  /// Commands under way, by the lidar's number; a later one replaces the earlier.
  private readonly pending = new Map<number, Action>();

  /// `base` is the page's address; `onPick` is called with the id of a lidar.
  constructor(
    private readonly base: string,
    onPick: (id: string) => void,
  ) {
    this.picker.addEventListener("change", () => {
      this.dismissTrouble();
      onPick(this.picker.value);
    });
    this.modes.addEventListener("change", () => this.refresh());
    for (const action of ["start", "stop", "reset"] as const) {
      this.buttons[action].addEventListener("click", () => void this.ask(action));
    }
    element("trouble-dismiss", HTMLButtonElement).addEventListener("click", () =>
      this.dismissTrouble(),
    );
  }

  /// Shows the lidars to choose from, and the one chosen.
  show(lidars: readonly Lidar[], lidar: Lidar | undefined, connected: boolean): void {
    const modeBefore = this.lidar?.number === lidar?.number ? this.lidar?.mode : undefined;
    this.lidar = lidar;
    this.connected = connected;
    this.pickerRow.hidden = lidars.length < 2;
    setOptions(
      this.picker,
      lidars.map((each) => [each.id, lidarName(each)]),
    );
    this.picker.value = lidar?.id ?? "";
    this.modeRow.hidden = !lidar || lidar.modes.length === 0;
    setOptions(this.modes, lidar?.modes.map((mode) => [mode.name, mode.name]) ?? []);
    // What the user picked stays until the lidar itself has another mode.
    if (lidar && lidar.mode !== modeBefore) this.modes.value = lidar.mode;
    this.refresh();
  }

  /// Says what went wrong, until it is dismissed or the next command.
  showTrouble(trouble: Trouble): void {
    setText(this.troubleMessage, trouble.message);
    showText(this.troubleHint, trouble.hint);
    this.trouble.hidden = false;
  }

  private dismissTrouble(): void {
    this.trouble.hidden = true;
  }

  private refresh(): void {
    const lidar = this.lidar;
    const picked = lidar?.modes.find((mode) => mode.name === this.modes.value);
    showText(this.modeNote, picked ? modeWords(picked) : "");
    const offered = buttonsFor({
      state: lidar?.state ?? Lidar_State.UNKNOWN,
      connected: this.connected && lidar !== undefined,
      pending: lidar && this.pending.get(lidar.number),
      otherMode: picked !== undefined && picked.name !== lidar?.mode,
    });
    for (const action of ["start", "stop", "reset"] as const) {
      const { label, enabled, busy } = offered[action];
      const button = this.buttons[action];
      setText(button, label);
      // Not `disabled`: that would take the focus away from under the keyboard.
      button.setAttribute("aria-disabled", String(!enabled));
      button.setAttribute("aria-busy", String(busy));
    }
  }

  private async ask(action: Action): Promise<void> {
    const lidar = this.lidar;
    if (!lidar || this.buttons[action].getAttribute("aria-disabled") === "true") return;
    this.dismissTrouble();
    this.pending.set(lidar.number, action);
    this.refresh();
    const mode = action === "start" ? this.modes.value : "";
    const trouble = await command(this.base, lidar.id, action, mode);
    // If another command has replaced this one, its end is no news.
    if (this.pending.get(lidar.number) !== action) return;
    this.pending.delete(lidar.number);
    if (trouble && this.lidar?.number === lidar.number) this.showTrouble(trouble);
    this.refresh();
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
  const chosen = select.value;
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
  if (options.some(([value]) => value === chosen)) select.value = chosen;
}

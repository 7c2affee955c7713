// The speed of the rotation: what is measured, what is wanted, and the field to want another.
import { element, setText, showText } from "./dom";
import { Lidar_State, type Lidar, type Rotation } from "./lidars";
import { Mark } from "./marks";
import { parseSpeed, rangeWords, speedWords } from "./speed";

export class SpeedControl {
  private readonly section = element("rotation", HTMLElement);
  private readonly measured = element("speed-measured", HTMLElement);
  private readonly rpm = element("rpm", HTMLElement);
  private readonly aim = element("speed-aim", HTMLElement);
  private readonly aimMark = new Mark("rest");
  private readonly aimWords = document.createElement("span");
  private readonly warning = element("speed-warning", HTMLElement);
  private readonly withdraw = element("speed-withdraw", HTMLButtonElement);
  private readonly form = element("speed-form", HTMLFormElement);
  private readonly field = element("speed", HTMLInputElement);
  private readonly set = element("speed-set", HTMLButtonElement);
  private readonly usual = element("speed-usual", HTMLButtonElement);
  private readonly note = element("speed-note", HTMLElement);

  private rotation: Rotation | undefined;
  private number = 0;
  private problem = "";
  private busy = false;

  /// `onWish` is called with the turns a second that the user wishes for, 0 for the usual speed.
  constructor(private readonly onWish: (hz: number) => void) {
    this.aim.append(this.aimMark.element, this.aimWords);
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.submit();
    });
    this.field.addEventListener("input", () => this.showProblem(""));
    this.usual.addEventListener("click", () => this.wish(0));
    this.withdraw.addEventListener("click", () => this.wish(0));
  }

  /// `busy`: a wish is on its way to the gateway.
  show(lidar: Lidar | undefined, connected: boolean, busy: boolean): void {
    const rotation = lidar?.rotation;
    const scanning = connected && lidar?.state === Lidar_State.SCANNING;
    const words = speedWords(rotation, scanning);
    this.section.hidden = !words.known;
    setText(this.measured, words.measured);
    setText(this.rpm, words.rpm);
    this.aimMark.show(words.mark);
    setText(this.aimWords, words.aim);
    showText(this.warning, words.warning);
    this.withdraw.hidden = !words.withdrawable;
    this.form.hidden = !words.settable;
    // What the user typed stays until the lidar is told another speed.
    const other = this.number !== lidar?.number || this.rotation?.wantedHz !== rotation?.wantedHz;
    this.rotation = rotation;
    this.number = lidar?.number ?? 0;
    if (other) {
      this.field.value = rotation && rotation.wantedHz > 0 ? trimmed(rotation.wantedHz) : "";
      this.problem = "";
    }
    this.busy = busy || !connected;
    for (const button of [this.set, this.usual, this.withdraw]) {
      button.setAttribute("aria-disabled", String(this.busy));
    }
    this.showProblem(this.problem);
  }

  private submit(): void {
    const wish = parseSpeed(this.field.value, this.rotation);
    if ("problem" in wish) {
      this.showProblem(wish.problem);
      this.field.focus();
    } else {
      this.wish(wish.hz);
    }
  }

  private wish(hz: number): void {
    if (this.busy) return;
    this.showProblem("");
    this.onWish(hz);
    // "0" was a word for the usual speed; the field shows the speed itself.
    const shown = hz > 0 ? hz : (this.rotation?.usualHz ?? 0);
    this.field.value = shown > 0 ? trimmed(shown) : "";
  }

  private showProblem(problem: string): void {
    this.problem = problem;
    this.field.setAttribute("aria-invalid", String(problem !== ""));
    this.note.classList.toggle("wrong", problem !== "");
    setText(this.note, problem || rangeWords(this.rotation));
  }
}

function trimmed(hz: number): string {
  return String(Number(hz.toFixed(2)));
}

// The controls of one lidar: start, stop and reset, the scan mode and the speed.
import { command, update } from "./api";
import { Commands } from "./commands";
import { element, setText } from "./dom";
import { buttonsFor, type Action, type Doing } from "./lidar_state";
import { Lidar_State, type Lidar } from "./lidars";
import { ModePicker } from "./mode_picker";
import { SpeedControl } from "./speed_control";
import type { TroubleBox } from "./trouble";

const ACTIONS = ["start", "stop", "reset"] as const;

export class Controls {
  private readonly buttons: Record<Action, HTMLButtonElement> = {
    start: element("start", HTMLButtonElement),
    stop: element("stop", HTMLButtonElement),
    reset: element("reset", HTMLButtonElement),
  };
  private readonly modes = new ModePicker((mode) => this.setMode(mode));
  private readonly speed = new SpeedControl((hz) => this.setSpeed(hz));
  private readonly commands = new Commands<Doing>((lidar, trouble) => this.ended(lidar, trouble));
  /// The speed is taken in at once, whatever else is under way.
  private readonly wishes = new Commands<number>((lidar, trouble) => this.ended(lidar, trouble));

  private lidar: Lidar | undefined;
  private connected = false;

  /// `base` is the page's address.
  constructor(
    private readonly base: string,
    private readonly trouble: TroubleBox,
  ) {
    for (const action of ACTIONS) {
      this.buttons[action].addEventListener("click", () => this.act(action));
    }
  }

  show(lidar: Lidar | undefined, connected: boolean): void {
    this.lidar = lidar;
    this.connected = connected;
    this.refresh();
  }

  private refresh(): void {
    const lidar = this.lidar;
    const pending = this.commands.of(lidar);
    const offered = buttonsFor({
      state: lidar?.state ?? Lidar_State.UNKNOWN,
      connected: this.connected && lidar !== undefined,
      pending,
    });
    for (const action of ACTIONS) {
      const { label, enabled, busy } = offered[action];
      const button = this.buttons[action];
      setText(button, label);
      // Not `disabled`: that would take the focus away from under the keyboard.
      button.setAttribute("aria-disabled", String(!enabled));
      button.setAttribute("aria-busy", String(busy));
    }
    this.modes.show(lidar, this.connected, pending === "mode");
    this.speed.show(lidar, this.connected, this.wishes.of(lidar) !== undefined);
  }

  private act(action: Action): void {
    const lidar = this.lidar;
    if (!lidar || this.buttons[action].getAttribute("aria-disabled") === "true") return;
    this.trouble.dismiss();
    void this.commands.give(lidar, action, () => command(this.base, lidar.id, action));
  }

  private setMode(mode: string): void {
    const lidar = this.lidar;
    if (!lidar) return;
    this.trouble.dismiss();
    void this.commands.give(lidar, "mode", () => update(this.base, lidar.id, { mode }));
  }

  private setSpeed(hz: number): void {
    const lidar = this.lidar;
    if (!lidar) return;
    this.trouble.dismiss();
    void this.wishes.give(lidar, hz, () => update(this.base, lidar.id, { speed_hz: hz }));
  }

  private ended(lidar: Lidar, trouble: Parameters<TroubleBox["show"]>[0] | undefined): void {
    if (trouble && this.lidar?.number === lidar.number) this.trouble.show(trouble);
    this.refresh();
  }
}

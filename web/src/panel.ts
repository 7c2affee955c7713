// The panel's readouts: who the lidar is, how it is, and what the stream measures.
import { element, setText, showText } from "./dom";
import { stateWords } from "./lidar_state";
import { inTrouble, Lidar_State, type Lidar } from "./lidars";
import { baudWords } from "./line";
import { LinePanel } from "./line_panel";
import { Mark } from "./marks";
import type { Sweep } from "./sweep";
import { decimal, NONE, sinceWords, virtualWords, whole } from "./words";

export interface Measured {
  /// What the lidar sees now; undefined if that is not known.
  sweep: Sweep | undefined;
  sweepsPerS: number | undefined;
  missed: number;
}

const HICCUP_MS = 1500;

export class Panel {
  private readonly state = element("state", HTMLElement);
  private readonly mark = new Mark("rest");
  private readonly word = element("state-word", HTMLElement);
  private readonly since = element("state-since", HTMLElement);
  private readonly cause = element("cause", HTMLElement);
  private readonly hint = element("hint", HTMLElement);
  private readonly virtualNote = element("virtual-note", HTMLElement);
  private readonly virtualWords = element("virtual-words", HTMLElement);
  private readonly values = {
    samples: element("samples-per-second", HTMLElement),
    points: element("points-per-sweep", HTMLElement),
    rate: element("sweeps-per-second", HTMLElement),
    missed: element("missed", HTMLElement),
    model: element("model", HTMLElement),
    serial: element("serial", HTMLElement),
    firmware: element("firmware", HTMLElement),
    port: element("port", HTMLElement),
    baud: element("baud", HTMLElement),
  };
  private readonly line = new LinePanel();
  private troubleSeen: number | undefined;

  constructor() {
    this.state.prepend(this.mark.element);
  }

  /// Shows a lidar as the gateway told of it; undefined: there is none. Without a connection what it told
  /// of the state is no longer known to be so.
  showLidar(lidar: Lidar | undefined, connected: boolean): void {
    const known = connected ? lidar : undefined;
    const { word, tone } = known
      ? stateWords(known.state, inTrouble(known))
      : stateWords(Lidar_State.UNKNOWN);
    this.state.dataset["tone"] = tone;
    this.mark.show(tone);
    setText(this.word, known || !connected ? word : "No lidar");
    this.showCause(known, connected);
    this.virtualNote.hidden = !lidar?.isVirtual;
    setText(this.virtualWords, virtualWords(lidar));
    setText(this.values.model, lidar?.device?.model || NONE);
    setText(this.values.serial, lidar?.device?.serialNumber || NONE);
    setText(this.values.firmware, lidar?.device?.firmware || NONE);
    setText(this.values.port, lidar?.url || NONE);
    setText(this.values.baud, baudWords(lidar?.line));
    this.line.show(lidar?.line);
  }

  // A hiccup is over before it could be read, and what it pushes about would only distract.
  private showCause(known: Lidar | undefined, connected: boolean): void {
    const passing = known?.state === Lidar_State.STALLED || known?.state === Lidar_State.STARTING;
    if (!known || !inTrouble(known)) this.troubleSeen = undefined;
    else this.troubleSeen ??= performance.now();
    const fresh =
      this.troubleSeen !== undefined && performance.now() - this.troubleSeen < HICCUP_MS;
    const shown = passing && fresh ? undefined : known;
    showText(
      this.cause,
      known ? (shown?.cause ?? "") : connected ? "The gateway knows of no lidar." : "",
    );
    showText(this.hint, shown?.hint ?? "");
  }

  /// How long the state, or the trouble, has lasted, and when the next attempt is, by this device's clock, which
  /// may differ from the gateway's.
  showSince(lidar: Lidar | undefined, unixS: number): void {
    setText(this.since, sinceWords(lidar, unixS));
  }

  /// Shows the stream's figures; those of a sweep are dashes while none comes.
  showMeasured({ sweep, sweepsPerS, missed }: Measured): void {
    const perS = sweep && sweepsPerS !== undefined ? sweep.samples * sweepsPerS : undefined;
    // To three digits: the fourth would never stand still.
    setText(this.values.samples, perS === undefined ? NONE : whole(Number(perS.toPrecision(3))));
    const points = sweep && `${whole(sweep.x.length)} / ${whole(sweep.samples)}`;
    setText(this.values.points, points ?? NONE);
    setText(this.values.rate, decimal(sweepsPerS, 1));
    setText(this.values.missed, whole(missed));
  }
}

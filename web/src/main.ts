// The page put together: the stream comes in, the drawing and the panel show it, the controls answer.
import { probe } from "./api";
import { Banner } from "./banner";
import { Connection, type ConnectionState, type Socket } from "./connection";
import { Controls } from "./controls";
import { RateMeter, SequenceCounter } from "./counters";
import { exposeDebugState } from "./debug_state";
import { DiagnosisDialog } from "./diagnosis_dialog";
import { element, setText, showText } from "./dom";
import { listenToGestures, ZOOM_STEP } from "./gestures";
import { Legend } from "./legend";
import { LidarList } from "./lidar_list";
import { inTrouble, Lidar_State, Lidars, type Lidar } from "./lidars";
import { encodeSubscribe, openFrame, type Frame, type ServerMessage } from "./messages";
import { Panel } from "./panel";
import { Revolution, type Seen } from "./revolution";
import { Scene } from "./scene";
import { formatSettings, parseSettings } from "./settings";
import { sweepOf, type Sweep } from "./sweep";
import { TroubleBox } from "./trouble";
import { duration, echoWords, summary } from "./words";

/// A scan that is this much late is no longer what the lidar sees.
const STALE_AFTER_S = 2.5;

class Page {
  private readonly base = document.baseURI.split("#")[0]!;
  private readonly lidars = new Lidars();
  private readonly settings = parseSettings(location.hash);
  private readonly connection = new Connection(
    {
      open: () => openSocket(this.base),
      probe: () => probe(this.base),
      now: () => performance.now(),
      random: Math.random,
      after: (milliseconds, callback) => {
        const timer = setTimeout(callback, milliseconds);
        return () => clearTimeout(timer);
      },
    },
    {
      connectionChanged: (state) => this.connectionChanged(state),
      messageReceived: (message) => this.receive(message),
    },
  );
  private readonly scene = new Scene();
  private readonly panel = new Panel();
  private readonly banner = new Banner(() => this.connection.connect());
  private readonly list = new LidarList((id) => this.pick(id));
  private readonly trouble = new TroubleBox();
  private readonly controls = new Controls(this.base, this.trouble);
  private readonly diagnosis = new DiagnosisDialog(this.base);
  private readonly legend = new Legend((by) => {
    this.settings.colourBy = by;
    this.remember();
    this.recolour();
  });
  private readonly stage = element("stage", HTMLElement);
  private readonly stageNote = element("stage-note", HTMLElement);
  private readonly readout = element("readout", HTMLElement);
  private readonly summaryLine = element("summary", HTMLElement);
  private readonly gateway = element("gateway", HTMLElement);
  private readonly darkTheme = matchMedia("(prefers-color-scheme: dark)");

  private lidar: Lidar | undefined;
  private subscribed = "";
  private revolution = new Revolution();
  /// The latest that is complete.
  private sweep: Sweep | undefined;
  private sequence = 0n;
  private arrivedS = 0;
  /// The sweep came since the connection was opened and the lidar began to scan.
  private fresh = false;
  private colourRange = 0;
  private counter = new SequenceCounter();
  private meter = new RateMeter();

  run(): void {
    this.scene.onEcho = (echo) => showText(this.readout, echo ? echoWords(echo) : "");
    this.scene.onColourRange = (range) => {
      this.colourRange = range;
      this.recolour();
    };
    listenToGestures(element("overlay", HTMLElement), this.scene);
    const onClick = (id: string, act: () => void) =>
      element(id, HTMLButtonElement).addEventListener("click", act);
    onClick("zoom-in", () => this.scene.zoomMiddle(ZOOM_STEP));
    onClick("zoom-out", () => this.scene.zoomMiddle(1 / ZOOM_STEP));
    onClick("fit", () => this.scene.fit());
    this.darkTheme.addEventListener("change", () => this.recolour());
    addEventListener("hashchange", () => this.readAddress());
    // A device that wakes up, or finds its network again, need not sit out the countdown.
    addEventListener("online", () => this.connection.connect());
    document.addEventListener("visibilitychange", () => {
      if (!document.hidden) this.connection.connect();
    });
    exposeDebugState({
      scene: this.scene,
      connected: () => this.connection.state.kind === "open",
      lidar: () => this.lidar,
      sequence: () => this.sequence,
      missed: () => this.counter.missed,
      stale: () => !this.live(),
    });
    this.recolour();
    this.refresh();
    setInterval(() => this.tick(), 500);
    this.connection.connect();
  }

  private connectionChanged(state: ConnectionState): void {
    if (state.kind !== "open") {
      this.subscribed = "";
      this.revolution = new Revolution();
      this.fresh = false;
      this.counter.resume();
    }
    this.banner.show(state, performance.now());
    this.refresh();
  }

  private receive({ message }: ServerMessage): void {
    switch (message.case) {
      case "hello":
        setText(this.gateway, message.value.server);
        this.lidars.replace(message.value.lidars);
        this.choose();
        break;
      case "lidar":
        this.lidars.put(message.value);
        this.choose();
        break;
      case "frame":
        this.show(message.value);
        break;
      case "subscribed":
        // Frames from here on are of another subscription: the first of them opens no gap.
        this.counter.resume();
        break;
      case "error":
        this.trouble.show(message.value);
        break;
      default:
        // Stats: what was dropped for us is seen in the sequence numbers.
        break;
    }
  }

  private pick(id: string): void {
    this.trouble.dismiss();
    this.settings.lidar = id;
    this.choose();
  }

  private readAddress(): void {
    const wished = parseSettings(location.hash);
    this.settings.colourBy = wished.colourBy;
    this.settings.lidar = wished.lidar;
    this.recolour();
    this.choose();
  }

  private choose(): void {
    const before = this.lidar;
    this.lidar = this.lidars.choose(this.settings.lidar, before?.id ?? "");
    if (this.lidar?.number !== before?.number) this.clear();
    if (this.lidar?.state !== Lidar_State.SCANNING) this.fresh = false;
    // Keep the present id in the address, so that the link still works after a restart.
    if (this.lidar && this.lidars.find(this.settings.lidar)) this.settings.lidar = this.lidar.id;
    this.remember();
    this.subscribe();
    this.refresh();
  }

  private subscribe(): void {
    const id = this.lidar?.id ?? "";
    if (!id || id === this.subscribed) return;
    this.connection.send(encodeSubscribe(id));
    this.subscribed = id;
  }

  private clear(): void {
    this.revolution = new Revolution();
    this.sweep = undefined;
    this.fresh = false;
    this.counter = new SequenceCounter();
    this.meter = new RateMeter();
    this.scene.show(undefined);
  }

  private show(frame: Frame): void {
    // Frames of the lidar looked at before may still be under way.
    if (!this.lidar || this.lidars.find(frame.lidar)?.number !== this.lidar.number) return;
    let seen: Seen;
    try {
      seen = this.revolution.add(frame, sweepOf(openFrame(frame)));
    } catch (error) {
      // Not drawn, and its sweep is counted as missed by the next.
      console.warn(`a sector of sweep ${frame.sequence} is damaged:`, error);
      return;
    }
    if (seen.complete) this.take(seen.complete, frame.sequence);
    this.scene.show(seen.drawn, seen.complete);
  }

  private take(sweep: Sweep, sequence: bigint): void {
    const wasLive = this.live();
    const qualityMeasured = this.sweep?.qualityMeasured;
    this.sweep = sweep;
    this.arrivedS = seconds();
    this.fresh = true;
    this.sequence = sequence;
    this.counter.see(sequence);
    this.meter.see(sweep.startS);
    if (sweep.qualityMeasured !== qualityMeasured) this.recolour();
    if (!wasLive) this.refresh();
  }

  private live(): boolean {
    return (
      this.connection.state.kind === "open" &&
      this.fresh &&
      this.lidar?.state === Lidar_State.SCANNING &&
      seconds() - this.arrivedS < STALE_AFTER_S
    );
  }

  private refresh(): void {
    const connected = this.connection.state.kind === "open";
    this.panel.showLidar(this.lidar, connected);
    this.list.show(this.lidars.all(), this.lidar, connected);
    this.controls.show(this.lidar, connected);
    const trouble = this.lidar !== undefined && inTrouble(this.lidar);
    this.diagnosis.offer(this.lidar, connected, trouble);
    this.tick();
  }

  // What changes with time alone, or so often that the eye wants it slower.
  private tick(): void {
    const live = this.live();
    const rate = live ? this.meter.rate : undefined;
    this.banner.show(this.connection.state, performance.now());
    const connected = this.connection.state.kind === "open";
    this.panel.showSince(connected ? this.lidar : undefined, Date.now() / 1000);
    this.panel.showMeasured({
      sweep: live ? this.sweep : undefined,
      sweepsPerS: rate,
      missed: this.counter.missed,
    });
    this.stage.classList.toggle("stale", !live);
    showText(this.stageNote, this.noteOnStage(live));
    setText(this.summaryLine, summary(connected, this.lidar, this.sweep, live, rate));
    if (!live) this.scene.halt();
  }

  private noteOnStage(live: boolean): string {
    if (live) return "";
    if (this.sweep) return `Last sweep ${duration(seconds() - this.arrivedS)} ago`;
    const connected = this.connection.state.kind === "open";
    if (connected && this.lidar?.state === Lidar_State.SCANNING)
      return "Waiting for the first sweep";
    return connected ? "No sweep yet" : "";
  }

  private recolour(): void {
    this.scene.setColourBy(this.settings.colourBy);
    this.legend.show({
      by: this.settings.colourBy,
      theme: this.darkTheme.matches ? "dark" : "light",
      range: this.colourRange,
      qualityMeasured: this.sweep?.qualityMeasured ?? true,
    });
  }

  private remember(): void {
    const hash = formatSettings(this.settings);
    if (hash !== location.hash) {
      history.replaceState(null, "", hash || location.pathname + location.search);
    }
  }
}

function openSocket(base: string): Socket {
  const url = new URL("api/v1/stream", base);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  return new WebSocket(url);
}

function seconds(): number {
  return performance.now() / 1000;
}

new Page().run();

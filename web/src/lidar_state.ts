// A lidar's state in words and shape, and what may be done in it. Pure.
import { Lidar_State } from "./lidars";

export type Tone = "good" | "busy" | "rest" | "bad";

export interface StateWords {
  word: string;
  tone: Tone;
}

/// The state in words, and the tone that gives it its colour and shape. A lidar that is tried again and again
/// is in one state for who looks at it, not in three by turns.
export function stateWords(state: Lidar_State, failing = false): StateWords {
  const attempt = state === Lidar_State.OPENING || state === Lidar_State.IDENTIFYING;
  switch (failing && attempt ? Lidar_State.BACKING_OFF : state) {
    case Lidar_State.ABSENT:
      return { word: "Not there", tone: "bad" };
    case Lidar_State.OPENING:
      return { word: "Connecting", tone: "busy" };
    case Lidar_State.STALLED:
      return { word: "Stalled, starting again", tone: "bad" };
    case Lidar_State.RESETTING:
      return { word: "Resetting", tone: "busy" };
    case Lidar_State.BACKING_OFF:
      return { word: "Trying again", tone: "bad" };
    case Lidar_State.DISCONNECTED:
      return { word: "Not connected", tone: "bad" };
    case Lidar_State.IDENTIFYING:
      return { word: "Identifying", tone: "busy" };
    case Lidar_State.IDLE:
      return { word: "Ready, motor off", tone: "rest" };
    case Lidar_State.STARTING:
      return { word: "Starting", tone: "busy" };
    case Lidar_State.SCANNING:
      return { word: "Scanning", tone: "good" };
    case Lidar_State.STOPPING:
      return { word: "Stopping", tone: "busy" };
    case Lidar_State.PROTECTION_STOP:
      return { word: "Protection stop", tone: "bad" };
    case Lidar_State.FAILED:
      return { word: "Failed", tone: "bad" };
    default:
      return { word: "Unknown", tone: "rest" };
  }
}

export type Action = "start" | "stop" | "reset";

/// What can be under way: one of the buttons' actions, or a change of the mode.
export type Doing = Action | "mode";

export interface Button {
  label: string;
  enabled: boolean;
  /// Under way: the button shows that it works on it.
  busy: boolean;
}

export interface Situation {
  state: Lidar_State;
  /// The stream is open, so that the state is the present one.
  connected: boolean;
  /// Asked for and not yet answered.
  pending: Doing | undefined;
}

/// What the three buttons offer.
export function buttonsFor(situation: Situation): Record<Action, Button> {
  const { state, connected, pending } = situation;
  const free = connected && pending === undefined;
  const starting = pending === "start" || state === Lidar_State.STARTING;
  const stopping = pending === "stop" || state === Lidar_State.STOPPING;
  return {
    start: {
      label: starting ? "Starting…" : "Start",
      enabled: free && state === Lidar_State.IDLE,
      busy: connected && starting,
    },
    stop: {
      label: stopping ? "Stopping…" : "Stop",
      // A start or a change of mode that hangs can be called off.
      enabled:
        connected && (free || pending === "start" || pending === "mode") && STOPPABLE.has(state),
      busy: connected && stopping,
    },
    reset: {
      label: pending === "reset" || state === Lidar_State.RESETTING ? "Resetting…" : "Reset",
      enabled: free && RESETTABLE.has(state),
      busy: connected && (pending === "reset" || state === Lidar_State.RESETTING),
    },
  };
}

// One that is in trouble can be told to stay stopped once it is back.
const STOPPABLE: ReadonlySet<Lidar_State> = new Set([
  Lidar_State.SCANNING,
  Lidar_State.STARTING,
  Lidar_State.STALLED,
]);

const RESETTABLE: ReadonlySet<Lidar_State> = new Set([
  Lidar_State.IDLE,
  Lidar_State.SCANNING,
  Lidar_State.PROTECTION_STOP,
  Lidar_State.FAILED,
]);

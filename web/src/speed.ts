// The speed of the rotation: what the page says of it, and what the user may wish for. Pure.
import type { MarkKind } from "./marks";
import { Rotation_Control, type Rotation } from "./lidars";
import { NONE } from "./words";

export interface SpeedWords {
  /// "10.02 Hz", or a dash.
  measured: string;
  /// "601 rpm"; empty if it is not measured.
  rpm: string;
  /// How what is measured stands to what is wanted.
  aim: string;
  mark: MarkKind;
  /// Why what was asked for is not obeyed, in the gateway's words; empty if it is.
  warning: string;
  /// The lidar has said what its motor can do.
  known: boolean;
  /// The speed can be set.
  settable: boolean;
  /// There is a wish that the lidar cannot obey, and that can be withdrawn.
  withdrawable: boolean;
}

/// The speed in words; `scanning`: it turns, or should.
export function speedWords(rotation: Rotation | undefined, scanning: boolean): SpeedWords {
  const control = rotation?.control ?? Rotation_Control.UNKNOWN;
  const measured = scanning ? (rotation?.measuredHz ?? 0) : 0;
  const warning = rotation?.warning ?? "";
  const words = {
    measured: measured > 0 ? `${measured.toFixed(2)} Hz` : NONE,
    rpm: measured > 0 ? `${Math.round(measured * 60)} rpm` : "",
    warning,
    known: control !== Rotation_Control.UNKNOWN,
    settable: control === Rotation_Control.DUTY || control === Rotation_Control.RPM,
    withdrawable: control === Rotation_Control.FIXED && warning !== "",
  };
  return { ...words, ...aimWords(rotation, control, scanning, measured) };
}

function aimWords(
  rotation: Rotation | undefined,
  control: Rotation_Control,
  scanning: boolean,
  measured: number,
): { aim: string; mark: MarkKind } {
  if (!rotation || control === Rotation_Control.UNKNOWN)
    return { aim: "Not known yet", mark: "rest" };
  if (control === Rotation_Control.FIXED) {
    return { aim: "Fixed: this lidar sets it itself", mark: rotation.warning ? "warning" : "rest" };
  }
  const wanted = rotation.wantedHz > 0 ? `${rotation.wantedHz.toFixed(1)} Hz` : "its usual speed";
  if (rotation.warning) return { aim: `Not as wanted: ${wanted}`, mark: "warning" };
  if (!scanning) return { aim: `Wanted: ${wanted}`, mark: "rest" };
  if (rotation.settled) return { aim: `Settled at ${wanted}`, mark: "ok" };
  return {
    aim: measured > 0 ? `Settling at ${wanted}` : `Measuring, ${wanted} wanted`,
    mark: "busy",
  };
}

/// The speeds that the user may choose from: "5.0 to 15.0 Hz, usually 10.0", as far as the lidar says.
export function rangeWords(rotation: Rotation | undefined): string {
  if (!rotation) return "";
  const range = rangeOf(rotation);
  const usual = rotation.usualHz > 0 ? `usually ${rotation.usualHz.toFixed(1)}` : "";
  const reach = range && `${range.least.toFixed(1)} to ${range.most.toFixed(1)} Hz`;
  return [reach ?? "", usual].filter((part) => part !== "").join(", ");
}

export type SpeedWish = { hz: number } | { problem: string };

/// More than any lidar turns.
const MOST_HZ = 50;

/// Reads what the user typed as turns a second, 0 being the usual speed; or says what is wrong with it.
export function parseSpeed(text: string, rotation: Rotation | undefined): SpeedWish {
  const trimmed = text.trim();
  if (trimmed === "")
    return { problem: "Give turns a second, such as 7, or 0 for the usual speed." };
  if (!/^\d{1,6}([.,]\d{0,6})?$/.test(trimmed)) {
    return { problem: "This is not a number of turns a second, such as 7 or 7.5." };
  }
  const hz = Number(trimmed.replace(",", "."));
  if (hz === 0) return { hz };
  const range = rotation && rangeOf(rotation);
  if (range && (hz < range.least || hz > range.most)) {
    const reach = `${range.least.toFixed(1)} to ${range.most.toFixed(1)} Hz`;
    return { problem: `This lidar turns at ${reach}; 0 is its usual speed.` };
  }
  if (hz > MOST_HZ) return { problem: `No lidar turns faster than ${MOST_HZ} Hz.` };
  return { hz };
}

// Rounded inwards to what is shown, so that every speed shown as possible is.
function rangeOf(rotation: Rotation): { least: number; most: number } | undefined {
  if (!(rotation.maxHz > 0)) return undefined;
  const least = Math.ceil(rotation.minHz * 10 - 1e-6) / 10;
  const most = Math.floor(rotation.maxHz * 10 + 1e-6) / 10;
  return { least, most };
}

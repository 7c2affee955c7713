// Numbers and moments in words.
import { stateWords } from "./lidar_state";
import { inTrouble, type Lidar, type ScanMode } from "./lidars";
import { nearestObstacle, type Echo, type Sweep } from "./sweep";

/// Stands where there is no value.
export const NONE = "–";

/// "0.82 m": to the centimetre up close, to the decimetre far away.
export function metres(value: number): string {
  return `${value.toFixed(value < 20 ? 2 : 1)} m`;
}

/// A value with so many decimals, or a dash for one that is not known.
export function decimal(value: number | undefined, decimals: number): string {
  return value === undefined || !Number.isFinite(value) ? NONE : value.toFixed(decimals);
}

/// Thousands apart: "4,000".
export function whole(value: number): string {
  return Math.round(value).toLocaleString("en");
}

/// A length of time, roughly: "40 s", "5 min", "3 h", "2 d".
export function duration(seconds: number): string {
  if (seconds < 100) return `${Math.floor(seconds)} s`;
  if (seconds < 100 * 60) return `${Math.floor(seconds / 60)} min`;
  if (seconds < 48 * 3600) return `${Math.floor(seconds / 3600)} h`;
  return `${Math.floor(seconds / 86400)} d`;
}

/// How long a lidar has been in its state, or in trouble, and when it is tried again: "for 12 s, next try in 3 s".
export function sinceWords(lidar: Lidar | undefined, unixS: number): string {
  const since = lidar?.failingSince ?? lidar?.since;
  if (!since) return "";
  const lasted = `for ${duration(Math.max(0, unixS - Number(since.seconds)))}`;
  const next = lidar?.nextAttempt;
  const waitS = next && Number(next.seconds) + next.nanos / 1e9 - unixS;
  return waitS !== undefined && waitS >= 1
    ? `${lasted}, next try in ${Math.ceil(waitS)} s`
    : lasted;
}

/// An echo for the readout: angle to a hundredth of a degree, distance to the millimetre.
export function echoWords(echo: Echo): string {
  return `${echo.angleDeg.toFixed(2)}°  ${echo.distanceM.toFixed(3)} m  quality ${echo.quality}`;
}

/// A scan mode in the picker's list: "Express – 4 kHz, 12 m (typical)", as far as these are known.
export function modeOption(mode: ScanMode): string {
  const rate = mode.samplesPerSecond > 0 ? kilohertz(mode.samplesPerSecond) : "";
  const reach = mode.maxDistanceM > 0 ? `${decimal(mode.maxDistanceM, 0)} m` : "";
  const facts = [rate, reach].filter((part) => part !== "").join(", ");
  return `${mode.name}${facts && ` – ${facts}`}${mode.typical ? " (typical)" : ""}`;
}

/// A scan mode for the picker's explanation: "4,000 samples/s, up to 12 m".
export function modeWords(mode: ScanMode): string {
  const rate = mode.samplesPerSecond > 0 ? `${whole(mode.samplesPerSecond)} samples/s` : "";
  const reach = mode.maxDistanceM > 0 ? `up to ${decimal(mode.maxDistanceM, 0)} m` : "";
  return [rate, reach].filter((part) => part !== "").join(", ");
}

// Three digits are enough: "4 kHz", "15.9 kHz".
function kilohertz(perS: number): string {
  return `${Number((perS / 1000).toPrecision(3))} kHz`;
}

/// The sweep in a sentence, for who cannot see the drawing. `live`: it is what the lidar sees now.
export function summary(
  connected: boolean,
  lidar: Lidar | undefined,
  sweep: Sweep | undefined,
  live: boolean,
  sweepsPerS: number | undefined,
): string {
  if (connected && !lidar) return "No lidar to show.";
  const state =
    connected && lidar ? `${stateWords(lidar.state, inTrouble(lidar)).word}.` : "Not connected.";
  if (!sweep) return `${state} No sweep yet.`;
  const nearest = nearestObstacle(sweep);
  const obstacle = nearest
    ? `nearest obstacle ${metres(nearest.distanceM)} at ${nearest.angleDeg.toFixed(0)}°.`
    : "no obstacle in sight.";
  if (!live) return `${state} In the last sweep: ${obstacle}`;
  const rate = sweepsPerS === undefined ? "" : ` ${sweepsPerS.toFixed(1)} sweeps/s.`;
  return `${obstacle[0]!.toUpperCase()}${obstacle.slice(1)}${rate}`;
}

/// What to know of a virtual lidar; empty for a real one.
export function virtualWords(lidar: Lidar | undefined): string {
  if (!lidar?.isVirtual) return "";
  return lidar.isStandIn
    ? "no scanner was found, this is a simulated room."
    : "this is a simulated room.";
}

// The lidars of the gateway as the stream tells of them, and which of them is being looked at.
import { Lidar_State, type Lidar } from "../gen/sweepcast/v1/lidar_pb";

export {
  Lidar_State,
  Rotation_Control,
  type Lidar,
  type Line,
  type Rotation,
  type ScanMode,
} from "../gen/sweepcast/v1/lidar_pb";

/// A lidar keeps its number while its id changes once, when it is identified; it goes on answering to
/// both ids, here too.
export class Lidars {
  private byNumber = new Map<number, Lidar>();
  private numberOf = new Map<string, number>();
  private troubled = new Set<number>();

  /// All there are, as told when the stream begins.
  replace(lidars: readonly Lidar[]): void {
    this.byNumber.clear();
    this.numberOf.clear();
    this.troubled.clear();
    lidars.forEach((lidar) => this.put(lidar));
  }

  /// One that is new or has changed.
  put(lidar: Lidar): void {
    this.byNumber.set(lidar.number, steady(this.byNumber.get(lidar.number), lidar));
    this.numberOf.set(lidar.id, lidar.number);
    if (TROUBLE.has(lidar.state)) this.troubled.add(lidar.number);
    if (WELL.has(lidar.state)) this.troubled.delete(lidar.number);
  }

  /// Whether it is in trouble: from its failure until it is well again, through all the attempts between.
  inTrouble(lidar: Lidar): boolean {
    return this.troubled.has(lidar.number);
  }

  /// In the gateway's order.
  all(): Lidar[] {
    return [...this.byNumber.values()].sort((a, b) => a.number - b.number);
  }

  /// By its id, present or former.
  find(id: string): Lidar | undefined {
    const number = this.numberOf.get(id);
    return number === undefined ? undefined : this.byNumber.get(number);
  }

  /// The one to look at: the one wished for; else the one looked at so far; else the first that scans;
  /// else the first.
  choose(wished: string, current: string): Lidar | undefined {
    const all = this.all();
    return (
      this.find(wished) ??
      this.find(current) ??
      all.find((lidar) => lidar.state === Lidar_State.SCANNING) ??
      all[0]
    );
  }
}

const TROUBLE: ReadonlySet<Lidar_State> = new Set([
  Lidar_State.DISCONNECTED,
  Lidar_State.PROTECTION_STOP,
  Lidar_State.FAILED,
]);
const WELL: ReadonlySet<Lidar_State> = new Set([Lidar_State.IDLE, Lidar_State.SCANNING]);

// The gateway tries a failed lidar again every other second, and tells of each attempt. Meanwhile it stays
// failed, with its cause and since the first time, so that the page does not flicker between the two.
function steady(before: Lidar | undefined, lidar: Lidar): Lidar {
  if (before?.state !== Lidar_State.FAILED) return lidar;
  const since = before.since && { since: before.since };
  if (lidar.state === Lidar_State.FAILED) return { ...lidar, ...since };
  const again = lidar.state === Lidar_State.IDENTIFYING && lidar.cause === "";
  const { state, cause, hint } = before;
  return again ? { ...lidar, ...since, state, cause, hint } : lidar;
}

/// What a lidar is and which one of them: its model and its id; or where it is attached, and that is all,
/// while it is not identified.
export function lidarTitle(lidar: Lidar): { title: string; place: string } {
  if (!lidar.device?.model) return { title: lidar.url || lidar.id, place: "" };
  return { title: lidar.device.model, place: lidar.isVirtual ? `${lidar.id}, virtual` : lidar.id };
}

/// What to call a lidar in a sentence: its model and id, or where it is attached while it is not identified.
export function lidarName(lidar: Lidar): string {
  if (!lidar.device?.model) return lidar.url || lidar.id;
  const name = `${lidar.device.model} · ${lidar.id}`;
  return lidar.isVirtual ? `${name} (virtual)` : name;
}

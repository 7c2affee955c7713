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

/// More lidars than any gateway has.
const MOST_LIDARS = 256;

/// A lidar keeps its number while its id changes once, when it is identified; it goes on answering to
/// both ids, here too.
export class Lidars {
  private byNumber = new Map<number, Lidar>();
  private numberOf = new Map<string, number>();

  /// All there are, as told when the stream begins.
  replace(lidars: readonly Lidar[]): void {
    this.byNumber.clear();
    this.numberOf.clear();
    lidars.forEach((lidar) => this.put(lidar));
  }

  /// Adds a lidar or replaces its earlier state. Ignores a new lidar if there are MOST_LIDARS
  /// already. find() knows a lidar's current id and the id before that, but no older ones.
  put(lidar: Lidar): void {
    if (!this.byNumber.has(lidar.number) && this.byNumber.size >= MOST_LIDARS) return;
    const before = this.byNumber.get(lidar.number)?.id;
    if (before !== undefined && before !== lidar.id) {
      for (const [id, number] of this.numberOf) {
        if (number === lidar.number && id !== before) this.numberOf.delete(id);
      }
    }
    this.byNumber.set(lidar.number, lidar);
    this.numberOf.set(lidar.id, lidar.number);
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

/// Whether it is in trouble: from its failure until it is well again, through all the attempts between.
export function inTrouble(lidar: Lidar): boolean {
  return lidar.failingSince !== undefined || lidar.state === Lidar_State.DISCONNECTED;
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

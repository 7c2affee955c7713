// Commands under way, at most one a lidar, and what becomes of them.
import type { Trouble } from "./api";
import type { Lidar } from "./lidars";

export class Commands<Kind> {
  private readonly pending = new Map<number, { kind: Kind }>();

  /// `onChange` is called when a command begins or ends; with the lidar and the trouble if it ends in one.
  constructor(private readonly onChange: (lidar: Lidar, trouble: Trouble | undefined) => void) {}

  /// What is asked of the lidar and not yet answered.
  of(lidar: Lidar | undefined): Kind | undefined {
    return lidar && this.pending.get(lidar.number)?.kind;
  }

  /// Runs a command. A later one replaces it: then its end is no news.
  async give(lidar: Lidar, kind: Kind, run: () => Promise<Trouble | undefined>): Promise<void> {
    const command = { kind };
    this.pending.set(lidar.number, command);
    this.onChange(lidar, undefined);
    const trouble = await run();
    if (this.pending.get(lidar.number) !== command) return;
    this.pending.delete(lidar.number);
    this.onChange(lidar, trouble);
  }
}

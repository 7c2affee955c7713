// Sectors put together: the newest echoes all around, to be drawn at once, and whole sweeps.
import { after, joined, turned, type Sweep } from "./sweep";

/// Which part of which sweep a sector is (stream.proto, Frame).
export interface Place {
  sequence: bigint;
  sector: number;
  last: boolean;
}

export interface Seen {
  /// The newest echoes: of the sweep under way, and where the lidar has not looked yet of the one before.
  drawn: Sweep;
  /// The sweep that this sector completes, if none of it was missed.
  complete?: Sweep | undefined;
}

interface Part {
  sweep: Sweep;
  /// Turned since the sweep began, in turns, before this sector and after it.
  from: number;
  to: number;
}

export class Revolution {
  private sequence: bigint | undefined;
  private parts: Part[] = [];
  private before: Part[] = [];
  private missing = false;
  private periodS = 0;

  /// Takes the next sector.
  add(place: Place, sweep: Sweep): Seen {
    if (place.sequence !== this.sequence || place.sector === 0) this.begin(place.sequence);
    if (place.sector !== this.parts.length) this.missing = true;
    const from =
      this.parts.length === 0 ? 0 : turned(this.parts[0]!.sweep.startTurn, sweep.startTurn);
    const to = from + turned(sweep.startTurn, sweep.endTurn);
    this.parts.push({ sweep, from, to });
    const ahead = this.before
      .filter((part) => part.to > to)
      .map((part) => ({ sweep: part.from > to ? part.sweep : after(part.sweep, to - part.from) }));
    const periodS = place.last && sweep.periodS > 0 ? sweep.periodS : this.periodS;
    this.periodS = periodS;
    const drawn = joined([...ahead, ...this.parts].map((part) => part.sweep));
    if (!place.last) return { drawn: { ...drawn, periodS } };
    const complete = this.missing ? undefined : joined(this.parts.map((part) => part.sweep));
    return { drawn: { ...drawn, periodS }, complete: complete && { ...complete, periodS } };
  }

  private begin(sequence: bigint): void {
    // What was begun and given up is void, so the echoes before it stay the newest.
    if (sequence !== this.sequence) this.before = this.parts;
    this.sequence = sequence;
    this.parts = [];
    this.missing = false;
  }
}

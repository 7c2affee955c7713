// What the page measures of the stream: sweeps per second and frames missed.

/// Counts the gaps in a lidar's sequence numbers.
export class SequenceCounter {
  missed = 0;
  private last: bigint | undefined;

  /// Takes note of a frame. A number that does not grow is a new count (the gateway was restarted).
  see(sequence: bigint): void {
    if (this.last !== undefined && sequence > this.last) {
      this.missed += Number(sequence - this.last - 1n);
    }
    this.last = sequence;
  }

  /// After this the next frame opens no gap: what went by meanwhile was not for us.
  resume(): void {
    this.last = undefined;
  }
}

const WINDOW_S = 3;
/// Less than this says nothing.
const LEAST_S = 1;

/// How many sweeps come a second, by the lidar's own times: how unevenly they arrive is no matter.
export class RateMeter {
  private times: number[] = [];

  /// Takes note of a sweep that began at `start` (seconds). A time that does not grow begins a new count.
  see(start: number): void {
    const last = this.times[this.times.length - 1];
    if (last !== undefined && start <= last) this.times = [];
    this.times.push(start);
    this.times = this.times.filter((time) => start - time <= WINDOW_S);
  }

  /// Sweeps a second; undefined while it is too new to say.
  get rate(): number | undefined {
    const first = this.times[0] ?? 0;
    const span = (this.times[this.times.length - 1] ?? 0) - first;
    return span < LEAST_S ? undefined : (this.times.length - 1) / span;
  }
}

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
/// Frames arrive in bursts, so less than this says nothing.
const LEAST_S = 1;

/// Frequency of something that happens again and again, over the last seconds.
export class RateMeter {
  private times: number[] = [];

  /// Takes note that it happened at `now` (seconds).
  tick(now: number): void {
    this.times.push(now);
    this.times = this.times.filter((time) => now - time <= WINDOW_S);
  }

  /// Times a second; undefined if it is not happening (any more), or too new to say.
  rate(now: number): number | undefined {
    const first = this.times[0];
    const last = this.times[this.times.length - 1];
    if (first === undefined || last === undefined) return undefined;
    if (last - first < LEAST_S || now - last > WINDOW_S) return undefined;
    return (this.times.length - 1) / (last - first);
  }
}

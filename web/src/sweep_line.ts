// The sweep line: where the lidar is looking now, carried on between frames at the measured speed.

/// A line at `turn` (in turns, not wrapped) at time `at`, turning `turnsPerS`. Times are in seconds.
export interface SweepLine {
  turn: number;
  at: number;
  turnsPerS: number;
}

// Without news the line turns on for so long, then is gone.
const TURNS_WITHOUT_NEWS = 2.5;

/// The line after a sweep that ended at `endTurn` arrived at `now` with revolutions of `periodS` seconds.
/// Frames arrive unevenly, so the line is not put right at once but made to arrive right one turn later;
/// only a line that is far off jumps. Undefined if the speed is not known.
export function follow(
  line: SweepLine | undefined,
  endTurn: number,
  periodS: number,
  now: number,
): SweepLine | undefined {
  if (!(periodS > 0)) return undefined;
  const turnsPerS = 1 / periodS;
  const seen = line && turnAt(line, now);
  if (seen === undefined) return { turn: endTurn, at: now, turnsPerS };
  // How far the line is behind, the short way around: [-0.5, 0.5).
  const behind = ((((endTurn - seen + 0.5) % 1) + 1) % 1) - 0.5;
  if (Math.abs(behind) > 0.25) return { turn: endTurn, at: now, turnsPerS };
  return { turn: seen, at: now, turnsPerS: turnsPerS * (1 + behind) };
}

/// Where the line is at `now`, in turns, [0, 1); undefined if the last news of it is too old.
export function turnAt(line: SweepLine, now: number): number | undefined {
  const turned = Math.max(0, now - line.at) * line.turnsPerS;
  if (turned > TURNS_WITHOUT_NEWS) return undefined;
  return (line.turn + turned) % 1;
}

// How long to wait before the next attempt to connect.

const FIRST_MS = 500;
const LONGEST_MS = 10_000;

/// Milliseconds to wait before attempt `attempt` (0 for the first after a loss): doubling from half a
/// second up to ten seconds, spread by a quarter either way so that pages do not return in step.
/// `random` is in [0, 1).
export function retryDelay(attempt: number, random: number): number {
  const delay = Math.min(FIRST_MS * 2 ** Math.min(attempt, 10), LONGEST_MS);
  return Math.round(delay * (0.75 + 0.5 * random));
}

// The HTTP API: commands to a lidar, its diagnosis, and the errors they come back with.
import { fromJson } from "@bufbuild/protobuf";
import { ErrorResponseSchema } from "../gen/sweepcast/v1/api_pb";
import { DiagnosisSchema, type Diagnosis } from "./diagnosis";
import type { Action } from "./lidar_state";

/// Something that went wrong, in words for the user.
export interface Trouble {
  message: string;
  hint: string;
}

export type Answer<Value> = { value: Value } | { trouble: Trouble };

/// What to change of a lidar; what is not given stays as it is.
export interface Update {
  mode?: string;
  /// Turns a second; 0: the usual speed.
  speed_hz?: number;
}

/// A motor takes seconds to reach its speed, and the gateway answers only then.
const COMMAND_DEADLINE_MS = 30_000;
/// Every line speed is tried, and a motor that should turn is waited for.
const DIAGNOSIS_DEADLINE_MS = 180_000;
const PROBE_DEADLINE_MS = 5_000;

/// Asks the gateway to start, stop or reset a lidar. Gives the trouble, or undefined if it was done.
export async function command(
  base: string,
  lidar: string,
  action: Action,
): Promise<Trouble | undefined> {
  const path = `${lidarPath(lidar)}/${action}`;
  return troubleIn(await ask(base, path, { method: "POST" }, COMMAND_DEADLINE_MS));
}

/// Asks the gateway to change a lidar's mode or speed. Gives the trouble, or undefined if it was done.
export async function update(
  base: string,
  lidar: string,
  changes: Update,
): Promise<Trouble | undefined> {
  const init = {
    method: "PATCH",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(changes),
  };
  return troubleIn(await ask(base, lidarPath(lidar), init, COMMAND_DEADLINE_MS));
}

/// Has the gateway examine a lidar and its port, which takes from nothing to tens of seconds.
export async function diagnose(
  base: string,
  lidar: string,
  cancel: AbortSignal,
): Promise<Answer<Diagnosis>> {
  const path = `${lidarPath(lidar)}/diagnosis`;
  const init = { cache: "no-store" } as const;
  const answer = await ask(base, path, init, DIAGNOSIS_DEADLINE_MS, cancel);
  return "trouble" in answer ? answer : diagnosisOf(answer.value);
}

/// Reads the gateway's answer to a request for a diagnosis.
export function diagnosisOf(body: string): Answer<Diagnosis> {
  try {
    return { value: fromJson(DiagnosisSchema, JSON.parse(body), { ignoreUnknownFields: true }) };
  } catch {
    return {
      trouble: {
        message: "The gateway sent a diagnosis that this page does not understand.",
        hint: "Reload the page.",
      },
    };
  }
}

/// Whether the gateway answers at all.
export async function probe(base: string): Promise<boolean> {
  try {
    const response = await fetch(new URL("healthz", base), {
      cache: "no-store",
      signal: AbortSignal.timeout(PROBE_DEADLINE_MS),
    });
    return response.ok;
  } catch {
    return false;
  }
}

/// What an error response says; what its status says if it is not one of the gateway's own.
export function troubleOf(status: number, body: string): Trouble {
  try {
    const { error } = fromJson(ErrorResponseSchema, JSON.parse(body), {
      ignoreUnknownFields: true,
    });
    // Not a lidar that is missing but the request itself: the page is newer than the gateway.
    if (error?.code === "not_found" || error?.code === "method_not_allowed") return TOO_OLD;
    if (error?.message) return { message: error.message, hint: error.hint };
  } catch {
    // Not JSON, or not of that shape: something between the page and the gateway answered.
  }
  if (status === 501) return TOO_OLD;
  return {
    message: `The gateway refused (HTTP status ${status}).`,
    hint: "Its log says why.",
  };
}

const TOO_OLD: Trouble = {
  message: "This gateway cannot do that.",
  hint: "It is older than this page: update it, restart it and reload the page.",
};

function lidarPath(lidar: string): string {
  return `api/v1/lidars/${encodeURIComponent(lidar)}`;
}

async function ask(
  base: string,
  path: string,
  init: RequestInit,
  deadlineMs: number,
  cancel?: AbortSignal,
): Promise<Answer<string>> {
  const stop = new AbortController();
  let late = false;
  const timer = setTimeout(() => {
    late = true;
    stop.abort();
  }, deadlineMs);
  cancel?.addEventListener("abort", () => stop.abort(), { once: true });
  try {
    const response = await fetch(new URL(path, base), { ...init, signal: stop.signal });
    const body = await response.text();
    return response.ok ? { value: body } : { trouble: troubleOf(response.status, body) };
  } catch {
    return { trouble: late ? noAnswerAfter(deadlineMs) : UNREACHABLE };
  } finally {
    clearTimeout(timer);
  }
}

function troubleIn(answer: Answer<string>): Trouble | undefined {
  return "trouble" in answer ? answer.trouble : undefined;
}

function noAnswerAfter(deadlineMs: number): Trouble {
  return {
    message: `No answer after ${deadlineMs / 1000} seconds.`,
    hint: "Look at the state of the lidar, then try again.",
  };
}

const UNREACHABLE: Trouble = {
  message: "The gateway cannot be reached.",
  hint: "Check that it runs and that this device is on its network, then try again.",
};

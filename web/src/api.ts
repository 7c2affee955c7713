// The HTTP API: commands to a lidar, and the errors they come back with.
import { fromJson } from "@bufbuild/protobuf";
import { ErrorResponseSchema } from "../gen/sweepcast/v1/api_pb";
import type { Action } from "./lidar_state";

/// Something that went wrong, in words for the user.
export interface Trouble {
  message: string;
  hint: string;
}

/// A motor takes seconds to reach its speed, and the gateway answers only then.
const COMMAND_DEADLINE_MS = 30_000;
const PROBE_DEADLINE_MS = 5_000;

/// Asks the gateway to start, stop or reset a lidar; `mode` names the scan mode to start in (empty: the
/// gateway's choice). Gives the trouble, or undefined if it was done.
export async function command(
  base: string,
  lidar: string,
  action: Action,
  mode: string,
): Promise<Trouble | undefined> {
  const url = new URL(`api/v1/lidars/${encodeURIComponent(lidar)}/${action}`, base);
  const init: RequestInit = { method: "POST", signal: AbortSignal.timeout(COMMAND_DEADLINE_MS) };
  if (action === "start" && mode !== "") {
    init.headers = { "Content-Type": "application/json" };
    init.body = JSON.stringify({ mode });
  }
  try {
    const response = await fetch(url, init);
    if (response.ok) return undefined;
    return troubleOf(response.status, await response.text());
  } catch (error) {
    return unanswered(error);
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
    if (error?.message) return { message: error.message, hint: error.hint };
  } catch {
    // Not JSON, or not of that shape: something between the page and the gateway answered.
  }
  return {
    message: `The gateway refused (HTTP status ${status}).`,
    hint: "Its log says why.",
  };
}

function unanswered(error: unknown): Trouble {
  if (error instanceof DOMException && error.name === "TimeoutError") {
    return {
      message: `No answer after ${COMMAND_DEADLINE_MS / 1000} seconds.`,
      hint: "Look at the state of the lidar, then try again.",
    };
  }
  return {
    message: "The gateway cannot be reached.",
    hint: "Check that it runs and that this device is on its network, then try again.",
  };
}

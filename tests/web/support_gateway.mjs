// Starts the real program for the page's tests, on a port of the system's choice, and ends it.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { createInterface } from "node:readline";

const START_DEADLINE_MS = 60_000;
const END_DEADLINE_MS = 20_000;

/// A running gateway with these lidars. `address` may name a port to take again after a restart.
export class Gateway {
  static async start(binary, { address = "127.0.0.1:0", lidars = ["virtual:a1m8"] } = {}) {
    const args = ["serve", "--http", address, "--tcp", "127.0.0.1:0"];
    for (const lidar of lidars) args.push("--lidar", lidar);
    const child = spawn(binary, args, { stdio: ["ignore", "pipe", "inherit"] });
    const gateway = new Gateway(child);
    try {
      gateway.url = await gateway.pageAddress();
    } catch (error) {
      await gateway.crash();
      throw error;
    }
    return gateway;
  }

  constructor(child) {
    this.child = child;
    this.exited = new Promise((resolve) => child.once("close", (status, signal) => resolve(status ?? signal)));
  }

  /// "127.0.0.1:PORT"
  get address() {
    return new URL(this.url).host;
  }

  /// Ends it by SIGTERM. Throws if it ends with an error, which includes what a sanitizer reports at the end.
  async end() {
    this.child.kill("SIGTERM");
    const late = setTimeout(() => this.child.kill("SIGKILL"), END_DEADLINE_MS);
    const status = await this.exited;
    clearTimeout(late);
    if (status !== 0 && !this.crashed) throw new Error(`the gateway ended with ${status}`);
  }

  /// Ends it at once, as a crash or a power cut would.
  async crash() {
    this.crashed = true;
    this.child.kill("SIGKILL");
    await this.exited;
  }

  async pageAddress() {
    const lines = createInterface({ input: this.child.stdout });
    const found = new Promise((resolve, reject) => {
      lines.on("line", (line) => {
        const match = line.match(/page:\s+(http:\/\/\S+)/);
        if (match) resolve(match[1]);
      });
      lines.once("close", () => reject(new Error("the gateway ended before it served a page")));
      this.child.once("error", reject);
    });
    const late = once(AbortSignal.timeout(START_DEADLINE_MS), "abort").then(() => {
      throw new Error("the gateway did not tell its page's address in time");
    });
    return Promise.race([found, late]);
  }
}

// The connection to the gateway's stream: opens it, notices when it is lost, and opens it again.
import { retryDelay } from "./backoff";
import { decodeServerMessage, PROTOCOL_VERSION, type ServerMessage } from "./messages";

export type ConnectionState =
  | { kind: "connecting" }
  | { kind: "open" }
  /// `retryAt` is on the clock given, in milliseconds.
  | { kind: "lost"; reason: string; retryAt: number };

/// The part of a WebSocket that is used here.
export type Socket = Pick<WebSocket, "binaryType" | "onmessage" | "onclose" | "send" | "close">;

/// What the connection needs from outside, so that tests need neither network nor time.
export interface Surroundings {
  open(): Socket;
  /// Asks over HTTP whether the gateway is there. Settles within a few seconds.
  probe(): Promise<boolean>;
  now(): number;
  random(): number;
  /// Calls back after so many milliseconds, unless the function returned is called first.
  after(milliseconds: number, callback: () => void): () => void;
}

export interface Listener {
  connectionChanged(state: ConnectionState): void;
  /// Not called with closing messages: they become the reason of the loss. May throw: then the message
  /// is refused and the connection goes on.
  messageReceived(message: ServerMessage): void;
}

/// From opening to the gateway's greeting.
const GREETING_DEADLINE_MS = 8_000;
/// A silent stream is normal while nothing scans, but a dead connection is silent too: after this long the
/// gateway is asked over HTTP.
const SILENCE_MS = 15_000;

/// A connection that ends sooner was none to speak of: the waits go on growing, so that a gateway that
/// turns us away is not asked twice a second for ever.
const STABLE_MS = 5_000;

export class Connection {
  private state_: ConnectionState = { kind: "connecting" };
  private socket: Socket | undefined;
  private attempt = 0;
  private openedAt: number | undefined;
  private closingReason = "";
  private cancelTimer = () => {};

  constructor(
    private readonly surroundings: Surroundings,
    private readonly listener: Listener,
  ) {}

  get state(): ConnectionState {
    return this.state_;
  }

  /// Connects now: at first, or instead of waiting for the next attempt.
  connect(): void {
    if (this.socket) return;
    this.cancelTimer();
    this.closingReason = "";
    this.change({ kind: "connecting" });
    const socket = this.surroundings.open();
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => this.lose(this.closingReason || event.reason);
    this.arm(GREETING_DEADLINE_MS, () => this.lose("The gateway does not answer."));
  }

  /// Sends a message; without a connection it is dropped.
  send(bytes: Uint8Array): void {
    if (this.state_.kind === "open") this.socket?.send(bytes);
  }

  private receive(data: unknown): void {
    if (!(data instanceof ArrayBuffer)) return;
    let message: ServerMessage;
    try {
      message = decodeServerMessage(new Uint8Array(data));
    } catch {
      this.lose("The gateway sent something that this page does not understand.");
      return;
    }
    if (message.message.case === "closing") {
      this.closingReason = message.message.value.reason;
      return;
    }
    if (message.message.case === "hello") {
      const version = message.message.value.protocolVersion;
      if (version !== PROTOCOL_VERSION) {
        this.lose(`The gateway speaks version ${version} of the stream: reload this page.`);
        return;
      }
      this.openedAt = this.surroundings.now();
      this.change({ kind: "open" });
    }
    this.arm(SILENCE_MS, () => this.probe());
    this.listener.messageReceived(message);
  }

  private async probe(): Promise<void> {
    const socket = this.socket;
    const alive = await this.surroundings.probe();
    if (socket !== this.socket) return;
    if (alive) this.arm(SILENCE_MS, () => this.probe());
    else this.lose("The gateway does not answer.");
  }

  private lose(reason: string): void {
    const socket = this.socket;
    if (!socket) return;
    this.socket = undefined;
    socket.onmessage = null;
    socket.onclose = null;
    socket.close();
    const now = this.surroundings.now();
    if (this.openedAt !== undefined && now - this.openedAt >= STABLE_MS) this.attempt = 0;
    this.openedAt = undefined;
    const delay = retryDelay(this.attempt++, this.surroundings.random());
    this.arm(delay, () => this.connect());
    this.change({ kind: "lost", reason, retryAt: now + delay });
  }

  // There is one timer: whatever is waited for now.
  private arm(milliseconds: number, callback: () => void): void {
    this.cancelTimer();
    this.cancelTimer = this.surroundings.after(milliseconds, callback);
  }

  private change(state: ConnectionState): void {
    this.state_ = state;
    this.listener.connectionChanged(state);
  }
}

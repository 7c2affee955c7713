// A network and a clock that tests turn by hand, for the connection.
import { create, toBinary, type MessageInitShape } from "@bufbuild/protobuf";
import { ServerMessageSchema } from "../../web/gen/sweepcast/v1/stream_pb";
import type { Socket, Surroundings } from "../../web/src/connection";

export class FakeSocket implements Socket {
  binaryType: BinaryType = "blob";
  onmessage: Socket["onmessage"] = null;
  onclose: Socket["onclose"] = null;
  readonly sent: unknown[] = [];
  closed = false;

  send(bytes: unknown): void {
    this.sent.push(bytes);
  }

  close(): void {
    this.closed = true;
  }

  /// The gateway says something.
  hear(message: MessageInitShape<typeof ServerMessageSchema>["message"] & {}): void {
    const bytes = toBinary(ServerMessageSchema, create(ServerMessageSchema, { message }));
    this.hearRaw(bytes.slice().buffer);
  }

  hearRaw(data: unknown): void {
    this.onmessage?.call(this as never, { data } as MessageEvent);
  }

  hello(protocolVersion = 1): void {
    this.hear({
      case: "hello",
      value: { protocolVersion, server: "sweepcast" },
    });
  }

  /// The connection ends.
  drop(reason = ""): void {
    this.onclose?.call(this as never, { reason } as CloseEvent);
  }
}

export class FakeSurroundings implements Surroundings {
  readonly sockets: FakeSocket[] = [];
  alive = true;
  probes = 0;
  private time = 0;
  private timers: { at: number; callback: () => void }[] = [];

  get socket(): FakeSocket {
    return this.sockets[this.sockets.length - 1]!;
  }

  open(): FakeSocket {
    this.sockets.push(new FakeSocket());
    return this.socket;
  }

  probe(): Promise<boolean> {
    ++this.probes;
    return Promise.resolve(this.alive);
  }

  now(): number {
    return this.time;
  }

  random(): number {
    return 0.5;
  }

  after(milliseconds: number, callback: () => void): () => void {
    const timer = { at: this.time + milliseconds, callback };
    this.timers.push(timer);
    return () => (this.timers = this.timers.filter((each) => each !== timer));
  }

  /// Lets time pass: what falls due is called, in order, and promises settle.
  async pass(milliseconds: number): Promise<void> {
    const end = this.time + milliseconds;
    for (;;) {
      const [next] = this.timers.filter((timer) => timer.at <= end).sort((a, b) => a.at - b.at);
      if (!next) break;
      this.timers = this.timers.filter((timer) => timer !== next);
      this.time = next.at;
      next.callback();
      await new Promise((resolve) => setImmediate(resolve));
    }
    this.time = end;
  }
}

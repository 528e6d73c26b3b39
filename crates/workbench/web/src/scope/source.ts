/** The socket of the worker: the samples of one drive, and nothing else. */
import type { Header } from "./block";
import type { Wanted } from "./protocol";

const PROTOCOL = "profidrive.live.1";
/** The first pause before another try, and the longest, in ms. */
const FIRST = 250;
const LONGEST = 5000;

interface Handlers {
  header(header: Header): void;
  block(octets: ArrayBuffer): void;
  /** No values come, for this reason. */
  nothing(reason: string | null): void;
  connected(on: boolean): void;
}

/** Receives the samples of one drive until it is closed. */
export class Source {
  private socket: WebSocket | null = null;
  private timer = 0;
  private tries = 0;
  private closed = false;
  private reads = false;

  constructor(
    private readonly drive: string,
    private readonly address: string,
    private readonly parameters: string[],
    private readonly wanted: Wanted,
    private visible: boolean,
    private readonly handlers: Handlers,
  ) {
    this.connect();
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
    if (this.socket !== null) this.socket.onmessage = null;
    this.socket?.close();
  }

  /** Begins again, with the header of what comes. */
  again(): void {
    this.socket?.close();
  }

  setVisible(visible: boolean): void {
    this.visible = visible;
    this.send({ type: "visible", visible });
  }

  private topic(what: string): string {
    return `drive/${this.drive}/${what}`;
  }

  private send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  private connect(): void {
    const socket = new WebSocket(this.address, PROTOCOL);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.reads = false;
    socket.onopen = () => {
      this.tries = 0;
      this.handlers.connected(true);
      this.send({ type: "visible", visible: this.visible });
      if (this.wanted === "auto") this.send({ type: "subscribe", topic: this.topic("samples"), rate: 30 });
      else this.read(true);
    };
    socket.onmessage = ({ data }) => {
      if (typeof data !== "string") this.handlers.block(data as ArrayBuffer);
      else this.take(JSON.parse(data) as { type: string } & Header);
    };
    socket.onclose = () => {
      if (this.closed) return;
      this.handlers.connected(false);
      const pause = Math.min(LONGEST, FIRST * 2 ** this.tries) * (0.5 + Math.random() / 2);
      this.tries += 1;
      this.timer = setTimeout(() => this.connect(), pause) as unknown as number;
    };
  }

  /** Reads parameters, or no longer. */
  private read(on: boolean): void {
    if (this.reads === on) return;
    this.reads = on;
    const topic = this.topic("acyclic");
    if (on) this.send({ type: "subscribe", topic, rate: 30, parameters: this.parameters });
    else this.send({ type: "unsubscribe", topic });
  }

  private take(message: { type: string } & Header): void {
    if (message.type !== "stream") return;
    const cyclic = message.topic === this.topic("samples");
    if (cyclic) this.read(message.source === "none");
    if (message.source !== "none") this.handlers.header(message);
    else if (!cyclic) this.handlers.nothing(message.reason);
  }
}

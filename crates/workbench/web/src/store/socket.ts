/** The socket by which the workbench sends what changes. Only the modules of this folder use it. */
import { request, type Server } from "../api";
import type { Happening } from "./store";

const PROTOCOL = "profidrive.live.1";
/** The first pause before another try, and the longest, in ms. */
const FIRST = 250;
const LONGEST = 5000;
/** The workbench sends a sign of life each 250 ms; a socket without any for this time is opened again, in ms. */
const DEAD = 3000;
/** Time for the answer whether there is a session, in ms: whatever is wrong, the socket is tried again soon. */
const ANSWER = 2000;

/** What the workbench sends. */
export type Incoming =
  | { type: "hello"; build: string; boot: string; t: number; next_event: number }
  | { type: "clock"; t: number }
  | { type: "snapshot"; topic: string; rev: number; t: number; data: unknown }
  | ({ type: "event"; t: number; unix_ms: number } & Happening);

interface Handlers {
  message(message: Incoming): void;
  /** The workbench lets this browser in no more. */
  refused(): void;
  /** The sockets cannot be opened, and there is a session: what the server is then. */
  other(build: string): void;
}

/** Returns the pause before a try, with a part by chance, so that many pages do not come back at once. */
export function pause(tries: number, chance: number): number {
  return Math.min(LONGEST, FIRST * 2 ** tries) * (0.5 + chance / 2);
}

/** Calls `open` when a pause is not worth its end: the network is back, or the page is looked at again. */
export function whenBack(open: () => void): void {
  addEventListener("online", open);
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) open();
  });
}

/** A socket that comes back by itself, with the same topics. */
export class Live {
  private socket: WebSocket | null = null;
  private tries = 0;
  private timer = 0;
  private boot = "";
  private lastEvent = -1;
  private heard = performance.now();
  private readonly topics = new Map<string, { rate: number; users: number }>();

  constructor(private readonly handlers: Handlers) {
    document.addEventListener("visibilitychange", () => {
      this.send({ type: "visible", visible: !document.hidden });
    });
    whenBack(() => this.now());
    setInterval(() => this.check(), 1000);
    this.open();
  }

  /** Gives up a socket that is open and dead, as after a cut cable. */
  private check(): void {
    if (this.socket !== null && performance.now() - this.heard > DEAD) {
      const dead = this.socket;
      dead.onclose = null;
      dead.onmessage = null;
      dead.close();
      this.socket = null;
      void this.again();
    }
  }

  /** Subscribes to a topic until the function that it returns is called. */
  want(topic: string, rate: number): () => void {
    const known = this.topics.get(topic);
    if (known === undefined) {
      this.topics.set(topic, { rate, users: 1 });
      this.send({ type: "subscribe", topic, rate });
    } else {
      known.users += 1;
    }
    return () => this.leave(topic);
  }

  private leave(topic: string): void {
    const known = this.topics.get(topic);
    if (known === undefined) {
      return;
    }
    known.users -= 1;
    if (known.users === 0) {
      this.topics.delete(topic);
      this.send({ type: "unsubscribe", topic });
    }
  }

  private send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) {
      this.socket.send(JSON.stringify(message));
    }
  }

  /** Does not wait for the end of a pause. */
  private now(): void {
    if (this.socket === null && this.timer !== 0) {
      clearTimeout(this.timer);
      this.timer = 0;
      this.open();
    }
  }

  private open(): void {
    const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/api/v1/live`;
    const socket = new WebSocket(address, PROTOCOL);
    this.socket = socket;
    this.heard = performance.now();
    socket.onopen = () => {
      this.tries = 0;
      this.send({ type: "visible", visible: !document.hidden });
      if (this.lastEvent >= 0) {
        this.send({ type: "resume", boot: this.boot, last_event: this.lastEvent });
      }
      for (const [topic, { rate }] of this.topics) {
        this.send({ type: "subscribe", topic, rate });
      }
    };
    socket.onmessage = ({ data }) => this.take(JSON.parse(data) as Incoming);
    socket.onclose = () => {
      this.socket = null;
      void this.again();
    };
  }

  private take(message: Incoming): void {
    this.heard = performance.now();
    if (message.type === "hello") {
      if (message.boot !== this.boot) {
        this.lastEvent = message.next_event - 1;
      }
      this.boot = message.boot;
    } else if (message.type === "event") {
      this.lastEvent = message.n;
    }
    this.handlers.message(message);
  }

  /** Finds out whether there is a session at all, then tries again. */
  private async again(): Promise<void> {
    const answer = await request<unknown>("session", { signal: AbortSignal.timeout(ANSWER) }).catch(
      (error: unknown) => error,
    );
    if (typeof answer === "object" && answer !== null && "status" in answer && answer.status === 401) {
      this.handlers.refused();
      return;
    }
    if (this.tries > 1) {
      // the answer to a protocol that the server does not have is not shown to a page
      const server = await request<Server>("server", { signal: AbortSignal.timeout(ANSWER) }).catch(() => null);
      if (server !== null) this.handlers.other(server.build);
    }
    this.timer = window.setTimeout(
      () => {
        this.timer = 0;
        this.open();
      },
      pause(this.tries, Math.random()),
    );
    this.tries += 1;
  }
}

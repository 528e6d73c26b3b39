/** Sockets between a page and its server. */
import type { Page } from "@playwright/test";

/** Changes the messages of a socket on their way to the page. */
export async function change(
  page: Page,
  socket: "live" | "control",
  of: (message: Record<string, unknown>) => unknown,
) {
  await page.routeWebSocket(`**/api/v1/${socket}`, (route) => {
    const server = route.connectToServer();
    server.onMessage((text) => route.send(typeof text === "string" ? JSON.stringify(of(JSON.parse(text))) : text));
  });
}

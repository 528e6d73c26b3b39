/** Encryption, as a browser and a TLS client of others see it. */
import { type ConnectionOptions, connect, type TLSSocket } from "node:tls";
import { test } from "@playwright/test";
import { end, expect, idOf, type Running, rows, serve } from "./bench";

let server: Running;

test.beforeAll(async () => {
  server = await serve("--demo", "--tls", "self-signed", "--listen", "127.0.0.1:0");
});
test.afterAll(() => end(server));

function meet(options: ConnectionOptions): Promise<TLSSocket> {
  const { hostname, port } = new URL(server.origin);
  return new Promise((resolve, reject) => {
    const socket = connect({ host: hostname, port: Number(port), ...options }, () => resolve(socket));
    socket.once("error", reject);
  });
}

test("the page, its sockets and STOP work encrypted", async ({ browser }) => {
  const context = await browser.newContext({ ignoreHTTPSErrors: true });
  const page = await context.newPage();
  await page.goto(server.url);
  await rows(page);
  const [cookie] = await context.cookies();
  expect(cookie).toMatchObject({ secure: true, httpOnly: true, sameSite: "Strict" });
  await page.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/control`);
  await page.getByRole("button", { name: "Take control" }).click();
  await expect(page.getByText(/This page has control/)).toBeVisible();
  await page.getByRole("button", { name: /^STOP/ }).click();
  await expect(page.getByRole("button", { name: "Reset STOP" })).toBeVisible();
  await context.close();
});

test("a browser warns of a certificate that it does not know", async ({ browser }) => {
  const page = await (await browser.newContext()).newPage();
  await expect(page.goto(server.url)).rejects.toThrow(/ERR_CERT_AUTHORITY_INVALID/);
  await page.context().close();
});

test("the fingerprint is that of the certificate, and old versions of TLS are refused", async () => {
  const socket = await meet({ rejectUnauthorized: false });
  expect(socket.getPeerCertificate().fingerprint256).toBe(server.fingerprint);
  expect(socket.getPeerCertificate().subjectaltname).toContain("IP Address:127.0.0.1");
  socket.destroy();
  const old = meet({ rejectUnauthorized: false, minVersion: "TLSv1", maxVersion: "TLSv1.1" });
  await expect(old).rejects.toThrow();
});

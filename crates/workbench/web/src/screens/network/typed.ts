/** IP addresses as they are typed. */

export interface Address {
  ip: string;
  mask: string;
  gateway: string | null;
}

const PART = "(?:25[0-5]|2[0-4]\\d|1\\d\\d|[1-9]?\\d)";
const FORM = new RegExp(`^${PART}(?:\\.${PART}){3}$`);

/** Returns an address as it was typed; `null` while a part of it is missing. */
export function typed(ip: string, mask: string, gateway: string): Address | null {
  const all = [ip, mask, gateway].map((text) => text.trim());
  const [address = "", subnet = "", router = ""] = all;
  const complete = FORM.test(address) && FORM.test(subnet) && (router === "" || FORM.test(router));
  return complete ? { ip: address, mask: subnet, gateway: router === "" ? null : router } : null;
}

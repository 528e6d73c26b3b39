/** Where the focus goes when the element that had it goes away or is disabled. */

/** Parts of the page that say where a reader is. */
const PARTS = "section, article, aside, dialog, nav, main";

const isThere = (element: Element): boolean => element.isConnected && !element.matches(":disabled");

/**
 * Keeps the focus in the part of the page where it was, so that keys go on from there and not from the top. A button that is disabled
 * for a while gets it back.
 */
export function keepFocus(): void {
  let path: Element[] = [];
  /** What was disabled, and the part that has the focus instead. */
  let away: { from: Element; part: Element } | null = null;
  addEventListener("focusin", ({ target }) => {
    path = [];
    for (let element = target as Element | null; element; element = element.parentElement) path.push(element);
    if (target !== away?.part) away = null;
  });
  addEventListener("focusout", ({ target, relatedTarget }) => {
    // a click beside all controls takes the focus away for good; what was removed or disabled has lost it
    if (relatedTarget !== null) return;
    // while it is being removed it is still there
    queueMicrotask(() => {
      if (path[0] === target && isThere(target as Element) && document.hasFocus()) path = [];
    });
  });
  new MutationObserver(() => {
    const focus = document.activeElement;
    if (away !== null && focus === away.part && isThere(away.from)) {
      if (away.from instanceof HTMLElement) away.from.focus({ preventScroll: true });
      return;
    }
    const [last, ...around] = path;
    if (last === undefined || isThere(last)) return;
    path = [];
    if (focus !== null && focus !== document.body && focus !== last) return;
    const part = around.find((element) => element.isConnected && element.matches(PARTS));
    if (!(part instanceof HTMLElement)) return;
    if (!part.hasAttribute("tabindex")) part.tabIndex = -1;
    away = { from: last, part };
    part.focus({ preventScroll: true });
  }).observe(document.body, { attributeFilter: ["disabled"], childList: true, subtree: true });
}

import { useEffect } from "preact/hooks";
import * as control from "../../store/control";
import { t } from "../../text";

/** A slow button has this share of the speed. */
const SLOW = 0.1;

/** The key of each direction, with the focus on the pad. */
const KEYS: Record<string, number> = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -SLOW, ArrowUp: SLOW };
/** The buttons: their share of the speed, and the key as it is shown. */
const BUTTONS = [
  { share: -1, key: "ArrowLeft", arrow: "\u2190" },
  { share: 1, key: "ArrowRight", arrow: "\u2192" },
  { share: -SLOW, key: "ArrowDown", arrow: "\u2193" },
  { share: SLOW, key: "ArrowUp", arrow: "\u2191" },
];

/** Which button began which command last, to show it as pressed. */
let pressed = { n: 0, share: 0 };

/** Rounds as people read it. */
function rpm(speed: number): number {
  return Math.round(speed * 100) / 100;
}

/** Buttons that move the axis while they are held. Whatever ends a hold halts the axis. */
export function JogPad({
  drive,
  speed,
  refused,
  slow,
}: {
  drive: string;
  speed: number | null;
  refused: boolean;
  /** Whether a slow round trip is all that speaks against it. */
  slow: boolean;
}) {
  const held = control.held.value;
  // what is too slow begins no jog; one under way ends by its beats
  const usable = !refused || (slow && speed !== null && speed > 0 && held !== null);
  useEffect(() => {
    if (!usable) control.letGo();
  }, [usable]);
  const begin = (share: number) => {
    if (!usable || speed === null) return;
    control.hold(drive, rpm(speed * share));
    pressed = { n: control.held.value?.n ?? 0, share };
  };
  return (
    <fieldset
      class="pad"
      aria-label={t("control.pad")}
      aria-describedby="jog-why"
      onBlurCapture={(event) => {
        // from one button to another is not away
        const to = event.relatedTarget;
        if (!(to instanceof Node && event.currentTarget.contains(to))) control.letGo();
      }}
      onContextMenu={(event) => event.preventDefault()}
      onKeyDown={(event) => {
        const share = KEYS[event.key];
        // with these keys an arrow is a command of the browser
        if (share === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
        event.preventDefault();
        if (!event.repeat) begin(share);
      }}
      onKeyUp={(event) => {
        if (KEYS[event.key] !== undefined) control.letGo();
      }}
    >
      {BUTTONS.map(({ share, key, arrow }) => (
        <button
          key={share}
          type="button"
          aria-keyshortcuts={key}
          class="jog"
          disabled={!usable}
          aria-pressed={held?.drive === drive && pressed.n === held.n && pressed.share === share}
          onPointerDown={(event) => {
            if (event.button !== 0) return;
            event.currentTarget.setPointerCapture(event.pointerId);
            begin(share);
          }}
          onPointerUp={control.letGo}
          onPointerCancel={control.letGo}
          onLostPointerCapture={control.letGo}
        >
          <span aria-hidden="true">{arrow} </span>
          {speed === null
            ? "\u2013"
            : t(share < 0 ? "control.backward" : "control.forward", { speed: rpm(Math.abs(speed * share)) })}
        </button>
      ))}
    </fieldset>
  );
}

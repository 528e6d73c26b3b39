import type { Signal } from "@preact/signals";
import type { ComponentChildren } from "preact";

interface Wanted {
  /** What it shows and sets. */
  of?: Signal<boolean>;
  /** What it shows, where that is not a signal. */
  checked?: boolean;
  disabled?: boolean;
  /** What is done beside. */
  onChange?: (on: boolean) => void;
  children: ComponentChildren;
}

/** A check box with its text. */
export function Check({ of, checked, disabled, onChange, children }: Wanted) {
  return (
    <label class="check">
      <input
        type="checkbox"
        checked={of?.value ?? checked ?? false}
        disabled={disabled ?? false}
        onChange={(event) => {
          const on = event.currentTarget.checked;
          if (of) of.value = on;
          onChange?.(on);
        }}
      />
      <span>{children}</span>
    </label>
  );
}

import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { Station } from "../../api";
import { Check } from "../../parts/Check";
import { foreign, label, sentence } from "../../parts/format";
import { silent } from "../../store/store";
import { t } from "../../text";
import * as address from "./address";
import { typed } from "./typed";

/** Time without a key before what is typed is checked, in ms. */
const PAUSE = 250;

/** Checks what is typed after a pause, and keeps what is known of the newest. */
function useFinding(wanted: string, check: (() => Promise<address.Finding>) | null): address.Finding | null {
  const known = useSignal<{ wanted: string; finding: address.Finding } | null>(null);
  // what is wanted decides, not the function that checks it
  useEffect(() => {
    if (check === null) return;
    let left = false;
    const pause = setTimeout(async () => {
      const finding = await check();
      if (!left) known.value = { wanted, finding };
    }, PAUSE);
    return () => {
      left = true;
      clearTimeout(pause);
    };
  }, [wanted]);
  return known.value?.wanted === wanted ? known.value.finding : null;
}

function Finding({ id, finding, waits }: { id: string; finding: address.Finding | null; waits: string }) {
  return (
    <p id={id} role="status" class={`small ${finding === null ? "muted" : finding.good ? "ok" : "fault"}`}>
      <bdi>{finding === null ? waits : sentence(finding.text)}</bdi>
    </p>
  );
}

function Name({ station, permanent }: { station: Station; permanent: boolean }) {
  const name = useSignal(station.name ?? "");
  const touched = useSignal(false);
  const busy = useSignal(false);
  const check = () => address.checkName(station.id, name.value, permanent);
  const finding = useFinding(`${touched.value} ${permanent} ${name.value}`, touched.value ? check : null);
  const input = useRef<HTMLInputElement>(null);
  const set = (text: string) => {
    name.value = text;
    touched.value = true;
  };
  return (
    <form
      onSubmit={async (event) => {
        event.preventDefault();
        if (finding?.good !== true || busy.value) return;
        busy.value = true;
        await address.setName(station.id, name.value, permanent);
        busy.value = false;
        touched.value = false;
      }}
    >
      <label class="field">
        {t("address.name")}
        <input
          ref={input}
          autocomplete="off"
          spellcheck={false}
          maxLength={240}
          value={name.value}
          aria-describedby="address-name"
          aria-invalid={finding?.good === false}
          onInput={(event) => set(event.currentTarget.value)}
        />
      </label>
      <Finding id="address-name" finding={finding} waits={t(touched.value ? "address.checking" : "address.rule")} />
      <div class="buttons">
        {finding !== null && finding.converted !== null && (
          <button
            type="button"
            onClick={() => {
              set(finding.converted ?? "");
              // this button goes
              input.current?.focus();
            }}
          >
            {t("address.convert", { name: finding.converted })}
          </button>
        )}
        <button class="primary" type="submit" disabled={finding?.good !== true || busy.value || silent.value !== null}>
          {t(touched.value && name.value === "" ? "address.clear" : "address.setname")}
        </button>
      </div>
    </form>
  );
}

function Ip({ station, permanent }: { station: Station; permanent: boolean }) {
  const ip = useSignal(station.ip ?? "");
  const mask = useSignal(station.mask ?? "255.255.255.0");
  const gateway = useSignal(station.gateway ?? "");
  const touched = useSignal(false);
  const busy = useSignal(false);
  const wanted = touched.value ? typed(ip.value, mask.value, gateway.value) : null;
  const finding = useFinding(
    `${permanent} ${JSON.stringify(wanted)}`,
    wanted === null ? null : () => address.checkAddress(station.id, wanted, permanent),
  );
  const fields = [
    ["address.ip", ip],
    ["address.mask", mask],
    ["address.gateway", gateway],
  ] as const;
  return (
    <form
      onSubmit={async (event) => {
        event.preventDefault();
        if (wanted === null || finding?.good !== true || busy.value) return;
        busy.value = true;
        await address.setAddress(station.id, wanted, permanent);
        busy.value = false;
        touched.value = false;
      }}
    >
      <div class="fields">
        {fields.map(([text, value]) => (
          <label class="field" key={text}>
            {t(text)}
            <input
              autocomplete="off"
              spellcheck={false}
              inputMode="decimal"
              maxLength={15}
              value={value.value}
              aria-describedby="address-ip"
              aria-invalid={finding?.good === false}
              onInput={(event) => {
                value.value = event.currentTarget.value;
                touched.value = true;
              }}
            />
          </label>
        ))}
      </div>
      <Finding id="address-ip" finding={finding} waits={t(wanted === null ? "address.form" : "address.checking")} />
      <div class="buttons">
        <button class="primary" type="submit" disabled={finding?.good !== true || busy.value || silent.value !== null}>
          {t("address.setip")}
        </button>
      </div>
    </form>
  );
}

/** Signal, name and address of a station. It is not modal: STOP stays within reach. */
export function AddressDialog({ station }: { station: Station }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const permanent = useSignal(true);
  const named = label(station);
  const said = address.said.value?.id === station.id ? address.said.value : null;
  const close = () => {
    // gives the focus back to the button that opened it
    dialog.current?.close();
    address.shown.value = null;
  };
  useEffect(() => {
    const shown = dialog.current;
    address.said.value = null;
    shown?.show();
    return () => shown?.close();
  }, []);
  return (
    <dialog
      ref={dialog}
      class="address"
      aria-labelledby="address-title"
      onKeyDown={(event) => {
        if (event.key === "Escape") close();
      }}
    >
      <h2 id="address-title">
        <bdi>{t("address.title", { name: named })}</bdi>
      </h2>
      <p class="muted number">
        {station.mac} {station.ip ?? t("remark.no_address")}
      </p>
      <Blink station={station} />
      <Name station={station} permanent={permanent.value} />
      <Ip station={station} permanent={permanent.value} />
      <Check of={permanent}>{t("address.permanent")}</Check>
      {!permanent.value && <p class="warn small">{t("address.temporary")}</p>}
      <p role="status" class={said?.failed ? "fault" : "ok"}>
        <bdi>{said === null ? "" : sentence(said.text)}</bdi>
      </p>
      <div class="buttons">
        <button type="button" onClick={close}>
          {t("address.close")}
        </button>
      </div>
    </dialog>
  );
}

/** Lets a station blink, so that it is found among others. */
export function Blink({ station }: { station: Station }) {
  const named = label(station);
  return (
    <button
      type="button"
      // a button that is disabled would lose the focus
      aria-disabled={address.blinking.value !== null || silent.value !== null}
      onClick={() => void (silent.value === null && address.blink(station.id, named))}
    >
      {t(address.blinking.value === station.id ? "address.blinking" : "address.blink")}{" "}
      <span class="unseen">
        <bdi>{foreign(named)}</bdi>
      </span>
    </button>
  );
}

import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { useLocation } from "preact-iso";
import { Check } from "../parts/Check";
import { foreign } from "../parts/format";
import { server, stations } from "../store/store";
import { t } from "../text";
import { commands, LETTERS, matching, screens } from "./commands";
import { recent, screenOf } from "./selected";
import { shortcuts, shown } from "./shortcuts";

/** Opens a dialog that is not modal: STOP stays within reach. It gives the focus back when it is closed. */
function useDialog() {
  const dialog = useRef<HTMLDialogElement>(null);
  // at once: the next key that is pressed is meant for it
  useLayoutEffect(() => {
    const element = dialog.current;
    element?.show();
    return () => element?.close();
  }, []);
  const close = () => {
    dialog.current?.close();
    shown.value = "";
  };
  return { dialog, close };
}

/** Finds screens and drives by typing. */
function Find() {
  const { path, route } = useLocation();
  const { dialog, close } = useDialog();
  const [text, setText] = useState("");
  const [at, setAt] = useState(0);
  const simulation = server.value?.simulation ?? false;
  const all = matching(commands(stations.value ?? [], recent(path), screenOf(path), simulation), text).slice(0, 12);
  const chosen = Math.min(at, all.length - 1);
  const go = (command: (typeof all)[number] | undefined) => {
    if (command === undefined) return;
    close();
    route(command.path + location.search);
  };
  return (
    <dialog
      ref={dialog}
      class="address palette"
      aria-label={t("palette.title")}
      onKeyDown={(event) => {
        if (event.key === "Escape") close();
      }}
    >
      <form
        onSubmit={(event) => {
          event.preventDefault();
          go(all[chosen]);
        }}
      >
        <label>
          {t("palette.find")}
          <input
            type="text"
            role="combobox"
            aria-expanded="true"
            aria-controls="palette-list"
            aria-activedescendant={chosen >= 0 ? `palette-${chosen}` : undefined}
            autocomplete="off"
            spellcheck={false}
            value={text}
            onInput={(event) => {
              setText(event.currentTarget.value);
              setAt(0);
            }}
            onKeyDown={(event) => {
              const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
              if (step === undefined) return;
              event.preventDefault();
              setAt((chosen + step + all.length) % Math.max(1, all.length));
            }}
          />
        </label>
      </form>
      {all.length === 0 && <p class="muted">{t("palette.nothing")}</p>}
      <div id="palette-list" role="listbox" aria-label={t("palette.title")}>
        {all.map((command, place) => (
          // keys go to the field, which names the option; a click is an extra
          <div
            key={command.text + command.path}
            id={`palette-${place}`}
            role="option"
            tabIndex={-1}
            aria-selected={place === chosen}
            onClick={() => go(command)}
            onKeyDown={(event) => {
              if (event.key === "Enter") go(command);
            }}
          >
            <bdi>{foreign(command.text)}</bdi>
            {command.keys !== "" && <kbd>{command.keys}</kbd>}
          </div>
        ))}
      </div>
    </dialog>
  );
}

/** Lists the keys, and switches them off. */
function Keys() {
  const { dialog, close } = useDialog();
  const rows = [
    ["Ctrl+Space", t("keys.stop")],
    ["Esc Esc", t("keys.stop")],
    [t("keys.space"), t("keys.stop.control")],
    ["?", t("keys.help")],
    ["Ctrl+K", t("keys.palette")],
    ["/", t("keys.search")],
    ...screens(server.value?.simulation ?? false).map((screen) => [`g ${LETTERS[screen]}`, t(`nav.${screen}`)]),
    ["R, S, C", t("keys.scope")],
    [t("keys.arrows"), t("keys.jog")],
  ] as const;
  return (
    <dialog
      ref={dialog}
      class="address keys"
      aria-labelledby="keys-title"
      onKeyDown={(event) => {
        if (event.key === "Escape") close();
      }}
    >
      <h2 id="keys-title">{t("keys.title")}</h2>
      {/* first, as the focus is there: the keys of STOP are in sight */}
      <Check of={shortcuts}>{t("keys.on")}</Check>
      <table>
        <tbody>
          {rows.map(([key, what]) => (
            <tr key={key}>
              <th scope="row">
                <kbd>{key}</kbd>
              </th>
              <td>{what}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p class="muted small">{t("keys.motion")}</p>
      <div class="buttons">
        <button type="button" onClick={close}>
          {t("address.close")}
        </button>
      </div>
    </dialog>
  );
}

/** What keys open over each screen. */
export function Overlay() {
  if (shown.value === "palette") return <Find />;
  return shown.value === "keys" ? <Keys /> : null;
}

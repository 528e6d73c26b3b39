import { signal } from "@preact/signals";
import { type ComponentChildren, Fragment } from "preact";
import { useLocation } from "preact-iso";
import type { Station } from "../../api";
import { address } from "../../app/selected";
import { Command } from "../../parts/Command";
import { downloadText } from "../../parts/download";
import { cell, foreign, label, product, sentence, sorted } from "../../parts/format";
import { Loading } from "../../parts/Loading";
import { findings, owner, ownerName, Reason, reason, State } from "../../parts/Reason";
import { Shaft } from "../../parts/Shaft";
import { leases } from "../../store/control";
import { searchNow } from "../../store/live";
import { aged, failure, searched, searching, server, silent, stations } from "../../store/store";
import { age, t } from "../../text";
import { right } from "../compare/state";
import { AddressDialog, Blink } from "./AddressDialog";
import { said, shown } from "./address";
import { Identities } from "./Identities";
import { backUp, choose, chosen, isReadable, readIdentities, saved, saving } from "./selection";

const dash = "\u2013";

function name(station: Station): string {
  const nameless = station.name === null && !station.id.startsWith("ip-");
  return nameless ? t("network.noname") : label(station);
}

/** Whether there is room for all columns: where there is none, what matters most stands first. */
const room = matchMedia("(min-width: 900px) and (not (pointer: coarse))");
const roomy = signal(room.matches);
room.addEventListener("change", () => {
  roomy.value = room.matches;
});

/** The parts of a row, by their column. */
interface Cells {
  why: ComponentChildren;
  shaft: ComponentChildren;
  name: ComponentChildren;
  state: ComponentChildren;
  actions: ComponentChildren;
  rest: ComponentChildren;
  owner: ComponentChildren;
}

const WIDE = ["why", "shaft", "name", "rest", "state", "owner", "actions"] as const;
const SMALL = ["name", "state", "why", "shaft", "actions", "rest", "owner"] as const;

function inOrder(cells: Cells) {
  // with keys, so that a page that is turned keeps its buttons
  return (roomy.value ? WIDE : SMALL).map((column) => <Fragment key={column}>{cells[column]}</Fragment>);
}

function Row({ station, simulation, changes }: { station: Station; simulation: boolean; changes: boolean }) {
  const identity = station.info?.identity;
  const known = station.mac !== "00:00:00:00:00:00";
  const found = findings(station);
  return (
    <tr data-id={station.id} class={station.lost === null && silent.value === null ? "" : "stale"}>
      {changes && (
        <td class="choose">
          <input
            type="checkbox"
            aria-label={t("network.choose", { name: label(station) })}
            checked={chosen.value.has(station.id)}
            disabled={!isReadable(station)}
            onChange={(event) => choose(station.id, event.currentTarget.checked)}
          />
        </td>
      )}
      {inOrder({
        why: (
          <td class="why">
            <Reason station={station} />
          </td>
        ),
        shaft: simulation && (
          <td>
            <Shaft id={station.id} />
          </td>
        ),
        name: (
          <th scope="row">
            <a href={`/drives/${encodeURIComponent(station.id)}/overview${location.search}`}>
              <bdi>{name(station)}</bdi>
            </a>
            {station.status && found.length > 0 && <span class="warn small"> {found.join(", ")}</span>}
          </th>
        ),
        rest: (
          <>
            <td class="number">
              <div>{station.ip ?? dash}</div>
              <div class="muted">{known ? station.mac : dash}</div>
            </td>
            <td class="product" title={product(station)}>
              <bdi>{product(station) || dash}</bdi>
            </td>
            <td>
              <bdi>{identity ? foreign(identity.software_revision) : dash}</bdi>
            </td>
            <td>
              <bdi>{identity ? foreign(identity.serial_number) : dash}</bdi>
            </td>
          </>
        ),
        state: <td>{silent.value === null ? <State station={station} short /> : dash}</td>,
        owner: (
          <td>
            <bdi>{ownerName(station) ?? dash}</bdi>
          </td>
        ),
        actions: changes && (
          <td>
            <div class="actions">
              <Blink station={station} />
              <button
                type="button"
                aria-haspopup="dialog"
                onClick={() => {
                  shown.value = station.id;
                }}
              >
                {t("address.open")} <span class="unseen">{label(station)}</span>
              </button>
            </div>
          </td>
        ),
      })}
    </tr>
  );
}

/** What is done with the stations that are selected. */
function Chosen({ all }: { all: Station[] }) {
  const { route } = useLocation();
  const selected = all.filter(({ id }) => chosen.value.has(id));
  const [one, other] = selected;
  return (
    <>
      <button
        type="button"
        disabled={selected.length === 0 || saving.value || silent.value !== null}
        onClick={() => void backUp(selected)}
      >
        {t("network.backup", { count: selected.length })}
      </button>
      <button
        type="button"
        disabled={selected.length === 0 || silent.value !== null}
        onClick={() => void readIdentities(selected)}
      >
        {t("network.identity.read", { count: selected.length })}
      </button>
      <button
        type="button"
        class="roomy"
        disabled={selected.length !== 2}
        onClick={() => {
          if (!one || !other) return;
          right.value = `drive ${other.id}`;
          route(address(one.id, "compare") + location.search);
        }}
      >
        {t("network.compare")}
      </button>
    </>
  );
}

/** Writes the table to a file of the browser. */
function exportTable(all: Station[]): void {
  const head = ["name", "ip", "mac", "vendor and type", "firmware", "serial number", "state", "controller", "status"];
  const rows = all.map((station) => [
    station.name ?? "",
    station.ip ?? "",
    station.mac,
    product(station),
    station.info?.identity?.software_revision ?? "",
    station.info?.identity?.serial_number ?? "",
    station.status?.state_text ?? "",
    owner(station),
    reason(station),
  ]);
  const text = [head, ...rows].map((row) => row.map(cell).join(",")).join("\r\n");
  downloadText("network.csv", "text/csv", `${text}\r\n`);
}

function place(): string {
  return server.value?.interface ?? t("network.place.plant");
}

/** The first motion of a newcomer: with a virtual drive that no controller has. */
function FirstMotion({ all }: { all: readonly Station[] }) {
  const free = all.find(({ id, status, lost }) => {
    if (!status || lost !== null || status.faults.length > 0 || status.torque_allowed === false) return false;
    const taken = status.controller?.connected && !leases.value.has(id);
    return !taken && status.on_loss?.action !== "keeps-turning";
  });
  if (!free) return null;
  const name = label(free);
  return (
    <section class="card roomy" aria-labelledby="first-motion">
      <h2 id="first-motion">{t("motor.title")}</h2>
      <ol>
        <li>
          <bdi>{t("motor.take", { name })}</bdi>
        </li>
        <li>{t("motor.enable")}</li>
        <li>{t("motor.jog")}</li>
      </ol>
      <a href={address(free.id, "control") + location.search}>{t("motor.open")}</a>
    </section>
  );
}

export function Network() {
  const simulation = server.value?.simulation ?? false;
  const searches = server.value?.searches ?? true;
  const all = sorted(stations.value ?? []);
  const waiting = stations.value === null || searched.value === null;
  const since = aged(searched.value);
  const changes = searches && server.value?.role === "control";
  const readable = all.filter(isReadable);
  const named = changes ? all.find((station) => station.id === shown.value) : undefined;
  return (
    <section class="network">
      <div class="title">
        <h1>{t("network.title")}</h1>
        <span class="muted">{since === null ? t("network.searching") : t("network.age", { age: age(since) })}</span>
        {changes && (
          <button type="button" disabled={searching.value} onClick={() => void searchNow()}>
            {t(searching.value ? "network.searching" : "network.scan")}
          </button>
        )}
        <button type="button" disabled={all.length === 0} onClick={() => exportTable(all)}>
          {t("network.export")}
        </button>
        {changes && <Chosen all={readable} />}
      </div>
      {saved.value !== null && (
        <p class={`hint ${saved.value.failed ? "fault" : ""}`} role="status">
          <bdi>{sentence(saved.value.text)}</bdi>
        </p>
      )}
      {!searches && <p class="hint">{t("network.addresses")}</p>}
      {failure.value !== null && (
        <p class="hint fault">
          <bdi>{t("network.failed", { reason: foreign(failure.value) })}</bdi>
        </p>
      )}
      {said.value !== null && said.value.id !== named?.id && (
        <p class={`hint ${said.value.failed ? "fault" : ""}`} role="status">
          <bdi>{sentence(said.value.text)}</bdi>
        </p>
      )}
      {named !== undefined && <AddressDialog key={named.id} station={named} />}
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
      <section class="scroll" tabIndex={0} aria-label={t("network.caption")}>
        <table>
          <caption class="unseen">{t("network.caption")}</caption>
          <thead>
            <tr>
              {changes && (
                <th scope="col" class="choose">
                  <input
                    type="checkbox"
                    aria-label={t("network.choose.all")}
                    checked={readable.length > 0 && readable.every(({ id }) => chosen.value.has(id))}
                    onChange={(event) => {
                      chosen.value = new Set(event.currentTarget.checked ? readable.map(({ id }) => id) : []);
                    }}
                  />
                </th>
              )}
              {inOrder({
                why: <th scope="col">{t("network.why")}</th>,
                shaft: simulation && <th scope="col">{t("network.shaft")}</th>,
                name: <th scope="col">{t("network.name")}</th>,
                rest: (
                  <>
                    <th scope="col">{t("network.addresses.both")}</th>
                    <th scope="col">{t("network.product")}</th>
                    <th scope="col">{t("network.firmware")}</th>
                    <th scope="col">{t("network.serial")}</th>
                  </>
                ),
                state: <th scope="col">{t("network.state")}</th>,
                owner: <th scope="col">{t("network.owner")}</th>,
                actions: changes && <th scope="col">{t("network.actions")}</th>,
              })}
            </tr>
          </thead>
          <tbody>
            {all.map((station) => (
              <Row key={station.id} station={station} simulation={simulation} changes={changes} />
            ))}
            {all.length === 0 && (
              <tr>
                <td class="empty" colSpan={12}>
                  {waiting ? (
                    <Loading what={t(stations.value === null ? "loading.workbench" : "loading.search")} count={6} />
                  ) : searches ? (
                    t("network.empty.search", { place: place() })
                  ) : (
                    t("network.empty.addresses")
                  )}
                </td>
              </tr>
            )}
          </tbody>
        </table>
      </section>
      <Identities />
      {simulation && <FirstMotion all={all} />}
      {searches && <Command verb="scan" station={null} />}
    </section>
  );
}

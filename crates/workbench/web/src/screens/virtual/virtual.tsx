import { signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { useLocation } from "preact-iso";
import {
  ask,
  type PlantCheck,
  type PlantStarted,
  type Possible,
  post,
  Refused,
  type Plant as Running,
  request,
  type Shaft as ShaftState,
  type Station,
} from "../../api";
import { recent } from "../../app/selected";
import { downloadText } from "../../parts/download";
import { digits, foreign, product, sentence } from "../../parts/format";
import { Loading } from "../../parts/Loading";
import { ownerName, State } from "../../parts/Reason";
import { Shaft } from "../../parts/Shaft";
import { reason } from "../../store/jobs";
import { paused, restarts, server, shafts, silent, stations, whenRestarted } from "../../store/store";
import { t } from "../../text";

/** The drive that something is to happen to, and what became of the last wish. */
const selection = signal("");
const answer = signal<{ text: string; failed: boolean } | null>(null);

/** The time of the plant in s from which events are recorded, and how many there are. */
const recording = signal<{ since: number; count: number } | null>(null);

/** Begins to record what is let happen: it becomes a plant file. */
async function record(): Promise<void> {
  const { time } = await request<{ time: number }>("plant/drives");
  recording.value = { since: time, count: 0 };
}

function Recording() {
  const running = recording.value;
  return (
    <section class="happen">
      <h2>{t("virtual.record.title")}</h2>
      <p class="buttons">
        <button type="button" onClick={() => void record()}>
          {t(running === null ? "virtual.record" : "virtual.record.again")}
        </button>
        {running !== null && (
          <a href={`/api/v1/plant/scenario?since=${running.since}`} download="scenario.toml">
            {t(running.count === 1 ? "virtual.record.save.one" : "virtual.record.save", { count: running.count })}
          </a>
        )}
      </p>
      <p class="muted small">{t("virtual.record.how")}</p>
    </section>
  );
}

/** The plant file that is edited, and what is wrong with it; the text is empty before it was read. */
const plant = signal("");
/** Whether it has edits that no plant was started with. */
const edited = signal(false);
const wrong = signal<PlantCheck["problem"]>(null);
const restarted = signal<{ text: string; failed: boolean } | null>(null);
/** Time without typing or keys after which the file is checked and a load is sent, in ms. */
const PAUSE = 300;
let timer = 0;

/** The line of a plant file with its seed. */
const SEED = /^seed *= *(\d+).*$/m;

/** Which plant the file is of: how many were started before it. */
let fileOf: number | null = null;
/** Whether another plant was started since the file was read. */
const replaced = signal(false);

async function readPlant(): Promise<void> {
  try {
    // first: a plant that is started meanwhile is another one than that of the number
    const { restarts } = await request<Running>("plant/drives");
    // without what was injected: that would come again at its time after a restart
    plant.value = await (await ask("plant/scenario?without_events=true")).text();
    fileOf = restarts;
    edited.value = false;
    replaced.value = false;
    wrong.value = null;
  } catch (error) {
    restarted.value = { text: reason(error), failed: true };
  }
}

function edit(text: string): void {
  plant.value = text;
  edited.value = true;
  clearTimeout(timer);
  timer = window.setTimeout(() => {
    void post<PlantCheck>("plant/check", { text }).then(
      ({ problem }) => {
        if (plant.value === text) wrong.value = problem;
      },
      (error: unknown) => {
        restarted.value = { text: reason(error), failed: true };
      },
    );
  }, PAUSE);
}

/** Starts the plant with the file, in the place of the one that it is of, or of whichever runs. */
async function restart(whichever: boolean): Promise<void> {
  const text = plant.value;
  restarted.value = await post<PlantStarted>("plant/restart", { text, restarts: whichever ? null : fileOf }).then(
    ({ restarts }) => {
      fileOf = restarts;
      edited.value = plant.value !== text;
      replaced.value = false;
      return { text: t("virtual.restarted"), failed: false };
    },
    (error: unknown) => {
      if (error instanceof Refused && error.kind === "changed") replaced.value = true;
      return { text: reason(error), failed: true };
    },
  );
}

// what was recorded and said is of the plant before; a file without edits is read again where the section is open
whenRestarted(() => {
  recording.value = null;
  answer.value = null;
  if (restarts.value !== fileOf) restarted.value = null;
  if (plant.value !== "" && !edited.value && restarts.value !== fileOf) void readPlant();
});

/** Lets the time of the plant stand still, or go on. */
function Clock({ may }: { may: boolean }) {
  const set = async (wanted: boolean) => {
    try {
      await post("plant/clock", { paused: wanted });
      restarted.value = null;
    } catch (error) {
      restarted.value = { text: reason(error), failed: true };
    }
  };
  return (
    <p class="buttons">
      <span>{t(paused.value ? "virtual.clock.paused" : "virtual.clock.real")}</span>
      <button type="button" disabled={!may} onClick={() => void set(!paused.value)}>
        {t(paused.value ? "virtual.clock.go" : "virtual.clock.pause")}
      </button>
    </p>
  );
}

/** The plant: its time, its seed, its file with what was injected so far, and all of it started again. */
function Plant() {
  const may = server.value?.role === "control" && silent.value === null;
  const seed = SEED.exec(plant.value)?.[1] ?? "";
  const open = plant.value !== "";
  // what is typed there, as long as it is typed
  const [typed, setTyped] = useState<string | null>(null);
  return (
    <section class="happen">
      <h2>{t("virtual.plant.title")}</h2>
      <Clock may={may} />
      <details
        onToggle={(event) => {
          if (event.currentTarget.open && !edited.value) void readPlant();
        }}
      >
        <summary>{t("virtual.plant")}</summary>
        <textarea
          class="number"
          aria-label={t("virtual.plant")}
          aria-invalid={wrong.value !== null}
          rows={16}
          spellcheck={false}
          readOnly={!may}
          value={plant.value}
          onInput={(event) => edit(event.currentTarget.value)}
        />
        {wrong.value !== null && (
          <p class="fault" role="alert">
            <bdi>{t("virtual.plant.wrong", { line: wrong.value.line, text: sentence(wrong.value.message) })}</bdi>
          </p>
        )}
        <p class="buttons">
          <label class="inline">
            <span>{t("virtual.seed")}</span>
            <input
              value={typed ?? seed}
              size={8}
              maxLength={15}
              inputMode="numeric"
              autocomplete="off"
              disabled={!may || !open}
              onInput={(event) => {
                setTyped(event.currentTarget.value);
                const digits = event.currentTarget.value.replace(/\D/g, "");
                if (digits === "") return;
                const line = `seed = ${Number(digits)}`;
                edit(SEED.test(plant.value) ? plant.value.replace(SEED, line) : `${line}\n${plant.value}`);
              }}
              onBlur={() => setTyped(null)}
            />
          </label>
          <button type="button" disabled={!may || !open || wrong.value !== null} onClick={() => void restart(false)}>
            {t("virtual.restart")}
          </button>
          {replaced.value && (
            <button type="button" disabled={!may || wrong.value !== null} onClick={() => void restart(true)}>
              {t("virtual.restart.whichever")}
            </button>
          )}
          <button
            type="button"
            disabled={!open}
            onClick={() => downloadText("plant.toml", "application/toml", plant.value)}
          >
            {t("virtual.plant.save")}
          </button>
          <button type="button" onClick={() => void readPlant()}>
            {t("virtual.plant.again")}
          </button>
        </p>
        <p class="muted small">{t("virtual.plant.how")}</p>
      </details>
      <p role="status" class={restarted.value?.failed ? "fault" : ""}>
        {restarted.value && <bdi>{sentence(restarted.value.text)}</bdi>}
      </p>
    </section>
  );
}

/** What can be done by one button: the event, and how it is called. */
const BUTTONS = [
  ["sto=on", "virtual.sto.on"],
  ["sto=off", "virtual.sto.off"],
  ["mains=off", "virtual.mains.off"],
  ["mains=on", "virtual.mains.on"],
  ["cable=pulled", "virtual.cable.pulled"],
  ["cable=plugged", "virtual.cable.plugged"],
] as const;

async function inject(drive: string, event: string, seconds: number | null): Promise<void> {
  answer.value = await post<{ drive: string; event: string }>("plant/inject", { drive, event, seconds }).then(
    (done) => {
      if (recording.value !== null) recording.value = { ...recording.value, count: recording.value.count + 1 };
      return { text: t("virtual.done", { drive: foreign(done.drive), event: done.event }), failed: false };
    },
    (error: unknown) => ({ text: error instanceof Error ? error.message : String(error), failed: true }),
  );
}

/** Returns whether something limits the way of a shaft. */
function hasEnds({ stops, switches }: ShaftState): boolean {
  return [stops.negative, stops.positive, switches.negative, switches.positive].some((place) => place !== null);
}

/** The hard stops and limit switches of a shaft; a dash where it turns without end. */
function ends({ stops, switches }: ShaftState): string {
  const of = (key: "virtual.ends.stop" | "virtual.ends.switch", place: number | null) =>
    place === null ? [] : [t(key, { place: place.toFixed(2) })];
  const all = [
    ...of("virtual.ends.stop", stops.negative),
    ...of("virtual.ends.switch", switches.negative),
    ...of("virtual.ends.switch", switches.positive),
    ...of("virtual.ends.stop", stops.positive),
  ];
  return all.join(", ") || "\u2013";
}

/** The temperature that a drive reports: of its motor, else of its power stage. */
function temperature(station: Station | undefined): string {
  const degrees = station?.status?.motor_temperature ?? station?.status?.temperature;
  return degrees ? digits(degrees) : "\u2013";
}

interface Shown {
  shaft: ShaftState;
  station: Station | undefined;
  chosen: boolean;
  /** Whether the table has a column for the ends of the way. */
  withEnds: boolean;
}

function Row({ shaft, station, chosen, withEnds }: Shown) {
  const dash = "\u2013";
  const live = silent.value === null;
  const present = station?.status?.faults ?? [];
  return (
    <tr data-id={shaft.id} class={live ? "" : "stale"}>
      <th scope="row">
        <button
          type="button"
          aria-pressed={chosen}
          aria-label={t("virtual.choose", { name: foreign(shaft.name) })}
          onClick={() => {
            selection.value = shaft.id;
          }}
        >
          <bdi>{foreign(shaft.name)}</bdi>
        </button>
      </th>
      <td>
        <Shaft id={shaft.id} />
      </td>
      <td class="number right">{live ? shaft.position.toFixed(3) : dash}</td>
      <td class="number right">{live ? shaft.speed.toFixed(1) : dash}</td>
      <td class="number right">{live ? shaft.load.toFixed(2) : dash}</td>
      <td class="number right">{live ? temperature(station) : dash}</td>
      {withEnds && <td class="number">{live ? ends(shaft) : dash}</td>}
      <td>
        <bdi>{station ? product(station) : dash}</bdi>
      </td>
      <td>{live && station ? <State station={station} short /> : dash}</td>
      <td>
        <bdi>{(live && ownerName(station)) || dash}</bdi>
      </td>
      <td>{present.length > 0 ? present.map(({ number }) => `F${number}`).join(", ") : dash}</td>
      <td class={shaft.lasting.length > 0 ? "warn" : ""}>
        {shaft.lasting.length > 0 ? shaft.lasting.map(({ event }) => event).join(", ") : dash}
      </td>
    </tr>
  );
}

/** What was injected and has not ended, each with what ends it. */
function Lasting({ shaft, may }: { shaft: ShaftState; may: boolean }) {
  if (shaft.lasting.length === 0) return <p class="muted">{t("virtual.lasting.none")}</p>;
  return (
    <ul class="lasting" aria-label={t("virtual.lasting.of", { name: foreign(shaft.name) })}>
      {shaft.lasting.map(({ event, undo }) => (
        <li key={event}>
          <span class="warn number">{event}</span>
          {undo !== null && (
            <button type="button" disabled={!may} onClick={() => void inject(shaft.id, undo, null)}>
              {t("virtual.lasting.end", { event })}
            </button>
          )}
        </li>
      ))}
    </ul>
  );
}

/** The load of a virtual drive that the slider sets, in Nm. */
const HEAVIEST = 5;

/** A torque against the shaft. */
function Load({ shaft, may }: { shaft: ShaftState; may: boolean }) {
  const present = shaft.lasting.find(({ event }) => event.startsWith("load="))?.event ?? "load=0Nm";
  // while it has the focus it is where the keys put it, whatever the plant reports meanwhile
  const [wanted, setWanted] = useState<number | null>(null);
  const pause = useRef(0);
  const torque = wanted ?? Number.parseFloat(present.slice("load=".length));
  return (
    <label>
      <span>{t("virtual.load", { torque: torque.toFixed(1) })}</span>
      <input
        type="range"
        min={-HEAVIEST}
        max={HEAVIEST}
        step={0.1}
        value={torque}
        disabled={!may}
        // not every browser focuses it by a click
        onPointerDown={(press) => press.currentTarget.focus()}
        onInput={(change) => {
          const { valueAsNumber } = change.currentTarget;
          setWanted(valueAsNumber);
          clearTimeout(pause.current);
          pause.current = window.setTimeout(() => void inject(shaft.id, `load=${valueAsNumber}Nm`, null), PAUSE);
        }}
        onBlur={() => setWanted(null)}
      />
    </label>
  );
}

/** Lets something happen to one drive. */
function Happen({ shaft }: { shaft: ShaftState }) {
  const [possible, setPossible] = useState<Possible | null>(null);
  const [event, setEvent] = useState("");
  const [fault, setFault] = useState("");
  const [seconds, setSeconds] = useState("");
  useEffect(() => {
    setPossible(null);
    setFault("");
    request<Possible>(`plant/drives/${encodeURIComponent(shaft.id)}/events`).then(setPossible, () => setPossible(null));
  }, [shaft.id]);
  const time = seconds.trim() === "" ? null : Number(seconds);
  const wrong = time !== null && !(time > 0 && time <= 86_400);
  const control = server.value?.role === "control";
  const live = silent.value === null;
  const may = control && live && !wrong;
  const go = (what: string) => void inject(shaft.id, what, time);
  return (
    <section class="happen">
      <h2>{t("virtual.happen", { name: foreign(shaft.name) })}</h2>
      {!control && <p class="muted">{t("virtual.view")}</p>}
      <Lasting shaft={shaft} may={control && live} />
      <p class="buttons">
        {BUTTONS.map(([what, key]) => (
          <button key={what} type="button" disabled={!may} onClick={() => go(what)}>
            {t(key)}
          </button>
        ))}
      </p>
      <Load key={shaft.id} shaft={shaft} may={control && live} />
      <label>
        <span>{t("virtual.fault")}</span>
        <select value={fault} onChange={(change) => setFault(change.currentTarget.value)}>
          <option value="">{t("virtual.fault.none")}</option>
          {possible?.faults
            .filter(({ warning }) => !warning)
            .map(({ number, meaning }) => (
              <option key={number} value={number}>
                F{number} {foreign(meaning)}
              </option>
            ))}
        </select>
      </label>
      <p class="buttons">
        <button type="button" disabled={!may || fault === ""} onClick={() => go(`fault=${fault}`)}>
          {t("virtual.fault.once")}
        </button>
        <button type="button" disabled={!may || fault === ""} onClick={() => go(`fault=${fault}!`)}>
          {t("virtual.fault.stay")}
        </button>
        <button type="button" disabled={!may || fault === ""} onClick={() => go(`clear=${fault}`)}>
          {t("virtual.fault.clear")}
        </button>
      </p>
      <form
        onSubmit={(submit) => {
          submit.preventDefault();
          go(event);
        }}
      >
        <label>
          <span>{t("virtual.event")}</span>
          <input
            value={event}
            list="events"
            maxLength={100}
            spellcheck={false}
            autocomplete="off"
            placeholder="load=0.5Nm"
            onInput={(change) => setEvent(change.currentTarget.value)}
          />
          <datalist id="events">
            {possible?.keys.map(({ key, example, meaning }) => (
              <option key={key} value={example}>
                {meaning}
              </option>
            ))}
          </datalist>
        </label>
        <button type="submit" disabled={!may || event === ""}>
          {t("virtual.event.go")}
        </button>
      </form>
      <label>
        <span>{t("virtual.seconds")}</span>
        <input
          value={seconds}
          inputMode="decimal"
          autocomplete="off"
          aria-invalid={wrong}
          onInput={(change) => setSeconds(change.currentTarget.value)}
        />
        {wrong && <span class="fault">{t("virtual.seconds.wrong")}</span>}
      </label>
      <p role="status" class={answer.value?.failed ? "fault" : ""}>
        {answer.value && <bdi>{sentence(answer.value.text)}</bdi>}
      </p>
    </section>
  );
}

/** The virtual drives of a simulation: their shafts, and what can happen to them. */
export function Virtual() {
  const all = [...shafts.value.values()];
  const known = new Map((stations.value ?? []).map((station) => [station.id, station]));
  const { path } = useLocation();
  useEffect(() => {
    // it begins with the drive of the frame
    selection.value = recent(path) ?? selection.value;
  }, []);
  const one = shafts.value.get(selection.value) ?? all[0];
  const withEnds = all.some(hasEnds);
  return (
    <article class="virtual">
      <h1>{t("virtual.title")}</h1>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
      <section class="scroll" tabIndex={0} aria-label={t("virtual.title")}>
        <table>
          <caption class="unseen">{t("virtual.title")}</caption>
          <thead>
            <tr>
              <th scope="col">{t("network.name")}</th>
              <th scope="col">{t("network.shaft")}</th>
              <th scope="col" class="right">
                {t("virtual.position")}
              </th>
              <th scope="col" class="right">
                {t("virtual.speed")}
              </th>
              <th scope="col" class="right">
                {t("virtual.torque")}
              </th>
              <th scope="col" class="right">
                {t("virtual.temperature")}
              </th>
              {withEnds && <th scope="col">{t("virtual.ends")}</th>}
              <th scope="col">{t("network.product")}</th>
              <th scope="col">{t("network.state")}</th>
              <th scope="col">{t("network.owner")}</th>
              <th scope="col">{t("faults.title")}</th>
              <th scope="col">{t("virtual.lasting")}</th>
            </tr>
          </thead>
          <tbody>
            {all.length === 0 && (
              <tr>
                <td class="empty" colSpan={12}>
                  <Loading what={t("loading.plant")} count={6} />
                </td>
              </tr>
            )}
            {all.map((shaft) => (
              <Row
                key={shaft.id}
                shaft={shaft}
                station={known.get(shaft.id)}
                chosen={shaft.id === one?.id}
                withEnds={withEnds}
              />
            ))}
          </tbody>
        </table>
      </section>
      {one && <Happen shaft={one} />}
      <Recording />
      <Plant />
    </article>
  );
}

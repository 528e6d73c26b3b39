import { effect, type Signal, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import type { Station } from "../../api";
import { address, selected, selectedId } from "../../app/selected";
import { Check } from "../../parts/Check";
import { capital, faultText, foreign, label, sentence } from "../../parts/format";
import { Nothing } from "../../parts/Nothing";
import { otherOwner, otherPage, owner } from "../../parts/Reason";
import { Shaft } from "../../parts/Shaft";
import { Who } from "../../parts/Who";
import * as control from "../../store/control";
import { perDrive } from "../../store/perDrive";
import * as scope from "../../store/scope";
import { aged, now, outdated, server, silent } from "../../store/store";
import { t } from "../../text";
import { JogPad } from "./JogPad";

const purposes = perDrive<"speed" | "position">("speed");
const modes = perDrive(false);
/** Whether a person accepts that the drive runs on without its connection. */
const consents = perDrive(false);
const limits = perDrive("300");
/** Empty for any way. */
const travels = perDrive("");
/** What a person has seen of a real machine. */
const checks = perDrive<readonly boolean[]>([false, false, false]);
const tabs = perDrive<"jog" | "velocity" | "move" | "home" | "task">("jog");
const jogSpeeds = perDrive("20");
const speeds = perDrive("20");
const distances = perDrive("1");
const relatives = perDrive(true);
/** Of motion tasks. */
const numbers = perDrive("1");

const dash = "\u2013";

/** Returns whether the workbench says what is under control. */
const isKnown = () => silent.value === null && control.connected.value;

/** Consent and what was seen count until the drive is released. */
let taken: readonly string[] = [];
effect(() => {
  const held = control.leases.value;
  for (const id of taken.filter((one) => !held.has(one))) {
    consents.forget(id);
    checks.forget(id);
  }
  taken = [...held.keys()];
});

/** What is kept of a drive in this browser: how STOP stops it. */
const STOP_BY = "profidrive.stop.";
const chosenStops = signal<ReadonlyMap<string, control.StopBy>>(new Map());

function stopBy(id: string): control.StopBy {
  return chosenStops.value.get(id) ?? stopNamed(localStorage.getItem(STOP_BY + id));
}

function stopNamed(name: string | null): control.StopBy {
  return (["off1", "off2"] as const).find((one) => one === name) ?? "off3";
}

function chooseStop(id: string, by: string): void {
  const chosen = stopNamed(by);
  localStorage.setItem(STOP_BY + id, chosen);
  chosenStops.value = new Map(chosenStops.value).set(id, chosen);
}

/** Reads a number with a decimal point or comma. `1,000` is none: it may be a thousand. */
function numberOf(text: string): number | null {
  if (/^[+-]?\d{1,3}(,\d{3})+$/.test(text.trim())) return null;
  const value = Number(text.trim().replace(",", "."));
  return text.trim() === "" || !Number.isFinite(value) ? null : value;
}

function Field({
  title,
  value,
  unit,
  disabled,
  optional,
}: {
  title: string;
  value: Signal<string>;
  unit: string;
  disabled?: boolean;
  /** Whether it may be empty. */
  optional?: boolean;
}) {
  const wrong = numberOf(value.value) === null && !(optional && value.value.trim() === "");
  return (
    <label class="field">
      <span>{title}</span>
      <span>
        <input
          value={value.value}
          inputMode="decimal"
          autocomplete="off"
          disabled={disabled ?? false}
          aria-invalid={wrong}
          onInput={(event) => {
            value.value = event.currentTarget.value;
          }}
        />{" "}
        <span class="unit">{unit}</span>
      </span>
    </label>
  );
}

/** Why this page cannot take control, in words; nothing where it can. */
function obstacle(station: Station): string | null {
  const refusal = control.refusal.value;
  if (outdated.value) return t("frame.outdated");
  if (!isKnown()) return t("control.lost");
  if (refusal === "view" || refusal === "read_only") return t("control.view");
  if (refusal === "addresses") return t("control.addresses");
  if (refusal === "remote") return t("control.remote");
  if (control.own(station.id) !== undefined || control.leases.value.has(station.id)) return null;
  if (station.ip === null) return t("control.addressless");
  // that of another page is requested from it
  if (control.axes.value.some((axis) => axis.drive === station.id)) return null;
  const name = otherOwner(station);
  return name === null ? null : t("control.owned", { name });
}

/** What the drive does when it loses its connection. */
function OnLoss({ station }: { station: Station }) {
  const loss = station.status?.on_loss;
  if (!loss) return null;
  return (
    <p class={loss.action === "keeps-turning" ? "warn" : "muted"}>
      <bdi>{sentence(t("control.loss", { text: loss.text }))}</bdi>
    </p>
  );
}

function Take({ station }: { station: Station }) {
  const axis = control.own(station.id);
  const why = obstacle(station);
  const real = server.value?.simulation === false;
  const seen = checks.of(station.id);
  const ready = !real || seen.value.every(Boolean);
  const limit = limits.of(station.id);
  const highest = numberOf(limit.value);
  const purpose = purposes.of(station.id);
  const mode = modes.of(station.id);
  const runs = consents.of(station.id);
  const travel = travels.of(station.id);
  const way = travel.value.trim();
  // a travel that is no number is not the same as none
  const far = way !== "" && !((numberOf(travel.value) ?? 0) > 0);
  const other = control.axes.value.find((one) => one.drive === station.id);
  const who = other === undefined ? "" : otherPage(other.holder, other.claimed_name);
  const mine = control.taking.value.has(station.id);
  const waits = mine && other !== undefined && other.phase !== "taking";
  // by this page, or by the one that has it then
  const isTaken = (mine && !waits) || other?.phase === "taking";
  const next = other?.wanted ? otherPage(other.wanted.by, other.wanted.claimed_name) : null;
  const state = () => {
    if (waits) return t(other.wanted?.accepted ? "control.waits.stops" : "control.waits", { who });
    if (why !== null || other === undefined || mine) return why ?? "";
    const taken = capital(t("control.taken", { who }));
    return next === null ? taken : `${taken} ${capital(t("control.next", { who: next }))}`;
  };
  if (axis !== undefined) {
    return (
      <>
        <p>{t(axis.purpose === "speed" ? "control.held.speed" : "control.held.position")}</p>
        <p class="muted">{t(`control.stop.is.${axis.stop_by}`)}</p>
        {station.status?.on_loss?.action === "keeps-turning" && <OnLoss station={station} />}
        <button type="button" onClick={() => control.release(station.id)}>
          {t("control.release")}
        </button>
      </>
    );
  }
  return (
    <>
      <p class="muted">
        <bdi>{isKnown() ? owner(station) : dash}</bdi>
      </p>
      <OnLoss station={station} />
      <details class="options">
        <summary>
          {t("control.options", {
            purpose: t(`control.purpose.${purpose.value}`),
            limit: limit.value.trim() || dash,
            travel: way === "" ? t("control.options.anywhere") : t("control.options.travel", { travel: way }),
            stop: t(`stop.by.${stopBy(station.id)}`),
          })}
          {runs.value && `, ${t("control.options.runs")}`}
        </summary>
        <label class="field">
          <span>{t("control.purpose")}</span>
          <select
            value={purpose.value}
            onChange={(event) => {
              purpose.value = event.currentTarget.value as "speed" | "position";
              tabs.of(station.id).value = "jog";
            }}
          >
            <option value="speed">{t("control.purpose.speed")}</option>
            <option value="position">{t("control.purpose.position")}</option>
          </select>
        </label>
        <Field title={t("control.limit")} value={limit} unit="rpm" />
        <Field title={t("control.travel")} value={travel} unit="rev" optional />
        <label class="field">
          <span>{t("control.stop")}</span>
          <select value={stopBy(station.id)} onChange={(event) => chooseStop(station.id, event.currentTarget.value)}>
            <option value="off3">{t("control.stop.off3")}</option>
            <option value="off1">{t("control.stop.off1")}</option>
            <option value="off2">{t("control.stop.off2")}</option>
          </select>
        </label>
        <Check of={mode}>{t("control.mode")}</Check>
        <Check of={runs}>{t("control.runs")}</Check>
        <Who />
      </details>
      {real &&
        (["see", "clear", "stop"] as const).map((line, place) => (
          <Check
            key={line}
            checked={seen.value[place] ?? false}
            onChange={(on) => {
              seen.value = seen.value.map((before, at) => (at === place ? on : before));
            }}
          >
            {t(`control.check.${line}`)}
          </Check>
        ))}
      {/* one button, so that it keeps the focus */}
      <button
        type="button"
        class="primary"
        disabled={
          !waits && (why !== null || !ready || isTaken || next !== null || highest === null || highest <= 0 || far)
        }
        onClick={() => {
          if (waits) return control.withdraw(station.id);
          const how = {
            purpose: purpose.value,
            limit: highest ?? 0,
            travel: numberOf(travel.value),
            set_mode: mode.value,
            may_run_on: runs.value,
            checks: seen.value.every(Boolean),
            stop_by: stopBy(station.id),
          };
          control.take(station.id, how, other !== undefined);
        }}
      >
        {waits
          ? t("control.withdraw")
          : t(isTaken ? "control.taking" : other === undefined ? "control.take" : "control.request")}
      </button>
      <p class="muted" role="status">
        <bdi>{state()}</bdi>
      </p>
      {/* outside of the status, which would be read out each second */}
      {waits && other.wanted?.accepted === false && (
        <p class="muted number">{t("control.waits.left", { seconds: other.wanted.seconds })}</p>
      )}
    </>
  );
}

/** The trouble of an axis that STOP stopped. */
const STOPPED = "stopped";

function Enable({ station }: { station: Station }) {
  const axis = control.own(station.id);
  const on = control.operates(axis);
  const free = axis !== undefined && !axis.busy && axis.phase !== "releasing";
  const other = axis === undefined ? control.heldAxis(station.id) : undefined;
  const present = axis ?? other;
  const phase = present ? control.phaseOf(present) : "none";
  // who pressed STOP on this page has no trouble with it
  const expected = axis?.trouble?.kind === STOPPED && control.lastStop.value?.by === control.session.value;
  const faults = station.status?.faults ?? [];
  return (
    <>
      {other && (
        <p>
          <bdi>{capital(t("control.taken", { who: otherPage(other.holder, other.claimed_name) }))}</bdi>
        </p>
      )}
      <p class={on ? "state live" : "muted"}>{isKnown() ? t(`control.phase.${phase}`) : dash}</p>
      {axis?.travel_ended && <p class="warn">{t("control.travel.ended")}</p>}
      {axis?.trouble && !expected && (
        <p class="warn">
          <bdi>{sentence([axis.trouble.text, ...faults.map(faultText)].join("; "))}</bdi>
        </p>
      )}
      <p class="buttons">
        <button
          type="button"
          class={faults.length > 0 ? "" : "primary"}
          disabled={!free || on || control.stopped.value}
          onClick={() => control.enable(station.id)}
        >
          {t("control.enable")}
        </button>
        <button type="button" disabled={axis === undefined || !on} onClick={() => control.disable(station.id)}>
          {t("control.disable")}
        </button>
        {faults.length > 0 && (
          <button type="button" class="primary" disabled={!free || on} onClick={() => control.acknowledge(station.id)}>
            {t("faults.acknowledge")}
          </button>
        )}
      </p>
      {axis && control.stopped.value && <p class="muted">{t("control.reset.first")}</p>}
    </>
  );
}

function Confirm({ id }: { id: string }) {
  const highest = numberOf(limits.of(id).value);
  const axis = control.own(id);
  if (axis?.confirmed || highest === null) return null;
  const moved = axis?.moved === true;
  return (
    <p class="buttons">
      <span class="muted small">
        {t("control.first", { limit: highest / 10 })} {!moved && t("control.confirm.move")}
      </span>
      <button type="button" disabled={!moved} onClick={() => control.confirmDirection(id)}>
        {t("control.confirm")}
      </button>
    </p>
  );
}

/** Why nothing moves the axis, in words; `null` where it can be moved. */
function refusal(station: Station): string | null {
  const axis = control.own(station.id);
  if (axis === undefined) return t("control.motion.take");
  if (control.stopped.value) return t("control.reset.first");
  return control.operates(axis) ? null : t("control.motion.enable");
}

/** Why the jog buttons are off, in words; `null` where they are on. */
function jogRefusal(station: Station, slow: boolean): string | null {
  const refused = refusal(station);
  if (refused !== null) return refused;
  const speed = numberOf(jogSpeeds.of(station.id).value);
  if (speed === null || speed <= 0) return t("control.jog.speed");
  if (control.trip.value === null) return t("control.measuring");
  return slow ? t("control.slow", { ms: Math.round(control.trip.value ?? 0) }) : null;
}

function Motion({ station }: { station: Station }) {
  const { id } = station;
  const axis = control.own(id);
  const jogSpeed = jogSpeeds.of(id);
  const speed = speeds.of(id);
  const turns = distances.of(id);
  const relative = relatives.of(id);
  const number = numbers.of(id);
  const tab = tabs.of(id);
  const off = refusal(station);
  const on = off === null;
  const slow = (control.trip.value ?? 0) > control.SLOW;
  const refused = jogRefusal(station, slow);
  const offered =
    axis?.purpose === "position" ? (["jog", "move", "home", "task"] as const) : (["jog", "velocity"] as const);
  const here = (offered as readonly string[]).includes(tab.value) ? tab.value : "jog";
  const rpm = numberOf(speed.value);
  const distance = numberOf(turns.value);
  const task = numberOf(number.value);
  const numbered = task !== null && Number.isInteger(task);
  // the drive has the speeds of homing and of tasks, which no tenth bounds
  const unconfirmed = control.own(id)?.confirmed ? null : t("control.motion.direction");
  const none = (name: string) => t("control.motion.number", { name });
  const noSpeed = rpm === null ? none(t("control.speed")) : null;
  const far = t(relative.value ? "control.distance" : "control.target");
  const noMove = distance === null ? none(far) : noSpeed;
  const noTask = numbered ? null : t("control.motion.task");
  /** Beside the first field of a kind of motion: why its button is off. */
  const why = (text: string | null) => (
    <p class="small muted" id="motion-why" role="status">
      {off ?? text}
    </p>
  );
  const halt = (
    <button type="button" class="motion" disabled={axis?.phase !== "moving"} onClick={() => control.halt(id)}>
      {t("control.halt")}
    </button>
  );
  return (
    <>
      <div class="buttons" role="tablist" aria-label={t("control.motion")}>
        {offered.map((name) => (
          <button
            key={name}
            type="button"
            role="tab"
            aria-selected={here === name}
            onClick={() => {
              tab.value = name;
            }}
          >
            {t(`control.${name}`)}
          </button>
        ))}
      </div>
      {here === "jog" && (
        <>
          <div class="beside-field">
            <Field title={t("control.speed")} value={jogSpeed} unit="rpm" />
            <p class={`small ${slow && on ? "fault" : "muted"}`} id="jog-why" role="status">
              {refused ?? t("control.keys")}
            </p>
            {/* the longest of these texts has its place, so that no other moves the pad */}
            <p class="small reserve" aria-hidden="true">
              {t("control.keys")}
            </p>
          </div>
          <JogPad drive={id} speed={numberOf(jogSpeed.value)} refused={refused !== null} slow={slow && on} />
        </>
      )}
      {here === "velocity" && (
        <>
          <div class="beside-field">
            <Field title={t("control.speed")} value={speed} unit="rpm" />
            {why(noSpeed)}
          </div>
          <p class="buttons">
            <button
              type="button"
              class="motion"
              aria-describedby="motion-why"
              disabled={!on || rpm === null}
              onClick={() => control.velocity(id, rpm ?? 0)}
            >
              {t("control.velocity.go")}
            </button>
            {halt}
          </p>
        </>
      )}
      {here === "move" && (
        <>
          <div class="beside-field">
            <Field title={far} value={turns} unit="rev" />
            {why(noMove)}
          </div>
          <Check of={relative}>{t("control.relative")}</Check>
          <Field title={t("control.speed")} value={speed} unit="rpm" />
          <p class="buttons">
            <button
              type="button"
              class="motion"
              aria-describedby="motion-why"
              disabled={!on || noMove !== null}
              onClick={() => control.move(id, distance ?? 0, relative.value, rpm ?? 0)}
            >
              {t("control.move.go")}
            </button>
            {halt}
          </p>
        </>
      )}
      {here === "home" && (
        <>
          <div class="beside-field">
            <p class="small muted" id="home-speed">
              {t("control.home.speed")}
            </p>
            {why(unconfirmed)}
          </div>
          <p class="buttons">
            <button
              type="button"
              class="motion"
              aria-describedby="home-speed motion-why"
              disabled={!on || unconfirmed !== null}
              onClick={() => control.home(id)}
            >
              {t("control.home.go")}
            </button>
            {halt}
            {axis?.homed !== null && <span>{t(axis?.homed ? "control.homed" : "control.unhomed")}</span>}
          </p>
        </>
      )}
      {here === "task" && (
        <>
          <div class="beside-field">
            <Field title={t("control.number")} value={number} unit="" />
            {why(unconfirmed ?? noTask ?? t("control.task.speed"))}
          </div>
          <p class="buttons">
            <button
              type="button"
              class="motion"
              aria-describedby="motion-why"
              disabled={!on || unconfirmed !== null || !numbered}
              onClick={() => control.task(id, task ?? 0)}
            >
              {t("control.task.go")}
            </button>
            {halt}
          </p>
        </>
      )}
      {axis !== undefined && <Confirm id={id} />}
    </>
  );
}

const WIDTH = 320;
const HEIGHT = 48;

/** Least height of a plot of a position, in revolutions: noise at rest stays small. */
const SMALL = 0.1;

/** What an axis of this page did in the last seconds: its speed, or its position where its telegram has no speed. */
function Plot({ id, unit }: { id: string; unit: string }) {
  const all = control.own(id) === undefined ? [] : control.track.value.filter(({ drive }) => drive === id);
  const speeds = all.flatMap(({ time, speed: value }) => (value === null ? [] : [{ time, value }]));
  const positions = all.flatMap(({ time, position: value }) => (value === null ? [] : [{ time, value }]));
  const still = speeds.length === 0 && positions.length > 0;
  const shown = still ? positions : speeds;
  const values = shown.map(({ value }) => value);
  const highest = Math.max(1, ...values.map(Math.abs));
  const middle = still ? (Math.min(...values) + Math.max(...values)) / 2 : 0;
  const half = still ? Math.max(SMALL, Math.max(...values) - Math.min(...values)) / 2 : highest;
  const end = shown.at(-1)?.time ?? 0;
  const points = shown.map(({ time, value }) => {
    const x = WIDTH - ((end - time) / 5000) * WIDTH;
    return `${x.toFixed(1)},${(HEIGHT / 2 - ((value - middle) / half) * (HEIGHT / 2 - 3)).toFixed(1)}`;
  });
  const caption = still
    ? t("control.plot.position", { low: minus((middle - half).toFixed(3)), high: minus((middle + half).toFixed(3)) })
    : t("control.plot", { highest: highest.toFixed(1), unit });
  return (
    <figure class="plotted">
      <svg class="plot" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} width={WIDTH} height={HEIGHT} aria-hidden="true">
        {!still && <path d={`M0 ${HEIGHT / 2}H${WIDTH}`} class="zero" />}
        <polyline points={points.join(" ")} />
      </svg>
      <figcaption>{shown.length === 0 ? t("control.plot.none") : caption}</figcaption>
    </figure>
  );
}

function minus(text: string): string {
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
}

function shown(value: number | null, decimals: number): string {
  return value === null ? dash : minus(value.toFixed(decimals));
}

/** Values that are older than this are not shown here, in s: what a person moves by is present or missing. */
const OLD = 3;

/** A beat that came too late is shown for this time, in ms. */
const LATE = 2000;

/** Whether the beats of this page arrive: without them the axis stops. */
function Beat({ held }: { held: boolean }) {
  const last = control.pulse.value;
  const at = Math.max(now.value, last?.at ?? 0);
  const state = !held
    ? "none"
    : last === null || control.old.value
      ? "missing"
      : at - control.late.value < LATE
        ? "late"
        : "fresh";
  // a half of each second, as a sign that the page lives
  const on = state !== "none" && (last?.n ?? 0) % 20 < 10;
  return (
    <span class={`beat ${state}`} data-beat={last?.n ?? 0}>
      <span class={on ? "dot on" : "dot"} aria-hidden="true" /> {t(`control.beat.${state}`)}
    </span>
  );
}

/** The values of the axis, whichever page has it. What its telegram lacks, and all of a drive that none has, was read. */
function Values({ station }: { station: Station }) {
  const { id, status } = station;
  // nothing of before a loss stands for what is not known now
  const known = isKnown();
  const axis = known ? control.heldAxis(id) : undefined;
  const held = control.own(id) !== undefined;
  const read = known && (aged(station.age) ?? OLD) < OLD ? status : null;
  // telegrams of speed have no position, and those of position no speed: then it is the one that was read
  const speed = axis?.speed ?? read?.speed_actual?.value ?? null;
  const set = axis?.speed_set ?? read?.speed_set?.value ?? null;
  const position = axis?.position ?? read?.position?.value ?? null;
  const title = (name: string, cyclic: number | null | undefined, value: number | null) =>
    axis !== undefined && (cyclic ?? null) === null && value !== null ? t("control.read", { name }) : name;
  const unit = axis?.unit ?? read?.speed_actual?.unit ?? "rpm";
  return (
    <section class={control.old.value ? "control-values stale" : "control-values"} aria-label={t("overview.values")}>
      <dl>
        <div class="value">
          <dt>{title(t("value.speed"), axis?.speed, speed)}</dt>
          <dd>
            <span class="main number">{shown(speed, 1)}</span> <span class="unit">{unit}</span>
          </dd>
        </div>
        <div class="value">
          <dt>{title(t("value.set"), axis?.speed_set, set)}</dt>
          <dd>
            <span class="number big">{shown(set, 1)}</span> <span class="unit">{unit}</span>
          </dd>
        </div>
        <div class="value">
          <dt>{title(t("value.position"), axis?.position, position)}</dt>
          <dd>
            <span class="number big">{shown(position, 3)}</span> <span class="unit">rev</span>
          </dd>
        </div>
      </dl>
      {server.value?.simulation && <Shaft id={id} />}
      <Plot id={id} unit={unit} />
      <p class="muted small number">
        <Beat held={held} />{" "}
        {t("control.trip", { ms: !held || control.trip.value === null ? dash : Math.round(control.trip.value) })}
      </p>
    </section>
  );
}

/** Time of the picture of a step, in s. */
const stepTime = signal("2");

/** Records what the next step of the set speed does, whatever moves the axis. */
function Step({ id }: { id: string }) {
  const waited = scope.step.value?.drive === id ? scope.step.value : null;
  const waits = waited !== null && !waited.done;
  const never = control.heldAxis(id)?.purpose === "position";
  return (
    <p class="buttons">
      {/* one button, so that it keeps the focus */}
      <button
        type="button"
        aria-describedby="step-none"
        disabled={never && !waits}
        onClick={() => (waits ? scope.giveUp() : scope.recordStep(id, Number(stepTime.value) * 1e6))}
      >
        {t(waits ? "scope.step.cancel" : "scope.step.record")}
      </button>
      <label class="check">
        <span>{t("scope.span")}</span>
        <select
          value={stepTime.value}
          disabled={waits}
          onChange={(event) => {
            stepTime.value = event.currentTarget.value;
          }}
        >
          {["1", "2", "5", "10"].map((seconds) => (
            <option key={seconds} value={seconds}>
              {`${seconds} s`}
            </option>
          ))}
        </select>
      </label>
      {never && (
        <span class="muted" id="step-none">
          {t("scope.step.none")}
        </span>
      )}
      {waited !== null && !never && (
        <span role="status" class="muted">
          {t(waits ? "scope.step.waits" : "scope.step.done")}
        </span>
      )}
      {waited?.done && <a href={address(id, "scope") + location.search}>{t("scope.step.open")}</a>}
    </p>
  );
}

/** Takes an axis, enables it, and moves it while its page is there. */
export function Control() {
  const { path } = useLocation();
  const id = selectedId(path);
  const station = selected(path);
  useEffect(() => {
    // whoever leaves this screen does not see the axis any more
    return () => {
      control.letGo();
      scope.leaveStep();
    };
  }, []);
  if (id === null || !station) {
    return <Nothing title={t("control.title")} select={t("control.select")} />;
  }
  const said = control.said.value.get(id) ?? null;
  return (
    <article
      class="control"
      onFocusIn={(event) => {
        if (event.target instanceof HTMLElement && event.target.matches("input, select")) control.letGo();
      }}
    >
      <div class="title">
        <h1>
          {t("control.title")} <bdi>{label(station)}</bdi>
        </h1>
        <Step id={id} />
      </div>
      <Values station={station} />
      <p role="status" class={said?.failed ? "fault" : "muted"}>
        {said && <bdi>{foreign(said.text, 600)}</bdi>}
      </p>
      <div class="steps">
        <section aria-label={t("control.step.take")}>
          <h2>
            <span class="step">1</span> {t("control.step.take")}
          </h2>
          <Take station={station} />
        </section>
        <section aria-label={t("control.step.enable")}>
          <h2>
            <span class="step">2</span> {t("control.step.enable")}
          </h2>
          <Enable station={station} />
        </section>
        <section aria-label={t("control.step.motion")}>
          <h2>
            <span class="step">3</span> {t("control.step.motion")}
          </h2>
          <Motion station={station} />
        </section>
      </div>
      <p class="muted small">{t("control.rules")}</p>
    </article>
  );
}

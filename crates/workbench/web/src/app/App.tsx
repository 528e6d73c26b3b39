import { useEffect, useRef } from "preact/hooks";
import { ErrorBoundary, LocationProvider, lazy, Route, Router, useLocation } from "preact-iso";
import { Icon, type IconName } from "../parts/Icon";
import { useLate } from "../parts/Loading";
import { Network } from "../screens/network/Network";
import { leases } from "../store/control";
import { access, quiet, server, silent } from "../store/store";
import { t } from "../text";
import { Frame } from "./Frame";
import { useKeys } from "./keys";
import { Overlay } from "./Palette";
import { address, recent, remember, type Screen, screenOf } from "./selected";
import { shown } from "./shortcuts";
import { type Theme, theme } from "./theme";

const Overview = lazy(() => import("../screens/screens").then((screens) => screens.Overview));
const Control = lazy(() => import("../screens/screens").then((screens) => screens.Control));
const Parameters = lazy(() => import("../screens/screens").then((screens) => screens.Parameters));
const Scope = lazy(() => import("../screens/screens").then((screens) => screens.Scope));
const Compare = lazy(() => import("../screens/screens").then((screens) => screens.Compare));
const Faults = lazy(() => import("../screens/screens").then((screens) => screens.Faults));
const Machine = lazy(() => import("../screens/screens").then((screens) => screens.Machine));
const Telegram = lazy(() => import("../screens/screens").then((screens) => screens.Telegram));
const Capture = lazy(() => import("../screens/screens").then((screens) => screens.Capture));
const Log = lazy(() => import("../screens/screens").then((screens) => screens.Log));
const Virtual = lazy(() => import("../screens/screens").then((screens) => screens.Virtual));

/** Keeps what follows the address: `?lang=`. */
const query = location.search;

/** The screens that a narrow page offers. */
const NARROW: readonly Screen[] = ["network", "overview", "faults"];

function Link({ href, icon, text }: { href: string; icon: IconName; text: string }) {
  const { path } = useLocation();
  const here = screenOf(path) === screenOf(href);
  return (
    <a
      href={href + query}
      aria-current={here ? "page" : undefined}
      data-narrow={NARROW.includes(screenOf(href)) ? "" : undefined}
    >
      <Icon name={icon} />
      <span>{text}</span>
    </a>
  );
}

function Navigation() {
  const id = recent(useLocation().path);
  return (
    <nav aria-label={t("nav.label")}>
      <Link href="/network" icon="network" text={t("nav.network")} />
      <Link href={address(id, "overview")} icon="overview" text={t("nav.overview")} />
      <Link href={address(id, "control")} icon="live" text={t("nav.control")} />
      <Link href={address(id, "parameters")} icon="parameters" text={t("nav.parameters")} />
      <Link href={address(id, "scope")} icon="scope" text={t("nav.scope")} />
      <Link href={address(id, "faults")} icon="triangle" text={t("nav.faults")} />
      <Link href={address(id, "compare")} icon="compare" text={t("nav.compare")} />
      <Link href={address(id, "machine")} icon="machine" text={t("nav.machine")} />
      <Link href={address(id, "telegram")} icon="telegram" text={t("nav.telegram")} />
      <Link href="/capture" icon="capture" text={t("nav.capture")} />
      <Link href="/log" icon="log" text={t("nav.log")} />
      {server.value?.simulation && <Link href="/virtual" icon="virtual" text={t("nav.virtual")} />}
      <button
        type="button"
        class="plain help"
        onClick={() => {
          shown.value = "keys";
        }}
      >
        {t("keys.title")} <kbd>?</kbd>
      </button>
      <label class="theme">
        <span>{t("theme.label")}</span>
        <select
          value={theme.value}
          onChange={(event) => {
            theme.value = event.currentTarget.value as Theme;
          }}
        >
          <option value="system">{t("theme.system")}</option>
          <option value="light">{t("theme.light")}</option>
          <option value="dark">{t("theme.dark")}</option>
          <option value="contrast">{t("theme.contrast")}</option>
        </select>
      </label>
    </nav>
  );
}

function Shell() {
  const { path } = useLocation();
  useKeys();
  const first = useRef(true);
  useEffect(() => {
    remember(path);
    // the focus goes where the new screen begins: the link or field that led there may be gone
    if (!first.current) document.getElementById("content")?.focus({ preventScroll: true });
    first.current = false;
    document.title = `${t(`nav.${screenOf(path)}`)} - ${t("app.title")}`;
  }, [path]);
  return (
    <div class={`shell ${silent.value === null ? "" : "lost"} ${leases.value.size > 0 ? "in-control" : ""}`}>
      <a class="skip" href="#content">
        {t("nav.skip")}
      </a>
      <Frame />
      <Overlay />
      <div class="body">
        <Navigation />
        <main id="content" tabIndex={-1} class={quiet.value ? "stale" : ""}>
          {!NARROW.includes(screenOf(path)) && <p class="narrow muted">{t("nav.narrow")}</p>}
          <ErrorBoundary>
            <Router>
              <Route path="/" component={Network} />
              <Route path="/network" component={Network} />
              <Route path="/drives/:id/overview" component={Overview} />
              <Route path="/drives/:id/control" component={Control} />
              <Route path="/drives/:id/parameters" component={Parameters} />
              <Route path="/drives/:id/scope" component={Scope} />
              <Route path="/drives/:id/faults" component={Faults} />
              <Route path="/drives/:id/compare" component={Compare} />
              <Route path="/drives/:id/machine" component={Machine} />
              <Route path="/drives/:id/telegram" component={Telegram} />
              <Route path="/capture" component={Capture} />
              <Route path="/log" component={Log} />
              <Route path="/virtual" component={Virtual} />
              <Route default component={Network} />
            </Router>
          </ErrorBoundary>
        </main>
      </div>
    </div>
  );
}

/** What stands here until the workbench lets this browser in: usually for so short a time that words would only flicker. */
function Entering() {
  if (!useLate()) return null;
  return (
    <main class="login">
      <h1>{t("app.title")}</h1>
      <p role="status">{t("loading.waits", { what: t("loading.workbench") })}</p>
    </main>
  );
}

export function App() {
  const state = access.value;
  if (state.kind === "entering") {
    return <Entering />;
  }
  if (state.kind === "out") {
    return (
      <main class="login">
        <h1>{t(state.silent ? "app.title" : "login.title")}</h1>
        <p role="alert">{state.reason}</p>
      </main>
    );
  }
  return (
    <LocationProvider>
      <Shell />
    </LocationProvider>
  );
}

import type { FrameNode, FrameReport } from "../../api";
import { foreign, sentence } from "../../parts/format";
import { t } from "../../text";
import { octets } from "../telegram/nodes";
import { range } from "./state";

function Field({ node, depth }: { node: FrameNode; depth: number }) {
  const [start, end] = range.value;
  const chosen = start === node.start && end === node.end;
  return (
    <>
      <li class={`depth-${Math.min(depth, 8)}`}>
        <button
          type="button"
          class="plain"
          aria-pressed={chosen}
          data-field={node.name}
          onClick={() => {
            range.value = [node.start, node.end];
          }}
        >
          <span class={node.weight === "error" ? "fault" : node.weight === "warning" ? "warn" : ""}>
            {foreign(node.name)}
          </span>{" "}
          <bdi class="muted">{foreign(node.value, 300)}</bdi>
        </button>
      </li>
      {node.children?.map((child, number) => (
        <Field key={number} node={child} depth={depth + 1} />
      ))}
    </>
  );
}

/** One frame: its fields, and its octets with those of the field that is selected. */
export function Frame({ shown }: { shown: FrameReport }) {
  const all = octets(shown.octets);
  const [start, end] = range.value;
  return (
    <section class="one-frame">
      <h2>
        {t("capture.one", { number: shown.frame })}
        <span class="muted small number">{shown.time.toFixed(6)} s</span>
      </h2>
      {shown.texts.map((text) => (
        <p key={text}>
          <bdi>{sentence(text)}</bdi>
        </p>
      ))}
      <div class="frame-columns">
        {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
        <ul class="tree" tabIndex={0} aria-label={t("capture.tree")}>
          <Field node={shown.tree} depth={0} />
        </ul>
        {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
        <section class="hex number" tabIndex={0} aria-label={t("capture.octets")}>
          {Array.from({ length: Math.ceil(all.length / 16) }, (_, line) => (
            <p key={line}>
              <span class="muted">{(line * 16).toString(16).toUpperCase().padStart(4, "0")}</span>{" "}
              {all.slice(line * 16, line * 16 + 16).map((octet, column) => {
                const at = line * 16 + column;
                return (
                  <span key={column} class={at >= start && at < end ? "octet marked" : "octet"}>
                    {octet}
                  </span>
                );
              })}
            </p>
          ))}
        </section>
      </div>
    </section>
  );
}

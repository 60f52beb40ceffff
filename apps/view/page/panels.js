// The panel's sections of options, made from the program's tables. Options that no section names are in the last one.
import { by_id, element, section, segments } from "./dom.js";
import { state, hooks, side_edited, look_of, default_look, technique_of, technique_of_look, scene_now, is_flat } from "./state.js";
import { name_of } from "./names.js";
import { row } from "./controls.js";
import { light_ball } from "./light.js";
import { refresh_search } from "./search.js";

const kSections = [
  ["occlusion", "Ambient shadow", true, ["ao-radius", "ao-strength", "ao-scale"]],
  ["light", "Light", true, ["light-direction", "key", "fill", "rim", "shadow-strength", "light-size", "lights"]],
  [
    "environment",
    "Surroundings",
    false,
    ["hdri-file", "hdri-intensity", "hdri-rotation", "hdri-ambient", "hdri-skybox"],
  ],
  ["section", "Cut", false, ["section", "explode"]],
  ["picture", "Picture", false, ["exposure", "contrast", "anti-aliasing", "material", "color", "style"]],
  ["background", "Background and ground", false, ["background-color", "no-background", "ground"]],
];
const kElsewhere = /^(look|ao|quality|set|device|effects|resolution|passes|svg|bits|threads|isa|camera-.*)$/;
// Passes that have a button; the others are in a list.
const kShown = ["ao", "indirect", "depth", "normal", "albedo", "shadow", "outline", "line"];

const kTraced = [
  ["reference", "the picture with ray-traced occlusion"],
  ["error", "difference of the occlusion from the ray-traced reference"],
];

const rows = [];
let effect_rows = [];
let effects_of = ""; // what the sections of effects were made for

const option_named = (name) => state.hello.options.find((option) => option.name === name);
const applies = (option) =>
  option && (!option.repeated || option.name === "section") && (is_flat() ? option.gbuffer : option.model) !== false;
const effect_named = (name) => state.hello.effects.find((effect) => effect.name === name);

/// Sets an option of the edited side; undefined: its default.
export function set_option(name, text, moving = false) {
  const side = side_edited();
  if (text === undefined) delete side.options[name];
  else side.options[name] = text;
  hooks.changed(moving);
}

export function set_parameter(name, text, moving = false) {
  const side = side_edited();
  if (text === undefined) delete side.set[name];
  else side.set[name] = text;
  hooks.changed(moving);
}

const radius_now = () => scene_now()?.radius || 1;

export const option_access = (name) => ({
  get: () => side_edited().options[name],
  set: (text, moving) => set_option(name, text, moving),
  radius: radius_now,
});
const parameter_access = (name) => ({
  get: () => side_edited().set[name],
  set: (text, moving) => set_parameter(name, text, moving),
  radius: radius_now,
});

function option_row(option) {
  const named = { ...option, technical: `--${option.name}` };
  const made = row(named, name_of("option", option.name), option_access(option.name), `option-${option.name}`);
  rows.push(made);
  return made.root;
}

/// Adds a button to `parts` that calls `reset`. It is hidden while none of the rows is changed. Returns {refresh}.
function reset_button(parts, rows_of_section, reset) {
  const button = element("button", { type: "button", class: "quiet reset", text: "Reset section", on_click: reset });
  const refresh = () => (button.hidden = !rows_of_section.some((made) => made.root.classList.contains("changed")));
  parts.push(button);
  return { refresh };
}

function options_section([id, title, is_open, names]) {
  const first = rows.length,
    parts = [];
  const known = names.map(option_named).filter(applies);
  if (!known.length) return null;
  if (known.some((option) => option.name === "light-direction")) {
    const ball = light_ball(option_access("light-direction"));
    rows.push(ball);
    parts.push(ball.root);
  }
  for (const option of known) parts.push(option_row(option));
  if (id === "environment") parts.push(...environment_buttons());
  const own = rows.slice(first).filter((made) => made.root.classList.contains("row"));
  rows.push(
    reset_button(parts, own, () => {
      for (const option of known) delete side_edited().options[option.name];
      hooks.changed(false);
    }),
  );
  return section(id, title, is_open, ...parts);
}

function environment_buttons() {
  const choose = () => by_id("file_environment").click();
  return [
    element(
      "div",
      { class: "buttons" },
      element("button", { type: "button", text: "Clear sky", on_click: () => set_option("hdri-file", "sky:") }),
      element("button", { type: "button", text: "Open an image…", on_click: choose }),
    ),
  ];
}

// Look, technique and quality.

/// `entries` of refresh(value, entries): value, plain name and technical name of each choice.
function described_select(id, option, summary_of, chosen) {
  const summary = element("p", { class: "summary", id: `${id}_summary` });
  const select = element("select", {
    id,
    "data-testid": id,
    "aria-describedby": `${id}_summary`,
    on_change: () => chosen(select.value || undefined),
  });
  const refresh = (value, entries) => {
    const key = entries.map(([name, text]) => name + text).join("|");
    if (select.dataset.key !== key) {
      select.dataset.key = key;
      select.replaceChildren(...entries.map(([name, text, title]) => element("option", { value: name, text, title })));
    }
    select.value = value;
    select.title = `--${option} ${select.selectedOptions[0]?.title}`;
    summary.textContent = summary_of();
  };
  return {
    refresh,
    nodes: [
      element(
        "div",
        { class: "row wide" },
        element("label", { for: id, text: name_of("option", option) }),
        element("div", { class: "control" }, select),
      ),
      summary,
    ],
  };
}

function look_section() {
  const is_auto = () => is_flat() && !scene_now()?.look && !side_edited().options.look;
  const look = described_select(
    "look",
    "look",
    () => (is_auto() ? "chosen by what the file holds" : (look_of(side_edited())?.summary ?? "")),
    (name) => set_option("look", !is_flat() && name === default_look() ? undefined : name),
  );
  const technique = described_select(
    "technique",
    "ao",
    () => {
      const name = technique_of(side_edited());
      if (is_auto() && !side_edited().options.ao) return "";
      return effect_named(name)?.summary ?? (name === "none" ? "no occlusion" : "");
    },
    (name) => set_option("ao", name),
  );
  const kinds = [
    ["", "default", "the quality that the look sets"],
    ...(option_named("quality")?.choices ?? []).map((name) => [name, name]),
  ];
  const quality = segments("Quality", "quality", kinds, (name) => set_option("quality", name || undefined));
  rows.push({
    root: quality.root,
    refresh: () => {
      const side = side_edited();
      const looks = state.hello.looks
        .filter((entry) => is_flat() || !entry.gbuffer)
        .map((entry) => [entry.name, name_of("look", entry.name), entry.name]);
      const found = scene_now()?.look;
      if (is_flat())
        look.refresh(side.options.look ?? "", [
          ["", `automatic: ${found ? name_of("look", found) : "by the planes"}`, "auto"],
          ...looks,
        ]);
      else look.refresh(look_of(side)?.name, looks);
      const own = technique_of_look(side);
      const techniques = (option_named("ao")?.choices ?? []).filter((name) => name !== "reference");
      technique.refresh(side.options.ao ?? "", [
        ["", is_auto() || !own ? "automatic" : `Default: ${name_of("effect", own)}`, own ?? "auto"],
        ...techniques.map((name) => [name, name_of("effect", name), name]),
      ]);
      quality.show(side.options.quality);
    },
  });
  return section("look", "Look", true, ...look.nodes, ...technique.nodes, quality.root);
}

// What is shown.

function show_section() {
  const box = element("div", { id: "shows" });
  const number = element("p", { class: "summary", id: "error_number", "aria-live": "polite" });
  let made_for = null,
    buttons = null,
    more = null;
  const set = (show) => {
    side_edited().show = show;
    hooks.changed(false);
  };
  const refresh = () => {
    const side = side_edited(),
      passes = look_of(side)?.passes ?? [];
    const key = passes.map((pass) => pass.name).join() + is_flat();
    if (made_for !== key) {
      made_for = key;
      const chips = passes.filter((pass) => kShown.includes(pass.name));
      const entries = [
        ["picture", "the finished picture"],
        ...chips.map((pass) => [pass.name, pass.summary]),
        ...(is_flat() ? [] : kTraced),
      ].map(([name, summary]) => [name, name_of("show", name), `${name}: ${summary}`]);
      buttons = segments("Show", "show", entries, set);
      buttons.root.classList.add("chips");
      const rest = passes.filter((pass) => !kShown.includes(pass.name) && !["beauty", "all"].includes(pass.name));
      more = element(
        "select",
        { "aria-label": "Other images", "data-testid": "show-more", on_change: () => more.value && set(more.value) },
        element("option", { value: "", text: "Other images" }),
        ...rest.map(({ name, summary }) =>
          element("option", { value: name, text: name_of("show", name), title: `${name}: ${summary}` }),
        ),
      );
      box.replaceChildren(buttons.root, ...(rest.length ? [more] : []));
    }
    buttons.show(side.show);
    more.value = [...more.options].some((option) => option.value === side.show) ? side.show : "";
  };
  rows.push({ root: box, refresh });
  return section("show", "Show", true, box, number);
}

// Effects in use.

function effect_section(name, is_open) {
  const effect = effect_named(name),
    parts = [element("p", { class: "summary", text: effect.summary })],
    made = [];
  for (const parameter of effect.parameters) {
    if (parameter.name === "sample_index") continue;
    const full = `${name}.${parameter.name}`,
      own = look_of(side_edited())?.presets?.[full];
    const entry = { ...parameter, initial: own ?? parameter.initial, technical: `--set ${full}` };
    const one = row(entry, name_of("parameter", full), parameter_access(full), `parameter-${full}`);
    made.push(one);
    parts.push(one.root);
  }
  effect_rows.push(...made);
  effect_rows.push(
    reset_button(parts, made, () => {
      for (const key of Object.keys(side_edited().set)) if (key.startsWith(name + ".")) delete side_edited().set[key];
      hooks.changed(false);
    }),
  );
  const title = `${effect.kind === "occlusion" ? "Ambient shadow: " : ""}${name_of("effect", name)}`;
  return section(`effect_${name}`, title, is_open, ...parts);
}

/// Returns the names of the effects that the edited side runs, in order.
export function effects_in_use() {
  const side = side_edited(),
    technique = technique_of(side);
  const names = (look_of(side)?.effects ?? []).map((name) => (name === "occlusion" ? technique : name));
  return [...new Set(names)].filter((name) => effect_named(name)?.parameters.length);
}

function refresh_effects() {
  const names = effects_in_use(),
    key = [look_of(side_edited())?.name, ...names].join();
  if (effects_of !== key) {
    effects_of = key;
    effect_rows = [];
    const box = by_id("effects"),
      open = new Set([...box.children].filter((part) => part.open).map((part) => part.id));
    const technique = technique_of(side_edited());
    box.replaceChildren(...names.map((name) => effect_section(name, open.has(`section_effect_${name}`))));
    const first = by_id(`section_effect_${technique}`);
    if (first) box.prepend(first);
    refresh_search();
  }
  for (const made of effect_rows) made.refresh();
}

/// Makes all sections of options. Returns {first, groups, last}: elements, each list in the order of the panel.
export function make_panels() {
  rows.length = 0;
  effects_of = "";
  const named = new Set(kSections.flatMap(([, , , names]) => names));
  const parts = [look_section(), show_section()];
  const groups = kSections.map(options_section).filter(Boolean);
  const rest = state.hello.options.filter(
    (option) => !named.has(option.name) && !kElsewhere.test(option.name) && !/^(Output|Files)$/.test(option.group),
  );
  const more = options_section(["more", "More options", false, rest.map((option) => option.name)]);
  const effects = element(
    "div",
    { id: "effects_box" },
    element("p", { class: "kicker", text: "Details of the look" }),
    element("div", { id: "effects" }),
  );
  return { first: parts, groups, last: [effects, more].filter(Boolean) };
}

export function refresh_panels() {
  for (const made of rows) made.refresh();
  refresh_effects();
}

// Export: a file of the picture, the state as a command, as Python, as C++ or as settings, and a link.
import { by_id, element, section, complain, complain_of_unknown, announce, download, copy_text } from "./dom.js";
import { state, hooks, side_edited, side_b, options_of, model_now, is_flat, new_side, take_options, fragment_of_state } from "./state.js";
import { framed } from "./camera.js";
import { size_asked } from "./stage.js";
import { name_of } from "./names.js";
import { parse_vector } from "./math.js";
import { hex_of } from "./controls.js";
import { uploaded_name, with_upload_names } from "./files.js";

const kFormats = ["png", "exr", "svg", "jpg", "webp"];

/// Returns a word for a POSIX shell.
export const shell_word = (text) => (/^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

const file_now = () => uploaded_name(model_now()?.file) ?? model_now()?.file ?? model_now()?.name ?? "MODEL";
const field_of = (name) => state.hello.options.find((option) => option.name === name)?.field;
const kind_of = (name) => state.hello.options.find((option) => option.name === name)?.kind ?? "text";

/// Returns the side that is exported: the one that is seen, of two the one that the panel changes.
function side_taken() {
  if (state.compare === "off") return state.a;
  return state.compare === "b" ? side_b() : side_edited();
}

/// Returns the options of a side with the device and what is shown, as they are saved and copied. A picture of another
/// shape than the view's shows all of the view.
function all_options(side, size) {
  const camera = state.cameras.get(state.model);
  const options = options_of(side, camera && size ? framed(camera, size, size_asked()) : camera);
  if (side.device) options.device = side.device;
  if (side.show === "reference") options.ao = "reference";
  else if (!["picture", "error"].includes(side.show)) options.passes = side.show;
  return options;
}

/// Returns the options as they are copied: with the name that an uploaded environment had, since the upload is temporary.
function copied_options(side, size) {
  const options = all_options(side, size),
    uploaded = uploaded_name(options["hdri-file"]);
  return uploaded ? { ...options, "hdri-file": uploaded } : options;
}

/// Returns what must be done with uploaded files before a copied text is used, or "".
function remark_of(side) {
  const names = [model_now()?.file, side.options["hdri-file"]].map(uploaded_name).filter(Boolean);
  return names.length ? `put ${names.join(" and ")} where you run this` : "";
}

/// Returns a copied text below a comment with what must be done before.
function with_remark(comment, side, text) {
  const remark = remark_of(side);
  return remark ? `${comment} ${remark}\n${text}` : text;
}

/// Returns the command line that draws the picture.
export function command_of(side, size) {
  const words = ["umbrage", is_flat() ? "shade" : "render", shell_word(file_now())];
  for (const [name, value] of Object.entries(copied_options(side, size))) {
    if (name === "set") for (const entry of value) words.push("--set", shell_word(entry));
    else if (kind_of(name) !== "flag")
      words.push(/^[-+]/.test(value) ? `--${name}=${shell_word(value)}` : `--${name} ${shell_word(value)}`);
    else if (value === "true" && name !== "hdri-ambient") words.push(`--${name}`);
    else if (value === "false" && name === "hdri-ambient") words.push(`--${name}=false`);
  }
  if (!is_flat()) words.push(`--resolution ${size.join(",")}`);
  return with_remark("#", side, [...words, "-o", `picture.${by_id("save_format")?.value ?? "png"}`].join(" "));
}

/// Calls write(field, kind, text) for every option that the libraries have.
function for_fields(side, size, write) {
  for (const [name, text] of Object.entries(copied_options(side, size))) {
    const field = field_of(name);
    if (field && name !== "set") write(field, kind_of(name), text);
  }
}

const color_values = (text) => {
  const hex = hex_of(text);
  return hex ? [1, 3, 5].map((i) => Number((parseInt(hex.slice(i, i + 2), 16) / 255).toFixed(7))) : null;
};

/// Returns the numbers of an option that is a list of numbers, else null.
function values_of(kind, text) {
  if (kind === "vector") return parse_vector(text);
  if (kind === "color") return color_values(text);
  return kind === "angles" ? text.split(",").map(Number) : null;
}

function python_value(kind, text) {
  if (kind === "flag") return text === "true" ? "True" : "False";
  if (kind === "integer" || kind === "number") return String(Number(text));
  if (kind === "words")
    return `(${text
      .split(",")
      .map((word) => `${JSON.stringify(word)},`)
      .join(" ")})`;
  const values = values_of(kind, text);
  return values ? `(${values.join(", ")})` : JSON.stringify(text);
}

/// Returns a script that draws the picture.
export function python_of(side, size) {
  const camera = [],
    rest = [];
  for_fields(side, size, (field, kind, text) => {
    if (field.startsWith("camera.")) camera.push(`"${field.slice(7)}": ${python_value(kind, text)}`);
    else rest.push(`${field}=${python_value(kind, text)}`);
  });
  const settings = Object.entries(side.set).map(([name, text]) => `${JSON.stringify(name)}: ${JSON.stringify(text)}`);
  if (camera.length) rest.push(`camera={${camera.join(", ")}}`);
  if (settings.length) rest.push(`settings={${settings.join(", ")}}`);
  if (!is_flat()) rest.unshift(`size=(${size.join(", ")})`);
  const call = is_flat() ? "shade_files" : "render";
  const words = [JSON.stringify(file_now()), ...rest].join(",\n    ");
  return with_remark("#", side, `import umbrage\n\numbrage.${call}(${words}).save("picture.png")\n`);
}

const as_float = (value) => (Number.isInteger(value) ? `${value}.0f` : `${value}f`);

function cpp_value(field, kind, text) {
  if (kind === "flag") return text;
  if (kind === "integer") return String(Number(text));
  if (kind === "number") return as_float(Number(text));
  if (kind === "words")
    return `{${text
      .split(",")
      .map((word) => JSON.stringify(word))
      .join(", ")}}`;
  const values = values_of(kind, text);
  if (!values) return JSON.stringify(text);
  const is_double = /position|focal_point/.test(field);
  const number = (value) => (is_double ? (Number.isInteger(value) ? `${value}.0` : String(value)) : as_float(value));
  return `std::array{${values.map(number).join(", ")}}`;
}

/// Returns a program that draws the picture.
export function cpp_of(side, size) {
  const request = is_flat() ? "ShadeRequest" : "RenderRequest";
  const lines = [
    `umb::${request} request;`,
    `request.${is_flat() ? "file" : "model"} = ${JSON.stringify(file_now())};`,
  ];
  if (!is_flat()) lines.push(`request.width = ${size[0]};`, `request.height = ${size[1]};`);
  for_fields(side, size, (field, kind, text) => lines.push(`request.${field} = ${cpp_value(field, kind, text)};`));
  const settings = Object.entries(side.set).map(([name, text]) => JSON.stringify(`${name}=${text}`));
  if (settings.length) lines.push(`request.settings = {${settings.join(", ")}};`);
  lines.push(
    "umb::Picture picture;",
    `umb::Outcome outcome = umb::${is_flat() ? "shade" : "render"}(request, picture);`,
    'if (outcome.code == 0) outcome = umb::save(picture, "picture.png");',
  );
  lines.push("return outcome.code;");
  const body = lines.map((line) => `  ${line}\n`).join("");
  return with_remark("//", side, `#include <array>\n\n#include "umbrage/umbrage.hpp"\n\nint main() {\n${body}}\n`);
}

function settings_text() {
  const options = copied_options(side_taken());
  delete options.passes;
  return JSON.stringify(options, null, 2) + "\n";
}

const is_object = (value) => typeof value === "object" && value !== null && !Array.isArray(value);

/// Returns the objects of options in a file of settings: those of all commands, then those of `render`, `shade` and
/// `view`. Objects of other commands are left out.
function parts_of_settings(settings) {
  const of_all = Object.fromEntries(Object.entries(settings).filter(([, value]) => !is_object(value)));
  return [of_all, ...["render", "shade", "view"].map((name) => settings[name]).filter(is_object)];
}

async function load_settings(file) {
  try {
    const options = JSON.parse(await file.text());
    if (!is_object(options)) throw new Error("it is not an object");
    const side = side_edited();
    Object.assign(side, new_side(), { show: side.show });
    const parts = parts_of_settings(options);
    const unknown = parts.flatMap((part) => take_options(side, part));
    hooks.take_camera(Object.assign({}, ...parts));
    hooks.changed(false);
    complain_of_unknown(unknown, file.name);
    announce(`Settings of ${file.name}`);
  } catch (error) {
    complain(`${file.name} is not a file of settings: ${error.message}`);
  }
}

/// Returns what is saved and copied if it is not all that is seen.
function note_of(side) {
  const is_one = !["off", "b"].includes(state.compare);
  const of_side = is_one ? ` of ${state.b && state.edited === "b" ? "B" : "A"}` : "";
  if (side.show === "error") return `The map of the error cannot be saved: Save and Copy give the picture${of_side}.`;
  if (side.show === "picture") return is_one ? `Save and Copy give the picture${of_side} alone.` : "";
  return `Save and Copy give this image${of_side}: ${name_of("show", side.show).toLowerCase()}.`;
}

const size_wanted = () =>
  by_id("save_size").value
    ? size_asked().map((side) => side * Number(by_id("save_size").value))
    : [Number(by_id("save_width").value), Number(by_id("save_height").value)];

/// Shows the sizes and the note of what is exported.
export function refresh_take() {
  const note = by_id("take_note"),
    text = note_of(side_taken()),
    seen = size_asked();
  note.textContent = text;
  note.hidden = !text;
  for (const entry of by_id("save_size").options)
    if (entry.value) entry.textContent = `${entry.value}×: ${seen.map((side) => side * Number(entry.value)).join(" × ")}`;
  by_id("save_size").hidden = is_flat();
  by_id("own_size").hidden = is_flat() || by_id("save_size").value !== "";
  const format = by_id("save_format").value.toUpperCase(),
    what = is_flat() ? format : `${format}, ${size_wanted().join(" × ")} pixels`;
  by_id("save_now").title = `Save the picture (Ctrl+S): ${what}. Export in the panel has other sizes and formats.`;
}

/// Writes the picture as the section says and gives it to the user. One at a time.
export async function save() {
  const buttons = [by_id("save"), by_id("save_now")],
    [width, height] = size_wanted(),
    format = by_id("save_format").value;
  if (buttons[0].disabled) return;
  for (const button of buttons) button.disabled = button.ariaBusy = true;
  try {
    const options = all_options(side_taken(), [width, height]);
    const body = JSON.stringify({ options, model: state.model, format, width, height });
    const answer = await fetch(new URL("save", document.baseURI), {
      method: "POST",
      body,
      headers: { "Content-Type": "application/json" },
    });
    if (!answer.ok)
      throw new Error((await answer.json().catch(() => ({}))).error ?? `the program answered ${answer.status}`);
    const name = `${(model_now()?.name ?? "picture").replace(/\.\w+$/, "").replace(/[^\w.-]+/g, "_")}.${format}`;
    download(await answer.blob(), name);
    announce(`Saved ${name}`);
  } catch (error) {
    complain(`Not saved: ${with_upload_names(error.message)}`, "save");
  }
  for (const button of buttons) button.disabled = button.ariaBusy = false;
}

export function take_section() {
  const number = (id, label, value) =>
    element("input", { type: "number", id, "aria-label": label, min: 1, max: 16384, value, class: "number", on_change: refresh_take });
  const button = (id, text, act) => element("button", { type: "button", id, text, on_click: act });
  const text = element("pre", { id: "copied", tabindex: 0, "aria-label": "The copied text", hidden: true });
  const copy = (make) => () => {
    text.textContent = make(side_taken(), size_wanted());
    text.hidden = false;
    copy_text(text.textContent);
  };
  const file = element("input", {
    type: "file",
    id: "settings_file",
    accept: ".json",
    class: "unseen",
    tabindex: -1,
    "aria-label": "File of settings",
    on_change: () => file.files[0] && load_settings(file.files[0]),
  });
  return section(
    "take",
    "Export",
    false,
    element("p", { class: "kicker", text: "Picture as in the view, in pixels" }),
    element(
      "div",
      { class: "save" },
      element(
        "select",
        { id: "save_size", "aria-label": "Size", on_change: refresh_take },
        ...["1", "2", "4"].map((factor) => element("option", { value: factor })),
        element("option", { value: "", text: "own size" }),
      ),
      element(
        "select",
        { id: "save_format", "aria-label": "Format", on_change: refresh_take },
        ...kFormats.map((name) => element("option", { value: name, text: name.toUpperCase() })),
      ),
      button("save", "Save", save),
    ),
    element(
      "div",
      { class: "save", id: "own_size", hidden: true },
      number("save_width", "Width in pixels", 1920),
      element("span", { text: "×" }),
      number("save_height", "Height in pixels", 1080),
    ),
    element("p", { class: "summary", id: "take_note", hidden: true }),
    element("p", { class: "kicker", text: "Copy as" }),
    element(
      "div",
      { class: "buttons" },
      button("copy_command", "Command line", copy(command_of)),
      button("copy_python", "Python", copy(python_of)),
      button("copy_cpp", "C++", copy(cpp_of)),
      button("copy_link", "Link", () => copy_text(location.href.split("#")[0] + "#" + fragment_of_state())),
    ),
    text,
    element("p", { class: "kicker", text: "Settings" }),
    element(
      "div",
      { class: "buttons" },
      button("settings_save", "Download JSON", () =>
        download(new Blob([settings_text()], { type: "application/json" }), "umbrage.json"),
      ),
      button("settings_load", "Load…", () => file.click()),
      file,
    ),
  );
}

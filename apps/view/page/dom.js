// Elements of the page.

export const by_id = (id) => document.getElementById(id);
export const is_calm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/// Makes an element. `properties` are attributes, but `on_NAME` is a listener and `text` the content; false omits one.
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on_")) made.addEventListener(name.slice(3), value);
    else if (name === "text") made.textContent = value;
    else made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

let last_id = 0;
export const new_id = () => `c${++last_id}`;

/// Makes a group of radio buttons that looks like one switch. `entries`: [value, text, help]. Returns {root, show}.
export function segments(label, name, entries, chosen) {
  const inputs = entries.map(([value]) =>
    element("input", { type: "radio", name, value, on_change: () => chosen(value) }),
  );
  const parts = entries.map(([value, text, help], i) =>
    element(
      "label",
      { title: help, "data-testid": `${name}-${value || "auto"}` },
      inputs[i],
      element("span", { text }),
    ),
  );
  const root = element("fieldset", { class: "segments" }, element("legend", { text: label }), ...parts);
  return { root, show: (value) => inputs.forEach((input) => (input.checked = input.value === (value ?? ""))) };
}

let typed = null;
/// Whether the text in a box has been changed and not yet been taken.
export const is_typed = (box) => typed === box;
addEventListener("input", (event) => (typed = event.target), true);
for (const end of ["change", "focusout"]) addEventListener(end, () => (typed = null), true);

/// Makes a section of the panel that opens and closes.
export function section(id, title, is_open, ...children) {
  const head = element("summary", {}, element("h2", { text: title }));
  return element("details", { id: `section_${id}`, "data-testid": `section-${id}`, open: is_open }, head, ...children);
}

/// Says something in the status line, to screen readers too.
export function announce(text) {
  by_id("said").textContent = text;
  clearTimeout(announce.timer);
  announce.timer = setTimeout(() => (by_id("said").textContent = ""), 4000);
}

const kMaxErrors = 4; // boxes shown at once

/// Shows an error until it is dismissed. With a key it replaces the one of the same key, and `forgive` removes it.
export function complain(text, key) {
  const box = by_id("errors");
  if (key) forgive(key);
  for (const old of [...box.children]) if (old.firstChild.textContent === text) old.remove();
  const close = element("button", {
    type: "button",
    "aria-label": "Dismiss",
    text: "×",
    on_click: () => shown.remove(),
  });
  const shown = element(
    "div",
    { class: "error", "data-key": key, "data-testid": "error" },
    element("span", { text }),
    close,
  );
  box.append(shown);
  while (box.children.length > kMaxErrors) (box.querySelector("[data-key]") ?? box.firstChild).remove();
}

export function forgive(key) {
  for (const old of [...by_id("errors").children]) if (old.dataset.key === key) old.remove();
}

/// Names options that are left out, if there are any. `source`: where they come from.
export function complain_of_unknown(names, source) {
  if (!names.length) return;
  const is_one = names.length === 1;
  complain(`${source}: the program does not know ${names.join(", ")}, which ${is_one ? "is" : "are"} left out.`);
}

/// Gives the user a file.
export function download(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

/// Keeps a choice of the user for the next visit. A sandboxed frame has no storage: it lasts as long as the page.
export function keep(name, text) {
  try {
    localStorage.setItem(`umbrage-${name}`, text);
  } catch {}
}

export function kept(name) {
  try {
    return localStorage.getItem(`umbrage-${name}`) ?? "";
  } catch {
    return "";
  }
}

/// Puts a text on the clipboard. Pages that are not secure have no clipboard but execCommand.
export async function copy_text(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = element("textarea", { "aria-hidden": "true", class: "unseen" });
    area.value = text;
    document.body.append(area);
    area.select();
    const is_copied = document.execCommand("copy");
    area.remove();
    if (!is_copied) return complain("The browser does not allow the page to copy; the text is below the buttons.");
  }
  announce("Copied");
}

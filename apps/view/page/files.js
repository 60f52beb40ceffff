// Files that are dropped on the page or chosen: uploaded, then opened as a model, an environment or a G-buffer.
import { by_id, complain, announce } from "./dom.js";
import { hooks } from "./state.js";

// Endings of the main file of a drop, the most telling first; its other files are materials, textures and buffers.
const kModels = ["gltf", "glb", "obj", "fbx", "dae", "3ds", "3mf", "ply", "stl", "off", "pdb", "xyz", "pts"];
const kEnvironments = ["hdr", "pic"];
const kGbuffers = ["npy", "npz", "pfm", "tif", "tiff", "asc"];
const kEither = ["exr", "png", "jpg", "jpeg"];

const kDropLength = 24; // of the name of a drop: so long that no folder of a user looks like one

/// Returns the name that an uploaded file had, or null for a file that is not an upload.
export const uploaded_name = (file) => kUploaded.exec(file ?? "")?.[1] ?? null;
const kUploaded = new RegExp(`(?:^|/)[a-z0-9]{${kDropLength}}/([^/]+)$`);

/// Returns a sentence of the program with the names of uploaded files in place of their temporary paths.
export const with_upload_names = (sentence) => sentence.replaceAll(kUploadFolder, "");
const kUploadFolder = new RegExp(`/[^'"\\n]*/[a-z0-9]{${kDropLength}}/`, "g");

const ending_of = (name) => (/\.([a-z0-9]+)$/i.exec(name.replace(/\.gz$/i, ""))?.[1] ?? "").toLowerCase();

/// Returns the main file of a drop and what it is: "model", "environment", "gbuffer", or "" if the user must say.
export function main_file(names) {
  for (const [endings, as] of [
    [kModels, "model"],
    [kEnvironments, "environment"],
    [kGbuffers, "gbuffer"],
    [kEither, ""],
  ]) {
    for (const ending of endings) {
      const name = names.find((candidate) => ending_of(candidate) === ending);
      if (name) return { name, as };
    }
  }
  return { name: names[0], as: "model" };
}

function upload(drop, file, progress) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    const address = new URL("files", document.baseURI);
    address.search = new URLSearchParams({ drop, name: file.name });
    request.open("POST", address);
    request.upload.onprogress = (event) => progress(event.loaded);
    request.onerror = () => reject(new Error("the connection broke"));
    request.onload = () => {
      let answer = {};
      try {
        answer = JSON.parse(request.responseText);
      } catch {
        answer = { error: request.responseText.slice(0, 300) };
      }
      if (request.status < 300 && answer.file) resolve(answer.file);
      else reject(new Error(answer.error || `the program answered ${request.status}`));
    };
    request.send(file);
  });
}

const kMaxHeader = 65536; // bytes of an OpenEXR file that are searched for its channels

/// Returns the names of the channels of an OpenEXR file, those of its first part; none if they are not found.
async function exr_channels(file) {
  const text = new TextDecoder("latin1").decode(await file.slice(0, kMaxHeader).arrayBuffer());
  const start = /channels\0chlist\0[^]{4}/.exec(text); // ends with the size of the list
  if (!start) return [];
  const names = [],
    of_type = 16; // bytes after each name
  let at = start.index + start[0].length;
  while (at < text.length && text[at] !== "\0") {
    const end = text.indexOf("\0", at);
    if (end < 0) return names;
    names.push(text.slice(at, end));
    at = end + 1 + of_type;
  }
  return names;
}

/// Returns what a picture is, if it tells: one with depth or normals is a G-buffer.
async function kind_by_channels(file) {
  if (!file.name.toLowerCase().endsWith(".exr")) return "";
  const names = await exr_channels(file).catch(() => []);
  return names.some((name) => /(^|\.)z$|depth|normal/i.test(name)) ? "gbuffer" : "";
}

let asked = Promise.resolve(); // the question before, which is answered first

/// Asks whether a picture is an environment or a G-buffer. Returns "" if the user closes the question.
const ask_kind = (name) => (asked = asked.then(() => show_question(name)));

function show_question(name) {
  const dialog = by_id("ask");
  by_id("ask_name").textContent = name;
  dialog.returnValue = "";
  dialog.showModal();
  return new Promise((resolve) => dialog.addEventListener("close", () => resolve(dialog.returnValue), { once: true }));
}

/// Uploads files and opens the main one. `as`: what it is, if known.
export async function open_files(files, as) {
  if (!files.length) return;
  const names = files.map((file) => file.name);
  const twice = names.find((name, i) => names.indexOf(name) < i);
  if (twice) return complain(`Two of the files are named ${twice}; open files of one name one after the other.`, "upload");
  const main = as ? { name: files[0].name, as } : main_file(names);
  main.as ||= (await kind_by_channels(files[names.indexOf(main.name)])) || (await ask_kind(main.name));
  if (!main.as) return;
  const drop = Array.from(crypto.getRandomValues(new Uint8Array(kDropLength)), (x) => (x % 36).toString(36)).join("");
  const total = files.reduce((sum, file) => sum + file.size, 0) || 1;
  let done = 0,
    opened = "";
  try {
    for (const file of files) {
      const progress = (loaded) => hooks.status(`sending ${file.name}`, (done + loaded) / total);
      progress(0);
      const stored = await upload(drop, file, progress);
      done += file.size;
      if (file.name === main.name) opened = stored;
    }
    hooks.link.send({ type: "open", file: opened, as: main.as });
    announce(`Opening ${main.name}`);
  } catch (error) {
    complain(`${main.name} was not sent: ${error.message}`, "upload");
  }
  hooks.status("", 0);
}

export function attach_files() {
  let depth = 0;
  const has_files = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  const show = (is_over) => (by_id("drop").hidden = !is_over);
  addEventListener("dragenter", (event) => has_files(event) && show(++depth > 0));
  addEventListener("dragleave", (event) => has_files(event) && show(--depth > 0));
  addEventListener("dragover", (event) => has_files(event) && event.preventDefault());
  addEventListener("drop", (event) => {
    if (!has_files(event)) return;
    event.preventDefault();
    depth = 0;
    show(false);
    open_files([...event.dataTransfer.files]);
  });
  for (const [id, as] of [
    ["file_any", ""],
    ["file_environment", "environment"],
  ]) {
    by_id(id).addEventListener("change", (event) => {
      open_files([...event.target.files], as);
      event.target.value = "";
    });
  }
  by_id("open").addEventListener("click", () => by_id("file_any").click());
}

// Builds dist/ and the example: writes the shader kits by the program `umbrage`, shortens their text, and bundles.
// UMBRAGE is the program; by default that of the folder build beside web/. Ends with an error if the module is too large.
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { build } from "esbuild";

export const root = join(dirname(fileURLToPath(import.meta.url)), "..");
export const umbrage = process.env.UMBRAGE || join(root, "../build/bin/umbrage");
const kMaxBytes = 60000;
const generated = join(root, "generated");

// With a radius of 100 %, the radius of occlusion is that of the scene, which is a uniform.
const bleeding = ["bitmask.radius=100%", "bitmask.bleeding=1", "denoise.indirect=1", "denoise.light_rounds=3"];
const kits = {
  ao: { effects: "bitmask,denoise", set: ["bitmask.radius=100%"], half: "aoHalf" },
  aoHalf: { effects: "bitmask,denoise,upsample", set: ["bitmask.radius=100%"] },
  bleeding: { effects: "bitmask,denoise", set: bleeding, half: "bleedingHalf" },
  bleedingHalf: { effects: "bitmask,denoise,upsample", set: [...bleeding, "upsample.indirect=on"] },
  normals: { effects: "normals", set: [] },
  toon: { effects: "toon", set: [] },
  outline: { effects: "outline", set: ["outline.mode=paper"] },
};

/** Returns GLSL without comments and white space that is not needed. Lines of the preprocessor stay lines. */
export function shortened(text) {
  const lines = text.replace(/\/\*[^]*?\*\//g, " ").replace(/\/\/[^\n]*/g, "").split("\n").map((line) => line.trim());
  let result = "";
  for (const line of lines.filter((line) => line)) {
    if (line.startsWith("#")) result += (result && !result.endsWith("\n") ? "\n" : "") + line + "\n";
    else result += (/\w$/.test(result) && /^\w/.test(line) ? " " : "") + line;
  }
  // A space between two signs stays: a - -b.
  return result.split("\n").map((line) => line.startsWith("#") ? line : line.replace(/\s+/g, " ").replace(/([-+]) (?=\1)/g, "$1@")
    .replace(/ ?([-+*\/=<>!&|?:;,(){}[\]^%~]) ?/g, "$1").replace(/\b(\d+)\.0\b(?!\d)/g, "$1.").replace(/(?<![\w.])0\.(\d)/g, ".$1")
    .replace(/vec3\(([\d.]+),\1,\1\)/g, "vec3($1)").replaceAll("@", " ")).join("\n");
}

/** Returns a text cut into the declarations at its top level, which several shaders share. */
function pieces(text) {
  const parts = [];
  for (let from = 0, depth = 0, k = 0; k < text.length; ++k) {
    depth += "({".includes(text[k]) - ")}".includes(text[k]);
    if (depth == 0 && (";\n".includes(text[k]) || (text[k] == "}" && !/^\s*\w*;/.test(text.slice(k + 1))))) parts.push(text.slice(from, from = k + 1));
  }
  return parts;
}

/** Writes the settings as numbers in place of the struct that holds them. */
function inlined(text) {
  const [whole, kind, fields, values] = text.match(/struct (\w+Settings)\{([^}]*)\};const \1 C=\1\((.*?)\);/) ?? [""];
  if (!whole) return text;
  const list = values.match(/(?:[^,(]|\([^)]*\))+/g), known = new Map();
  const all = [...fields.matchAll(/(\w+ (\w+)(?:\[\d+\])?;)/g)].map(([, field, name], k) => [field, name, list[k]]), left = all.filter(([field]) => field.includes("["));
  for (const [field, name, number] of all) if (!field.includes("[")) known.set("C." + name, number.startsWith("-") ? `(${number})` : number);
  const rest = left.length ? `struct ${kind}{${left.map(([field]) => field).join("")}};const ${kind} C=${kind}(${left.map(([, , value]) => value)});` : "";
  return text.replace(whole, rest).replace(/\bC\.\w+/g, (name) => known.get(name) ?? name);
}

// Words that GLSL defines, and those that the programs look up.
const kept = new RegExp(`^(${String.raw`attribute|const|uniform|layout|std140|location|highp|precision|in|out|inout|void|bool|u?int|float|[bui]?vec[234]|mat[234]|usampler2D|sampler2D|
  struct|if|else|for|while|do|break|continue|return|discard|true|false|version|es|define|ifndef|ifdef|endif|300|main|gl_\w+|UMBRAGE_\w+|\w+Frame|
  abs|acos|asin|atan|ceil|clamp|cos|cross|distance|dot|exp|exp2|floor|fract|inversesqrt|isinf|isnan|length|log|log2|max|min|mix|mod|normalize|pow|round|sign|
  sin|smoothstep|sqrt|step|tan|texelFetch|textureSize|floatBitsToU?[iI]nt|u?intBitsToFloat|any|all|not|[xyzw]{1,4}|[rgba]{1,4}|[stpq]{1,4}`.replace(/\s/g, "")})$`);

/** Gives short names to all other words of the texts. */
function renamed(texts) {
  const counts = new Map(), word = /(?<![\w.])\d[\w.]*(?:e[-+]?\d+)?|[A-Za-z_]\w*/g;
  for (const text of texts) for (const [long] of text.matchAll(word)) if (!/^\d/.test(long)) counts.set(long, (counts.get(long) ?? 0) + 1);
  const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz", short = new Map();
  const name = (k) => (k < 26 ? "" : name(Math.floor((k - 26) / 52))) + letters[k < 26 ? k : (k - 26) % 52];
  for (const [long] of [...counts].sort((a, b) => b[1] - a[1])) if (!kept.test(long)) short.set(long, name(short.size));
  return (text) => text.replace(word, (long) => short.get(long) ?? long);
}

/** Writes the kits as a module. Shaders are lists of pieces, names of textures are numbers; `kitOf` makes what frame.js exports. */
async function writeKits() {
  rmSync(generated, { recursive: true, force: true });
  mkdirSync(generated);
  const all = [], names = [], number = (list, value) => list.includes(value) ? list.indexOf(value) : list.push(value) - 1;
  for (const [name, { effects, set }] of Object.entries(kits)) {
    const folder = join(generated, name);
    execFileSync(umbrage, ["shaders", effects, "--language", "glsl-es", ...set.flatMap((one) => ["--set", one]), "-o", folder], { stdio: ["ignore", "ignore", "inherit"] });
    const { kit, sources, reducedView } = await import(pathToFileURL(join(folder, "frame.js")).href);
    all.push({ name, kit, reducedView, files: [...new Set(kit.passes.map((pass) => pass.file))].map((file) => [file, inlined(shortened(sources[file]))]) });
  }
  const rename = renamed(all.flatMap(({ files }) => files.map(([, text]) => text))), pool = [], functions = [];
  const lines = all.map(({ name, kit, files }, index) => {
    const texts = files.map(([file, text]) => [file, kit.passes.find((pass) => pass.file == file).effect, pieces(rename(text)).map((part) => number(pool, part))]);
    const planes = kit.textures.map(({ name, channels, neutral, exact }) => [number(names, name), channels, exact ? 1 : 0, ...(neutral === undefined ? [] : [neutral])]);
    const passes = kit.passes.map((pass) => [files.findIndex(([file]) => file == pass.file), pass.round, pass.size == "reduced" ? 1 : 0,
      ...[pass.samplers.map(rename), pass.inputs, pass.outputs].map((list) => list.map((name) => number(names, name)))]);
    // A uniform block: offsets, of floats below 0 less 1, and formulas.
    const filled = Object.entries(kit.blocks).map(([effect, { size, fields }]) => `${effect}: ${number(functions, `block(${size}, ({ ${
      [...new Set(fields.flatMap(({ formula }) => formula.match(/[a-z_]\w*/g)))].filter((name) => !/^(min|max|floor|sqrt)$/.test(name))} }) => [${
      fields.map(({ type, offset, formula }) => `${type == "int" ? offset : -1 - offset}, ${formula}`)}])`)}`.replace(/\d+$/, "frame$&"));
    return `export const ${name} = kitOf(${[index, kit.factor, Object.keys(kit.blocks), texts, planes, passes, kits[name].half].map((v) => JSON.stringify(v ?? null))}, { ${filled} });`;
  });
  writeFileSync(join(generated, "kits.js"), `const pool = ${JSON.stringify(pool)}, names = ${JSON.stringify(names.join(" "))}.split(" ");
const { min, max, floor, sqrt } = Math, named = (list) => list.map((k) => names[k]);
${all[0].reducedView}
const block = (size, fill) => (view, round) => {
  const data = new DataView(new ArrayBuffer(size)), pixel_width = (view.right - view.left) / view.width, pixel_height = (view.top - view.bottom) / view.height;
  const values = fill({ ...view, round, pixel_width, pixel_height, orthographic: +view.orthographic, scene_radius: view.sceneRadius, depth_min: view.depthMin,
                        depth_max: view.depthMax, light_x: view.lightX, light_y: view.lightY, light_z: view.lightZ });
  for (let k = 0; k < values.length; k += 2) values[k] < 0 ? data.setFloat32(-1 - values[k], values[k + 1], true) : data.setInt32(values[k], values[k + 1], true);
  return data.buffer;
};
${functions.map((text, k) => `const frame${k} = ${text};`).join("\n")}
function kitOf(settings, factor, blocks, files, planes, passes, half, frames) {
  return { frames, reducedView, half, sources: Object.fromEntries(files.map(([file, , parts]) => [file, parts.map((k) => pool[k]).join("")])),
    kit: { settings, factor, blocks: Object.fromEntries(blocks.map((name) => [name, { name: name[0].toUpperCase() + name.slice(1) + "Frame" }])), textures: planes.map(([name, channels, exact, neutral]) => ({ name: names[name], channels, exact, neutral })),
      passes: passes.map(([k, round, reduced, samplers, inputs, outputs]) => ({ file: files[k][0], effect: files[k][1], round, size: reduced ? "reduced" : "full",
        samplers: named(samplers), inputs: named(inputs), outputs: named(outputs) })) } };
}
${lines.join("\n")}
`);
}

export const common = { bundle: true, absWorkingDir: root, logLevel: "warning", legalComments: "none", target: "es2022" };

async function main() {
  if (!existsSync(umbrage)) throw new Error(`there is no program ${umbrage}; build it, or set UMBRAGE`);
  await writeKits();
  await build({ ...common, entryPoints: { "umbrage-three": "src/three.js", "umbrage-core": "src/core.js" }, outdir: "dist", format: "esm", minify: true, external: ["three", "three/*"] });
  const { outputFiles } = await build({ ...common, entryPoints: ["example/main.js"], write: false, format: "iife", minify: true });
  writeFileSync(join(root, "dist/example.html"), readFileSync(join(root, "example/index.html"), "utf8")
    .replace("<!-- script -->", () => `<script>${outputFiles[0].text.replaceAll("</script", "<\\/script")}</script>`));
  const { size } = statSync(join(root, "dist/umbrage-three.js"));
  console.log(`dist/umbrage-three.js: ${size} bytes`);
  if (size >= kMaxBytes) throw new Error(`dist/umbrage-three.js has ${size} bytes, the limit is ${kMaxBytes}`);
}

if (process.argv[1] == fileURLToPath(import.meta.url)) await main();

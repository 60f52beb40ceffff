// Tests in headless Chromium: node test/run.mjs [part of a name]. CHROMIUM and UMBRAGE are the programs.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";
import puppeteer from "puppeteer-core";
import { common, root, umbrage } from "../scripts/build.mjs";
import { readExr, writePfm } from "./files.mjs";

const folder = mkdtempSync(join(tmpdir(), "umbrage-web-"));
const run = (...args) => execFileSync(umbrage, [...args, "--device", "cpu"], { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });
const base64 = (data) => Buffer.from(new Float32Array(data).buffer).toString("base64");
const floats = (text) => new Float32Array(new Uint8Array(Buffer.from(text, "base64")).buffer);
const channel = (plane, c) => plane.filter((_, k) => k % 3 == c);
const tan = (degrees) => Math.tan((degrees / 2) * Math.PI / 180);

/** Returns a perspective projection matrix. */
const perspective = (degrees, aspect, near = 1, far = 10) => [1 / (tan(degrees) * aspect), 0, 0, 0, 0, 1 / tan(degrees), 0, 0, 0, 0,
  -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0];

/** Compares `ao` where `depth` shows a surface. */
function compare(a, b, depth, bound = 0.004) {
  let count = 0, within = 0, max = 0, sum = 0;
  depth.forEach((d, k) => {
    if (d == 0) return;
    const difference = Math.abs(a[k] - b[k]);
    ++count, sum += difference, within += difference <= bound;
    if (!(difference <= max)) max = difference;
  });
  console.log(`    max ${max.toPrecision(3)}, mean ${(sum / count).toPrecision(3)}, within ${bound}: ${(100 * within / count).toFixed(3)} % of ${count}`);
  return 100 * within / count;
}

const solids = (width, height) => ["scene:solids", "--resolution", `${width}x${height}`, "--camera-view-angle", "33", "--anti-aliasing", "1"];
const cpu = ["--look", "ao", "--ao", "bitmask", "--ao-radius", "0.4"];

/** Returns planes of the scene. */
function planesOf(width, height, ...options) {
  run(...solids(width, height), ...options, "-o", "planes.exr");
  return readPlanes(width, height);
}

/** Returns the planes that the program wrote, rows from the bottom: depth (0: background), normal, ao and others. */
function readPlanes(width, height) {
  const { planes } = readExr(join(folder, "planes.exr")), result = {};
  const up = (names) => {
    const data = new Float32Array(names.length * width * height);
    names.forEach((name, c) => planes[name].forEach((v, k) => { data[names.length * ((height - 1 - Math.floor(k / width)) * width + k % width) + c] = v; }));
    return data;
  };
  for (const name of Object.keys(planes)) {
    const [plane, channel] = name.split(".");
    if (plane == "depth") result.depth = up([name]).map((d) => (d < 1e9 ? d : 0));
    else if (channel == "X" || channel == "R") result[plane] = up((channel == "X" ? ["X", "Y", "Z"] : ["R", "G", "B"]).map((c) => `${plane}.${c}`));
    else if (!channel) result[plane] = up([name]);
  }
  return result;
}

/** Returns the CPU program's `ao` of planes that a page drew. */
function shade(planes, { width, height }, camera) {
  writePfm(join(folder, "d.pfm"), width, height, planes.depth);
  writePfm(join(folder, "n.pfm"), width, height, planes.normal);
  run("shade", "--depth", "d.pfm", "--normal", "n.pfm", ...camera, "--repair", "off", "--normal-space", "camera", "--normal-encoding", "signed",
    "--background", "0", "--look", "ao", "--ao", "bitmask", "--ao-radius", "0.5", "--passes", "ao", "-o", "planes.exr");
  return readPlanes(width, height).ao;
}

const size = { width: 240, height: 180 };
let page, baseline;
const call = (name, ...args) => page.evaluate((name, args) => window.tests[name](...args), name, args);
const three = async (options) => {
  const { depth, normal, ao, ...result } = await call("three", { ...size, ...options });
  return { ...result, depth: floats(depth), normal: floats(normal), ao: floats(ao) };
};

/** Returns what core.js makes of planes. `wanted`: names and numbers of channels. */
async function core(kit, width, height, planes, wanted, options) {
  const inputs = Object.fromEntries(Object.entries(planes).map(([name, plane]) => [name, base64(plane)]));
  const result = await call("planes", { kit, width, height, planes: inputs, radius: 0.4, projection: perspective(33, width / height), wanted, ...options });
  return Object.fromEntries(Object.entries(result).map(([name, plane]) => [name, floats(plane)]));
}

const tests = {
  async "core: AO is that of the CPU"() {
    const { depth, normal, ao } = planesOf(256, 192, ...cpu, "--passes", "depth,normal,ao");
    assert(compare((await core("ao", 256, 192, { depth, normal }, [["ao", 1]])).ao, ao, depth) >= 99.9);
  },
  async "core: AO at half resolution is that of the CPU"() {
    const { depth, normal, ao } = planesOf(255, 191, ...cpu, "--ao-scale", "half", "--passes", "depth,normal,ao");
    assert(compare((await core("ao", 255, 191, { depth, normal }, [["ao", 1]], { halfResolution: true })).ao, ao, depth) >= 99.9);
  },
  async "core: colour bleeding is that of the CPU"() {
    // The planes are shaded a second time, since a scene has light of back sides, which a depth buffer does not show.
    run(...solids(256, 192), "--look", "bleeding", "--passes", "depth,normal,albedo", "-o", "g.exr");
    for (const halfResolution of [false, true]) {
      run("shade", "g.exr", "--look", "bleeding", ...cpu.slice(2), "--passes", "depth,normal,direct,ambient,albedo,ao,indirect", "-o", "planes.exr",
        ...["bitmask.bleeding=1", "denoise.rounds=1", "denoise.light_rounds=3"].flatMap((one) => ["--set", one]), ...(halfResolution ? ["--ao-scale", "half"] : []));
      const { ao, indirect, ...planes } = readPlanes(256, 192);
      const result = await core("bleeding", 256, 192, planes, [["ao", 1], ["indirect", 3]], { halfResolution });
      assert(compare(result.ao, ao, planes.depth) >= 99.9);
      for (const c of [0, 1, 2]) assert(compare(channel(result.indirect, c), channel(indirect, c), planes.depth) >= 99.9);
    }
  },
  async "core: tone steps and outlines are those of the CPU"() {
    const width = 120, height = 1100;  // of as many rounds of smoothing as the kit has
    run(...solids(width, height), "--look", "bleeding", "--passes", "depth,normal,albedo", "-o", "g.exr");
    run("shade", "g.exr", "--effects", "toon,outline", "--set", "toon.rig=key", "--set", "outline.mode=paper", "--passes", "depth,normal,albedo,lit,outline", "-o", "planes.exr");
    const { lit, outline, ...planes } = readPlanes(width, height), view = { depthMax: planes.depth.reduce((a, b) => Math.max(a, b)) };
    const lines = await core("outline", width, height, planes, [["outline", 1]], { view }), toon = await core("toon", width, height, planes, [["lit", 3]]);
    assert(compare(lines.outline, outline, planes.depth) >= 99.9);
    // Of lit, not of ao: at the edges of tone steps, rounding is as large as the steps are steep.
    for (const c of [0, 1, 2]) assert(compare(channel(toon.lit, c), channel(lit, c), planes.depth) >= 99.7);
  },
  async "core: normals from depth are those of the CPU"() {
    const { depth } = planesOf(256, 192, "--look", "ao", "--passes", "depth,normal");
    writePfm(join(folder, "d.pfm"), 256, 192, depth);
    run("shade", "--depth", "d.pfm", "--background", "0", "--fov", "33", "--repair", "off", "--look", "ao", "--passes", "normal", "-o", "planes.exr");
    const expected = readPlanes(256, 192).normal, { normal } = await core("ao", 256, 192, { depth }, [["normal", 3]]);
    for (const c of [0, 1, 2]) assert(compare(channel(normal, c), channel(expected, c), depth) >= 99.9);
  },
  async "three: depth is that of rays, AO that of the CPU"() {
    baseline ??= await three({});
    console.log(`    depth error ${baseline.depthError.toPrecision(3)}`);
    assert(baseline.depthError < 1e-3);
    assert(compare(baseline.ao, shade(baseline, size, ["--fov", "45"]), baseline.depth) >= 99.9);
  },
  async "three: orthographic"() {
    const result = await three({ orthographic: true });
    console.log(`    depth error ${result.depthError.toPrecision(3)}`);
    assert(result.depthError < 1e-3);
    assert(compare(result.ao, shade(result, size, ["--orthographic", "--window=-4,4,-3,3"]), result.depth) >= 99.9);
  },
  async "what is missing or wrong is said in a sentence"() {
    const floats = ["EXT_color_buffer_float"], all = [...floats, "EXT_color_buffer_half_float"];
    assert.match(await call("refusal", { kit: "ao", without: all }), /neither EXT_color_buffer_float nor EXT_color_buffer_half_float/);
    assert.match(await call("refusal", { kit: "bleeding", without: floats }), /needs EXT_color_buffer_float/);
    assert.match(await call("refusal", { kit: "ao", input: { width: 0 } }), /needs a width and a height/);
    assert.match(await call("refusal", { kit: "ao", input: { normals: "packed" } }), /'octahedral', not 'packed'/);
    assert.match(await call("refusal", { kit: "ao", input: { depth: null } }), /needs a depth texture/);
    assert.equal(await call("refusal", { kit: "ao" }), "");
  },
  async "render() leaves the caller's state"() {
    assert.deepEqual(await call("state"), { changed: [], error: 0 });
  },
  async "no object leaks in 100 resizes and dispose"() {
    const { looks, without, after } = await call("leaks");
    for (const { look, before, after } of looks) assert.deepEqual(after, before, look);
    assert(looks[0].before.Texture > without.Texture);
    assert.deepEqual(after, without);
  },
  async "the example opens from disk"() {
    const example = await browser.newPage(), errors = [];
    example.on("pageerror", (error) => errors.push(error.message)).on("console", (line) => line.type() == "error" && errors.push(line.text()));
    await example.setViewport({ width: 640, height: 420 });
    await example.goto(pathToFileURL(join(root, "dist/example.html")).href);
    await example.waitForFunction(() => window.drawn > 1, { timeout: 120000 });
    if (process.env.PICTURES) await example.screenshot({ path: join(process.env.PICTURES, "example.png") });
    await example.close();
    assert.deepEqual(errors, []);
  },
  async "looks"() {
    for (const [name, options] of Object.entries({ ao: { output: "ao" }, picture: {}, half: { output: "ao", halfResolution: true }, bleeding: { look: "bleeding" }, toon: { look: "toon" } })) {
      const { error, mean, black, colored } = await call("picture", { width: 800, height: 600, options });
      console.log(`    ${name}: mean ${mean.toFixed(0)}, black ${black.toFixed(3)}, coloured ${colored.toFixed(3)}`);
      assert.equal(error, 0);
      assert(options.output == "ao" ? colored == 0 && mean > 225 && mean < 253 : colored > 0.15 && mean > 100 && mean < 230, name);
      assert(name == "toon" ? black > 0.005 && black < 0.1 : black < 0.005, name);
      if (process.env.PICTURES) await page.screenshot({ path: join(process.env.PICTURES, name + ".png") });
    }
  },
  async "types"() {
    execFileSync("npx", ["tsc", "--noEmit", "--strict", "--skipLibCheck", "--module", "nodenext", "--target", "es2022", "test/types.ts"], { cwd: root, stdio: "inherit" });
  },
};

// Against depth of 32 bits: options, the least percentage of pixels within a bound, the bound, and what must be so.
for (const [name, [options, percent, bound, check = () => true]] of Object.entries({
  "reversed depth": [{ parameters: { reversedDepthBuffer: true } }, 99.9, 0.004, (result) => result.reversed],
  "logarithmic depth": [{ parameters: { logarithmicDepthBuffer: true } }, 99.9, 0.004, (result) => result.logarithmic],
  "depth of 24 bits": [{ depthBits: 24 }, 99.9, 0.004],
  "depth of 16 bits": [{ depthBits: 16 }, 99.9, 0.02],
  "multisampled depth": [{ samples: 4 }, 95, 0.05],
  "half resolution": [{ options: { halfResolution: true } }, 95, 0.1],
  "half floats where float targets are missing": [{ without: ["EXT_color_buffer_float"] }, 99.9, 0.004, (result) => result.targets == "half"],
})) tests["three: " + name] = async () => {
  baseline ??= await three({});
  const result = await three(options);
  assert(compare(result.ao, baseline.ao, baseline.depth, bound) >= percent);
  assert(check(result) && (options.samples || result.depthError < 1e-3));
};

await build({ ...common, entryPoints: ["test/page.js"], outfile: join(folder, "page.js"), format: "iife" });
const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium", protocolTimeout: 600000,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] });
let failed = 0;
try {
  page = await browser.newPage();
  page.on("console", (line) => ["error", "warn"].includes(line.type()) && console.log("    " + line.text()));
  await page.setViewport({ width: 800, height: 600 });
  await page.goto("about:blank");
  await page.addScriptTag({ path: join(folder, "page.js") });
  for (const [name, test] of Object.entries(tests).filter(([name]) => name.includes(process.argv[2] ?? ""))) {
    const begin = Date.now();
    try {
      await test();
      console.log(`ok ${name} (${Date.now() - begin} ms)`);
    } catch (error) {
      ++failed;
      console.log(`FAILED ${name}\n    ${error.message}`);
    }
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failed ? 1 : 0);

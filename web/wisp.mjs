/**
 * Wisp in WebAssembly: scenes, worlds and their values, with the bits of the native build. Types are in wisp.d.ts.
 *
 *     const wisp = await loadWisp();
 *     const scene = wisp.readScene( "flag.yaml", { "flag.yaml": text } );
 *     const world = scene.createWorld();
 *     world.step();
 *     world.points( world.bodies[0] );   // Float32Array, a view of the engine's memory
 */
import createModule from "./wisp_module.mjs";

/** A failure of the engine: its message names file and line, or element. */
export class WispError extends Error {
  constructor(message) {
    super(message);
    this.name = "WispError";
  }
}

const KINDS = ["strands", "cloth", "balloon", "collider", "plane"];
const VALUES = { points: 0, strain: 1, speed: 2, width: 3, colour: 4, motionStats: 5, normals: 6 };
const MAX_PARAMETER_VALUES = 16;
// A scene may read files of the folders above its own.
const FOLDERS_ABOVE = "0/1/2/3/4/5/6/7";

/** Whether this machine runs the module: WebAssembly with 128-bit SIMD. */
export function isSupported() {
  // A function that returns v128.const 0.
  const probe = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11];
  return typeof WebAssembly === "object" && WebAssembly.validate(new Uint8Array(probe));
}

async function readBytes(source) {
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) {
    return source;
  }
  const url = source ?? new URL("./wisp_module.wasm", import.meta.url);
  if (String(url).startsWith("file:")) {
    const { readFile } = await import("node:fs/promises");
    return readFile(new URL(url));
  }
  const response = await fetch(url);
  if (!response.ok) {
    throw new WispError(`${url}: ${response.status} ${response.statusText}`);
  }
  return response.arrayBuffer();
}

/** Load an instance of the engine, with memory of its own. */
export async function loadWisp(options = {}) {
  if (!isSupported()) {
    throw new WispError("WebAssembly with SIMD is missing: Wisp needs Chrome 91, Firefox 90, Safari 16.4 or newer");
  }
  const print = options.print ?? ((line) => console.warn(line));
  const module = await createModule({ wasmBinary: await readBytes(options.wasm), print, printErr: print });
  return new Wisp(module);
}

// ---- calls ----

/** Calls into the module, with texts and arrays in its memory. */
class Engine {
  constructor(module) {
    this.module = module;
  }

  call(name, ...values) {
    return this.module[`_web_${name}`](...values);
  }

  /** Call what returns 0 or null on failure. */
  demand(name, ...values) {
    const result = this.call(name, ...values);
    if (!result) {
      throw new WispError(this.text(this.call("message")));
    }
    return result;
  }

  text(pointer) {
    const heap = this.module.HEAPU8;
    return new TextDecoder().decode(heap.slice(pointer, heap.indexOf(0, pointer)));
  }

  floats(pointer, count) {
    return new Float32Array(this.module.HEAPU8.buffer, pointer, count);
  }

  /** Call a function with a block of memory; it is free again afterwards. */
  withBytes(size, use) {
    const pointer = this.module._malloc(Math.max(size, 1));
    if (!pointer) {
      throw new WispError(`out of memory for ${size} bytes`);
    }
    try {
      return use(pointer);
    } finally {
      this.module._free(pointer);
    }
  }

  withText(text, use) {
    const bytes = new TextEncoder().encode(`${text}\0`);
    return this.withBytes(bytes.length, (pointer) => {
      this.module.HEAPU8.set(bytes, pointer);
      return use(pointer);
    });
  }

  /** Call a function that fills numbers. */
  numbers(Type, count, use) {
    return this.withBytes(count * Type.BYTES_PER_ELEMENT, (pointer) => {
      const result = use(pointer);
      return [Array.from(new Type(this.module.HEAPU8.buffer, pointer, count)), result];
    });
  }
}

class Wisp {
  #engine;
  #scenes = 0;

  constructor(module) {
    this.#engine = new Engine(module);
    this.version = this.#engine.text(this.#engine.call("version"));
  }

  readScene(name, files) {
    const engine = this.#engine;
    const folder = `/${++this.#scenes}/${FOLDERS_ABOVE}`;
    writeFiles(engine, folder, files);
    if (files[name] === undefined) {
      throw new WispError(`${name}: not among the files ${Object.keys(files).join(", ")}`);
    }
    return new Scene(engine, this, name, files, folder);
  }

  openRecording(bytes, name = "recording.wisp") {
    return new Recording(this.#engine, bytes, name);
  }

  tune(scene, { error, length = 0, limit = 60, progress = null }) {
    const engine = this.#engine;
    engine.module.tuneProgress = progress;
    const count = scene.parameters.length;
    const [configuration, out] = engine.numbers(Int32Array, count, (indices) =>
      engine.numbers(Float64Array, 5, (values) =>
        scene.at((path) => engine.demand("tune", path, error, length, limit, indices, values)))[0]);
    const parameters = {};
    scene.parameters.forEach((parameter, k) => {
      parameters[parameter.name] = parameter.values[configuration[k]];
    });
    return { meetsTarget: out[0] === 1, parameters, ms: out[1], error: out[2], runs: out[3], stoppedEarly: out[4] === 1 };
  }
}

// ---- scenes ----

function writeFiles(engine, folder, files) {
  const fs = engine.module.FS;
  for (const [name, content] of Object.entries(files)) {
    const parts = [];
    for (const part of (name.startsWith("/") ? name : `${folder}/${name}`).split("/")) {
      if (part === "..") {
        parts.pop();
      } else if (part !== "" && part !== ".") {
        parts.push(part);
      }
    }
    fs.mkdirTree(`/${parts.slice(0, -1).join("/")}`);
    fs.writeFile(`/${parts.join("/")}`, content);
  }
  fs.mkdirTree(folder);
}

class Scene {
  #engine;
  #wisp;
  #files;
  #folder;
  #handle;

  constructor(engine, wisp, name, files, folder) {
    this.#engine = engine;
    this.#wisp = wisp;
    this.#files = files;
    this.#folder = folder;
    this.name = name;
    this.#handle = this.at((path) => engine.demand("scene_open", path));
    this.dt = engine.call("scene_dt", this.#handle);
    this.steps = engine.call("scene_steps", this.#handle);
    this.gravity = engine.numbers(Float32Array, 3, (out) => engine.call("scene_gravity", this.#handle, out))[0];
    this.parameters = Array.from({ length: engine.call("scene_parameter_count", this.#handle) }, (_, k) => this.#parameter(k));
  }

  /** Call a function with the path of the scene; messages then begin with its name alone. */
  at(use) {
    this.#engine.module.FS.chdir(this.#folder);
    return this.#engine.withText(this.name, use);
  }

  #parameter(k) {
    const engine = this.#engine;
    const [values, count] = engine.numbers(Float64Array, MAX_PARAMETER_VALUES,
      (out) => engine.call("scene_parameter_values", this.#handle, k, out));
    return {
      name: engine.text(engine.call("scene_parameter_name", this.#handle, k)),
      values: values.slice(0, count),
      value: engine.call("scene_parameter_value", this.#handle, k),
      unordered: engine.call("scene_parameter_is_unordered", this.#handle, k) === 1,
    };
  }

  get text() {
    const content = this.#files[this.name];
    return typeof content === "string" ? content : new TextDecoder().decode(content);
  }

  get files() {
    return { ...this.#files };
  }

  withText(text) {
    return this.#wisp.readScene(this.name, { ...this.#files, [this.name]: text });
  }

  withParameters(changes) {
    const engine = this.#engine;
    const unknown = Object.keys(changes).find((name) => !this.parameters.some((parameter) => parameter.name === name));
    if (unknown !== undefined) {
      throw new WispError(`${this.name}: got setting '${unknown}', expected one of ${this.parameters.map((k) => k.name).join(", ")}`);
    }
    const nearest = (values, value) => values.reduce((best, v, i) => Math.abs(v - value) < Math.abs(values[best] - value) ? i : best, 0);
    const configuration = this.parameters.map((parameter) => {
      const value = changes[parameter.name] ?? parameter.value;
      const index = nearest(parameter.values, value);
      if (Math.abs(parameter.values[index] - value) > 1e-6 * Math.abs(value)) {
        throw new WispError(`${this.name}: ${parameter.name}: got ${value}, expected one of ${parameter.values.join(", ")}`);
      }
      return index;
    });
    const written = "/edited";
    engine.withBytes(4 * configuration.length, (indices) => {
      new Int32Array(engine.module.HEAPU8.buffer, indices, configuration.length).set(configuration);
      // The edited scene is checked where it will be read: among the files that it reads.
      return this.at((from) => engine.withText(`${this.name}${written.slice(1)}`, (to) =>
        engine.demand("scene_write", this.#handle, from, indices, to)));
    });
    const path = `${this.name}${written.slice(1)}`;
    const text = engine.module.FS.readFile(path, { encoding: "utf8" });
    engine.module.FS.unlink(path);
    return this.withText(text);
  }

  createWorld({ reference = false, factor = 4 } = {}) {
    const engine = this.#engine;
    if (!Number.isInteger(factor) || factor < 1 || factor > 64) {
      throw new WispError(`${this.name}: factor: got ${factor}, expected a whole number from 1 to 64`);
    }
    return new World(engine, this.at((path) => engine.demand("world_open", path, reference ? factor : 0)), this);
  }

  release() {
    if (this.#handle) {
      this.#engine.call("scene_close", this.#handle);
      this.#handle = 0;
      this.#engine.module.FS.chdir("/");
      removeFolder(this.#engine.module.FS, `/${this.#folder.split("/")[1]}`);
    }
  }
}

function removeFolder(fs, path) {
  for (const name of fs.readdir(path).filter((entry) => entry !== "." && entry !== "..")) {
    const inner = `${path}/${name}`;
    if (fs.isDir(fs.stat(inner).mode)) {
      removeFolder(fs, inner);
    } else {
      fs.unlink(inner);
    }
  }
  fs.rmdir(path);
}

// ---- worlds ----

class World {
  #engine;
  #handle;

  constructor(engine, handle, scene) {
    this.#engine = engine;
    this.#handle = handle;
    this.scene = scene;
    this.bodies = Array.from({ length: this.#call("body_count") }, (_, index) => this.#body(index));
  }

  #call(name, ...values) {
    if (!this.#handle) {
      throw new WispError("the world is released");
    }
    return this.#engine.call(name, this.#handle, ...values);
  }

  #demand(name, ...values) {
    if (!this.#handle) {
      throw new WispError("the world is released");
    }
    return this.#engine.demand(name, this.#handle, ...values);
  }

  #body(index) {
    const engine = this.#engine;
    const kind = KINDS[this.#call("body_kind", index)];
    const strandCount = this.#call("body_strands", index);
    return {
      index,
      name: engine.text(this.#call("body_name", index)),
      kind,
      vertexCount: this.#call("body_vertices", index),
      triangles: copyIntegers(engine, this.#call("body_triangles", index), 3 * this.#call("body_triangle_count", index)),
      offsets: kind === "strands" ? copyIntegers(engine, this.#call("body_offsets", index), strandCount + 1) : null,
      strandCount,
      moves: kind !== "collider" && kind !== "plane",
      tears: this.#call("body_tears", index) === 1,
      hidden: this.#call("body_is_shown", index) === 0,
      isFrozenHair: this.#call("hair_is_frozen", index) === 1,
      has: this.#flags("body_has", index),
      computes: this.#flags("body_computes", index),
    };
  }

  #flags(name, index) {
    return Object.fromEntries(Object.entries(VALUES).map(([what, number]) => [what, this.#call(name, index, number) === 1]));
  }

  triangles(body) {
    return viewIntegers(this.#engine, this.#call("body_triangles", body.index), body.triangles?.length ?? 0);
  }

  step() {
    this.#demand("world_step");
  }

  get stepCount() {
    return this.#call("world_step_count");
  }

  get time() {
    return this.#call("world_time");
  }

  hash() {
    return this.#engine.text(this.#call("world_hash"));
  }

  request(body, what) {
    if (!this.#own(body).has[what]) {
      throw new WispError(`'${body.name}' has no value '${what}'`);
    }
    this.#demand("request", body.index, VALUES[what]);
  }

  /** The body of this world that a body describes. */
  #own(body) {
    const own = this.bodies[body?.index];
    if (!own || own.name !== body.name) {
      throw new WispError(`got body ${JSON.stringify(body?.name)}, which is not of this world`);
    }
    return own;
  }

  #values(body, what, perVertex) {
    if (!this.#own(body).has[what] && what !== "points") {
      throw new WispError(`'${body.name}' has no value '${what}'`);
    }
    return this.#engine.floats(this.#demand("values", body.index, VALUES[what]), perVertex * body.vertexCount);
  }

  points(body) {
    return this.#values(body, "points", 3);
  }

  normals(body) {
    return this.#values(body, "normals", 3);
  }

  colour(body) {
    return this.#values(body, "colour", 3);
  }

  strain(body) {
    return this.#values(body, "strain", 1);
  }

  speed(body) {
    return this.#values(body, "speed", 1);
  }

  width(body) {
    return this.#values(body, "width", 1);
  }

  motionStats(body) {
    const [m] = this.#engine.numbers(Float64Array, 7, (out) => this.#demand("motion_stats", body.index, out));
    return {
      mass: m[0], kineticEnergy: m[1], potentialEnergy: m[2], volume: m[3], strainMax: m[4], strainMean: m[5], speedMax: m[6],
    };
  }

  // ---- costs ----

  get stepSeconds() {
    return this.#call("step_seconds");
  }

  profile() {
    return Array.from({ length: this.#call("profile_count") }, (_, line) => ({
      pass: this.#engine.text(this.#call("profile_pass", line)),
      seconds: this.#call("profile_seconds", line),
    }));
  }

  counters() {
    const counters = {};
    for (let k = 0; k < this.#engine.call("counter_count"); ++k) {
      const count = this.#call("counter", k);
      if (count > 0) {
        counters[this.#engine.text(this.#engine.call("counter_name", k))] = count;
      }
    }
    return counters;
  }

  get memoryBytes() {
    return this.#call("memory_bytes");
  }

  // ---- input ----

  grab(body, vertex) {
    this.#demand("grab", body.index, vertex);
  }

  drag(body, vertex, [x, y, z]) {
    this.#demand("drag", body.index, vertex, x, y, z);
  }

  letGo(body, vertex) {
    this.#demand("let_go", body.index, vertex);
  }

  colliderPlace(body) {
    return this.#engine.numbers(Float32Array, 3, (out) => this.#demand("collider_place", body.index, out))[0];
  }

  moveCollider(body, [x, y, z]) {
    this.#demand("move_collider", body.index, x, y, z);
  }

  setGravity([x, y, z]) {
    this.#demand("set_gravity", x, y, z);
  }

  setWind([x, y, z]) {
    const felt = this.#call("set_wind", x, y, z);
    if (felt < 0) {
      throw new WispError(this.#engine.text(this.#engine.call("message")));
    }
    return felt > 0;
  }

  // ---- frozen hair ----

  frozenHair(body) {
    const [v] = this.#engine.numbers(Float64Array, 10, (out) => this.#demand("hair_read", body.index, out));
    return {
      intensity: v[0], reach: v[1], stretchStiffness: v[2], bendStiffness: v[3], clumpRadius: v[4],
      freezes: v[5] === 1, aligns: v[6] === 1, clumps: v[7] === 1, temperature: v[8], wetness: v[9],
    };
  }

  setFrozenHair(body, changes) {
    const v = { ...this.frozenHair(body), ...changes };
    this.#demand("hair_set", body.index, v.intensity, v.reach, v.stretchStiffness, v.bendStiffness, v.clumpRadius);
  }

  commandFrozenHair(body, [x, y, z]) {
    this.#demand("hair_command", body.index, x, y, z);
  }

  beginStroke(body) {
    this.#demand("hair_begin_stroke", body.index);
  }

  climateStiffness(body, temperature, wetness) {
    return this.#call("hair_climate_stiffness", body.index, temperature, wetness);
  }

  // ---- snapshots ----

  snapshot() {
    const size = this.#call("snapshot_size");
    if (size < 0) {
      throw new WispError("the world is too large for a snapshot");
    }
    return this.#engine.withBytes(size, (pointer) => {
      this.#demand("snapshot", pointer, size);
      return this.#engine.module.HEAPU8.slice(pointer, pointer + size);
    });
  }

  restore(bytes) {
    this.#engine.withBytes(bytes.length, (pointer) => {
      this.#engine.module.HEAPU8.set(bytes, pointer);
      this.#demand("restore", pointer, bytes.length);
    });
  }

  release() {
    if (this.#handle) {
      this.#call("world_close");
      this.#handle = 0;
    }
  }
}

function viewIntegers(engine, pointer, count) {
  return pointer && count > 0 ? new Int32Array(engine.module.HEAPU8.buffer, pointer, count) : null;
}

function copyIntegers(engine, pointer, count) {
  return viewIntegers(engine, pointer, count)?.slice() ?? null;
}

// ---- recordings ----

class Recording {
  #engine;
  #handle;
  #bytes;

  constructor(engine, bytes, name) {
    this.#engine = engine;
    this.#bytes = engine.module._malloc(Math.max(bytes.length, 1));
    if (!this.#bytes) {
      throw new WispError(`${name}: out of memory for ${bytes.length} bytes`);
    }
    engine.module.HEAPU8.set(bytes, this.#bytes);
    try {
      this.#handle = engine.withText(name, (text) => engine.demand("recording_open", this.#bytes, bytes.length, text));
    } catch (error) {
      engine.module._free(this.#bytes);
      throw error;
    }
    this.dt = this.#call("dt");
    this.frameCount = this.#call("frames");
    this.isComplete = this.#call("is_complete") === 1;
    this.bodies = Array.from({ length: this.#call("bodies") }, (_, index) => this.#body(index));
    this.seek(0);
  }

  #call(name, ...values) {
    return this.#engine.call(`recording_${name}`, this.#handle, ...values);
  }

  #body(index) {
    const strandCount = this.#call("strands", index);
    return {
      index,
      name: this.#engine.text(this.#call("name", index)),
      kind: strandCount > 0 ? "strands" : "cloth",
      vertexCount: this.#call("vertices", index),
      triangles: copyIntegers(this.#engine, this.#call("triangles", index), 3 * this.#call("triangle_count", index)),
      offsets: strandCount > 0 ? copyIntegers(this.#engine, this.#call("offsets", index), strandCount + 1) : null,
      strandCount,
      moves: true,
      tears: this.#call("tears", index) === 1,
      hidden: false,
    };
  }

  seek(frame) {
    this.#engine.demand("recording_seek", this.#handle, frame);
    this.frame = frame;
    this.time = this.#call("time");
  }

  hash() {
    return this.#engine.text(this.#call("hash"));
  }

  triangles(body) {
    return viewIntegers(this.#engine, this.#call("triangles", body.index), body.triangles?.length ?? 0);
  }

  points(body) {
    return this.#engine.floats(this.#call("points", body.index), 3 * body.vertexCount);
  }

  release() {
    if (this.#handle) {
      this.#call("close");
      this.#engine.module._free(this.#bytes);
      this.#handle = 0;
    }
  }
}

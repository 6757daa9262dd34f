/** Wisp in WebAssembly. Units are SI: metres, seconds, kilograms. */

/** A failure of the engine: its message names file and line, or element. */
export class WispError extends Error {}

/** Whether this machine runs the module: WebAssembly with 128-bit SIMD. */
export function isSupported(): boolean;

export interface LoadOptions {
  /** The bytes of wisp_module.wasm or where they are; default: beside wisp.mjs. */
  wasm?: ArrayBuffer | Uint8Array | URL | string;
  /** Receives warnings, a line at a time; default: console.warn. */
  print?: (line: string) => void;
}

/** Load an instance of the engine, with memory of its own. One instance runs on one thread. */
export function loadWisp(options?: LoadOptions): Promise<Wisp>;

/** Files by name. Names are relative to the folder of the scene, and may begin with "../". */
export type Files = Record<string, string | Uint8Array>;

export interface Wisp {
  readonly version: string;
  /** @throws WispError the scene is wrong; the message names file, line and column */
  readScene(name: string, files: Files): Scene;
  /** @param bytes of a .wisp file */
  openRecording(bytes: Uint8Array, name?: string): Recording;
  /** Find the cheapest settings of a scene whose error is small enough, by running it many times. Blocks. */
  tune(scene: Scene, options: TuneOptions): Tuned;
}

export interface TuneOptions {
  /** m, root mean square distance from a converged run */
  error: number;
  /** s of motion that are compared; default: the scene, at most 1 */
  length?: number;
  /** s after which no run starts, default 60 */
  limit?: number;
  /** Called after every run; false ends the search. */
  progress?: (runs: number, maxRuns: number) => boolean | void;
}

export interface Tuned {
  /** False: no settings meet the target, and these are the closest. */
  meetsTarget: boolean;
  parameters: Record<string, number>;
  /** median time of a step */
  ms: number;
  /** m */
  error: number;
  runs: number;
  /** The limit ended the search: better settings may exist. */
  stoppedEarly: boolean;
}

/** A setting that determines the accuracy of a scene, not its material. */
export interface Parameter {
  readonly name: string;
  /** From cheap and coarse to expensive and fine, unless unordered. */
  readonly values: number[];
  /** That of the scene. */
  readonly value: number;
  /** The last value, 0, turns the approximation off. */
  readonly unordered: boolean;
}

export interface Scene {
  readonly name: string;
  /** s, of a step */
  readonly dt: number;
  /** of the scene's own run */
  readonly steps: number;
  readonly gravity: [number, number, number];
  /** Empty where nothing moves in time. */
  readonly parameters: Parameter[];
  /** The scene's file as text, and all files. */
  readonly text: string;
  readonly files: Files;
  /** The same scene with other settings; comments and order of the file stay. */
  withParameters(changes: Record<string, number>): Scene;
  /** The same files with another text of the scene. */
  withText(text: string): Scene;
  /** @param options.reference the converged run: finest settings, and `factor` (default 4) times their substeps */
  createWorld(options?: { reference?: boolean; factor?: number }): World;
  /** Worlds that were made of it stay valid. */
  release(): void;
}

export type BodyKind = "strands" | "cloth" | "balloon" | "collider" | "plane";
export type Value = "points" | "strain" | "speed" | "width" | "colour" | "motionStats" | "normals";

export interface Body {
  readonly index: number;
  readonly name: string;
  readonly kind: BodyKind;
  readonly vertexCount: number;
  /** [3 * triangles], counter-clockwise seen from outside; null for strands. Of a body that tears those of the start. */
  readonly triangles: Int32Array | null;
  /** Its triangles change: `triangles(body)` of the world or recording has those of now. */
  readonly tears: boolean;
  /** [strandCount + 1] first vertex of each strand, root first; null for others */
  readonly offsets: Int32Array | null;
  readonly strandCount: number;
  /** False for colliders, which move only as told. A plane is shown as a square of 2 m. */
  readonly moves: boolean;
  /** Strands that others follow: they are not shown, and have no points to read. */
  readonly hidden: boolean;
}

export interface WorldBody extends Body {
  readonly isFrozenHair: boolean;
  /** Values that can be requested. */
  readonly has: Record<Value, boolean>;
  /** Values that the scene computes itself: requesting them changes nothing, other values become part of the hash. */
  readonly computes: Record<Value, boolean>;
}

export interface FrozenHair {
  /** x: 1 turns whole strands, 0 their tips alone */
  intensity: number;
  /** m, of the cursor */
  reach: number;
  stretchStiffness: number;
  bendStiffness: number;
  /** m */
  clumpRadius: number;
  /** stages that the scene has */
  freezes: boolean;
  aligns: boolean;
  clumps: boolean;
  /** of the scene's climate or the default one: degrees Celsius, and 0 to 1 */
  temperature: number;
  wetness: number;
}

/** Arrays are views of the engine's memory, in the order of the scene's vertices, until the next call. Copy what is to stay. */
export interface World {
  readonly scene: Scene;
  readonly bodies: WorldBody[];
  /** Make a step of the scene, with its events. */
  step(): void;
  readonly stepCount: number;
  /** s */
  readonly time: number;
  /** 64 bits in hexadecimal, as `wisp run` prints them. */
  hash(): string;
  /** Compute a value from the next step on. Points of shown bodies always are. What the scene does not compute changes the hash. */
  request(body: Body, what: Value): void;
  /** m, [3 * vertexCount]; colliders too */
  points(body: Body): Float32Array;
  /** [3 * triangles] of now; null for strands */
  triangles(body: Body): Int32Array | null;
  /** unit vectors */
  normals(body: Body): Float32Array;
  /** linear red, green, blue */
  colour(body: Body): Float32Array;
  /** largest |l/l0 - 1| at a vertex */
  strain(body: Body): Float32Array;
  /** m/s */
  speed(body: Body): Float32Array;
  /** m, diameter of a strand */
  width(body: Body): Float32Array;
  motionStats(body: Body): {
    mass: number; kineticEnergy: number; potentialEnergy: number; volume: number;
    strainMax: number; strainMean: number; speedMax: number;
  };

  /** s, of the last step */
  readonly stepSeconds: number;
  profile(): { pass: string; seconds: number }[];
  /** Numerical failures, limits reached and work done, without those that are 0. */
  counters(): Record<string, number>;
  readonly memoryBytes: number;

  /** Take hold of a vertex: of a surface it is pinned, of strands their head comes along. @throws WispError it cannot be dragged */
  grab(body: Body, vertex: number): void;
  /** Where a held vertex is at the end of the next step. */
  drag(body: Body, vertex: number, target: [number, number, number]): void;
  letGo(body: Body, vertex: number): void;
  colliderPlace(body: Body): [number, number, number];
  /** Where a collider is at the end of the next step. @throws WispError keyframes move it */
  moveCollider(body: Body, place: [number, number, number]): void;
  /** m/s^2 */
  setGravity(gravity: [number, number, number]): void;
  /** m/s. @returns whether anything feels it */
  setWind(wind: [number, number, number]): boolean;

  /** Parameters of frozen hair (`isFrozenHair`). */
  frozenHair(body: Body): FrozenHair;
  /** Other parameters from the next step on. */
  setFrozenHair(body: Body, changes: Partial<Pick<FrozenHair, "intensity" | "reach" | "stretchStiffness" | "bendStiffness" | "clumpRadius">>): void;
  /** The next step updates the strands, those within reach towards a point. */
  commandFrozenHair(body: Body, cursor: [number, number, number]): void;
  /** Forget what commands have done, where strokes add up (`base: stroke`). */
  beginStroke(body: Body): void;
  /** Stiffness that a climate gives strands, by the scene's curve or the default one. @param temperature degrees Celsius @param wetness 0 to 1 */
  climateStiffness(body: Body, temperature: number, wetness: number): number;

  /** State and step count. */
  snapshot(): Uint8Array;
  /** @throws WispError the bytes are no snapshot of this world; nothing has changed then */
  restore(bytes: Uint8Array): void;
  release(): void;
}

export interface Recording {
  readonly bodies: Body[];
  readonly frameCount: number;
  /** s, between two frames */
  readonly dt: number;
  /** False: the file was cut off. */
  readonly isComplete: boolean;
  readonly frame: number;
  readonly time: number;
  seek(frame: number): void;
  /** that the run had after this frame, 0s if the file has none */
  hash(): string;
  points(body: Body): Float32Array;
  /** [3 * triangles] of the frame; null for strands */
  triangles(body: Body): Int32Array | null;
  release(): void;
}

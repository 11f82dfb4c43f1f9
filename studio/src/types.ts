/** Types that the studio's files share: a scene's settings, a piece of a field, and its look. */

/** Metres, unless said otherwise. */
export type Vec3 = [number, number, number];

/** An array: a preset by name, of this many boards, or positions and normals of your own. */
export type ArrayChoice =
  | { preset: string; tiles: [number, number] }
  | OwnArray;

/** Metres, and unit vectors whither each transducer radiates. */
export type OwnArray = { name: string; positions: Vec3[]; normals: Vec3[] };

/** An obstacle, as `[[obstacles]]` of a scene file. */
export type Obstacle =
  | { point: Vec3; normal: Vec3; kind: "rigid" | "soft" }
  | { center: Vec3; radius: number; kind: "rigid" | "soft" };

export const SCALES = ["linear", "squared", "decibel"] as const;
export const AXES = ["x", "y", "z"] as const;
/** The slice, three that cross in its middle, the volume, or slice and volume. */
export const VIEWS = ["slice", "planes", "volume", "both"] as const;
export const QUANTITIES = ["modulus", "wave", "phase"] as const;
/** The levels of the page: the field alone, two methods beside one another, or everything. */
export const LEVELS = ["play", "compare", "engineer"] as const;
export type Level = (typeof LEVELS)[number];
export type ScaleName = (typeof SCALES)[number];
export type Axis = (typeof AXES)[number];
export type View = (typeof VIEWS)[number];
export type Quantity = (typeof QUANTITIES)[number];
export type Theme = "dark" | "light";

/** One of the two methods that are compared. */
export type Slot = 0 | 1;

/** Everything that undo, links and files know. */
export interface State {
  array: ArrayChoice;
  /** The board's own phases and amplitudes, or any drive. */
  quantization: "board" | "none";
  /** The temperature of the air, in degrees C. */
  temperature: number;
  /** Absorption of the air in Np/m; null: that of air of this temperature. */
  absorption: number | null;
  /** Density of the air in kg/m^3; null likewise. */
  density: number | null;
  points: Vec3[];
  /** Peak |p| of each point in Pa, 0 for a quiet one; null: as loud as all can be at once. */
  pressures: number[] | null;
  /** The points, by number from 0, whose pressures the page filled in. */
  filled: number[];
  methods: [string, string];
  /** Foci turned into traps, or "". */
  signature: "" | "trap" | "twin" | "vortex";
  obstacles: Obstacle[];
  /** The place of an ear. */
  ear: Vec3 | null;
  /** The slice: the axis that it is normal to, height and x, y of its middle, the length of its sides. */
  plane: { axis: Axis; z: number; size: number; center: [number, number] };
  level: Level;
  view: View;
  /** The part of p that the slices show: |p|, the wave Re(p e^{-jwt}), or the phase. */
  quantity: Quantity;
  /** Whose field the 3-D view shows. */
  slot: Slot;
  scale: ScaleName;
  /** The path of the moving points, or null. */
  path: Path | null;
}

/** All points carried alike: around their places on a circle, or back and forth along x. */
export type Path =
  | { kind: "circle"; radius: number; frequency: number }
  | { kind: "line"; length: number; frequency: number };

/** A field's complex pressures on a flat lattice of nu x nv places: corner + u * i/(nu - 1) + v * j/(nv - 1). */
export interface Lattice {
  corner: Vec3;
  u: Vec3;
  v: Vec3;
  nu: number;
  nv: number;
  /** re and im, i fastest: 2 nu nv numbers. */
  values: Float32Array;
}

/** |p| on a box of nx x ny x nz places, x fastest. */
export interface Volume {
  least: Vec3;
  most: Vec3;
  count: [number, number, number];
  moduli: Float32Array;
}

/** The colour of p: by its quantity and the theme, |p| also by a scale. */
export interface Look {
  quantity: Quantity;
  scale: ScaleName;
  /** The |p| of the top in Pa. */
  top: number;
  /** The instant of the wave, w t in rad. */
  turn: number;
  theme: Theme;
}

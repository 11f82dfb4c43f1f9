/** Types that the studio's files share: the state, a slice or volume of a field, and how it is shown. */

/** A vector in metres, unless stated otherwise. */
export type Vec3 = [number, number, number];

/** Further keys of an array in a scene file, such as its mask. */
type Parts = { parts?: Record<string, unknown> };

/** An array: a preset with its number of boards, or a user's own positions and normals. */
export type ArrayChoice = ({ preset: string; tiles: [number, number] } & Parts) | OwnArray;

/** Positions in m, and unit vectors in the direction in which each transducer radiates. */
export type OwnArray = { name: string; positions: Vec3[]; normals: Vec3[] } & Parts;

/** A sphere to be trapped: radius in m, density in kg/m^3, speed of sound in m/s; and gravity in m/s^2. */
export type Bead = { radius: number; density: number; sound_speed: number; gravity: Vec3 };

/** An obstacle, as `[[obstacles]]` of a scene file; `tint` is the colour of a bead, which is no obstacle but is drawn like one. */
export type Obstacle =
  | { point: Vec3; normal: Vec3; kind: "rigid" | "soft" }
  | { center: Vec3; radius: number; kind: "rigid" | "soft"; tint?: Vec3 };

export const SCALES = ["linear", "squared", "decibel"] as const;
export const AXES = ["x", "y", "z"] as const;
/** The slice, three slices that cross in its middle, the volume, or slice and volume. */
export const VIEWS = ["slice", "planes", "volume", "both"] as const;
/** The parts of p that slices show. */
export const SHADES = ["modulus", "wave", "phase"] as const;
/** The predicted touch of a skin that slices show for points on a path: its felt strength, its steady push, or its motion. */
export const TOUCHES = ["felt", "push", "skin"] as const;
export const QUANTITIES = [...SHADES, ...TOUCHES] as const;
/** The levels of the page: only the field, a comparison of two methods, or everything. */
export const LEVELS = ["play", "compare", "engineer"] as const;
export type Level = (typeof LEVELS)[number];
export type ScaleName = (typeof SCALES)[number];
export type Axis = (typeof AXES)[number];
export type View = (typeof VIEWS)[number];
export type Shade = (typeof SHADES)[number];
export type TouchQuantity = (typeof TOUCHES)[number];
export type Quantity = (typeof QUANTITIES)[number];
export type Theme = "dark" | "light";

/** The number of one of the two compared methods, A or B. */
export type Slot = 0 | 1;

/** The part of the page that undo, links and files store. */
export interface State {
  array: ArrayChoice;
  /** The phases and amplitudes that the board can play, or any drive. */
  quantization: "board" | "none";
  /** The temperature of the air, in degrees C. */
  temperature: number;
  /** Absorption of the air in Np/m; null: that of air at this temperature. */
  absorption: number | null;
  /** Density of the air in kg/m^3; null: that of air at this temperature. */
  density: number | null;
  points: Vec3[];
  /** Target |p| (peak) of each point in Pa, 0 for a quiet point; null: as loud as all points can be at once. */
  pressures: number[] | null;
  /** The numbers, from 0, of the points whose targets the page filled in. */
  filled: number[];
  methods: [string, string];
  /** Options of methods, by their names, from a scene file. */
  options: Record<string, Record<string, unknown>>;
  /** The signature that makes traps of the points, or "" for foci; or names for each point, joined by dots. */
  signature: string;
  /** The bead in each trap; null: that of the core. */
  bead: Bead | null;
  obstacles: Obstacle[];
  /** The place of an ear, where the page reports the sound level; null: no ear. */
  ear: Vec3 | null;
  /** The slice: the axis normal to it, height and x, y of its middle, the length of its sides; `pixels` for other pictures. */
  plane: { axis: Axis; z: number; size: number; center: [number, number]; pixels?: number };
  level: Level;
  view: View;
  /** The quantity that the slices show: |p|, the wave Re(p e^{-jwt}), the phase, or the touch of a skin on the slice. */
  quantity: Quantity;
  /** The slot whose field the 3-D view shows. */
  slot: Slot;
  scale: ScaleName;
  /** The path of the moving points, or null. */
  path: Path | null;
}

/** A path that all points follow alike: on a circle around their places, or back and forth along x. */
export type Path =
  | { kind: "circle"; radius: number; frequency: number }
  | { kind: "line"; length: number; frequency: number };

/** Complex pressures on a flat lattice of nu x nv samples at corner + u * i/(nu - 1) + v * j/(nv - 1). */
export interface Lattice {
  corner: Vec3;
  u: Vec3;
  v: Vec3;
  nu: number;
  nv: number;
  /** re and im, i fastest: 2 nu nv numbers. */
  values: Float32Array;
}

/** |p| on a box of nx x ny x nz samples, x fastest. */
export interface Volume {
  least: Vec3;
  most: Vec3;
  count: [number, number, number];
  moduli: Float32Array;
}

/**
 * The predicted touch of a skin: largest strength (1 at the threshold), felt width in m, largest displacement in m, largest
 * pressure in Pa that is felt as a push, and the force in N of a contact that is felt alike.
 */
export interface Touched {
  most: number;
  width: number;
  peak: number;
  pressed: number;
  force: number;
}

/** How p becomes a colour: its quantity, the theme, and for |p| a scale. */
export interface Look {
  quantity: Shade;
  /** The lattice is not p: it is the felt strength or push (drawn as |p|) or the displacement of a skin in m (drawn as a wave). */
  touch?: TouchQuantity;
  scale: ScaleName;
  /** The |p| or push at the top of the scale in Pa, the strength, or the displacement in m. */
  top: number;
  /** The phase of the wave's animation, w t in rad. */
  turn: number;
  theme: Theme;
}

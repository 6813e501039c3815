/** A vector, metres where it is a place: of three.js, plain, or an array. */
export type Vec3Like = { readonly x: number; readonly y: number; readonly z: number } | readonly [number, number, number] | Float32Array;
/** A quaternion: of three.js, plain, or an array x, y, z, w. */
export type QuatLike =
  | { readonly x: number; readonly y: number; readonly z: number; readonly w: number }
  | readonly [number, number, number, number]
  | Float32Array;
export interface Vec3 { x: number; y: number; z: number }
export interface Quat { x: number; y: number; z: number; w: number }
export interface Pose { position: Vec3; rotation: Quat }
export interface Velocity { linear: Vec3; angular: Vec3 }
export type Quality = 'fast' | 'balanced' | 'exact';

export interface WorldOptions {
  /** m/s². Default (0, -9.81, 0). */
  gravity?: Vec3Like;
  /** Length of a step, seconds. Default 1/60. */
  stepSeconds?: number;
  /** Substeps of a step, at least 1. Default 4. */
  substeps?: number;
  /** Work that a step does. Default balanced. */
  quality?: Quality;
  /** True if bodies at rest may fall asleep. Default true. */
  sleeping?: boolean;
  /** Most steps that one update takes. Default 15. */
  catchUpSteps?: number;
  /** Least speed of which a hit is told, m/s. Default 1. */
  hitSpeed?: number;
}

/** Surface and filter of a shape. */
export interface SurfaceOptions {
  /** kg/m³. Default 1000. */
  density?: number;
  /** Coulomb's coefficient, at least 0. Default 0.6. */
  friction?: number;
  /** Share of the speed given back, 0 to 1. Default 0. */
  restitution?: number;
  /** True if it only reports what it meets. Default false. */
  sensor?: boolean;
  /** Bits of the layers that it is on. Default 1. */
  layers?: number;
  /** Bits of the layers that it meets. Default all. */
  mask?: number;
}

/** A shape by its sizes, metres. */
export type Geometry =
  | { type: 'box'; halfExtents: Vec3Like }
  | { type: 'sphere'; radius: number }
  /** Along y; `halfHeight`: half of the segment without its caps. */
  | { type: 'capsule'; halfHeight: number; radius: number }
  | { type: 'taperedCapsule'; halfHeight: number; radiusBottom: number; radiusTop: number }
  | { type: 'cylinder'; halfHeight: number; radius: number }
  | { type: 'cone'; halfHeight: number; radius: number }
  /** All below y = 0 of its frame; static bodies only. */
  | { type: 'halfSpace' }
  /** The convex hull of points. */
  | { type: 'hull'; points: ArrayLike<number> }
  /** One-sided triangles; for bodies that are not dynamic. */
  | { type: 'mesh'; vertices: ArrayLike<number>; indices: ArrayLike<number> }
  /** Heights of a grid, row after row along x, centred on its origin; for bodies that are not dynamic. */
  | { type: 'heightField'; columns: number; rows: number; spacing: number; heights: ArrayLike<number> };

/** A shape, and where it is in its body. */
export type ShapeOptions = Geometry & SurfaceOptions & { position?: Vec3Like; rotation?: QuatLike };

export type BodyKind = 'dynamic' | 'static' | 'kinematic';

/** A body to be added; surface and filter are those of shapes that do not say their own. */
export interface BodyOptions extends SurfaceOptions {
  /** Default dynamic. */
  kind?: BodyKind;
  position?: Vec3Like;
  rotation?: QuatLike;
  /** m/s. */
  linearVelocity?: Vec3Like;
  /** rad/s. */
  angularVelocity?: Vec3Like;
  /** 1/s. Default 0. */
  linearDamping?: number;
  /** 1/s. Default 0. */
  angularDamping?: number;
  /** Default 1. */
  gravityScale?: number;
  shape?: ShapeOptions;
  shapes?: ShapeOptions[];
  /** kg, distributed as the shapes are; by default their densities say. */
  mass?: number;
  /** True if it may fall asleep. Default true. */
  sleeping?: boolean;
  quality?: Quality;
}

/** Drives a joint toward a speed, else toward a pose. */
export interface MotorOptions {
  /** rad/s of a hinge, m/s of a slider. */
  speed?: number;
  /** Angle of a hinge, radians; place of a slider, metres. */
  target?: number;
  /** Turn of a ball joint, as a scaled axis, radians. */
  turn?: Vec3Like;
  /** Frequency of the spring toward a pose, Hz. Default 5. */
  hertz?: number;
  /** 1, the default, is critical. */
  dampingRatio?: number;
  /** N. Default no bound. */
  maxForce?: number;
  /** N·m. Default no bound. */
  maxTorque?: number;
}

/** A joint to be added, where its bodies are now. */
export interface JointOptions {
  type: 'ball' | 'hinge' | 'slider' | 'fixed' | 'distance';
  a: bigint;
  b: bigint;
  /** World; of a distance joint its end at A. Every type but fixed needs it. */
  anchor?: Vec3Like;
  /** World: end of a distance joint at B. */
  anchorB?: Vec3Like;
  /** World: axis of a hinge or a slider, twist axis of a ball joint. */
  axis?: Vec3Like;
  /** Radians of a hinge, metres of a slider or a distance joint. A distance joint without one is a rod. */
  range?: readonly [number, number];
  /** Half angle of a ball joint's cone, radians. */
  swing?: number;
  /** Twist of a ball joint, radians. */
  twist?: readonly [number, number];
  /** True if its bodies collide with each other. Default false. */
  collide?: boolean;
  /** N·m of rotations, N of translations. Default 0. */
  friction?: number;
  /** N. Default unbreakable. */
  breakForce?: number;
  /** N·m. Default unbreakable. */
  breakTorque?: number;
  /** Pulls what is free back to where it was when the joint was made. */
  spring?: { hertz?: number; dampingRatio?: number };
  motor?: MotorOptions;
}

export interface QueryOptions {
  /** Bits of the layers that are asked. Default all. */
  mask?: number;
  /** Kinds of bodies that are asked. Default all. */
  kinds?: BodyKind[];
  /** True if sensors answer as well. Default false. */
  sensors?: boolean;
  /** Bodies that are left out. */
  except?: bigint[];
}

/** First contact of a ray or a moved shape with a body. */
export interface Hit {
  body: bigint;
  /** Number of the shape in its body. */
  shape: number;
  /** Share of the way before the hit, 0 to 1. */
  fraction: number;
  /** World. */
  point: Vec3;
  /** Out of the body, unit. */
  normal: Vec3;
}

/** An event of a step. `character` is the index of a character in its world, `bone` the name of its body. */
export type PhysicsEvent =
  | { type: 'begin' | 'end' | 'sensorBegin' | 'sensorEnd'; a: bigint; b: bigint }
  | { type: 'hit'; a: bigint; b: bigint; point: Vec3; normal: Vec3; speed: number; impulse: number }
  | { type: 'broken'; joint: bigint }
  | { type: 'quarantined'; body: bigint }
  | CharacterEvent;

export type CharacterEvent = { character: number } & (
  | { type: 'pushed' | 'flinched' | 'detached'; bone: string }
  | { type: 'struck'; bone: string; impulse: number }
  | { type: 'clip'; name: string; payload: string }
  | { type: 'touch' | 'part'; bone: string; other: bigint }
  | { type: 'letGo'; bone: string; held: bigint }
  | { type: 'caught'; steps: number }
  | { type: 'settled'; since: number }
  | { type: 'preparing'; rolls: boolean }
  | { type: 'recovered' | 'powered' | 'stumbled' | 'limp' | 'landed' | 'neverSettled' | 'gettingUp' | 'up' }
);

export interface RopeOptions {
  from: Vec3Like;
  to: Vec3Like;
  /** Number of its springs. Default one for each 0.1 m. */
  links?: number;
  /** kg. Default 0.1 kg a metre. */
  mass?: number;
  /** Metres. Default 0.01. */
  radius?: number;
  /** What holds its first end where it is: the world, or a body by its id. Default nothing. */
  holdFrom?: 'world' | bigint;
  /** What holds its last end. */
  holdTo?: 'world' | bigint;
}

export interface ClothOptions {
  /** World. */
  corner: Vec3Like;
  /** From the corner along the first row. */
  across: Vec3Like;
  /** From the corner along the first column, at right angles to `across`. */
  down: Vec3Like;
  /** Number of springs in a row. Default one for each 0.1 m. */
  columns?: number;
  /** Number of springs in a column. */
  rows?: number;
  /** kg. Default 0.2 kg/m². */
  mass?: number;
  /** What holds it: its corners by number (0 and 1 of the first row, 2 and 3 of the last), or all of the first row. Default nothing. */
  hang?: 'firstRow' | readonly number[];
}

export interface SoftBallOptions {
  center: Vec3Like;
  /** Metres. */
  radius: number;
  /** kg. Default 100 kg/m³. */
  mass?: number;
}

/** Spring toward the pose of the clips: by name, or by numbers. */
export type MuscleOptions = 'relaxed' | 'alive' | 'stiff' | { hertz: number; dampingRatio?: number; strength?: number };
/** Spring that holds a body near its place in the clips: by name, or by numbers. */
export type PinOptions = 'soft' | 'firm' | { hertz: number; dampingRatio?: number; maxForce: number; maxTorque: number };
export type DriveMode = 'limp' | 'keyed' | { muscle: MuscleOptions; pin?: PinOptions };

export interface CharacterOptions {
  /** Name of the file, for messages; its words are hints on the character's kind. */
  name?: string;
  /** Ragdoll settings, as `NAME.ragdoll.json` has them. */
  settings?: string | object;
  /** Files beside a glTF that is not in one piece, by their paths in it. */
  files?: Record<string, Uint8Array>;
  /** Height in the bind pose, metres. By default it is told from the file. */
  height?: number;
  /** kg. By default it is told from the size. */
  mass?: number;
  /** Source of the springs of hair and the like: the file's, those and else by names of joints, or none. Default file. */
  springs?: 'file' | 'names' | 'none';
  /** Garments by names of joints, or none. Default none. */
  garments?: 'names' | 'none';
  /** Name of the clip that loops until something happens, and by which it goes. By default a walk, else an idle. */
  looped?: string;
  /** What it does once it lies still. Default it gets up, if it has a clip to get up by. */
  afterSettling?: 'getUp' | 'stayDown';
  /** How its bodies are driven while it falls. Default limp. */
  falling?: DriveMode;
  /** N·s of a blow that fells it; 0: every blow does. Default 0.6 m/s times its mass. */
  toughness?: number;
  /** True if events report what its bodies touch. Default false. */
  tellsContacts?: boolean;
}

export type CharacterState = 'animated' | 'limp' | 'preparing' | 'gettingUp' | 'flinching' | 'powered';
export type CharacterPreset = 'animated' | 'flinching' | 'powered' | 'limp';
/** Full; bodies that give no way; a mover and clips alone; nothing at all. */
export type CharacterDetail = 'full' | 'hitBodies' | 'keyed' | 'frozen';

export interface HoldOptions {
  /** Place of what is held in the frame of the hand's body. */
  position?: Vec3Like;
  rotation?: QuatLike;
  /** True if it is dropped when the character goes limp. Default false. */
  drops?: boolean;
  /** N. Default unbreakable. */
  breakForce?: number;
  /** N·m. Default unbreakable. */
  breakTorque?: number;
}

export interface GrabOptions {
  /** N. Default 1300. */
  maxForce?: number;
  /** Metres. Default 0.25. */
  reach?: number;
  /** Distance by which it slips at full force before it lets go, metres. Default 0.4 of a hand, no bound of a point. */
  slip?: number;
  /** m/s. Default 1 of a hand, 2.5 of a point. */
  speed?: number;
}

export interface PlayOptions {
  /** Seconds of the crossfade. Default 0.25. */
  fade?: number;
  /** Clip seconds a second. Default 1. */
  speed?: number;
  /** True if it plays on and on. Default true. */
  loop?: boolean;
}

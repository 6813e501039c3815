/** A vector, of three.js, as a plain object, or as an array; metres for positions. */
export type Vec3Like = { readonly x: number; readonly y: number; readonly z: number } | readonly [number, number, number] | Float32Array;
/** A quaternion, of three.js, as a plain object, or as an array x, y, z, w. */
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
  /** Gravity, m/s². Default (0, -9.81, 0). */
  gravity?: Vec3Like;
  /** Length of a step, seconds. Default 1/60. */
  stepSeconds?: number;
  /** Substeps of a step, at least 1. Default 4. */
  substeps?: number;
  /** Quality of a step. Default balanced. */
  quality?: Quality;
  /** True if bodies at rest may fall asleep. Default true. */
  sleeping?: boolean;
  /** Largest number of steps per update. Default 15. */
  catchUpSteps?: number;
  /** Smallest speed of a reported hit, m/s. Default 1. */
  hitSpeed?: number;
}

/** Surface and filter of a shape. */
export interface SurfaceOptions {
  /** Density, kg/m³. Default 1000. */
  density?: number;
  /** Coefficient of Coulomb friction, at least 0. Default 0.6. */
  friction?: number;
  /** Coefficient of restitution, 0 to 1. Default 0. */
  restitution?: number;
  /** True if the shape only reports overlaps. Default false. */
  sensor?: boolean;
  /** Bits of the layers to which the shape belongs. Default 1. */
  layers?: number;
  /** Bits of the layers with which the shape collides. Default all. */
  mask?: number;
}

/** A shape with its sizes, metres. */
export type Geometry =
  | { type: 'box'; halfExtents: Vec3Like }
  | { type: 'sphere'; radius: number }
  /** Capsule along y; `halfHeight`: half of the segment without its caps. */
  | { type: 'capsule'; halfHeight: number; radius: number }
  | { type: 'taperedCapsule'; halfHeight: number; radiusBottom: number; radiusTop: number }
  | { type: 'cylinder'; halfHeight: number; radius: number }
  | { type: 'cone'; halfHeight: number; radius: number }
  /** All points below y = 0 of its frame; static bodies only. */
  | { type: 'halfSpace' }
  /** The convex hull of points. */
  | { type: 'hull'; points: ArrayLike<number> }
  /** One-sided triangles; not for dynamic bodies. */
  | { type: 'mesh'; vertices: ArrayLike<number>; indices: ArrayLike<number> }
  /** Heights of a grid, row by row along x, centred on its origin; not for dynamic bodies. */
  | { type: 'heightField'; columns: number; rows: number; spacing: number; heights: ArrayLike<number> };

/** A shape with its pose in the body. */
export type ShapeOptions = Geometry & SurfaceOptions & { position?: Vec3Like; rotation?: QuatLike };

export type BodyKind = 'dynamic' | 'static' | 'kinematic';

/** Definition of a body; surface and filter apply to shapes that have none of their own. */
export interface BodyOptions extends SurfaceOptions {
  /** Kind of the body. Default dynamic. */
  kind?: BodyKind;
  position?: Vec3Like;
  rotation?: QuatLike;
  /** Linear velocity, m/s. */
  linearVelocity?: Vec3Like;
  /** Angular velocity, rad/s. */
  angularVelocity?: Vec3Like;
  /** Linear damping, 1/s. Default 0. */
  linearDamping?: number;
  /** Angular damping, 1/s. Default 0. */
  angularDamping?: number;
  /** Factor of gravity. Default 1. */
  gravityScale?: number;
  shape?: ShapeOptions;
  shapes?: ShapeOptions[];
  /** Mass, kg, distributed over the shapes; by default computed from their densities. */
  mass?: number;
  /** True if the body may fall asleep. Default true. */
  sleeping?: boolean;
  quality?: Quality;
}

/** Motor of a joint, toward a speed or else toward a pose. */
export interface MotorOptions {
  /** Speed, rad/s for a hinge, m/s for a slider. */
  speed?: number;
  /** Angle of a hinge, radians; position of a slider, metres. */
  target?: number;
  /** Rotation of a ball joint, as a scaled axis, radians. */
  turn?: Vec3Like;
  /** Frequency of the spring toward a pose, Hz. Default 5. */
  hertz?: number;
  /** Damping ratio; 1, the default, is critical. */
  dampingRatio?: number;
  /** Largest force, N. Default unlimited. */
  maxForce?: number;
  /** Largest torque, N·m. Default unlimited. */
  maxTorque?: number;
}

/** Definition of a joint at the present poses of its bodies. */
export interface JointOptions {
  type: 'ball' | 'hinge' | 'slider' | 'fixed' | 'distance';
  a: bigint;
  b: bigint;
  /** Anchor in the world; for a distance joint, its end at A. Every type but fixed needs it. */
  anchor?: Vec3Like;
  /** End of a distance joint at B, in the world. */
  anchorB?: Vec3Like;
  /** Axis of a hinge or a slider, twist axis of a ball joint; in the world. */
  axis?: Vec3Like;
  /** Range, radians for a hinge, metres for a slider or a distance joint. A distance joint without a range is a rod. */
  range?: readonly [number, number];
  /** Half angle of the cone of a ball joint, radians. */
  swing?: number;
  /** Range of the twist of a ball joint, radians. */
  twist?: readonly [number, number];
  /** True if the two bodies collide with each other. Default false. */
  collide?: boolean;
  /** Friction, N·m for rotations, N for translations. Default 0. */
  friction?: number;
  /** Force at which the joint breaks, N. Default unbreakable. */
  breakForce?: number;
  /** Torque at which the joint breaks, N·m. Default unbreakable. */
  breakTorque?: number;
  /** Spring that pulls the free motions back to the pose at which the joint was made. */
  spring?: { hertz?: number; dampingRatio?: number };
  motor?: MotorOptions;
}

export interface QueryOptions {
  /** Bits of the layers that are included. Default all. */
  mask?: number;
  /** Kinds of bodies that are included. Default all. */
  kinds?: BodyKind[];
  /** True if sensors are included. Default false. */
  sensors?: boolean;
  /** Bodies that are excluded. */
  except?: bigint[];
}

/** First contact of a ray or a moving shape with a body. */
export interface Hit {
  body: bigint;
  /** Index of the shape in its body. */
  shape: number;
  /** Position of the hit as a fraction of the way, 0 to 1. */
  fraction: number;
  /** Point of the hit, in the world. */
  point: Vec3;
  /** Normal of the surface, outward, unit length. */
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
  /** Number of springs of the rope. Default one per 0.1 m. */
  links?: number;
  /** Mass, kg. Default 0.1 kg per metre. */
  mass?: number;
  /** Radius, metres. Default 0.01. */
  radius?: number;
  /** Holder of the first end at its position: the world, or a body by its id. Default none. */
  holdFrom?: 'world' | bigint;
  /** Holder of the last end. */
  holdTo?: 'world' | bigint;
}

export interface ClothOptions {
  /** Position in the world. */
  corner: Vec3Like;
  /** Vector from the corner along the first row. */
  across: Vec3Like;
  /** Vector from the corner along the first column, perpendicular to `across`. */
  down: Vec3Like;
  /** Number of springs in a row. Default one per 0.1 m. */
  columns?: number;
  /** Number of springs in a column. */
  rows?: number;
  /** Mass, kg. Default 0.2 kg/m². */
  mass?: number;
  /** Held part of the cloth: its corners by number (0 and 1 of the first row, 2 and 3 of the last), or all of the first row. Default none. */
  hang?: 'firstRow' | readonly number[];
}

export interface SoftBallOptions {
  center: Vec3Like;
  /** Radius, metres. */
  radius: number;
  /** Mass, kg. Default 100 kg/m³. */
  mass?: number;
}

/** Spring toward the pose of the clips, by name or by numbers. */
export type MuscleOptions = 'relaxed' | 'alive' | 'stiff' | { hertz: number; dampingRatio?: number; strength?: number };
/** Spring that holds a body near its position in the clips, by name or by numbers. */
export type PinOptions = 'soft' | 'firm' | { hertz: number; dampingRatio?: number; maxForce: number; maxTorque: number };
export type DriveMode = 'limp' | 'keyed' | { muscle: MuscleOptions; pin?: PinOptions };

export interface CharacterOptions {
  /** Name of the file, for messages; its words help to classify the character. */
  name?: string;
  /** Ragdoll settings, as in `NAME.ragdoll.json`. */
  settings?: string | object;
  /** Files to which a glTF refers, by their paths in it. */
  files?: Record<string, Uint8Array>;
  /** Height in the bind pose, metres. By default derived from the file. */
  height?: number;
  /** Mass, kg. By default derived from the size. */
  mass?: number;
  /** Source of springs, such as of hair: the file, the file or else joint names, or none. Default file. */
  springs?: 'file' | 'names' | 'none';
  /** Garments by joint names, or none. Default none. */
  garments?: 'names' | 'none';
  /** Name of the clip that loops by default and sets the locomotion. Default a walk, else an idle. */
  looped?: string;
  /** Action after the character lies still. Default get up, if it has a get-up clip. */
  afterSettling?: 'getUp' | 'stayDown';
  /** Drive of the bodies during a fall. Default limp. */
  falling?: DriveMode;
  /** Impulse of a hit that makes the character fall, N·s; 0: every hit does. Default 0.6 m/s times its mass. */
  toughness?: number;
  /** True if events report contacts of the character's bodies. Default false. */
  tellsContacts?: boolean;
}

export type CharacterState = 'animated' | 'limp' | 'preparing' | 'gettingUp' | 'flinching' | 'powered';
export type CharacterPreset = 'animated' | 'flinching' | 'powered' | 'limp';
/** Full; bodies that can be hit but not pushed; only mover and clips; frozen. */
export type CharacterDetail = 'full' | 'hitBodies' | 'keyed' | 'frozen';

export interface HoldOptions {
  /** Position of the held body in the frame of the hand's body. */
  position?: Vec3Like;
  rotation?: QuatLike;
  /** True if the held body is dropped when the character goes limp. Default false. */
  drops?: boolean;
  /** Force at which the grip breaks, N. Default unbreakable. */
  breakForce?: number;
  /** Torque at which the grip breaks, N·m. Default unbreakable. */
  breakTorque?: number;
}

export interface GrabOptions {
  /** Largest force, N. Default 1300. */
  maxForce?: number;
  /** Largest distance at which a body can be grabbed, metres. Default 0.25. */
  reach?: number;
  /** Slip at full force after which the grip opens, metres. Default 0.4 for a hand, unlimited for a point. */
  slip?: number;
  /** Largest speed of the drag, m/s. Default 1 for a hand, 2.5 for a point. */
  speed?: number;
}

export interface PlayOptions {
  /** Duration of the crossfade, seconds. Default 0.25. */
  fade?: number;
  /** Clip seconds per second. Default 1. */
  speed?: number;
  /** True if the clip loops. Default true. */
  loop?: boolean;
}

from os import PathLike
from typing import Any, Callable, Literal, Mapping, Sequence, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from typing_extensions import Unpack

from .types import BuildReport, CharacterSettings, ClipArrays, Contacts, DoctorReport, DropReport, Events, FallQuality, MeshArrays, RayHits

__all__ = [
    "__version__",
    "SinewError",
    "FileError",
    "Cancelled",
    "CharacterFile",
    "Ragdoll",
    "Model",
    "Character",
    "Actor",
    "Bake",
    "Collider",
    "Drive",
    "Field",
    "Particles",
    "LiveParticles",
    "Mover",
    "LiveCharacter",
    "World",
    "BatchWorlds",
    "bake",
    "load",
    "load_bytes",
    "load_arrays",
    "mannequin",
    "load_ragdoll",
    "load_model",
]

__version__: str

_Path = str | PathLike[str]
_Floats = NDArray[np.float32]
_Ids = NDArray[np.uint64]
_Shape = Literal["box", "sphere", "capsule", "cylinder", "cone", "half_space"]
_Quality = Literal["fast", "balanced", "exact"]
_Hit = tuple[float, str, ArrayLike]
_World = _Path | Sequence["Collider"]
_Fade = Literal["none", "linear", "smooth", "square"]

class SinewError(Exception):
    """A call that failed within Sinew."""

class FileError(SinewError):
    """A file that cannot be read or written, or is invalid; the message names the file and the place."""

class Cancelled(SinewError):
    """A bake that was cancelled by its progress function."""

def load(
    path: _Path,
    *,
    settings: Mapping[str, Any] | None = None,
    roles: Mapping[str, str] | None = None,
    ignore: Sequence[str] | None = None,
    bodies: Mapping[str, bool] | None = None,
    unit: float | None = None,
    height: float | None = None,
    mass: float | None = None,
) -> CharacterFile:
    """Reads a GLB, glTF, VRM or FBX with a skinned character. `settings` has the keys of a settings file and is used instead of the one beside the file; over it: `roles` of joints, joints to `ignore`, `bodies` that bones get or not, the file's `unit` or the character's `height` in metres, its `mass` in kg."""

def load_bytes(
    data: bytes,
    *,
    name: str = "character",
    settings: Mapping[str, Any] | None = None,
    roles: Mapping[str, str] | None = None,
    ignore: Sequence[str] | None = None,
    bodies: Mapping[str, bool] | None = None,
    unit: float | None = None,
    height: float | None = None,
    mass: float | None = None,
) -> CharacterFile:
    """Reads a character from the bytes of a GLB, VRM or FBX, or of a glTF that holds its buffers; `name` is used in errors. Other arguments as in `load`."""

def load_arrays(
    joints: Sequence[str],
    parents: ArrayLike,
    translations: ArrayLike,
    rotations: ArrayLike,
    *,
    scales: ArrayLike | None = None,
    inverse_bind: ArrayLike | None = None,
    meshes: Sequence[MeshArrays] | None = None,
    clips: Mapping[str, ClipArrays] | None = None,
    name: str = "character",
    settings: Mapping[str, Any] | None = None,
    roles: Mapping[str, str] | None = None,
    ignore: Sequence[str] | None = None,
    bodies: Mapping[str, bool] | None = None,
    unit: float | None = None,
    height: float | None = None,
    mass: float | None = None,
) -> CharacterFile:
    """Creates a character from arrays, +Y up: names of joints, their parents (n,), -1 for a root and else before them, and their rest pose in their parents: translations (n, 3), rotations (n, 4) x y z w, scales (n, 3). `inverse_bind` (n, 4, 4) is from a mesh to each joint; without it meshes are where the rest pose has them. All else as `load`."""

def bake(
    actors: Sequence[Actor],
    *,
    seconds: float = 10.0,
    fps: float = 30.0,
    world: _World | None = None,
    wind: ArrayLike | None = None,
    fields: Sequence[Field] | None = None,
    gravity: ArrayLike | None = None,
    dt: float = ...,
    substeps: int = 4,
    quality: _Quality = "balanced",
    key_error: tuple[float, float] | None = None,
    progress: Callable[[float], bool | None] | None = None,
) -> list[Bake]:
    """Simulates several characters in one world, where they meet each other. `world` is the name of a file or a list of colliders, by default a floor; `wind` and `gravity` are m/s and m/s². Keys that are not needed for an error of `key_error` (metres, radians; 0.1 mm and 0.01°) are left out. `progress` is called with the share that is done; if it returns False the bake ends with `Cancelled`."""

def mannequin() -> CharacterFile:
    """The built-in mannequin, 1.75 m, with a walk and two ways to get up."""

def load_ragdoll(path: _Path) -> Ragdoll:
    """Reads a ragdoll: a definition (.json), an MJCF or URDF model (.xml, .urdf), or a character, from which it is built."""

def load_model(path: _Path) -> Model:
    """Reads an MJCF model (.xml), a URDF (.urdf) or the physics of a glTF (.gltf, .glb): bodies, joints, and a floor if the file has one."""

@final
class CharacterFile:
    """Rigged character read from a file."""

    @property
    def name(self) -> str:
        """Name of the file, as given."""

    @property
    def joints(self) -> list[str]:
        """Names of the joints."""

    @property
    def clips(self) -> list[str]:
        """Names of the clips."""

    @property
    def roles(self) -> dict[str, str]:
        """Joint of each recognised role of the body (`hips`, `leftFoot`, ...)."""

    @property
    def notes(self) -> list[str]:
        """Assumptions: the unit, the size, skipped content."""

    def build(
        self,
        *,
        mass: float | None = None,
        height: float | None = None,
        shapes: Literal["auto", "box", "capsule"] = "auto",
        sex: Literal["male", "female"] = "male",
        limits: Literal["anatomy", "clips"] = "anatomy",
    ) -> Ragdoll:
        """Builds the ragdoll; mass in kg, height in metres."""

    def character(
        self,
        ragdoll: Ragdoll | None = None,
        *,
        clip: str | None = None,
        exact: bool = False,
        builtin_motions: bool = True,
        gets_up: bool = True,
        falling: Drive | None = None,
    ) -> Character:
        """The character with its motions; `clip` plays until it falls: with `exact` at the height of the file, whatever the ground, else on the ground. `falling` drives the bodies during the fall."""

    def glb(self) -> bytes:
        """The file as a GLB that contains its companion files; for arrays, the file built from them."""

@final
class Ragdoll:
    """Ragdoll: bodies and joints, parents before children; joint `i` holds body `i + 1`."""

    @property
    def bones(self) -> list[str]:
        """Joint that each body carries."""

    @property
    def roles(self) -> list[str]:
        """Role of each body."""

    @property
    def masses(self) -> _Floats:
        """Mass of each body, kg: (bodies,)."""

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index of each body's parent, -1 for the first: (bodies,)."""

    @property
    def torques(self) -> _Floats:
        """Largest muscle torque of each joint, N·m: (joints,)."""

    @property
    def bind_poses(self) -> _Floats:
        """Bind pose of each body, metres: (bodies, 7)."""

    @property
    def joint_frames(self) -> _Floats:
        """Frame of each joint in the parent body: (joints, 7). Its first axis is the twist's or the hinge's."""

    @property
    def total_mass(self) -> float:
        """Total mass, kg."""

    @property
    def height(self) -> float:
        """Height in the bind pose, metres."""

    @property
    def unit_scale(self) -> float:
        """Metres per unit of the file."""

    @staticmethod
    def from_json(text: str) -> Ragdoll:
        """The ragdoll of a definition's text, as `to_json` gives it."""

    def edited(
        self,
        bone: str,
        *,
        mass: float | None = None,
        shape: _Shape | None = None,
        size: Sequence[float] | None = None,
        scale: float | None = None,
        swing_y: tuple[float, float] | None = None,
        swing_z: tuple[float, float] | None = None,
        twist: tuple[float, float] | None = None,
        friction_torque: float | None = None,
    ) -> Ragdoll:
        """A copy with changes of one body (by role or bone) and the joint above it, in kg, metres, radians, N·m; omitted values stay."""

    def cured(self) -> tuple[Ragdoll, DoctorReport]:
        """A copy with the doctor's repairs, and its findings."""

    def to_mjcf(self, name: str = "ragdoll") -> tuple[str, list[str]]:
        """The definition as a MuJoCo model, and a sentence on each loss."""

    @property
    def report(self) -> BuildReport:
        """Report of the build."""

    def doctor(self) -> DoctorReport:
        """Findings of the doctor."""

    def drop_test(self) -> DropReport:
        """Drops the ragdoll and throws it at a wall."""

    def to_json(self) -> str:
        """The definition as JSON, as `sinew ragdoll build` writes it."""

    def save(self, path: _Path) -> None:
        """Writes the definition atomically."""

    def __len__(self) -> int:
        """Number of bodies."""


@final
class Model:
    """Model of bodies and joints of MuJoCo's format, with all of its shapes."""

    @property
    def name(self) -> str:
        """Name of the model."""

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""

    @property
    def joints(self) -> list[str]:
        """Names of the joints."""

    @property
    def notes(self) -> list[str]:
        """Skipped content of the file."""


@final
class Character:
    """Character with its motions."""

    @property
    def roles(self) -> list[str]:
        """Role of each body, as `hits` name them."""

    @property
    def joints(self) -> list[str]:
        """Names of the joints, in the order of pose arrays; joints added by Sinew come last."""

    @property
    def place_in_file(self) -> _Floats:
        """Pose at which the character stands as in its file: (7,). Positions of the file times its unit are then world positions."""

    @property
    def raised(self) -> float:
        """Height by which the played clip is raised onto its floor, metres; 0 for an exact one."""

    @property
    def clips(self) -> list[str]:
        """Names of the clips: the file's, and Sinew's get-ups."""

    def scaled(self, factor: float) -> Character:
        """A copy of another size: a child, a giant."""

    @property
    def swept_radius(self) -> float:
        """Radius of a mover that keeps all bodies on its side of a wall while the clip plays, metres."""

    def edited(self, **settings: Unpack[CharacterSettings]) -> Character:
        """A copy with other settings of falls, hits, getting up and motions: `sinew.types.CharacterSettings` lists them."""

    def bake(
        self,
        *,
        seconds: float = 10.0,
        fps: float = 30.0,
        hits: Sequence[_Hit] | None = None,
        flinch: bool = False,
        limp_at: float | None = None,
        drives: Sequence[Drive] | None = None,
        return_at: float | None = None,
        return_seconds: float = 0.5,
        topple: bool | None = None,
        topple_velocity: ArrayLike | None = None,
        world: _World | None = None,
        wind: ArrayLike | None = None,
        fields: Sequence[Field] | None = None,
        gravity: ArrayLike | None = None,
        dt: float = ...,
        substeps: int = 4,
        quality: _Quality = "balanced",
        key_error: tuple[float, float] | None = None,
        pose: ArrayLike | None = None,
        phase: float = 0.0,
        name: str = "sinew",
        progress: Callable[[float], bool | None] | None = None,
    ) -> Bake:
        """Simulates the character alone, as `bake` with one `Actor`. Without any action, it goes limp after half a second."""

    def random_fall(
        self, seed: int, *, seconds: float = 3.0, fps: float = 30.0, impulse: float = 120.0
    ) -> Bake:
        """A random fall: pose within the limits, ground and hit by the seed; the same bits on every machine."""

@final
class Actor:
    """Character of a bake with its hits and drives."""

    def __new__(
        cls,
        character: Character,
        *,
        hits: Sequence[_Hit] | None = None,
        flinch: bool = False,
        limp_at: float | None = None,
        drives: Sequence[Drive] | None = None,
        return_at: float | None = None,
        return_seconds: float = 0.5,
        topple: bool | None = None,
        topple_velocity: ArrayLike | None = None,
        pose: ArrayLike | None = None,
        phase: float = 0.0,
        name: str = "sinew",
    ) -> Actor:
        """A hit is a time in seconds, a body by role or joint, and an impulse in N·s; with `flinch` weak ones only cause a flinch. `drives` change what moves its bones over time. At `return_at` seconds its clip alone has the pose again; the simulated pose dies away in `return_seconds` before. With `topple` a single character that goes limp and stays upright is pushed over; by default where nothing else is done to it. `topple_velocity`: the velocity, m/s (3,), that its highest point gets at `limp_at` seconds."""

@final
class Drive:
    """Drive of a bone (by role or joint), of a bone and all `below` it, or of the whole character, from a time on."""

    def __new__(
        cls,
        mode: Literal["keyed", "powered", "pinned", "limp"],
        *,
        time: float = 0.0,
        bone: str | None = None,
        below: bool = False,
        half_life: float = 0.1,
        hertz: float = 5.0,
        damping_ratio: float = 1.0,
        strength: float = 1.0,
        pin_hertz: float = 3.0,
        pin_force: float = 400.0,
        pin_torque: float = 100.0,
    ) -> Drive:
        """`keyed`: the body follows the clip; `powered`: muscles of a `strength` up to 1 move it toward the clip as springs of this frequency; `pinned`: as `powered`, with a spring from the world too, limited in N and N·m; `limp`: only joint friction acts. Half of the change is made within `half_life` seconds."""

    @property
    def mode(self) -> str:
        """`keyed`, `powered`, `pinned` or `limp`."""

    @property
    def time(self) -> float:
        """Seconds from the start."""

    @property
    def bone(self) -> str | None:
        """Driven bone; None: all."""

    @property
    def below(self) -> bool:
        """True if everything below the bone is driven, too."""

    @property
    def half_life(self) -> float:
        """Seconds in which half of the change is made."""

@final
class Field:
    """Wind, water, gravity or drag that acts on all bodies, movers and particles."""

    @staticmethod
    def wind(
        velocity: ArrayLike,
        *,
        density: float = 1.225,
        drag: float = 1.0,
        lift: float = 0.0,
        gust_speed: float = 0.0,
        gust_length: float = 3.0,
        gust_time: float = 1.0,
        seed: int = 0,
    ) -> Field:
        """Moving air, m/s (3,), with gusts of a speed (m/s), a length (m) and a time (s)."""

    @staticmethod
    def water(
        height: float = 0.0,
        *,
        density: float = 1000.0,
        flow: ArrayLike | None = None,
        damping: float = 1.0,
        drag: float = 0.5,
    ) -> Field:
        """Water below a height, metres, with a `flow` in m/s (3,)."""

    @staticmethod
    def gravity(acceleration: ArrayLike) -> Field:
        """An acceleration added to the world's gravity, m/s² (3,)."""

    @staticmethod
    def attraction(center: ArrayLike, strength: float, *, softening: float = 0.0) -> Field:
        """Attraction to a point with a strength G·M, m³/s²; a negative one repels."""

    @staticmethod
    def mutual_gravity(constant: float = ..., *, softening: float = 0.0) -> Field:
        """Attraction of all bodies by each other; the constant is in m³/(kg s²)."""

    @staticmethod
    def drag(
        *, linear: float = 0.0, quadratic: float = 0.0, angular: float = 0.0, flow: ArrayLike | None = None
    ) -> Field:
        """Drag: N·s/m, N·s²/m², N·m·s, in a medium with a `flow` in m/s (3,)."""

    def inside(
        self,
        kind: _Shape,
        size: Sequence[float],
        *,
        pose: ArrayLike | None = None,
        margin: float = 0.0,
        fade: _Fade = "none",
    ) -> Field:
        """A copy that acts only inside a shape at a pose (7,), with full strength from `margin` metres below its surface on."""

@final
class Particles:
    """Definition of a rope, cloth or a soft ball, for `World.add_particles`."""

    @staticmethod
    def rope(
        start: ArrayLike,
        end: ArrayLike,
        *,
        links: int | None = None,
        mass: float | None = None,
        radius: float | None = None,
        stiffness: float | None = None,
    ) -> Particles:
        """A rope between two points (3,), metres: kg, metres, N/m; by default 10 mm nylon."""

    @staticmethod
    def cloth(
        corner: ArrayLike,
        across: ArrayLike,
        down: ArrayLike,
        *,
        columns: int | None = None,
        rows: int | None = None,
        mass: float | None = None,
        hang: bool = False,
    ) -> Particles:
        """A rectangle of cloth from a corner along two edges (3,), metres; with `hang` its first row is held by the world."""

    @staticmethod
    def soft_ball(center: ArrayLike, radius: float, *, mass: float | None = None) -> Particles:
        """An elastic skin filled with air."""

    def attached(self, particle: int, body: int | None = None) -> Particles:
        """A copy in which a particle is held where it is, by a body or, without one, by the world; -1 is the last particle."""

    def __len__(self) -> int:
        """Number of particles."""

@final
class LiveParticles:
    """Particles in a world."""

    @property
    def positions(self) -> _Floats:
        """Position of each particle, metres: (n, 3)."""

    @property
    def velocities(self) -> _Floats:
        """Velocity of each particle, m/s: (n, 3)."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Triangles of the surface: (t, 3); none for a rope."""

    def push(self, particle: int, impulse: ArrayLike) -> None:
        """Applies an impulse to a particle, N·s (3,)."""

    def set_position(self, particle: int, position: ArrayLike) -> None:
        """Moves a particle, metres (3,)."""

    def remove(self) -> None:
        """Removes the particles from the world."""

@final
class Mover:
    """Upright capsule in a world that walks, climbs steps and jumps."""

    @property
    def position(self) -> _Floats:
        """Lowest point, metres: (3,)."""

    @property
    def velocity(self) -> _Floats:
        """Velocity, m/s: (3,)."""

    @property
    def grounded(self) -> bool:
        """True if the mover stands on the ground."""

    @property
    def ground(self) -> int | None:
        """Id of the body below the mover; None in the air and on another mover."""

    def walk(self, velocity: ArrayLike) -> None:
        """Sets the walking velocity relative to the ground, m/s (3,)."""

    def jump(self, speed: float = 3.5) -> None:
        """Jumps from the ground in the next step, with an upward speed, m/s."""

    def launch(self, velocity: ArrayLike) -> None:
        """Throws the mover with a velocity, m/s (3,)."""

    def teleport(self, position: ArrayLike) -> None:
        """Teleports the lowest point, metres (3,)."""

    def set_height(self, height: float) -> bool:
        """Changes the height, metres; False if there is no space to grow."""

    def remove(self) -> None:
        """Removes the mover from the world."""

@final
class Collider:
    """Body of a world, besides characters. Static unless `dynamic` or `keyed`."""

    def __new__(
        cls,
        kind: _Shape,
        size: Sequence[float],
        *,
        pose: ArrayLike | None = None,
        friction: float = 0.6,
        restitution: float = 0.0,
    ) -> Collider:
        """A shape as `World.add_body` takes it, at a pose (7,)."""

    @staticmethod
    def floor(height: float = 0.0, *, friction: float = 0.6) -> Collider:
        """A half-space below a height, metres."""

    @staticmethod
    def mesh(
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        pose: ArrayLike | None = None,
        friction: float = 0.6,
        restitution: float = 0.0,
    ) -> Collider:
        """A surface of triangles: vertices (v, 3) in metres, triangles (t, 3), counter-clockwise seen from outside."""

    @staticmethod
    def hull(
        points: ArrayLike, *, pose: ArrayLike | None = None, friction: float = 0.6, restitution: float = 0.0
    ) -> Collider:
        """The convex hull of points (n, 3), metres."""

    @staticmethod
    def load(path: _Path) -> list[Collider]:
        """All bodies of a world file (.json) or a mesh (.glb, .obj)."""

    def dynamic(self, *, density: float = 1000.0) -> Collider:
        """A copy moved by forces; density in kg/m³."""

    def keyed(self, times: ArrayLike, poses: ArrayLike) -> Collider:
        """A copy moved to poses (n, 7) at times (n,) in seconds, regardless of obstacles."""

@final
class Bake:
    """Result of a bake: poses, events, metrics, and a clip."""

    @property
    def times(self) -> _Floats:
        """Seconds of each frame: (frames,)."""

    @property
    def states(self) -> list[str]:
        """State of the character in each frame: `animated`, `limp`, `preparing`, `getting up`, ..."""

    @property
    def translations(self) -> _Floats:
        """Local translation of each joint, in the file's unit: (frames, joints, 3)."""

    @property
    def rotations(self) -> _Floats:
        """Local rotation of each joint, x y z w: (frames, joints, 4)."""

    @property
    def positions(self) -> _Floats:
        """Position of each joint in the world, metres: (frames, joints, 3)."""

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index of each joint's parent, -1 for a root: (joints,)."""

    @property
    def events(self) -> list[tuple[float, str]]:
        """Time in seconds and name of each event."""

    @property
    def hits(self) -> list[tuple[float, str, list[float]]]:
        """Hits: time in seconds, body, impulse in N·s."""

    @property
    def quality(self) -> FallQuality:
        """Metrics of the fall."""

    @property
    def verdict(self) -> str:
        """`good`, `usable` or `bad`."""

    @property
    def reasons(self) -> list[str]:
        """Reasons for a verdict that is not `good`."""

    @property
    def steps(self) -> int:
        """Number of simulated steps."""

    @property
    def bodies(self) -> int:
        """Number of bodies of the ragdoll."""

    @property
    def keys(self) -> tuple[int, int]:
        """Number of keys before and after unneeded ones were left out."""

    @property
    def key_error(self) -> tuple[float, float]:
        """Largest error of the clip's keys against the frames: metres, radians."""

    @property
    def world_from_model(self) -> _Floats:
        """Matrix from the file's space to the world: (3, 4)."""

    @property
    def hash(self) -> int:
        """Hash of the state at the end: equal on every machine."""

    def glb(self, *, mesh: bool = True) -> bytes:
        """The file with the clip, or only its bones with the clip if `mesh` is false."""

    def usda(self, *, physics: bool = True) -> tuple[str, list[str]]:
        """The character, its motion and its ragdoll as USD text (.usda), and a sentence on each loss."""

    def save(self, path: _Path, *, mesh: bool = True) -> None:
        """Writes the file of `glb` atomically."""

@final
class World:
    """World of bodies and joints. Metres, kilograms, seconds, radians; +Y is up."""

    def __new__(
        cls,
        *,
        gravity: ArrayLike | None = None,
        dt: float = ...,
        substeps: int = 4,
        quality: _Quality = "balanced",
        sleeping: bool = True,
        threads: int = 1,
    ) -> World: ...
    def add_body(
        self,
        kind: _Shape,
        size: Sequence[float],
        *,
        pose: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        body: Literal["dynamic", "static", "kinematic"] = "dynamic",
        density: float = 1000.0,
        friction: float = 0.6,
        restitution: float = 0.0,
    ) -> int:
        """Adds a body of one shape and returns its id. `size` is metres: half extents of a box, radius of a sphere, radius and half height of others; density kg/m³."""

    def add_floor(self, height: float = 0.0) -> int:
        """Adds a fixed half-space below that height, metres, and returns its id."""

    def add_ragdoll(
        self,
        ragdoll: Ragdoll,
        *,
        pose: ArrayLike | None = None,
        poses: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
    ) -> tuple[_Ids, _Ids]:
        """Adds a ragdoll and returns ids of its bodies (n,) and joints (n - 1,). `pose` (7,) moves the bind pose; `poses` (n, 7) and `velocities` (n, 6) are of each body."""

    def add_collider(self, collider: Collider) -> int:
        """Adds a collider and returns its id; a keyed one follows its keys from the world's time 0 on."""

    def add_character(
        self, character: Character, *, pose: ArrayLike | None = None, phase: float = 0.0
    ) -> LiveCharacter:
        """Adds a character, standing at a pose (7,), `phase` seconds into its clip; updated after every step."""

    def add_field(self, field: Field) -> int:
        """Adds a field and returns its id."""

    def add_wind(
        self,
        velocity: ArrayLike,
        *,
        gust_speed: float = 0.0,
        gust_length: float = 3.0,
        gust_time: float = 1.0,
        seed: int = 0,
    ) -> int:
        """Adds wind, m/s, with gusts of a speed (m/s), a length (m) and a time (s), and returns its id."""

    def remove_field(self, field: int) -> None:
        """Removes a field."""

    def explode(
        self,
        center: ArrayLike,
        radius: float,
        impulse: float,
        *,
        fade: _Fade = "linear",
        sheltered: bool = False,
    ) -> None:
        """Explodes at a point (3,): everything within a radius, metres, gets an impulse per area, N·s/m² at the centre; with `sheltered` not behind static bodies."""

    def add_particles(self, particles: Particles) -> LiveParticles:
        """Adds a rope, cloth or a soft ball."""

    def add_mover(
        self,
        position: ArrayLike,
        *,
        radius: float = 0.3,
        height: float = 1.8,
        mass: float = 80.0,
        push_force: float = 800.0,
        step_height: float = 0.35,
    ) -> Mover:
        """Adds a mover with its lowest point at a position (3,); metres, kg, N."""

    def remove_body(self, body: int) -> None:
        """Removes a body with its joints."""

    def add_joint(
        self,
        kind: Literal["ball", "hinge", "slider", "fixed"],
        a: int,
        b: int,
        anchor: ArrayLike,
        *,
        axis: ArrayLike | None = None,
        range: tuple[float, float] | None = None,
    ) -> int:
        """Joins two bodies at a point of the world, metres; `range` is in radians, for a slider in metres. Returns its id."""

    def remove_joint(self, joint: int) -> None:
        """Removes a joint."""

    def drive_joint(
        self,
        joint: int,
        target: ArrayLike,
        *,
        hertz: float,
        damping_ratio: float = 1.0,
        max_torque: float = ...,
    ) -> None:
        """Drives a joint toward a rotation (3,), a scaled axis in radians, by a spring of a frequency in Hz with a largest torque, N·m."""

    def step(self, count: int = 1) -> None:
        """Takes `count` steps, without the GIL."""

    @property
    def step_count(self) -> int:
        """Number of steps taken."""

    @property
    def time(self) -> float:
        """Simulated time, seconds."""

    @property
    def body_ids(self) -> _Ids:
        """Ids of all bodies."""

    @property
    def joint_ids(self) -> _Ids:
        """Ids of all joints."""

    def poses(self, bodies: ArrayLike | None = None) -> _Floats:
        """Poses of bodies, of all by default: (n, 7)."""

    def velocities(self, bodies: ArrayLike | None = None) -> _Floats:
        """Velocities of bodies, linear m/s and angular rad/s: (n, 6)."""

    def set_poses(self, bodies: ArrayLike, poses: ArrayLike) -> None:
        """Sets poses of bodies: (n, 7)."""

    def set_velocities(self, bodies: ArrayLike, velocities: ArrayLike) -> None:
        """Sets velocities of bodies: (n, 6)."""

    def push(self, body: int, impulse: ArrayLike, *, point: ArrayLike | None = None) -> None:
        """Applies an impulse to a body, N·s: (3,), at its centre of mass or at a point of the world, metres."""

    def ray(self, origins: ArrayLike, ways: ArrayLike) -> RayHits:
        """First hits of rays from `origins` (n, 3) along `ways` (n, 3), metres; a ray ends at `origin + way`. Without a hit the body is 2**64 - 1 and the fraction 1."""

    def overlap(self, kind: _Shape, size: Sequence[float], pose: ArrayLike) -> _Ids:
        """Ids of bodies that a shape at a pose overlaps."""

    def contacts(self) -> Contacts:
        """Points of contact of the last step."""

    def events(self) -> Events:
        """Events of the last step: pairs of bodies that begin and end touching, and that hit each other."""

    def joint_gap(self, joint: int) -> float:
        """Distance between the anchors of a joint, metres."""

    def joint_turn(self, joint: int) -> _Floats:
        """Rotation of a joint from its frame, a scaled axis in radians: (3,)."""

    def hash(self) -> int:
        """Hash of the state, characters included: equal on every machine."""

    def save(self) -> bytes:
        """State as bytes, characters included, for `load`."""

    def load(self, state: bytes) -> None:
        """Restores a saved state."""


@final
class LiveCharacter:
    """Character in a world, updated after every step."""

    @property
    def state(self) -> str:
        """`animated`, `limp`, `preparing`, `getting up`, `flinching` or `powered`."""

    @property
    def events(self) -> list[str]:
        """Events of the last step, and of calls since."""

    @property
    def pose(self) -> _Floats:
        """Pose of the character in the world: (7,)."""

    @property
    def translations(self) -> _Floats:
        """Local translation of each joint, in the file's unit: (joints, 3)."""

    @property
    def rotations(self) -> _Floats:
        """Local rotation of each joint, x y z w: (joints, 4)."""

    @property
    def positions(self) -> _Floats:
        """Position of each joint in the world, metres: (joints, 3)."""

    def pose_without_springs(self) -> tuple[_Floats, _Floats]:
        """Local translations (joints, 3) and rotations (joints, 4) without the motion of springs."""

    def interpolated(self, alpha: float) -> tuple[_Floats, _Floats, _Floats]:
        """The pose `alpha` between the last step and this: of the character (7,), local translations (joints, 3) and rotations (joints, 4)."""

    @property
    def world_from_model(self) -> _Floats:
        """Matrix from the file's space to the world: (3, 4)."""

    @property
    def stumbles(self) -> bool:
        """True if the character is powered and takes steps to catch a push."""

    @property
    def level_of_detail(self) -> str:
        """`full`, `hit_bodies`, `keyed` or `frozen`."""

    @property
    def gets_up(self) -> bool:
        """True if the character gets up after lying still."""

    def set_gets_up(self, gets_up: bool) -> None:
        """Sets whether the character gets up after lying still."""

    @property
    def mover(self) -> Mover | None:
        """Mover of the character, or None."""

    @property
    def garments(self) -> list[LiveParticles]:
        """Particles of the garments."""

    @property
    def lost_joints(self) -> list[str]:
        """Joints of detached limbs."""

    def skin_matrices(self, skin: int = 0, *, alpha: float = 1.0) -> _Floats:
        """Matrices from a mesh's bind pose to the world for each joint of a skin, `alpha` between the last step and this: (joints of the skin, 3, 4)."""

    @property
    def bodies(self) -> _Ids:
        """Ids of the character's bodies, in the order of `Character.roles`; empty while none are in the world."""

    def set_move(self, velocity: ArrayLike | None) -> None:
        """Sets the velocity over the ground, m/s (3,); None: that of the clips."""

    def face(self, direction: ArrayLike) -> None:
        """Turns the character to face a direction (3,)."""

    def jump(self) -> None:
        """Jumps in the next step, if the character is on the ground."""

    def hit(self, bone: str, impulse: ArrayLike) -> float:
        """Hits a body, by role or joint, with an impulse in N·s (3,); returns its work, J."""

    def hit_at(self, body: int, point: ArrayLike, impulse: ArrayLike) -> float | None:
        """Hits one of the character's bodies, by id, at a point of the world (3,), with an impulse in N·s (3,); returns its work, J, or None if the body is not the character's."""

    def go_limp(self) -> None:
        """Makes the character limp."""

    def set_preset(self, preset: Literal["animated", "flinching", "powered", "limp"]) -> None:
        """Changes the drive of the whole character."""

    def set_drive(self, drive: Drive) -> None:
        """Changes the drive of a part from now on; the drive's time is ignored."""

    def return_to_clip(self, pose: ArrayLike, *, phase: float = 0.0, seconds: float = 0.5) -> None:
        """Blends the character back to its clip at `phase` seconds, at a pose (7,), within `seconds`."""

    def teleport(self, pose: ArrayLike) -> None:
        """Teleports the character to a pose (7,)."""

    def clear(self) -> bool:
        """Moves a limp character out of static shapes that it is deep in; False if it is in none."""

    def hold(self, bone: str, body: int, *, pose: ArrayLike | None = None, drops: bool = False, max_force: float = ..., max_torque: float = ...) -> int:
        """Makes a bone hold a dynamic body; `pose` (7,) is the body's pose in the bone's frame. Returns the joint's id."""

    def grab(self, bone: str, body: int, *, max_force: float = 1300.0, reach: float = 0.25, slip: float = 0.4, speed: float = 1.0, to: ArrayLike | None = None, drops: bool = True) -> int | None:
        """Makes a bone grab a body within reach (m), also one of another character, with a force in N. Returns the joint's id, or None."""

    def release(self, body: int) -> bool:
        """Releases a held body; False if it was not held."""

    @property
    def held(self) -> _Ids:
        """Ids of held bodies."""

    def detach(self, bone: str) -> _Ids | None:
        """Detaches a limb with everything below it; returns the ids of its bodies, or None if it was detached before."""

    def set_level_of_detail(self, detail: Literal["full", "hit_bodies", "keyed", "frozen"]) -> None:
        """Sets the level of detail."""

    def reset_springs(self) -> None:
        """Restarts the springs at rest."""

    def reset_garments(self) -> None:
        """Restarts the garments at rest."""

    def despawn(self) -> None:
        """Removes the character from the world."""


@final
class BatchWorlds:
    """Worlds with one figure each, on a floor. Each has the same bits as it would alone, for any number of threads."""

    def __new__(
        cls,
        figure: Ragdoll | Model,
        count: int,
        *,
        floor: bool = True,
        dt: float = ...,
        substeps: int = 4,
        quality: _Quality = "balanced",
        sleeping: bool = False,
        threads: int = 0,
    ) -> BatchWorlds: ...
    def __len__(self) -> int:
        """Number of worlds."""

    @property
    def bodies(self) -> list[str]:
        """Roles or names of the figure's bodies."""

    @property
    def joint_count(self) -> int:
        """Number of the figure's joints."""

    @property
    def threads(self) -> int:
        """Number of threads that step the worlds."""

    def step(self, count: int = 1) -> None:
        """Takes `count` steps in each world, without the GIL."""

    def reset(
        self,
        worlds: ArrayLike | None = None,
        *,
        poses: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
    ) -> None:
        """Resets the given worlds, or all, to their initial states, with initial `poses` (worlds, bodies, 7) and `velocities` (worlds, bodies, 6) if given."""

    def push(self, body: int, impulses: ArrayLike) -> None:
        """Applies an impulse to a body of each world, N·s: (worlds, 3)."""

    def drive(
        self, targets: ArrayLike, *, stiffness: ArrayLike, damping: ArrayLike, max_torques: ArrayLike
    ) -> None:
        """Drives the joints of each world toward rotations (worlds, joints, 3), scaled axes in radians: stiffness N·m/rad, damping N·m·s/rad and torque N·m of each joint (joints,)."""

    def poses(self) -> _Floats:
        """Poses of all bodies: (worlds, bodies, 7)."""

    def velocities(self) -> _Floats:
        """Velocities of all bodies: (worlds, bodies, 6)."""

    def joint_turns(self) -> _Floats:
        """Rotations of all joints, scaled axes in radians: (worlds, joints, 3)."""

    def joint_gaps(self) -> _Floats:
        """Largest gap of a joint in each world, metres: (worlds,)."""

    def depths(self) -> _Floats:
        """Deepest overlap in each world, metres: (worlds,)."""

    def hashes(self) -> _Ids:
        """Hash of each world's state: (worlds,)."""

    def contacts(self, world: int) -> Contacts:
        """Points of contact of one world."""

    def carried(self, motions: ArrayLike) -> _Floats:
        """Initial poses of the figure, moved by a pose for each world (worlds, 7): (worlds, bodies, 7), for `reset`."""


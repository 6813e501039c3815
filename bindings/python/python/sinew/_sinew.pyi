from os import PathLike
from typing import Literal, Sequence, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .types import BuildReport, Contacts, DoctorReport, DropReport, Events, FallQuality, RayHits

__all__ = [
    "__version__",
    "SinewError",
    "FileError",
    "CharacterFile",
    "Ragdoll",
    "Model",
    "Character",
    "Bake",
    "World",
    "BatchWorlds",
    "load",
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

class SinewError(Exception):
    """A call that failed within Sinew."""

class FileError(SinewError):
    """A file that cannot be read or written, or is not what it should be: the message names the file and the place."""

def load(path: _Path) -> CharacterFile:
    """Reads a GLB, glTF, VRM or FBX with a skinned character, and the settings beside it."""

def mannequin() -> CharacterFile:
    """The mannequin that comes with Sinew, 1.75 m, with a walk and two ways to get up."""

def load_ragdoll(path: _Path) -> Ragdoll:
    """Reads a ragdoll: a definition (.json), an MJCF model (.xml), or a character, of which it is built."""

def load_model(path: _Path) -> Model:
    """Reads an MJCF model: bodies, joints, and a floor where it has one."""

@final
class CharacterFile:
    """Rigged character as it was read."""

    @property
    def name(self) -> str:
        """Name of the file, as it was given."""

    @property
    def joints(self) -> list[str]:
        """Names of its joints."""

    @property
    def clips(self) -> list[str]:
        """Names of its clips."""

    @property
    def roles(self) -> dict[str, str]:
        """Joint of each role of the body that was recognised (`hips`, `leftFoot`, ...)."""

    @property
    def notes(self) -> list[str]:
        """Assumptions that were made: the unit, the size, what was left out."""

    def build(
        self,
        *,
        mass: float | None = None,
        height: float | None = None,
        shapes: Literal["auto", "box", "capsule"] = "auto",
        sex: Literal["male", "female"] = "male",
        limits: Literal["anatomy", "clips"] = "anatomy",
    ) -> Ragdoll:
        """Builds its ragdoll; mass in kg, height in metres."""

    def character(self, ragdoll: Ragdoll | None = None, *, clip: str | None = None) -> Character:
        """The character with its motions; `clip` plays until it falls."""

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
        """Index of the body that each hangs on, -1 for the first: (bodies,)."""

    @property
    def torques(self) -> _Floats:
        """Torque that the muscles of each joint can do, N·m: (joints,)."""

    @property
    def bind_poses(self) -> _Floats:
        """Pose of each body as the character was bound, metres: (bodies, 7)."""

    @property
    def joint_frames(self) -> _Floats:
        """Frame of each joint in the parent body: (joints, 7). Its first axis is the twist's or the hinge's."""

    @property
    def total_mass(self) -> float:
        """Mass of all of it, kg."""

    @property
    def height(self) -> float:
        """Height as it was bound, metres."""

    @property
    def report(self) -> BuildReport:
        """Report of the build."""

    def doctor(self) -> DoctorReport:
        """Findings of the doctor."""

    def drop_test(self) -> DropReport:
        """Drops it and throws it at a wall."""

    def to_json(self) -> str:
        """The definition as JSON, as `sinew ragdoll build` writes it."""

    def save(self, path: _Path) -> None:
        """Writes the definition, whole or not at all."""

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
        """Names of its bodies."""

    @property
    def joints(self) -> list[str]:
        """Names of its joints."""

    @property
    def notes(self) -> list[str]:
        """What was left out of the file."""


@final
class Character:
    """Character with its motions."""

    @property
    def roles(self) -> list[str]:
        """Role of each body, as `hits` name them."""

    def bake(
        self,
        *,
        seconds: float = 10.0,
        fps: float = 30.0,
        hits: Sequence[_Hit] | None = None,
        limp_at: float | None = None,
        world: _Path | None = None,
        pose: ArrayLike | None = None,
        phase: float = 0.0,
        name: str = "sinew",
    ) -> Bake:
        """Simulates it. A hit is a time in seconds, a body by role or joint, and an impulse in N·s."""

    def random_fall(
        self, seed: int, *, seconds: float = 3.0, fps: float = 30.0, impulse: float = 120.0
    ) -> Bake:
        """A random fall: pose within the limits, ground and hit by the seed; the same bits on every machine."""

@final
class Bake:
    """Outcome of a bake: poses, events, figures, and a clip."""

    @property
    def times(self) -> _Floats:
        """Seconds of each frame: (frames,)."""

    @property
    def states(self) -> list[str]:
        """State of the character in each frame: `Animated`, `Limp`, `GettingUp`, ..."""

    @property
    def translations(self) -> _Floats:
        """Local translation of each joint, in the file's unit: (frames, joints, 3)."""

    @property
    def rotations(self) -> _Floats:
        """Local rotation of each joint, x y z w: (frames, joints, 4)."""

    @property
    def positions(self) -> _Floats:
        """Place of each joint in the world, metres: (frames, joints, 3)."""

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index of each joint's parent, -1 for a root: (joints,)."""

    @property
    def events(self) -> list[tuple[float, str]]:
        """Time in seconds and name of each event."""

    @property
    def hits(self) -> list[tuple[float, str, list[float]]]:
        """Hits that struck it: time in seconds, body, impulse in N·s."""

    @property
    def quality(self) -> FallQuality:
        """Figures of the fall."""

    @property
    def verdict(self) -> str:
        """`good`, `usable` or `bad`."""

    @property
    def reasons(self) -> list[str]:
        """Reasons for a verdict that is not `good`."""

    @property
    def hash(self) -> int:
        """Hash of the state at the end: equal on every machine."""

    def glb(self, *, mesh: bool = True) -> bytes:
        """The file with the clip in it, or the bones alone with the clip if there is to be no mesh."""

    def save(self, path: _Path, *, mesh: bool = True) -> None:
        """Writes that file, whole or not at all."""

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
        """Draws a joint to a turn (3,), a scaled axis in radians, by a spring of so many hertz, with at most so much torque, N·m."""

    def step(self, count: int = 1) -> None:
        """Takes so many steps, without the GIL."""

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
        """Puts bodies elsewhere: (n, 7)."""

    def set_velocities(self, bodies: ArrayLike, velocities: ArrayLike) -> None:
        """Sets velocities of bodies: (n, 6)."""

    def push(self, body: int, impulse: ArrayLike, *, point: ArrayLike | None = None) -> None:
        """Gives a body an impulse, N·s: (3,), at its centre of mass or at a point of the world, metres."""

    def ray(self, origins: ArrayLike, ways: ArrayLike) -> RayHits:
        """First hits of rays from `origins` (n, 3) along `ways` (n, 3), metres; a ray ends at `origin + way`. Without a hit the body is 2**64 - 1 and the fraction 1."""

    def overlap(self, kind: _Shape, size: Sequence[float], pose: ArrayLike) -> _Ids:
        """Ids of bodies that a shape at a pose overlaps."""

    def contacts(self) -> Contacts:
        """Points of contact of the last step."""

    def events(self) -> Events:
        """Events of the last step: pairs of bodies that begin and end to touch, and that hit."""

    def joint_gap(self, joint: int) -> float:
        """Distance between the anchors of a joint, metres."""

    def joint_turn(self, joint: int) -> _Floats:
        """Turn of a joint from its frame, a scaled axis in radians: (3,)."""

    def hash(self) -> int:
        """Hash of the state: equal on every machine."""

    def save(self) -> bytes:
        """State as bytes, for `load`."""

    def load(self, state: bytes) -> None:
        """Brings back a saved state."""


@final
class BatchWorlds:
    """Worlds that hold one figure each, on a floor. Each has the bits that it would have alone, whatever the number of threads."""

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
        """Number of threads that step them."""

    def step(self, count: int = 1) -> None:
        """Takes so many steps in each world, without the GIL."""

    def reset(
        self,
        worlds: ArrayLike | None = None,
        *,
        poses: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
    ) -> None:
        """Brings worlds back to their beginning, those that are named or all; `poses` (worlds, bodies, 7) and `velocities` (worlds, bodies, 6) as they shall begin."""

    def push(self, body: int, impulses: ArrayLike) -> None:
        """Gives that body of each world an impulse, N·s: (worlds, 3)."""

    def drive(
        self, targets: ArrayLike, *, stiffness: ArrayLike, damping: ArrayLike, max_torques: ArrayLike
    ) -> None:
        """Draws the joints of each world to turns (worlds, joints, 3), scaled axes in radians: stiffness N·m/rad, damping N·m·s/rad and torque N·m of each joint (joints,)."""

    def poses(self) -> _Floats:
        """Poses of all bodies: (worlds, bodies, 7)."""

    def velocities(self) -> _Floats:
        """Velocities of all bodies: (worlds, bodies, 6)."""

    def joint_turns(self) -> _Floats:
        """Turns of all joints, scaled axes in radians: (worlds, joints, 3)."""

    def joint_gaps(self) -> _Floats:
        """Widest gap of a joint in each world, metres: (worlds,)."""

    def depths(self) -> _Floats:
        """Deepest overlap in each world, metres: (worlds,)."""

    def hashes(self) -> _Ids:
        """Hash of each world's state: (worlds,)."""

    def contacts(self, world: int) -> Contacts:
        """Points of contact of one world."""

    def carried(self, motions: ArrayLike) -> _Floats:
        """Poses of the figure at its beginning, moved by a pose for each world (worlds, 7): (worlds, bodies, 7), for `reset`."""


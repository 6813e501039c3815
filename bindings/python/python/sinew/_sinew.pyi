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
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def clips(self) -> list[str]: ...
    @property
    def roles(self) -> dict[str, str]: ...
    @property
    def notes(self) -> list[str]: ...
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
    def bones(self) -> list[str]: ...
    @property
    def roles(self) -> list[str]: ...
    @property
    def masses(self) -> _Floats: ...
    @property
    def parents(self) -> NDArray[np.int64]: ...
    @property
    def torques(self) -> _Floats: ...
    @property
    def bind_poses(self) -> _Floats: ...
    @property
    def joint_frames(self) -> _Floats: ...
    @property
    def total_mass(self) -> float: ...
    @property
    def height(self) -> float: ...
    @property
    def report(self) -> BuildReport: ...
    def doctor(self) -> DoctorReport:
        """Findings of the doctor."""

    def drop_test(self) -> DropReport:
        """Drops it and throws it at a wall."""

    def to_json(self) -> str: ...
    def save(self, path: _Path) -> None: ...
    def __len__(self) -> int: ...

@final
class Model:
    """Model of bodies and joints of MuJoCo's format, with all of its shapes."""

    @property
    def name(self) -> str: ...
    @property
    def bodies(self) -> list[str]: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...

@final
class Character:
    """Character with its motions."""

    @property
    def roles(self) -> list[str]: ...
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
    def times(self) -> _Floats: ...
    @property
    def states(self) -> list[str]: ...
    @property
    def translations(self) -> _Floats: ...
    @property
    def rotations(self) -> _Floats: ...
    @property
    def positions(self) -> _Floats: ...
    @property
    def parents(self) -> NDArray[np.int64]: ...
    @property
    def events(self) -> list[tuple[float, str]]: ...
    @property
    def hits(self) -> list[tuple[float, str, list[float]]]: ...
    @property
    def quality(self) -> FallQuality: ...
    @property
    def verdict(self) -> str: ...
    @property
    def reasons(self) -> list[str]: ...
    @property
    def hash(self) -> int: ...
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
    ) -> int: ...
    def add_floor(self, height: float = 0.0) -> int: ...
    def add_ragdoll(
        self,
        ragdoll: Ragdoll,
        *,
        pose: ArrayLike | None = None,
        poses: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
    ) -> tuple[_Ids, _Ids]: ...
    def remove_body(self, body: int) -> None: ...
    def add_joint(
        self,
        kind: Literal["ball", "hinge", "slider", "fixed"],
        a: int,
        b: int,
        anchor: ArrayLike,
        *,
        axis: ArrayLike | None = None,
        range: tuple[float, float] | None = None,
    ) -> int: ...
    def remove_joint(self, joint: int) -> None: ...
    def drive_joint(
        self,
        joint: int,
        target: ArrayLike,
        *,
        hertz: float,
        damping_ratio: float = 1.0,
        max_torque: float = ...,
    ) -> None: ...
    def step(self, count: int = 1) -> None: ...
    @property
    def step_count(self) -> int: ...
    @property
    def time(self) -> float: ...
    @property
    def body_ids(self) -> _Ids: ...
    @property
    def joint_ids(self) -> _Ids: ...
    def poses(self, bodies: ArrayLike | None = None) -> _Floats: ...
    def velocities(self, bodies: ArrayLike | None = None) -> _Floats: ...
    def set_poses(self, bodies: ArrayLike, poses: ArrayLike) -> None: ...
    def set_velocities(self, bodies: ArrayLike, velocities: ArrayLike) -> None: ...
    def push(self, body: int, impulse: ArrayLike, *, point: ArrayLike | None = None) -> None: ...
    def ray(self, origins: ArrayLike, ways: ArrayLike) -> RayHits: ...
    def overlap(self, kind: _Shape, size: Sequence[float], pose: ArrayLike) -> _Ids: ...
    def contacts(self) -> Contacts: ...
    def events(self) -> Events: ...
    def joint_gap(self, joint: int) -> float: ...
    def joint_turn(self, joint: int) -> _Floats: ...
    def hash(self) -> int: ...
    def save(self) -> bytes: ...
    def load(self, state: bytes) -> None: ...

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
    def __len__(self) -> int: ...
    @property
    def bodies(self) -> list[str]: ...
    @property
    def joint_count(self) -> int: ...
    @property
    def threads(self) -> int: ...
    def step(self, count: int = 1) -> None: ...
    def reset(
        self,
        worlds: ArrayLike | None = None,
        *,
        poses: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
    ) -> None: ...
    def push(self, body: int, impulses: ArrayLike) -> None: ...
    def drive(
        self, targets: ArrayLike, *, stiffness: ArrayLike, damping: ArrayLike, max_torques: ArrayLike
    ) -> None: ...
    def poses(self) -> _Floats: ...
    def velocities(self) -> _Floats: ...
    def joint_turns(self) -> _Floats: ...
    def joint_gaps(self) -> _Floats: ...
    def depths(self) -> _Floats: ...
    def hashes(self) -> _Ids: ...
    def contacts(self, world: int) -> Contacts: ...
    def carried(self, motions: ArrayLike) -> _Floats: ...

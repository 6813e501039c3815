"""Types of returned dicts."""

from typing import TYPE_CHECKING, Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from ._sinew import Drive

_Floats = NDArray[np.float32]
_Ids = NDArray[np.uint64]


class FallQuality(TypedDict):
    """Metrics of a fall: metres, degrees, joules, seconds; docs/contract.md of the repository describes each."""

    energy_gain_max: float
    work_in_j: float
    joint_gap_max_m: float
    joint_gap_p99_m: float
    limit_overshoot_max_deg: float
    limit_overshoot_p99_deg: float
    penetration_max_m: float
    penetration_rest_max_m: float
    first_contact_s: float | None
    settled_s: float | None
    up_s: float | None
    nan: int


class CharacterSettings(TypedDict, total=False):
    """Settings of `Character.edited`; what is left out stays."""

    # Falls.
    gets_up: bool  # gets up once it lies still
    rolls_over: bool  # rolls over to the start of the nearest get-up
    keeps_out_of_floor: bool  # the skin stays out of the floor in transitions
    falling: "Drive"  # drives the bodies during a fall
    patience: float  # seconds after which it gets up although it moves
    max_speed: float  # largest speed that an animation hands over, m/s
    max_turn_speed: float  # rad/s
    friction: float
    rolling: float  # rolling resistance, metres
    restitution: float
    angular_damping: float  # 1/s
    quality: Literal["fast", "balanced", "exact"] | None  # None: the world's
    # The world, while clips move it.
    hit_bodies: bool  # its bodies are in the world
    yields: tuple[float, float]  # largest force, N, and momentum, N·s, with which these push
    mover: bool  # a mover stops and carries it
    step_height: float  # metres
    slope_limit: float  # radians
    turn_speed: float  # rad/s
    jump_speed: float  # m/s
    air_time: float  # seconds without ground after which it falls
    landing_speed: float  # m/s from which a landing makes it fall
    plants_feet: bool  # feet stay on the ground under them
    toughness: float | None  # N·s from which a hit makes it fall; None: every hit
    most_steps: int  # to catch a push while powered
    feels: float  # smallest impulse that counts as a hit, N·s
    tells_contacts: bool  # `events` contain contacts
    # Motions, by the names of clips.
    clip: str | None  # loops until it falls
    idle: str | None  # loops at rest, if `set_move` moves it
    faster: list[str]  # loop at higher speeds
    get_ups: list[str]
    clip_events: list[tuple[str, float, str]]  # clip, seconds, name
    locomotion: Literal["in_place", "by_clip", "exact"] | float  # m/s of a clip that walks on the spot
    opening: Literal["clip", "rest"]


class BuildReport(TypedDict):
    """Report of a build."""

    bodies: int
    total_mass_kg: float
    height_m: float
    dropped_bones: list[str]
    skin_error_m: float | None
    notes: list[str]


class Finding(TypedDict):
    """Finding of the doctor: a problem of a ragdoll, its cause, and its repair."""

    code: str
    severity: str
    bones: list[str]
    cause: str
    evidence: str
    fix: str
    fixed: bool


class DoctorReport(TypedDict):
    """Findings of the doctor."""

    findings: list[Finding]


class DropReport(TypedDict):
    """Verdict on a ragdoll that was dropped and thrown at a wall."""

    verdict: str
    reasons: list[str]
    drop: FallQuality
    wall: FallQuality


class RayHits(TypedDict):
    """First hit of each ray."""

    body: _Ids
    fraction: _Floats
    point: _Floats
    normal: _Floats


class Contacts(TypedDict):
    """Points of contact; world, metres, N·s."""

    a: _Ids
    b: _Ids
    position: _Floats
    normal: _Floats
    separation: _Floats
    impulse: _Floats


class Events(TypedDict):
    """Pairs of bodies, (n, 2)."""

    begin: _Ids
    end: _Ids
    hit: _Ids


class _MeshNeeds(TypedDict):
    positions: ArrayLike
    triangles: ArrayLike


class MeshArrays(_MeshNeeds, total=False):
    """Mesh for `load_arrays`: positions (v, 3), triangles (t, 3). A skinned one has joints and weights of each vertex (v, 4); one that
    moves with a single joint has its index as `joint`, and positions in that joint's space."""

    name: str
    joints: ArrayLike
    weights: ArrayLike
    joint: int


class _ClipNeeds(TypedDict):
    times: ArrayLike


class ClipArrays(_ClipNeeds, total=False):
    """Clip for `load_arrays`: times (f,) in seconds, local translations (f, n, 3), rotations (f, n, 4) x y z w, scales (f, n, 3)."""

    translations: ArrayLike
    rotations: ArrayLike
    scales: ArrayLike

"""Physics for characters: rigged files that fall, collide, are hit and get up.

Metres, kilograms, seconds, radians; +Y is up. A pose is seven numbers (place, quaternion x y z w), a velocity six (linear, angular), a
turn of a joint three (scaled axis). The same calls give the same bits on every machine and for every number of threads.
"""

from ._sinew import (
    Actor,
    BatchWorlds,
    Bake,
    Cancelled,
    Character,
    CharacterFile,
    Collider,
    Drive,
    FileError,
    LiveCharacter,
    Model,
    Ragdoll,
    SinewError,
    World,
    __version__,
    bake,
    load,
    load_arrays,
    load_bytes,
    load_model,
    load_ragdoll,
    mannequin,
)

__all__ = [
    "Actor",
    "Bake",
    "BatchWorlds",
    "Cancelled",
    "Character",
    "CharacterFile",
    "Collider",
    "Drive",
    "FileError",
    "LiveCharacter",
    "Model",
    "Ragdoll",
    "SinewError",
    "World",
    "__version__",
    "bake",
    "load",
    "load_arrays",
    "load_bytes",
    "load_model",
    "load_ragdoll",
    "mannequin",
]

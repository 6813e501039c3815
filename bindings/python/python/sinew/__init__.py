"""Physics for characters: rigged files that fall, collide, are hit and get up.

Metres, kilograms, seconds, radians; +Y is up. A pose is seven numbers (place, quaternion x y z w), a velocity six (linear, angular), a
turn of a joint three (scaled axis). The same calls give the same bits on every machine and for every number of threads.
"""

from ._sinew import (
    BatchWorlds,
    Bake,
    Character,
    CharacterFile,
    FileError,
    Model,
    Ragdoll,
    SinewError,
    World,
    __version__,
    load,
    load_model,
    load_ragdoll,
    mannequin,
)

__all__ = [
    "Bake",
    "BatchWorlds",
    "Character",
    "CharacterFile",
    "FileError",
    "Model",
    "Ragdoll",
    "SinewError",
    "World",
    "__version__",
    "load",
    "load_model",
    "load_ragdoll",
    "mannequin",
]

"""Installs the extension's zip by Blender's own operator and enables it. Its path is in SINEW_EXTENSION."""

import os
import sys

import bpy


def install():
    zip_file = os.environ["SINEW_EXTENSION"]
    done = bpy.ops.extensions.package_install_files(
        filepath=zip_file, repo="user_default", enable_on_install=True, overwrite=True
    )
    assert done == {"FINISHED"}, done
    assert any(name.endswith(".sinew_blender") for name in bpy.context.preferences.addons.keys()), "it is enabled"
    import sinew

    # Uses the wheel of the zip, not another one on the path.
    assert "extensions" in sinew.__file__, sinew.__file__


def addon():
    """The installed extension's own package."""
    return sys.modules[type(bpy.context.scene.sinew).__module__.rpartition(".")[0]]

"""Works in a window, and takes screenshots: `blender --factory-startup --enable-event-simulate --window-geometry 0 0 1200 800 -P window.py`.

SINEW_WHEEL is a folder with the unpacked wheel, SINEW_SHOTS a folder for the pictures, SINEW_DATA has the rigs. Debian's Blender 3.4 under Xvfb
will do: the extension is then used as an add-on.
"""

import os
import sys
import traceback

import bpy
import numpy
from mathutils import Euler

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.environ["SINEW_WHEEL"], os.path.dirname(HERE), HERE]
# Debian's glTF importer uses names that its numpy no longer has.
for name, kind in (("bool", bool), ("object", object), ("float", float), ("int", int)):
    if name not in numpy.__dict__:
        setattr(numpy, name, kind)

import rigs  # noqa: E402
import sinew_blender as addon  # noqa: E402

SHOTS = os.environ["SINEW_SHOTS"]
SECONDS = 200.0


def view():
    """Window, area and region of the 3D view."""
    window = bpy.context.window_manager.windows[0]
    area = max((a for a in window.screen.areas if a.type == "VIEW_3D"), key=lambda a: a.width)
    return window, area, next(r for r in area.regions if r.type == "WINDOW")


def within():
    window, area, region = view()
    return bpy.context.temp_override(window=window, area=area, region=region)


def look(at, distance, turn=0.9):
    _, area, _ = view()
    space = area.spaces[0]
    space.show_region_ui, space.overlay.show_relationship_lines = True, False
    for region in area.regions:
        if region.type == "UI" and hasattr(region, "active_panel_category"):
            try:
                region.active_panel_category = "Sinew"
            except (AttributeError, TypeError):
                pass  # Blender 3.4 cannot.
    eye = space.region_3d
    eye.view_perspective, eye.view_rotation = "PERSP", Euler((1.25, 0, turn)).to_quaternion()
    eye.view_location, eye.view_distance = at, distance


def shot(name):
    with within():
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
        bpy.ops.screen.screenshot(filepath=os.path.join(SHOTS, name + ".png"))


def pixel(place):
    """Pixel of the window at a place of the world."""
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    _, _, region = view()
    at = location_3d_to_region_2d(region, region.data, place)
    return int(region.x + at.x), int(region.y + at.y)


def at_frames(prefix, frames):
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        shot(f"{prefix}_{frame:03}")
        yield 0.1


def steps():
    """Steps of the test, with pauses in seconds in which Blender continues."""
    window, _, _ = view()
    rigs.empty_scene()
    yield 1.0
    window = view()[0]
    arm = rigs.cesium_man()
    bpy.context.scene.sinew.handover = 45
    look((0, 0, 0.6), 4.5)
    with within():
        bpy.ops.sinew.build()
    yield 0.5
    shot("built")
    with within():
        bpy.ops.sinew.preview("INVOKE_DEFAULT")
    while addon.preview.of(arm) is None:
        yield 0.3
    assert arm.animation_data.action is None or "Sinew" not in arm.animation_data.action.name
    yield from at_frames("preview", (30, 50, 60, 80, 150))
    with within():
        bpy.ops.sinew.preview("INVOKE_DEFAULT")
    yield 0.3
    window.event_simulate(type="ESC", value="PRESS", x=800, y=500)
    window.event_simulate(type="ESC", value="RELEASE", x=800, y=500)
    yield 1.5
    with within():
        bpy.ops.sinew.end_preview()
    yield from drag_a_limit(window, arm)
    with within():
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.ops.sinew.simulate("INVOKE_DEFAULT")
    while not arm.sinew.report:
        yield 0.3
    yield 0.5
    look((0, 0, 0.6), 4.5)
    yield from at_frames("keyed", (44, 45, 50, 55, 60, 70, 80, 100, 150))


def drag_a_limit(window, arm):
    """Drags a handle of the active bone's limits with the mouse."""
    bpy.context.scene.frame_set(1)
    with within():
        bpy.ops.object.mode_set(mode="POSE")
    bone = next(b for b in arm.pose.bones if b.sinew.has_swing and b.sinew.swing_z[1] > 0.5)
    arm.data.bones.active = arm.data.bones[bone.name]
    look(arm.matrix_world @ bone.head, 1.2)
    yield 0.5
    shot("handles")
    before = tuple(bone.sinew.swing_z)
    frame, reach = addon.handles.frame_of(arm, bone.name)
    start, end = (pixel(frame @ addon.handles.offset_of("swing_z", angle, reach)) for angle in (before[1], 0.3 * before[1]))
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=start[0] + 30, y=start[1])
    yield 2.0
    # A handle takes a click once it is highlighted, which needs the picture drawn.
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=start[0], y=start[1])
    yield 4.0
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=start[0] + 1, y=start[1])
    yield 4.0
    window.event_simulate(type="LEFTMOUSE", value="PRESS", x=start[0] + 1, y=start[1])
    yield 1.0
    for i in range(1, 11):
        x, y = (int(a + (b - a) * i / 10) for a, b in zip(start, end))
        window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
        yield 0.1
    shot("dragged")
    window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=end[0], y=end[1])
    yield 0.5
    after = tuple(bone.sinew.swing_z)
    assert abs(after[1] - 0.3 * before[1]) < 0.15 and after[0] == before[0], f"the handle was dragged from {before} to {after}"
    print(f"limit dragged from {before[1]:.2f} to {after[1]:.2f} rad")


def main():
    running, waited = steps(), [0.0]

    def go_on():
        try:
            pause = next(running)
        except StopIteration:
            print("PASS window")
            os._exit(0)
        except Exception:
            traceback.print_exc()
            os._exit(1)
        waited[0] += pause
        if waited[0] > SECONDS:
            print("the work does not end")
            os._exit(1)
        return pause

    addon.register()
    # Loading a scene ends other timers.
    bpy.app.timers.register(go_on, first_interval=1.0, persistent=True)


bpy.context.preferences.view.show_splash = False
bpy.context.preferences.system.viewport_aa = "OFF"
main()

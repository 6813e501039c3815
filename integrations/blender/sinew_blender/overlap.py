"""Measures how deep a character is in the ground and in colliders when the bodies take over."""

from mathutils import Vector
from mathutils.bvhtree import BVHTree

from . import overlay, stage
from . import skeleton as sk
from .skeleton import TO_Y

# Smallest reported depth, as a share of the height: feet of walks are up to 5 % in the ground without a visible jump.
DEEP = 0.06
# Number of spheres that stand for a capsule.
SPHERES = 5
# Directions without symmetry; a point is inside of a mesh if most of them cross it an odd number of times.
WAYS = (Vector((0.36, 0.48, 0.8)), Vector((-0.6, 0.64, -0.48)), Vector((0.28, -0.96, 0.03)))


def _spheres(shape):
    """Centres and radii that stand for a shape, in its own frame, metres."""
    if shape["type"] == "box":
        h = shape["half_extents"]
        signs = ((x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1))
        return [(Vector((x * h[0], y * h[1], z * h[2])), 0.0) for x, y, z in signs]
    if shape["type"] == "hull":
        return [(Vector(point), 0.0) for point in shape["points"]]
    low, high = shape.get("radius_bottom", shape.get("radius", 0.0)), shape.get("radius_top", shape.get("radius", 0.0))
    half, out = shape.get("half_height", 0.0), []
    for i in range(SPHERES):
        t = i / (SPHERES - 1)
        out.append((Vector((0.0, (2 * t - 1) * half, 0.0)), low + (high - low) * t))
    return out


def _posed(arm, skeleton, definition, frame):
    """The spheres of all bodies in the user's pose, Blender's length and Sinew's axes."""
    rest, unit = sk.rest_matrices(arm, skeleton), definition["unit_scale"]
    to_rest, out = TO_Y @ overlay.to_world_of(definition), []
    for body in definition["bodies"]:
        name = body["bone"]
        if name in rest:
            own = frame[name] @ rest[name].inverted() @ to_rest @ overlay.placed(body)
            out += [(own @ center, radius / unit) for center, radius in _spheres(body["shape"])]
    return out


def _is_inside(tree, point):
    odd = 0
    for way in WAYS:
        crossed, at = 0, point
        while crossed < 100:
            at = tree.ray_cast(at, way)[0]
            if at is None:
                break
            crossed += 1
            at = at + 1e-4 * way
        odd += crossed % 2
    return 2 * odd > len(WAYS)


def _depth(spheres, vertices, corners):
    """Depth of the spheres in a mesh."""
    low, high = Vector(vertices.min(0)), Vector(vertices.max(0))
    near = [(c, r) for c, r in spheres if all(a - r < x < b + r for a, x, b in zip(low, c, high))]
    if not near:
        return 0.0
    tree, worst = BVHTree.FromPolygons(vertices.tolist(), corners.tolist()), 0.0
    for center, radius in near:
        place, normal, _, off = tree.find_nearest(center)
        if _is_inside(tree, center):
            worst = max(worst, radius + off)
        elif normal.dot(center - place) >= 0:
            worst = max(worst, radius - off)
    return worst


def told(scene, arm, skeleton, definition, frame, number):
    """Warnings about the pose `frame`, which is that of the frame `number`."""
    unit, spheres, settings = definition["unit_scale"], _posed(arm, skeleton, definition, frame), scene.sinew
    found, least = [], DEEP * definition["height"]
    if settings.ground and spheres:
        depth = settings.ground_height - min(center.y - radius for center, radius in spheres)
        found.append((depth * unit, "the ground: move it, or set the ground's height"))
    others = stage.colliders(scene, [arm]) if spheres else []
    if others:
        at, sub = scene.frame_current, scene.frame_subframe
        scene.frame_set(number)
        try:
            for ob in others:
                depth = _depth(spheres, *stage.triangles(ob, TO_Y @ ob.matrix_world))
                found.append((depth * unit, f"{ob.name}: move it"))
        finally:
            scene.frame_set(at, subframe=sub)
    return [f"At the hand-over {arm.name} is {depth:.2f} m inside {what}" for depth, what in found if depth > least]

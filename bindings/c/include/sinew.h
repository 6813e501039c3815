/* Sinew: physics for characters, in C. docs/c.md is the guide.
 *
 * Metres, kilograms, seconds, radians; +Y is up, right-handed. Every function gives a SinewStatus; what it wanted to say is in
 * sinew_last_error(). A handle is used by one thread at a time, different handles by different ones. */

#ifndef SINEW_H
#define SINEW_H

/* Made by cbindgen from bindings/c/src: SINEW_BLESS=1 cargo test --manifest-path bindings/Cargo.toml -p sinew_c writes it anew. */

#include <stddef.h>
#include <stdint.h>

// Status of a call.
typedef enum SinewStatus {
  // The call succeeded.
  SINEW_STATUS_OK = 0,
  // A required pointer is null.
  SINEW_STATUS_NULL_POINTER = 1,
  // An id is stale: its object was removed, or belongs to another world.
  SINEW_STATUS_STALE_ID = 2,
  // A number, a size or a name is invalid.
  SINEW_STATUS_BAD_ARGUMENT = 3,
  // A file cannot be read or written, or is invalid; the message names the file and the place.
  SINEW_STATUS_BAD_FILE = 4,
  // The bytes are no snapshot of this version; the world is unchanged.
  SINEW_STATUS_BAD_SNAPSHOT = 5,
  // The buffer is too small; the needed count was stored.
  SINEW_STATUS_TOO_SMALL = 6,
  // A bug in the library. The object that was being changed is unusable and can only be freed.
  SINEW_STATUS_PANIC = 7,
} SinewStatus;

// State of a character, which determines the source of its pose.
typedef enum SinewCharacterState {
  // The pose is that of the clips.
  SINEW_CHARACTER_STATE_ANIMATED = 0,
  // The pose is that of the bodies, which fall or lie.
  SINEW_CHARACTER_STATE_LIMP = 1,
  // The pose is that of the bodies, which move to the start of a get-up clip.
  SINEW_CHARACTER_STATE_PREPARING = 2,
  // The pose is that of a get-up clip.
  SINEW_CHARACTER_STATE_GETTING_UP = 3,
  // The pose is that of the clips, except for a limb that was hit.
  SINEW_CHARACTER_STATE_FLINCHING = 4,
  // The pose is that of the bodies, which muscles pull toward the clips.
  SINEW_CHARACTER_STATE_POWERED = 5,
} SinewCharacterState;

// Kind of a body.
typedef enum SinewBodyKind {
  // Forces move the body.
  SINEW_BODY_KIND_DYNAMIC = 0,
  // The body never moves.
  SINEW_BODY_KIND_STATIC = 1,
  // The body moves at its velocity; no force or contact changes it.
  SINEW_BODY_KIND_KINEMATIC = 2,
} SinewBodyKind;

// Kind of events.
typedef enum SinewEventKind {
  // The bodies began to touch.
  SINEW_EVENT_KIND_BEGIN = 0,
  // The bodies stopped touching; ids may be stale.
  SINEW_EVENT_KIND_END = 1,
  // The bodies hit each other at high speed.
  SINEW_EVENT_KIND_HIT = 2,
} SinewEventKind;

// Kind of a joint.
typedef enum SinewJointKind {
  // Allows rotation about the anchor.
  SINEW_JOINT_KIND_BALL = 0,
  // Allows rotation about the axis. `range`: radians.
  SINEW_JOINT_KIND_HINGE = 1,
  // Allows sliding along the axis. `range`: metres.
  SINEW_JOINT_KIND_SLIDER = 2,
  // Locks all motions.
  SINEW_JOINT_KIND_FIXED = 3,
  // Rope or rod from the anchor of A to the anchor of B. `range`: metres.
  SINEW_JOINT_KIND_DISTANCE = 4,
} SinewJointKind;

// Kind of a shape, with the meaning of `size` in [`SinewShape`].
typedef enum SinewShapeKind {
  // Box. `size`: half of each side.
  SINEW_SHAPE_KIND_BOX = 0,
  // Ball. `size.x`: radius.
  SINEW_SHAPE_KIND_SPHERE = 1,
  // Capsule along y. `size.x`: radius; `size.y`: half the length without the caps.
  SINEW_SHAPE_KIND_CAPSULE = 2,
  // Cylinder along y. `size.x`: radius; `size.y`: half the length.
  SINEW_SHAPE_KIND_CYLINDER = 3,
  // Cone along y, the apex up. `size.x`: radius of the base; `size.y`: half the height.
  SINEW_SHAPE_KIND_CONE = 4,
  // All points below y = 0 of its frame, for static bodies. No sizes.
  SINEW_SHAPE_KIND_HALF_SPACE = 5,
} SinewShapeKind;

// Character in a world. Call `sinew_character_update` once after each `sinew_world_step`.
typedef struct SinewCharacter SinewCharacter;

// Kind of character: rig, ragdoll and motions, shared by any number of characters.
typedef struct SinewCharacterDef SinewCharacterDef;

// Ragdoll as data, which can be added to worlds.
typedef struct SinewRagdoll SinewRagdoll;

// World with bodies and joints. One thread at a time may use it.
typedef struct SinewWorld SinewWorld;

// Three numbers.
typedef struct SinewVec3 {
  // Coordinate along x.
  float x;
  // Coordinate along y, which is up.
  float y;
  // Coordinate along z.
  float z;
} SinewVec3;

// Rotation as a unit quaternion; other lengths are normalised. Four zeros are the identity.
typedef struct SinewRotation {
  // Coefficient of i.
  float x;
  // Coefficient of j.
  float y;
  // Coefficient of k.
  float z;
  // Real part.
  float w;
} SinewRotation;

// Rigid pose: rotation, then translation.
typedef struct SinewPose {
  // Position, metres.
  struct SinewVec3 position;
  // Rotation.
  struct SinewRotation rotation;
} SinewPose;

// Id of a body in a world. The id of a removed body is stale: using it is an error, and it never refers to another body.
typedef struct SinewBodyId {
  // Index and generation.
  uint64_t bits;
} SinewBodyId;

// Transform of a joint relative to its parent, in the file's units.
typedef struct SinewLocalTransform {
  // Position and rotation.
  struct SinewPose pose;
  // Scale along each axis.
  struct SinewVec3 scale;
} SinewLocalTransform;

// Definition of a joint.
typedef struct SinewJointDef {
  // One of `SinewJointKind`.
  uint32_t kind;
  // The first body.
  struct SinewBodyId a;
  // The second body; at least one of the two must be dynamic.
  struct SinewBodyId b;
  // Anchor of both bodies, world, metres; for a distance joint, its end at A.
  struct SinewVec3 anchor;
  // End of a distance joint at B, world, metres; ignored by other kinds.
  struct SinewVec3 anchor_b;
  // Axis of a hinge or a slider, world; must not be zero.
  struct SinewVec3 axis;
  // 1 if a hinge or slider has a range, else 0; a distance joint always has one. The present pose is 0.
  uint32_t has_range;
  // Lower end of the range.
  float range_lo;
  // Upper end of the range.
  float range_hi;
} SinewJointDef;

// Id of a joint in a world. The id of a removed joint is stale, as for bodies.
typedef struct SinewJointId {
  // Index and generation.
  uint64_t bits;
} SinewJointId;

// First hit of a ray.
typedef struct SinewRayHit {
  // The body that was hit.
  struct SinewBodyId body;
  // Point of the hit, world, metres.
  struct SinewVec3 point;
  // Normal of the surface, outward, unit length.
  struct SinewVec3 normal;
  // Position of the hit as a fraction of the ray, 0 to 1.
  float fraction;
} SinewRayHit;

// Shape around its body's origin. `kind` is a number instead of an enum, so that an invalid one is an error.
typedef struct SinewShape {
  // One of `SinewShapeKind`.
  uint32_t kind;
  // Sizes in metres, by the kind.
  struct SinewVec3 size;
} SinewShape;

// Contact point after the last step.
typedef struct SinewContact {
  // The body with the smaller index.
  struct SinewBodyId a;
  // The other body.
  struct SinewBodyId b;
  // Position between the surfaces, world, metres.
  struct SinewVec3 position;
  // Normal from A to B, unit length.
  struct SinewVec3 normal;
  // Gap between the surfaces, metres; negative if they overlap.
  float separation;
  // Total impulse of the last step, N·s.
  float impulse;
} SinewContact;

// Two bodies.
typedef struct SinewPair {
  // The body with the smaller index.
  struct SinewBodyId a;
  // The other body.
  struct SinewBodyId b;
} SinewPair;

// Settings of a world; `sinew_world_def_default` fills them in.
typedef struct SinewWorldDef {
  // Gravitational acceleration, m/s². Default (0, -9.81, 0).
  struct SinewVec3 gravity;
  // Length of a step, nanoseconds. Default 16,666,667, a sixtieth of a second.
  uint64_t step_nanoseconds;
  // Substeps of a step, at least 1. Default 4.
  uint32_t substeps;
  // Quality of a step: 0 fast, 1 balanced, 2 exact. Default 1.
  uint32_t quality;
  // 1 if bodies at rest may fall asleep, else 0. Default 1.
  uint32_t sleeping;
} SinewWorldDef;

// Velocity of a centre of mass, m/s, and angular velocity, rad/s; world axes.
typedef struct SinewVelocity {
  // Linear velocity, m/s.
  struct SinewVec3 linear;
  // Angular velocity, rad/s.
  struct SinewVec3 angular;
} SinewVelocity;

// Definition of a body; `sinew_body_def_default` fills it in.
typedef struct SinewBodyDef {
  // One of `SinewBodyKind`. Default dynamic.
  uint32_t kind;
  // Pose in the world.
  struct SinewPose pose;
  // Velocity, m/s and rad/s.
  struct SinewVelocity velocity;
  // Shapes, each around the body's origin.
  const struct SinewShape *shapes;
  // Number of shapes.
  size_t shape_count;
  // Mass, kg, distributed over the shapes; with 0, the default, the mass is computed from `density`.
  float mass;
  // Density, kg/m³. Default 1,000.
  float density;
  // Coefficient of Coulomb friction, at least 0. Default 0.6.
  float friction;
  // Coefficient of restitution, 0 to 1. Default 0.
  float restitution;
  // Bits of the layers to which the shapes belong. Default 1.
  uint32_t layers;
  // Bits of the layers with which the shapes collide. Default all.
  uint32_t mask;
  // Data of the user.
  uint64_t user_data;
} SinewBodyDef;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Returns the error text of the last call of this thread, or "" if it returned `SINEW_STATUS_OK`. The text names the file and the
// place. It is valid until the thread's next call.
const char *sinew_last_error(void);

// Returns the version of the library, such as "0.1.0".
const char *sinew_version(void);

// Reads a character (GLB, glTF, VRM, FBX) and builds its ragdoll. If the file has no get-up clip, a humanoid gets the built-in ones. A
// null path loads the built-in mannequin.
//
// The caller promises:
// `path` is null or text, `def` is null or points to room for a pointer.
enum SinewStatus sinew_character_def_load(const char *path,
                                          struct SinewCharacterDef **def);

// Frees a kind of character; its characters remain valid. Null is allowed.
//
// The caller promises:
// `def` is null or came from `sinew_character_def_load` and is not used afterwards.
void sinew_character_def_free(struct SinewCharacterDef *def);

// Stores the number of joints of the rig in `count`; a pose has as many transforms.
//
// The caller promises:
// `def` is null or a kind of character, `count` is null or points to a number.
enum SinewStatus sinew_character_def_joint_count(const struct SinewCharacterDef *def,
                                                 size_t *count);

// Stores the name of a joint in `name`; valid as long as the kind of character.
//
// The caller promises:
// `def` is null or a kind of character, `name` is null or points to room for a pointer.
enum SinewStatus sinew_character_def_joint_name(const struct SinewCharacterDef *def,
                                                size_t joint,
                                                const char **name);

// Adds an animated character to a world at a pose (+Y up, facing +Z). Rays can hit its bodies.
//
// The caller promises:
// `def` is null or a kind of character, `world` is null or a world that no other thread uses, `character` is null or room for a pointer.
enum SinewStatus sinew_character_spawn(const struct SinewCharacterDef *def,
                                       struct SinewWorld *world,
                                       struct SinewPose pose,
                                       struct SinewCharacter **character);

// Removes a character from its world and frees it. If the character is in another world, or one of its bodies was removed, it is freed
// anyway, and the status is `SINEW_STATUS_STALE_ID`.
//
// The caller promises:
// `character` came from `sinew_character_spawn` and is not used afterwards; `world` is null or a world that no other thread uses.
enum SinewStatus sinew_character_despawn(struct SinewCharacter *character,
                                         struct SinewWorld *world);

// Frees a character without removing its bodies, for a world that is freed, too. Null is allowed.
//
// The caller promises:
// `character` is null or came from `sinew_character_spawn` and is not used afterwards.
void sinew_character_free(struct SinewCharacter *character);

// Updates the character after a step of its world.
//
// The caller promises:
// `character` and `world` are null or used by no other thread.
enum SinewStatus sinew_character_update(struct SinewCharacter *character, struct SinewWorld *world);

// Hits a body, given by its role ("chest") or its joint's name, with an impulse, N·s, world axes. The character falls, or flinches if
// the hit is weak.
//
// The caller promises:
// `character` and `world` are null or used by no other thread, `body` is null or text.
enum SinewStatus sinew_character_hit(struct SinewCharacter *character,
                                     struct SinewWorld *world,
                                     const char *body,
                                     struct SinewVec3 impulse);

// Makes the character limp at its present velocity.
//
// The caller promises:
// `character` and `world` are null or used by no other thread.
enum SinewStatus sinew_character_go_limp(struct SinewCharacter *character,
                                         struct SinewWorld *world);

// Stores the state of the character in `state`.
//
// The caller promises:
// `character` is null or one that no other thread changes, `state` is null or points to room.
enum SinewStatus sinew_character_state(const struct SinewCharacter *character,
                                       enum SinewCharacterState *state);

// Stores the ids of the character's bodies in the world in `ids`, in the order of the ragdoll.
//
// The caller promises:
// `character` is null or one that no other thread changes; `ids` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_character_bodies(const struct SinewCharacter *character,
                                        struct SinewBodyId *ids,
                                        size_t capacity,
                                        size_t *count);

// Stores the transforms of all joints relative to their parents in `pose`, in the order of the file.
//
// The caller promises:
// `character` is null or one that no other thread changes; `pose` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_character_pose(const struct SinewCharacter *character,
                                      struct SinewLocalTransform *pose,
                                      size_t capacity,
                                      size_t *count);

// Stores the matrix from the file's model space to the world in `matrix`, 3 rows of 4: the parent transform of the pose.
//
// The caller promises:
// `character` is null or one that no other thread changes, `matrix` is null or has room for 12 numbers.
enum SinewStatus sinew_character_world_from_model(const struct SinewCharacter *character,
                                                  float *matrix);

// Saves a character to a buffer, in addition to the snapshot of its world; see `sinew_world_save`.
//
// The caller promises:
// `character` is null or one that no other thread changes; `bytes` has room for `capacity`, `size` is null or points to a number.
enum SinewStatus sinew_character_save(const struct SinewCharacter *character,
                                      uint8_t *bytes,
                                      size_t capacity,
                                      size_t *size);

// Restores a saved character of the same kind. If the bytes are invalid, the character is unchanged.
//
// The caller promises:
// `character` is null or used by no other thread, `bytes` has `size` bytes.
enum SinewStatus sinew_character_load(struct SinewCharacter *character,
                                      const uint8_t *bytes,
                                      size_t size);

// Adds a joint at the present poses of its bodies; stores its id in `id`.
//
// The caller promises:
// `world` is null or a world that no other thread uses, `def` null or a definition, `id` null or room for one.
enum SinewStatus sinew_world_add_joint(struct SinewWorld *world,
                                       const struct SinewJointDef *def,
                                       struct SinewJointId *id);

// Removes a joint.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_remove_joint(struct SinewWorld *world, struct SinewJointId id);

// Drives a joint toward a rotation of B relative to A, given as a scaled axis (a hinge: along x), by a spring with a frequency in Hz, a
// damping ratio and a largest torque, N·m. 0 Hz removes the motor.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_drive_joint(struct SinewWorld *world,
                                         struct SinewJointId id,
                                         struct SinewVec3 target,
                                         float hertz,
                                         float damping_ratio,
                                         float max_torque);

// Stores the distance between the joint's two anchors in `gap`, metres.
//
// The caller promises:
// `world` is null or a world that no other thread changes, `gap` is null or points to a number.
enum SinewStatus sinew_world_joint_gap(const struct SinewWorld *world,
                                       struct SinewJointId id,
                                       float *gap);

// Stores the pose of B relative to A, in the joint's frames, in `pose`: rotation and translation.
//
// The caller promises:
// As `sinew_world_joint_gap`.
enum SinewStatus sinew_world_joint_pose(const struct SinewWorld *world,
                                        struct SinewJointId id,
                                        struct SinewPose *pose);

// Casts a ray from `origin` along `way`, whose length is that of the ray. If it hits a body, `found` is 1 and `hit` is filled; else
// `found` is 0.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `hit` and `found` are null or have room.
enum SinewStatus sinew_world_ray(const struct SinewWorld *world,
                                 struct SinewVec3 origin,
                                 struct SinewVec3 way,
                                 struct SinewRayHit *hit,
                                 uint32_t *found);

// Stores the ids of the bodies that a shape at a pose would overlap, ascending.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `ids` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_world_overlap(const struct SinewWorld *world,
                                     struct SinewShape shape,
                                     struct SinewPose pose,
                                     struct SinewBodyId *ids,
                                     size_t capacity,
                                     size_t *count);

// Stores the points of all contacts, including contacts with a gap, in the order of pairs.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `contacts` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_world_contacts(const struct SinewWorld *world,
                                      struct SinewContact *contacts,
                                      size_t capacity,
                                      size_t *count);

// Stores the pairs of the last step's events of one kind (one of `SinewEventKind`), in the order of pairs.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `pairs` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_world_events(const struct SinewWorld *world,
                                    uint32_t kind,
                                    struct SinewPair *pairs,
                                    size_t capacity,
                                    size_t *count);

// Reads a ragdoll definition (`.json`) or an MJCF model (`.xml`), or builds the ragdoll of a character (GLB, glTF, VRM, FBX). A null path
// loads that of the built-in mannequin.
//
// The caller promises:
// `path` is null or text, `ragdoll` is null or points to room for a pointer.
enum SinewStatus sinew_ragdoll_load(const char *path,
                                    struct SinewRagdoll **ragdoll);

// Frees a ragdoll; its bodies in worlds remain. Null is allowed.
//
// The caller promises:
// `ragdoll` is null or came from `sinew_ragdoll_load` and is not used afterwards.
void sinew_ragdoll_free(struct SinewRagdoll *ragdoll);

// Stores the number of bodies of the ragdoll in `count`.
//
// The caller promises:
// `ragdoll` is null or a ragdoll, `count` is null or points to a number.
enum SinewStatus sinew_ragdoll_body_count(const struct SinewRagdoll *ragdoll, size_t *count);

// Stores the role of a body in `role`, such as "head" or "leftUpperArm"; valid as long as the ragdoll.
//
// The caller promises:
// `ragdoll` is null or a ragdoll, `role` is null or points to room for a pointer.
enum SinewStatus sinew_ragdoll_role(const struct SinewRagdoll *ragdoll,
                                    size_t body,
                                    const char **role);

// Adds a ragdoll to a world in its bind pose, standing at a pose (+Y up, facing +Z), at rest. Stores the ids of its bodies in `ids`, in
// the order of the definition. If `ids` is too small, the world is unchanged.
//
// The caller promises:
// `world` is null or a world that no other thread uses, `ragdoll` is null or a ragdoll; `ids` has room for `capacity`, `count` is null or
// points to a number.
enum SinewStatus sinew_ragdoll_spawn(const struct SinewRagdoll *ragdoll,
                                     struct SinewWorld *world,
                                     struct SinewPose pose,
                                     struct SinewBodyId *ids,
                                     size_t capacity,
                                     size_t *count);

// Stores the hash of the complete state in `hash`: the same on every machine, for every number of threads.
//
// The caller promises:
// `world` is null or a world that no other thread changes, `hash` is null or points to a number.
enum SinewStatus sinew_world_hash(const struct SinewWorld *world,
                                  uint64_t *hash);

// Saves a world to a buffer; stores the number of bytes in `size`, also if the capacity is too small.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `bytes` has room for `capacity`, `size` is null or points to a number.
enum SinewStatus sinew_world_save(const struct SinewWorld *world,
                                  uint8_t *bytes,
                                  size_t capacity,
                                  size_t *size);

// Restores a saved world. If the bytes are invalid, the world is unchanged.
//
// The caller promises:
// `world` is null or a world that no other thread uses, `bytes` has `size` bytes.
enum SinewStatus sinew_world_load(struct SinewWorld *world, const uint8_t *bytes, size_t size);

// Fills in the default settings of a world.
//
// The caller promises:
// `def` is null or points to room for one.
enum SinewStatus sinew_world_def_default(struct SinewWorldDef *def);

// Fills in the defaults of a body: dynamic, at the origin, without a shape.
//
// The caller promises:
// `def` is null or points to room for one.
enum SinewStatus sinew_body_def_default(struct SinewBodyDef *def);

// Creates a world. `def` may be null for the defaults.
//
// The caller promises:
// `def` is null or points to settings, `world` is null or points to room for a pointer.
enum SinewStatus sinew_world_new(const struct SinewWorldDef *def, struct SinewWorld **world);

// Frees a world; null is allowed.
//
// The caller promises:
// `world` is null or came from `sinew_world_new` and is not used afterwards.
void sinew_world_free(struct SinewWorld *world);

// Takes steps on the given number of threads, which does not affect the result. 0 and 1 use only the calling thread.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_step(struct SinewWorld *world,
                                  uint32_t steps,
                                  uint32_t threads);

// Stores the number of steps since the world was created in `steps`.
//
// The caller promises:
// `world` is null or a world that no other thread changes, `steps` is null or points to a number.
enum SinewStatus sinew_world_step_count(const struct SinewWorld *world, uint64_t *steps);

// Adds a body; stores its id in `id`.
//
// The caller promises:
// `world` is null or a world that no other thread uses, `def` null or a definition with valid `shapes`, `id` null or room for one.
enum SinewStatus sinew_world_add_body(struct SinewWorld *world,
                                      const struct SinewBodyDef *def,
                                      struct SinewBodyId *id);

// Removes a body with its joints.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_remove_body(struct SinewWorld *world, struct SinewBodyId id);

// Stores the ids of all bodies in `ids`, ascending by index.
//
// The caller promises:
// `world` is null or a world that no other thread changes, `ids` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_world_bodies(const struct SinewWorld *world,
                                    struct SinewBodyId *ids,
                                    size_t capacity,
                                    size_t *count);

// Stores the poses of bodies in the world in `poses`, one for each id.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `ids` and `poses` have `count` elements.
enum SinewStatus sinew_world_poses(const struct SinewWorld *world,
                                   const struct SinewBodyId *ids,
                                   size_t count,
                                   struct SinewPose *poses);

// Stores the velocities of bodies in `velocities`, one for each id.
//
// The caller promises:
// As `sinew_world_poses`.
enum SinewStatus sinew_world_velocities(const struct SinewWorld *world,
                                        const struct SinewBodyId *ids,
                                        size_t count,
                                        struct SinewVelocity *velocities);

// Moves a body to a pose without passing through the space between.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_set_pose(struct SinewWorld *world,
                                      struct SinewBodyId id,
                                      struct SinewPose pose);

// Sets the velocity of a body; ignored for static bodies.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_set_velocity(struct SinewWorld *world,
                                          struct SinewBodyId id,
                                          struct SinewVelocity velocity);

// Applies an impulse, N·s, world axes, to a dynamic body at a point in the world, or at its centre of mass if `point` is null.
//
// The caller promises:
// `world` is null or a world that no other thread uses, `point` is null or points to one.
enum SinewStatus sinew_world_push(struct SinewWorld *world,
                                  struct SinewBodyId id,
                                  struct SinewVec3 impulse,
                                  const struct SinewVec3 *point);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SINEW_H */

/* Sinew: physics for characters, in C. docs/c.md is the guide.
 *
 * Metres, kilograms, seconds, radians; +Y is up, right-handed. Every function gives a SinewStatus; what it wanted to say is in
 * sinew_last_error(). A handle is used by one thread at a time, different handles by different ones. */

#ifndef SINEW_H
#define SINEW_H

/* Made by cbindgen from bindings/c/src: SINEW_BLESS=1 cargo test --manifest-path bindings/Cargo.toml -p sinew_c writes it anew. */

#include <stddef.h>
#include <stdint.h>

// Outcome of a call.
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
  // The buffer is too small; the needed count was returned.
  SINEW_STATUS_TOO_SMALL = 6,
  // A bug in the library. The object being changed is unusable and can only be freed.
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
  // The body moves at its velocity; nothing pushes it.
  SINEW_BODY_KIND_KINEMATIC = 2,
} SinewBodyKind;

// Kind of events.
typedef enum SinewEventKind {
  // Bodies that began to touch.
  SINEW_EVENT_KIND_BEGIN = 0,
  // Bodies that stopped; ids may be stale.
  SINEW_EVENT_KIND_END = 1,
  // Bodies that hit each other fast.
  SINEW_EVENT_KIND_HIT = 2,
} SinewEventKind;

// Kind of a joint.
typedef enum SinewJointKind {
  // Turns freely about the anchor.
  SINEW_JOINT_KIND_BALL = 0,
  // Turns about the axis. `range`: radians.
  SINEW_JOINT_KIND_HINGE = 1,
  // Slides along the axis. `range`: metres.
  SINEW_JOINT_KIND_SLIDER = 2,
  // Locks all motions.
  SINEW_JOINT_KIND_FIXED = 3,
  // Rope or rod from the anchor of A to that of B. `range`: metres.
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
  // Everything below y = 0 of its frame, for static bodies. No sizes.
  SINEW_SHAPE_KIND_HALF_SPACE = 5,
} SinewShapeKind;

// Character in a world. It is stepped after the world: `sinew_world_step`, then `sinew_character_update`, one for one.
typedef struct SinewCharacter SinewCharacter;

// Kind of a character: rig, ragdoll and motions, shared by any number of characters.
typedef struct SinewCharacterDef SinewCharacterDef;

// Ragdoll as data, to be added to worlds.
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

// Transform of a joint in its parent, in the file's units.
typedef struct SinewLocalTransform {
  // Position and rotation.
  struct SinewPose pose;
  // Scale along each axis.
  struct SinewVec3 scale;
} SinewLocalTransform;

// Joint to be added.
typedef struct SinewJointDef {
  // One of `SinewJointKind`.
  uint32_t kind;
  // The first body.
  struct SinewBodyId a;
  // The other body; at least one of both must be dynamic.
  struct SinewBodyId b;
  // Anchor of both bodies, world, metres; of a distance joint its end at A.
  struct SinewVec3 anchor;
  // End of a distance joint at B, world, metres; ignored by other kinds.
  struct SinewVec3 anchor_b;
  // Axis of a hinge or a slider, world; not zero.
  struct SinewVec3 axis;
  // 1 if a hinge or slider has a range, else 0; a distance always has one. The present pose is 0.
  uint32_t has_range;
  // Least.
  float range_lo;
  // Most.
  float range_hi;
} SinewJointDef;

// Id of a joint in a world, as for bodies.
typedef struct SinewJointId {
  // Index and generation.
  uint64_t bits;
} SinewJointId;

// First hit of a ray.
typedef struct SinewRayHit {
  // The body.
  struct SinewBodyId body;
  // World, metres.
  struct SinewVec3 point;
  // Out of the body, unit length.
  struct SinewVec3 normal;
  // Fraction of the ray before the hit, 0 to 1.
  float fraction;
} SinewRayHit;

// Shape around its body's origin. `kind` is one of `SinewShapeKind`; a number, so that a wrong one is an error.
typedef struct SinewShape {
  // One of `SinewShapeKind`.
  uint32_t kind;
  // Sizes in metres, by the kind.
  struct SinewVec3 size;
} SinewShape;

// Point of a contact, as the last step left it.
typedef struct SinewContact {
  // The body with the smaller index.
  struct SinewBodyId a;
  // The other body.
  struct SinewBodyId b;
  // Position between the surfaces, world, metres.
  struct SinewVec3 position;
  // Normal from A to B, unit length.
  struct SinewVec3 normal;
  // Gap, metres; negative if they overlap.
  float separation;
  // Total impulse of the step, N·s.
  float impulse;
} SinewContact;

// Two bodies.
typedef struct SinewPair {
  // The body with the smaller index.
  struct SinewBodyId a;
  // The other body.
  struct SinewBodyId b;
} SinewPair;

// Settings of a world; `sinew_world_def_default` fills it.
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

// Body to be added; `sinew_body_def_default` fills it.
typedef struct SinewBodyDef {
  // One of `SinewBodyKind`. Default dynamic.
  uint32_t kind;
  // Pose in the world.
  struct SinewPose pose;
  // Velocity, m/s and rad/s.
  struct SinewVelocity velocity;
  // Shapes, all of them around the body's origin.
  const struct SinewShape *shapes;
  // Number of shapes.
  size_t shape_count;
  // Mass, kg, distributed over the shapes; 0, the default: computed from `density`.
  float mass;
  // Density, kg/m³. Default 1,000.
  float density;
  // Coulomb's coefficient, at least 0. Default 0.6.
  float friction;
  // Share of the speed given back, 0 to 1. Default 0.
  float restitution;
  // Bits of the layers that its shapes are on. Default 1.
  uint32_t layers;
  // Bits of the layers that they collide with. Default all.
  uint32_t mask;
  // Data of the user.
  uint64_t user_data;
} SinewBodyDef;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Sentence on the last call of this thread that gave no `SINEW_STATUS_OK`, or "". It names the file and the place. It lives until the
// thread's next call.
const char *sinew_last_error(void);

// Version of the library, such as "0.1.0".
const char *sinew_version(void);

// Reads a character (GLB, glTF, VRM, FBX) and builds its ragdoll. Where the file has no clip to get up by, a humanoid gets those that
// come with the library. A null path: the mannequin that comes with the library.
//
// The caller promises:
// `path` is null or text, `def` is null or points to room for a pointer.
enum SinewStatus sinew_character_def_load(const char *path,
                                          struct SinewCharacterDef **def);

// Frees a kind of character; its characters stay. Null is allowed.
//
// The caller promises:
// `def` is null or came from `sinew_character_def_load` and is not used any more.
void sinew_character_def_free(struct SinewCharacterDef *def);

// Number of joints in its rig, and of transforms in a pose.
//
// The caller promises:
// `def` is null or a kind of character, `count` is null or points to a number.
enum SinewStatus sinew_character_def_joint_count(const struct SinewCharacterDef *def,
                                                 size_t *count);

// Name of a joint; valid as long as the kind of character.
//
// The caller promises:
// `def` is null or a kind of character, `name` is null or points to room for a pointer.
enum SinewStatus sinew_character_def_joint_name(const struct SinewCharacterDef *def,
                                                size_t joint,
                                                const char **name);

// Adds an animated character to a world, with bodies that rays can hit, standing at a pose (+Y up, facing +Z).
//
// The caller promises:
// `def` is null or a kind of character, `world` is null or a world that no other thread uses, `character` is null or room for a pointer.
enum SinewStatus sinew_character_spawn(const struct SinewCharacterDef *def,
                                       struct SinewWorld *world,
                                       struct SinewPose pose,
                                       struct SinewCharacter **character);

// Takes a character out of its world and frees it. If it was in another one, or a body of it was removed, it is freed all the same,
// and the status says so.
//
// The caller promises:
// `character` came from `sinew_character_spawn` and is not used any more; `world` is null or a world that no other thread uses.
enum SinewStatus sinew_character_despawn(struct SinewCharacter *character,
                                         struct SinewWorld *world);

// Frees a character without removing its bodies, for a world that is freed as well. Null is allowed.
//
// The caller promises:
// `character` is null or came from `sinew_character_spawn` and is not used any more.
void sinew_character_free(struct SinewCharacter *character);

// Updates the character after a step of its world.
//
// The caller promises:
// `character` and `world` are null or used by no other thread.
enum SinewStatus sinew_character_update(struct SinewCharacter *character, struct SinewWorld *world);

// Hits a body, by its role ("chest") or its joint's name, with an impulse, N·s, world axes. It falls, or flinches if the hit is weak.
//
// The caller promises:
// `character` and `world` are null or used by no other thread, `body` is null or text.
enum SinewStatus sinew_character_hit(struct SinewCharacter *character,
                                     struct SinewWorld *world,
                                     const char *body,
                                     struct SinewVec3 impulse);

// Makes it limp at its present velocity.
//
// The caller promises:
// `character` and `world` are null or used by no other thread.
enum SinewStatus sinew_character_go_limp(struct SinewCharacter *character,
                                         struct SinewWorld *world);

// State of the character.
//
// The caller promises:
// `character` is null or one that no other thread changes, `state` is null or points to room.
enum SinewStatus sinew_character_state(const struct SinewCharacter *character,
                                       enum SinewCharacterState *state);

// Returns the ids of its bodies in the world, in the order of its ragdoll.
//
// The caller promises:
// `character` is null or one that no other thread changes; `ids` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_character_bodies(const struct SinewCharacter *character,
                                        struct SinewBodyId *ids,
                                        size_t capacity,
                                        size_t *count);

// Returns the transforms of all joints relative to their parents, in the order of the file.
//
// The caller promises:
// `character` is null or one that no other thread changes; `pose` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_character_pose(const struct SinewCharacter *character,
                                      struct SinewLocalTransform *pose,
                                      size_t capacity,
                                      size_t *count);

// Returns the matrix from the file's model space to the world, the parent of the pose: 3 rows of 4.
//
// The caller promises:
// `character` is null or one that no other thread changes, `matrix` is null or has room for 12 numbers.
enum SinewStatus sinew_character_world_from_model(const struct SinewCharacter *character,
                                                  float *matrix);

// Saves a character to a buffer, to accompany the snapshot of its world; see `sinew_world_save`.
//
// The caller promises:
// `character` is null or one that no other thread changes; `bytes` has room for `capacity`, `size` is null or points to a number.
enum SinewStatus sinew_character_save(const struct SinewCharacter *character,
                                      uint8_t *bytes,
                                      size_t capacity,
                                      size_t *size);

// Restores a saved character of the same kind. If the bytes are invalid, it is unchanged.
//
// The caller promises:
// `character` is null or used by no other thread, `bytes` has `size` of them.
enum SinewStatus sinew_character_load(struct SinewCharacter *character,
                                      const uint8_t *bytes,
                                      size_t size);

// Adds a joint at the present poses of its bodies.
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

// Drives a joint toward a rotation of B in A (a hinge: about its axis, x), as a spring with a frequency in Hz and a damping ratio, with no more
// than a torque, N·m. 0 Hz: no motor.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_drive_joint(struct SinewWorld *world,
                                         struct SinewJointId id,
                                         struct SinewVec3 target,
                                         float hertz,
                                         float damping_ratio,
                                         float max_torque);

// Returns the distance of the joint's two anchors, metres.
//
// The caller promises:
// `world` is null or a world that no other thread changes, `gap` is null or points to a number.
enum SinewStatus sinew_world_joint_gap(const struct SinewWorld *world,
                                       struct SinewJointId id,
                                       float *gap);

// Returns the pose of B in A in the joint's frames: its rotation and its slide.
//
// The caller promises:
// As `sinew_world_joint_gap`.
enum SinewStatus sinew_world_joint_pose(const struct SinewWorld *world,
                                        struct SinewJointId id,
                                        struct SinewPose *pose);

// Casts a ray from `origin` along `way`, which also sets its length. If it hits a body, `found` is 1 and `hit` is filled, else `found` is 0.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `hit` and `found` are null or have room.
enum SinewStatus sinew_world_ray(const struct SinewWorld *world,
                                 struct SinewVec3 origin,
                                 struct SinewVec3 way,
                                 struct SinewRayHit *hit,
                                 uint32_t *found);

// Bodies that a shape at a pose would overlap, ascending.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `ids` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_world_overlap(const struct SinewWorld *world,
                                     struct SinewShape shape,
                                     struct SinewPose pose,
                                     struct SinewBodyId *ids,
                                     size_t capacity,
                                     size_t *count);

// Returns the points of all contacts, including those with a gap, in the order of pairs.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `contacts` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_world_contacts(const struct SinewWorld *world,
                                      struct SinewContact *contacts,
                                      size_t capacity,
                                      size_t *count);

// Events of the last step, of a kind (one of `SinewEventKind`), in the order of pairs.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `pairs` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_world_events(const struct SinewWorld *world,
                                    uint32_t kind,
                                    struct SinewPair *pairs,
                                    size_t capacity,
                                    size_t *count);

// Reads a ragdoll: a definition (`.json`), an MJCF model (`.xml`), or a character (GLB, glTF, VRM, FBX), of which it is built. A null
// path: that of the mannequin that comes with the library.
//
// The caller promises:
// `path` is null or text, `ragdoll` is null or points to room for a pointer.
enum SinewStatus sinew_ragdoll_load(const char *path,
                                    struct SinewRagdoll **ragdoll);

// Frees a ragdoll; bodies in worlds stay. Null is allowed.
//
// The caller promises:
// `ragdoll` is null or came from `sinew_ragdoll_load` and is not used any more.
void sinew_ragdoll_free(struct SinewRagdoll *ragdoll);

// Number of its bodies.
//
// The caller promises:
// `ragdoll` is null or a ragdoll, `count` is null or points to a number.
enum SinewStatus sinew_ragdoll_body_count(const struct SinewRagdoll *ragdoll, size_t *count);

// Role of a body, such as "head" or "leftUpperArm"; valid as long as the ragdoll.
//
// The caller promises:
// `ragdoll` is null or a ragdoll, `role` is null or points to room for a pointer.
enum SinewStatus sinew_ragdoll_role(const struct SinewRagdoll *ragdoll,
                                    size_t body,
                                    const char **role);

// Puts a ragdoll into a world, in its bind pose, standing at a pose (+Y up, facing +Z), at rest. Gives its bodies' ids in the order
// of the definition; with too little room for them nothing is put into the world.
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

// Hash of the complete state: the same on every machine, for every number of threads.
//
// The caller promises:
// `world` is null or a world that no other thread changes, `hash` is null or points to a number.
enum SinewStatus sinew_world_hash(const struct SinewWorld *world, uint64_t *hash);

// Saves a world to a buffer; `size` is the number of bytes, also if the capacity is too small.
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
// `world` is null or a world that no other thread uses, `bytes` has `size` of them.
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
// `world` is null or came from `sinew_world_new` and is not used any more.
void sinew_world_free(struct SinewWorld *world);

// Takes steps on the given number of threads; the result does not depend on it. 0 and 1 use the calling thread only.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_step(struct SinewWorld *world,
                                  uint32_t steps,
                                  uint32_t threads);

// Number of steps since the beginning.
//
// The caller promises:
// `world` is null or a world that no other thread changes, `steps` is null or points to a number.
enum SinewStatus sinew_world_step_count(const struct SinewWorld *world, uint64_t *steps);

// Adds a body.
//
// The caller promises:
// `world` is null or a world that no other thread uses, `def` null or a definition whose shapes are there, `id` null or room for one.
enum SinewStatus sinew_world_add_body(struct SinewWorld *world,
                                      const struct SinewBodyDef *def,
                                      struct SinewBodyId *id);

// Removes a body with its joints.
//
// The caller promises:
// `world` is null or a world that no other thread uses.
enum SinewStatus sinew_world_remove_body(struct SinewWorld *world, struct SinewBodyId id);

// Ids of all bodies, ascending by index.
//
// The caller promises:
// `world` is null or a world that no other thread changes, `ids` has room for `capacity`, `count` is null or points to a number.
enum SinewStatus sinew_world_bodies(const struct SinewWorld *world,
                                    struct SinewBodyId *ids,
                                    size_t capacity,
                                    size_t *count);

// Poses of bodies in the world, one for each id.
//
// The caller promises:
// `world` is null or a world that no other thread changes; `ids` and `poses` have `count` elements.
enum SinewStatus sinew_world_poses(const struct SinewWorld *world,
                                   const struct SinewBodyId *ids,
                                   size_t count,
                                   struct SinewPose *poses);

// Velocities of bodies, one for each id.
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

// Sets the velocity of a body; ignored for static ones.
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

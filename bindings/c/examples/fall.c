/* The built-in mannequin walks, is hit in the back, falls and gets up; a crate falls beside it.
 *
 *   fall [CHARACTER.glb]
 */
#include "sinew.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Every call returns a status; on an error the program prints the reason and exits. */
static void must(SinewStatus status, const char *what) {
    if (status != SINEW_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", what, sinew_last_error());
        exit(1);
    }
}

static SinewBodyId add(SinewWorld *world, SinewBodyKind kind, SinewShape shape, SinewVec3 at) {
    SinewBodyDef def;
    SinewBodyId id;
    must(sinew_body_def_default(&def), "defaults");
    def.kind = kind;
    def.shapes = &shape;
    def.shape_count = 1;
    def.pose.position = at;
    must(sinew_world_add_body(world, &def, &id), "body");
    return id;
}

static uint64_t hash_of(const SinewWorld *world) {
    uint64_t hash;
    must(sinew_world_hash(world, &hash), "hash");
    return hash;
}

int main(int argc, char **argv) {
    const char *names[] = {"animated", "limp", "preparing", "getting up", "flinching", "powered"};
    SinewWorld *world;
    SinewCharacterDef *def;
    SinewCharacter *character;
    must(sinew_world_new(NULL, &world), "world");

    SinewShape floor = {SINEW_SHAPE_KIND_HALF_SPACE, {0, 0, 0}};
    SinewShape crate = {SINEW_SHAPE_KIND_BOX, {0.25f, 0.25f, 0.25f}};
    add(world, SINEW_BODY_KIND_STATIC, floor, (SinewVec3){0, 0, 0});
    SinewBodyId box = add(world, SINEW_BODY_KIND_DYNAMIC, crate, (SinewVec3){2, 3, 0});

    must(sinew_character_def_load(argc > 1 ? argv[1] : NULL, &def), "character");
    SinewPose origin = {{0, 0, 0}, {0, 0, 0, 1}};
    must(sinew_character_spawn(def, world, origin, &character), "spawn");

    SinewCharacterState state, before = SINEW_CHARACTER_STATE_ANIMATED;
    int fell = 0, rose = 0;
    uint64_t middle = 0;
    size_t size = 0;
    uint8_t *snapshot = NULL;
    for (int step = 0; step < 720; step++) {
        if (step == 60) {
            must(sinew_character_hit(character, world, "chest", (SinewVec3){0, 0, 160}), "hit");
        }
        must(sinew_world_step(world, 1, 1), "step");
        must(sinew_character_update(character, world), "update");
        must(sinew_character_state(character, &state), "state");
        if (state != before) {
            printf("%5.2f s  %s\n", step / 60.0, names[state]);
            fell |= state == SINEW_CHARACTER_STATE_LIMP;
            rose |= fell && state == SINEW_CHARACTER_STATE_ANIMATED;
            before = state;
        }
        if (step == 200) { /* the world in the middle of the fall, to come back to */
            if (sinew_world_save(world, NULL, 0, &size) != SINEW_STATUS_TOO_SMALL) {
                return 1;
            }
            snapshot = malloc(size);
            must(sinew_world_save(world, snapshot, size, &size), "save");
            middle = hash_of(world);
        }
    }

    size_t joints = 0;
    must(sinew_character_def_joint_count(def, &joints), "joints");
    SinewLocalTransform *pose = malloc(joints * sizeof *pose);
    must(sinew_character_pose(character, pose, joints, &joints), "pose");
    const char *name;
    must(sinew_character_def_joint_name(def, 1, &name), "name");
    printf("joint %s at (%.2f, %.2f, %.2f) in its parent\n", name, pose[1].pose.position.x, pose[1].pose.position.y,
           pose[1].pose.position.z);

    SinewPose at;
    SinewRayHit hit;
    uint32_t found = 0;
    must(sinew_world_poses(world, &box, 1, &at), "pose of the box");
    must(sinew_world_ray(world, (SinewVec3){2, 5, 0}, (SinewVec3){0, -10, 0}, &hit, &found), "ray");
    printf("the box lies at %.3f m; a ray from above meets %s at %.3f m\n", at.position.y,
           found && hit.body.bits == box.bits ? "it" : "something else", hit.point.y);

    size_t points = 0;
    SinewContact contacts[64];
    must(sinew_world_contacts(world, contacts, 64, &points), "contacts");
    printf("%zu points of contact, state %016llx\n", points, (unsigned long long)hash_of(world));

    must(sinew_world_load(world, snapshot, size), "load");
    int same = hash_of(world) == middle;
    printf("back in the middle of the fall: %s\n", same ? "the same state" : "ANOTHER STATE");

    /* An invalid call returns an error and changes nothing. */
    SinewBodyId unknown = {UINT64_MAX};
    if (sinew_world_poses(world, &unknown, 1, &at) != SINEW_STATUS_STALE_ID || strlen(sinew_last_error()) == 0) {
        return 1;
    }

    free(pose);
    free(snapshot);
    sinew_character_free(character);
    sinew_character_def_free(def);
    sinew_world_free(world);
    int lies = found && hit.body.bits == box.bits && fabsf(hit.point.y - 0.5f) < 0.01f;
    return fell && (rose || argc > 1) && lies && points >= 1 && same ? 0 : 1;
}

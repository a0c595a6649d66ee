// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Reads the deformed surfaces and the particles of a running session, with Cyclone DDS and nothing of NeoETI
// but its IDL, and writes the last whole state of each as legacy VTK files, which ParaView opens. See
// docs/lab_readers.md.
#include <dds/dds.h>
#include <eti.h>
#include <session.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <whole_state.h>

enum { batch = 64, two_states = 2048 };  // chunks

struct arguments {
    struct place place;
    const char* out;
    double seconds;
    bool surfaces, particles;
};

static struct arguments parse(int count, char** words) {
    struct arguments a = {{"default", 0, false}, ".", 2.0, true, true};
    for (int i = 1; i < count; ++i) {
        const bool value = i + 1 < count;
        if (take_place(&a.place, &i, count, words)) {
            continue;
        }
        if (!strcmp(words[i], "--out") && value) {
            a.out = words[++i];
        } else if (!strcmp(words[i], "--seconds") && value) {
            a.seconds = strtod(words[++i], NULL);
        } else if (!strcmp(words[i], "--only-surfaces")) {
            a.particles = false;
        } else if (!strcmp(words[i], "--only-particles")) {
            a.surfaces = false;
        } else {
            printf(
                "Usage: surface_reader [--session NAME] [--domain N] [--out DIR] [--seconds S] [--network]\n"
                "                      [--only-surfaces | --only-particles]\n"
                "Reads for S seconds (2) after the first whole state, then writes the last one to\n"
                "DIR/surfaces.vtk and DIR/particles.vtk.\n"
                "  --network  use the network of CYCLONEDDS_URI instead of loopback; the server then runs "
                "with\n"
                "             --network, too\n");
            exit(strcmp(words[i], "--help") ? 2 : 0);
        }
    }
    return a;
}

// Takes what waits and hands it on; the number of samples.
static int drain(dds_entity_t reader, void (*take)(struct whole_state*, const void*),
                 struct whole_state* whole) {
    void* samples[batch] = {NULL};
    dds_sample_info_t info[batch];
    const int count = reader > 0 ? dds_take(reader, samples, info, batch, batch) : 0;
    for (int i = 0; i < count; ++i) {
        if (info[i].valid_data) {
            take(whole, samples[i]);
        }
    }
    if (count > 0) {
        dds_return_loan(reader, samples, count);
    }
    return count;
}

static void report(const char* what, const struct state_count* count, double seconds) {
    printf("{\"topic\": \"%s\", \"whole\": %lu, \"torn\": %lu, \"chunks\": %lu, \"bytes_per_s\": %.0f}\n",
           what, count->whole, count->torn, count->chunks, (double)count->bytes / seconds);
}

int main(int count, char** words) {
    const struct arguments a = parse(count, words);
    const struct session s = join(a.place);
    const dds_entity_t scene = reader_of(s, &eti_msg_SceneDescription_desc, "eti/scene", lasting, 1);
    dds_entity_t meshes = 0, particles = 0;
    if (a.surfaces) {
        meshes = reader_of(s, &eti_msg_MeshState_desc, "eti/mesh_state", state, two_states);
    }
    if (a.particles) {
        particles = reader_of(s, &eti_msg_ParticleState_desc, "eti/particle_state", state, two_states);
    }
    const dds_entity_t waitset = dds_create_waitset(s.participant);
    const dds_entity_t readers[] = {scene, meshes, particles};
    for (int i = 0; i < 3; ++i) {
        if (readers[i] > 0) {
            dds_waitset_attach(waitset, dds_create_readcondition(readers[i], DDS_ANY_STATE), i);
        }
    }

    struct whole_state* const whole = whole_state_new();
    const dds_time_t patience = dds_time() + DDS_SECS(patience_s);
    dds_time_t began = 0;
    while (!began || dds_time() < began + (dds_time_t)(a.seconds * 1e9)) {
        dds_waitset_wait(waitset, NULL, 0, DDS_MSECS(100));
        while (drain(scene, take_object, whole) + drain(meshes, take_mesh, whole) +
                   drain(particles, take_particles, whole) >
               0) {
        }
        if (!began && (!a.surfaces || whole->surfaces.whole) && (!a.particles || whole->particles.whole)) {
            began = dds_time();
            whole->surfaces = whole->particles = (struct state_count){0};
        }
        if (!began && dds_time() > patience) {
            give_up(
                "no complete state within a minute",
                "is a server of this --session, --domain and protocol running on this machine? Elsewhere: "
                "--network on both sides");
        }
    }
    dds_delete(s.participant);
    if (a.surfaces) {
        report("eti/mesh_state", &whole->surfaces, a.seconds);
    }
    if (a.particles) {
        report("eti/particle_state", &whole->particles, a.seconds);
    }
    if ((a.surfaces && !write_surfaces(whole, a.out)) || (a.particles && !write_particles(whole, a.out))) {
        give_up("cannot write the state", "give an existing folder with enough space with --out");
    }
    whole_state_free(whole);
    return 0;
}

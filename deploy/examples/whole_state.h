// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Puts chunks of surfaces and particles together to whole states, and writes these as legacy VTK files.
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { most_objects = 64, most_tissues = 64, most_positions = 1 << 20, most_chunks = 65536 };

// A list of positions in the making: x y z of each [m], and how far they may be off [m].
struct positions {
    uint32_t count;
    float* xyz;
    float* half_quantum;
};

struct object {
    char name[49];
    uint32_t triangle_count;
    uint32_t* triangles;       // three vertices each
    uint8_t* triangle_tissue;  // one each
    struct positions making, whole;
};

// Which chunks of a state have come.
struct chunks {
    bool any;
    uint32_t number;  // of the step
    uint64_t time_ns;
    uint32_t count, come;
    uint8_t seen[most_chunks];
};

struct state_count {
    unsigned long whole, torn, chunks, bytes;
};

struct whole_state {
    uint32_t object_count;
    struct object objects[most_objects];
    struct positions making[most_tissues], whole[most_tissues];
    struct chunks mesh_chunks, particle_chunks;
    uint64_t surfaces_ns, particles_ns;  // simulation time of the whole states
    struct state_count surfaces, particles;
};

struct whole_state* whole_state_new(void);
void whole_state_free(struct whole_state* state);

// Of an eti_msg_SceneDescription, eti_msg_MeshState, eti_msg_ParticleState. What cannot be right is left out.
void take_object(struct whole_state* state, const void* message);
void take_mesh(struct whole_state* state, const void* message);
void take_particles(struct whole_state* state, const void* message);

// To surfaces.vtk and particles.vtk in a folder.
bool write_surfaces(const struct whole_state* state, const char* folder);
bool write_particles(const struct whole_state* state, const char* folder);

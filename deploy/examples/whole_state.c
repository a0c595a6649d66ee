// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <whole_state.h>

#include <eti.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct whole_state* whole_state_new(void) {
    return calloc(1, sizeof(struct whole_state));
}

static void release(struct positions* positions) {
    free(positions->xyz);
    free(positions->half_quantum);
    *positions = (struct positions){0};
}

void whole_state_free(struct whole_state* state) {
    for (uint32_t i = 0; i < state->object_count; ++i) {
        free(state->objects[i].triangles);
        free(state->objects[i].triangle_tissue);
        release(&state->objects[i].making);
        release(&state->objects[i].whole);
    }
    for (int i = 0; i < most_tissues; ++i) {
        release(&state->making[i]);
        release(&state->whole[i]);
    }
    free(state);
}

static bool hold(struct positions* positions, uint32_t count) {
    if (positions->count == count) {
        return true;
    }
    release(positions);
    positions->xyz = calloc(count, 3 * sizeof(float));
    positions->half_quantum = calloc(count, sizeof(float));
    positions->count = positions->xyz && positions->half_quantum ? count : 0;
    return positions->count == count;
}

static struct object* object_named(struct whole_state* state, const char* name) {
    for (uint32_t i = 0; i < state->object_count; ++i) {
        if (!strcmp(state->objects[i].name, name)) {
            return &state->objects[i];
        }
    }
    return NULL;
}

void take_object(struct whole_state* state, const void* sample) {
    const eti_msg_SceneDescription* const m = sample;
    const uint32_t vertices = m->vertices._length / 3, triangles = m->triangles._length / 3;
    if (m->kind != eti_msg_OBJECT_SURFACE || !vertices || vertices > most_positions ||
        object_named(state, m->object) || state->object_count == most_objects ||
        m->triangle_tissue._length != triangles) {
        return;
    }
    for (uint32_t i = 0; i < 3 * triangles; ++i) {
        if (m->triangles._buffer[i] >= vertices) {
            return;
        }
    }
    struct object* const o = &state->objects[state->object_count];
    o->triangles = malloc(3 * triangles * sizeof(uint32_t));
    o->triangle_tissue = malloc(triangles);
    if (!hold(&o->making, vertices) || !hold(&o->whole, vertices) || !o->triangles || !o->triangle_tissue) {
        return;
    }
    memcpy(o->name, m->object, sizeof o->name);
    memcpy(o->triangles, m->triangles._buffer, 3 * triangles * sizeof(uint32_t));
    memcpy(o->triangle_tissue, m->triangle_tissue._buffer, triangles);
    o->triangle_count = triangles;
    ++state->object_count;
}

// Whether this chunk was still lacking in the newest state. One of a newer state gives the older one up.
static bool lacking(struct chunks* chunks, struct state_count* count, const eti_msg_Header* header,
                    uint32_t chunk, uint32_t all) {
    if (chunk >= all || (chunks->any && (int32_t)(header->number - chunks->number) < 0)) {
        return false;
    }
    if (!chunks->any || header->number != chunks->number) {
        count->torn += chunks->any && chunks->come < chunks->count;
        memset(chunks->seen, 0, sizeof chunks->seen);
        chunks->any = true;
        chunks->number = header->number;
        chunks->time_ns = header->simulation_time_ns;
        chunks->count = all;
        chunks->come = 0;
    }
    if (chunks->seen[chunk]) {
        return false;
    }
    chunks->seen[chunk] = 1;
    ++chunks->come;
    ++count->chunks;
    return true;
}

static bool place(struct positions* to, uint32_t first, const eti_msg_Vec3* lower, const eti_msg_Vec3* upper,
                  const dds_sequence_unsigned_short* places) {
    const uint32_t count = places->_length / 3;
    if (places->_length % 3 || first > to->count || count > to->count - first) {
        return false;
    }
    const float edge[3] = {upper->x - lower->x, upper->y - lower->y, upper->z - lower->z};
    const float corner[3] = {lower->x, lower->y, lower->z};
    float longest = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        longest = edge[axis] > longest ? edge[axis] : longest;
    }
    for (uint32_t i = 0; i < count; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            to->xyz[3 * (first + i) + axis] =
                corner[axis] + (float)places->_buffer[3 * i + axis] * (edge[axis] / 65535.0f);
        }
        to->half_quantum[first + i] = longest / 131070.0f;
    }
    return true;
}

static void keep(struct positions* whole, const struct positions* made) {
    if (hold(whole, made->count)) {
        memcpy(whole->xyz, made->xyz, 3 * made->count * sizeof(float));
        memcpy(whole->half_quantum, made->half_quantum, made->count * sizeof(float));
    }
}

void take_mesh(struct whole_state* state, const void* sample) {
    const eti_msg_MeshState* const m = sample;
    struct object* const o = object_named(state, m->object);
    struct chunks* const chunks = &state->mesh_chunks;
    // As encoded: header and numbers 24, name, boxes and counts 36, two bytes a place.
    state->surfaces.bytes += 64 + strlen(m->object) + 1 + 2 * m->places._length;
    if (!o || !lacking(chunks, &state->surfaces, &m->header, m->chunk, m->chunks) ||
        !place(&o->making, m->first, &m->lower, &m->upper, &m->places) || chunks->come < chunks->count) {
        return;
    }
    for (uint32_t i = 0; i < state->object_count; ++i) {
        keep(&state->objects[i].whole, &state->objects[i].making);
    }
    state->surfaces_ns = chunks->time_ns;
    ++state->surfaces.whole;
}

void take_particles(struct whole_state* state, const void* sample) {
    const eti_msg_ParticleState* const m = sample;
    struct chunks* const chunks = &state->particle_chunks;
    state->particles.bytes += 68 + 2 * m->places._length;
    if (m->tissue >= most_tissues || m->count > most_positions ||
        !lacking(chunks, &state->particles, &m->header, m->chunk, m->chunks) ||
        !hold(&state->making[m->tissue], m->count) ||
        !place(&state->making[m->tissue], m->first, &m->lower, &m->upper, &m->places) ||
        chunks->come < chunks->count) {
        return;
    }
    for (int i = 0; i < most_tissues; ++i) {
        keep(&state->whole[i], &state->making[i]);
    }
    state->particles_ns = chunks->time_ns;
    ++state->particles.whole;
}

// What all legacy files begin with. The time is in the title, where people and scripts find it.
static FILE* begin(const char* folder, const char* name, uint64_t time_ns, uint32_t points) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.vtk", folder, name);
    FILE* const file = fopen(path, "w");
    if (file) {
        fprintf(
            file,
            "# vtk DataFile Version 3.0\nNeoETI %s [m], simulation time %llu ns\nASCII\nDATASET POLYDATA\n",
            name, (unsigned long long)time_ns);
        fprintf(file, "POINTS %u float\n", points);
    }
    return file;
}

static void write_points(FILE* file, const struct positions* p) {
    for (uint32_t i = 0; i < p->count; ++i) {
        // Nine digits bring a float back as it was.
        fprintf(file, "%.9g %.9g %.9g\n", p->xyz[3 * i], p->xyz[3 * i + 1], p->xyz[3 * i + 2]);
    }
}

static void write_quanta(FILE* file, const struct positions* p) {
    for (uint32_t i = 0; i < p->count; ++i) {
        fprintf(file, "%.9g\n", p->half_quantum[i]);
    }
}

static bool end(FILE* file) {
    const bool whole = !ferror(file);
    return !fclose(file) && whole;
}

bool write_surfaces(const struct whole_state* state, const char* folder) {
    uint32_t points = 0, triangles = 0;
    for (uint32_t i = 0; i < state->object_count; ++i) {
        points += state->objects[i].whole.count;
        triangles += state->objects[i].triangle_count;
    }
    FILE* const file = begin(folder, "surfaces", state->surfaces_ns, points);
    if (!file) {
        return false;
    }
    for (uint32_t i = 0; i < state->object_count; ++i) {
        write_points(file, &state->objects[i].whole);
    }
    fprintf(file, "POLYGONS %u %u\n", triangles, 4 * triangles);
    uint32_t before = 0;
    for (uint32_t i = 0; i < state->object_count; ++i) {
        const struct object* const o = &state->objects[i];
        for (uint32_t t = 0; t < o->triangle_count; ++t) {
            fprintf(file, "3 %u %u %u\n", before + o->triangles[3 * t], before + o->triangles[3 * t + 1],
                    before + o->triangles[3 * t + 2]);
        }
        before += o->whole.count;
    }
    fprintf(file, "CELL_DATA %u\nSCALARS tissue int 1\nLOOKUP_TABLE default\n", triangles);
    for (uint32_t i = 0; i < state->object_count; ++i) {
        for (uint32_t t = 0; t < state->objects[i].triangle_count; ++t) {
            fprintf(file, "%u\n", state->objects[i].triangle_tissue[t]);
        }
    }
    fprintf(file, "POINT_DATA %u\nSCALARS half_quantum float 1\nLOOKUP_TABLE default\n", points);
    for (uint32_t i = 0; i < state->object_count; ++i) {
        write_quanta(file, &state->objects[i].whole);
    }
    fprintf(file, "FIELD objects 1\n");
    fprintf(file, "object 1 %u string\n", points);
    for (uint32_t i = 0; i < state->object_count; ++i) {
        for (uint32_t v = 0; v < state->objects[i].whole.count; ++v) {
            fprintf(file, "%s\n", state->objects[i].name);
        }
    }
    return end(file);
}

bool write_particles(const struct whole_state* state, const char* folder) {
    uint32_t points = 0;
    for (int i = 0; i < most_tissues; ++i) {
        points += state->whole[i].count;
    }
    FILE* const file = begin(folder, "particles", state->particles_ns, points);
    if (!file) {
        return false;
    }
    for (int i = 0; i < most_tissues; ++i) {
        write_points(file, &state->whole[i]);
    }
    fprintf(file, "VERTICES %u %u\n", points, 2 * points);
    for (uint32_t i = 0; i < points; ++i) {
        fprintf(file, "1 %u\n", i);
    }
    fprintf(file, "POINT_DATA %u\nSCALARS tissue int 1\nLOOKUP_TABLE default\n", points);
    for (int i = 0; i < most_tissues; ++i) {
        for (uint32_t p = 0; p < state->whole[i].count; ++p) {
            fprintf(file, "%d\n", i);
        }
    }
    fprintf(file, "SCALARS half_quantum float 1\nLOOKUP_TABLE default\n");
    for (int i = 0; i < most_tissues; ++i) {
        write_quanta(file, &state->whole[i]);
    }
    return end(file);
}

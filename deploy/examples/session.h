// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// A place on the bus of a running session, with Cyclone DDS. Errors end the program with a line that says
// what to do.
#pragma once

#include <dds/dds.h>
#include <stdbool.h>

struct session {
    dds_entity_t participant, publisher, subscriber;
};

// How a topic travels: as common/bus/topics.hpp has it, or the two sides do not match.
enum travel {
    state,    // best effort: the newest counts
    event,    // reliable
    lasting,  // reliable, and kept for those who join late
};

// Which session: as the programs' --session and --domain. Over loopback, as they do by default, unless
// `network` or CYCLONEDDS_URI says otherwise.
struct place {
    const char* session;
    unsigned domain;
    bool network;
};

// Takes --session NAME, --domain N or --network, if the word at `at` is one of these; `at` is then its last
// word.
bool take_place(struct place* place, int* at, int count, char** words);

struct session join(struct place place);

dds_entity_t reader_of(struct session session, const dds_topic_descriptor_t* type, const char* topic,
                       enum travel how, int depth);
dds_entity_t writer_of(struct session session, const dds_topic_descriptor_t* type, const char* topic,
                       enum travel how);

// How long to wait for the server [s]: on a busy machine finding it takes seconds.
enum { patience_s = 60 };

// Waits until the writer has a reader.
void wait_for_reader(dds_entity_t writer);

void give_up(const char* what, const char* remedy);

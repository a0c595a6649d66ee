// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <session.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char loopback[] =
    "<Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\" "
    "multicast=\"true\"/></Interfaces></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>100</"
    "MaxAutoParticipantIndex>"
    "</Discovery></Domain>";

static const char nobody[] =
    "is a server of this --session, --domain and protocol running on this machine? Elsewhere: --network on "
    "both sides";

void give_up(const char* what, const char* remedy) {
    fprintf(stderr, "%s; %s\n", what, remedy);
    exit(1);
}

static dds_entity_t made(dds_entity_t entity, const char* what) {
    if (entity < 0) {
        fprintf(stderr, "no %s: %s; is the network interface up, and the domain from 0 to 232?\n", what,
                dds_strretcode(-entity));
        exit(1);
    }
    return entity;
}

bool take_place(struct place* place, int* at, int count, char** words) {
    if (!strcmp(words[*at], "--network")) {
        place->network = true;
        return true;
    }
    if (*at + 1 < count && !strcmp(words[*at], "--session")) {
        place->session = words[++*at];
        return true;
    }
    if (*at + 1 < count && !strcmp(words[*at], "--domain")) {
        place->domain = (unsigned)strtoul(words[++*at], NULL, 10);
        return true;
    }
    return false;
}

struct session join(struct place place) {
    const char* const own = getenv("CYCLONEDDS_URI");
    if (!place.network && !(own && *own)) {
        made(dds_create_domain(place.domain, loopback), "domain");
    }
    struct session s;
    s.participant = made(dds_create_participant(place.domain, NULL, NULL), "participant");
    // Programs of another protocol would misread messages: they meet in another partition.
    char partition[80];
    snprintf(partition, sizeof partition, "%s/%d", place.session, ETI_PROTOCOL);
    const char* partitions[] = {partition};
    dds_qos_t* const quality = dds_create_qos();
    dds_qset_partition(quality, 1, partitions);
    s.publisher = made(dds_create_publisher(s.participant, quality, NULL), "publisher");
    s.subscriber = made(dds_create_subscriber(s.participant, quality, NULL), "subscriber");
    dds_delete_qos(quality);
    return s;
}

static dds_qos_t* quality_of(enum travel how, int depth) {
    dds_qos_t* const quality = dds_create_qos();
    dds_qset_reliability(quality, how == state ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
                         DDS_MSECS(20));
    dds_qset_durability(quality, how == lasting ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(quality, DDS_HISTORY_KEEP_LAST, depth);
    // The programs encode as plain CDR; Cyclone would choose another where a type allows both.
    const dds_data_representation_id_t plain = DDS_DATA_REPRESENTATION_XCDR1;
    dds_qset_data_representation(quality, 1, &plain);
    return quality;
}

static dds_entity_t topic_of(struct session s, const dds_topic_descriptor_t* type, const char* name) {
    return made(dds_create_topic(s.participant, type, name, NULL, NULL), name);
}

dds_entity_t reader_of(struct session s, const dds_topic_descriptor_t* type, const char* topic,
                       enum travel how, int depth) {
    dds_qos_t* const quality = quality_of(how, depth);
    const dds_entity_t reader =
        made(dds_create_reader(s.subscriber, topic_of(s, type, topic), quality, NULL), topic);
    dds_delete_qos(quality);
    return reader;
}

dds_entity_t writer_of(struct session s, const dds_topic_descriptor_t* type, const char* topic,
                       enum travel how) {
    dds_qos_t* const quality = quality_of(how, 1);
    const dds_entity_t writer =
        made(dds_create_writer(s.publisher, topic_of(s, type, topic), quality, NULL), topic);
    dds_delete_qos(quality);
    return writer;
}

void wait_for_reader(dds_entity_t writer) {
    for (int tried = 0; tried < 10 * patience_s; ++tried) {
        dds_publication_matched_status_t status;
        if (dds_get_publication_matched_status(writer, &status) == DDS_RETCODE_OK &&
            status.current_count > 0) {
            return;
        }
        dds_sleepfor(DDS_MSECS(100));
    }
    give_up("no reader within a minute", nobody);
}

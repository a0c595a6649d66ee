// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// A device of one's own, with Cyclone DDS and nothing of NeoETI but its IDL: holds the laryngoscope at a
// place for a while and asks for another value of something that lives. Prints where the server has it, and
// what it answers. See docs/lab_readers.md.
#include <dds/dds.h>
#include <eti.h>
#include <session.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { repeat_s = 5 };

struct arguments {
    struct place place;
    double seconds;
    float at[3];
    const char* wish;
    float value;
};

static struct arguments parse(int count, char** words) {
    struct arguments a = {{"default", 0, false}, 2.0, {0.0f, -0.2f, 0.2f}, NULL, 0.0f};
    for (int i = 1; i < count; ++i) {
        if (take_place(&a.place, &i, count, words)) {
            continue;
        }
        if (!strcmp(words[i], "--seconds") && i + 1 < count) {
            a.seconds = strtod(words[++i], NULL);
        } else if (!strcmp(words[i], "--at") && i + 3 < count) {
            for (int axis = 0; axis < 3; ++axis) {
                a.at[axis] = strtof(words[++i], NULL);
            }
        } else if (!strcmp(words[i], "--set") && i + 2 < count) {
            a.wish = words[++i];
            a.value = strtof(words[++i], NULL);
        } else {
            printf(
                "Usage: tool_writer [--session NAME] [--domain N] [--seconds S] [--at X Y Z] [--set NAME "
                "VALUE]\n"
                "                   [--network]\n"
                "Holds the laryngoscope at X Y Z [m] for S seconds (2), patient frame, without rotation. "
                "--set requests\n"
                "a value of a runtime parameter in SI units and waits for the answer. --network: instead of "
                "over\n"
                "loopback, use the network of CYCLONEDDS_URI.\n");
            exit(strcmp(words[i], "--help") ? 2 : 0);
        }
    }
    return a;
}

// The newest sample that waits, copied into `sample`.
static bool newest(dds_entity_t reader, void* sample) {
    bool any = false;
    dds_sample_info_t info;
    for (void* place = sample; dds_take(reader, &place, &info, 1, 1) > 0;) {
        any = any || info.valid_data;
    }
    return any;
}

int main(int count, char** words) {
    const struct arguments a = parse(count, words);
    const struct session s = join(a.place);
    const dds_entity_t poses = writer_of(s, &eti_msg_ToolPose_desc, "eti/laryngoscope_pose", state);
    const dds_entity_t commands = writer_of(s, &eti_msg_Command_desc, "eti/command", event);
    const dds_entity_t results = reader_of(s, &eti_msg_CommandResult_desc, "eti/command_result", event, 64);
    const dds_entity_t proxies = reader_of(s, &eti_msg_ProxyState_desc, "eti/proxy", state, 1);
    wait_for_reader(poses);
    wait_for_reader(commands);

    eti_msg_Command command = {.sender = "tool_writer", .id = 1, .value = a.value};
    if (a.wish) {
        snprintf(command.name, sizeof command.name, "%s", a.wish);
    }
    eti_msg_ProxyState proxy = {0};
    eti_msg_CommandResult result = {0};
    bool heard = false, answered = false;
    uint32_t commands_sent = 0;
    dds_time_t next_command = dds_time();
    const dds_time_t until = dds_time() + (dds_time_t)(a.seconds * 1e9);
    const dds_time_t patience = until + DDS_SECS(patience_s);
    for (uint32_t number = 1;
         dds_time() < until || ((!heard || (a.wish && !answered)) && dds_time() < patience); ++number) {
        // Repeated, because an answer is lost if the server has not yet discovered the reader of answers.
        if (a.wish && !answered && dds_time() >= next_command) {
            command.header = (eti_msg_Header){0, (uint64_t)dds_time(), ++commands_sent};
            dds_write(commands, &command);
            next_command = dds_time() + DDS_SECS(repeat_s);
        }
        eti_msg_ToolPose pose = {.header = {0, (uint64_t)dds_time(), number},
                                 .pose = {{a.at[0], a.at[1], a.at[2]}, {1.0f, 0.0f, 0.0f, 0.0f}}};
        dds_write(poses, &pose);
        heard = newest(proxies, &proxy) || heard;
        answered = answered || (newest(results, &result) && !strcmp(result.recipient, "tool_writer"));
        dds_sleepfor(DDS_MSECS(4));
    }
    if (!heard) {
        give_up("the server sent no proxy", "is it still running?");
    }
    const eti_msg_Vec3 device = proxy.device.position;
    printf("{\"device\": [%.9g, %.9g, %.9g], \"answered\": %s, \"accepted\": %s, \"reason\": \"%s\"}\n",
           device.x, device.y, device.z, answered ? "true" : "false",
           answered && result.accepted ? "true" : "false", result.reason);
    dds_delete(s.participant);
    return 0;
}

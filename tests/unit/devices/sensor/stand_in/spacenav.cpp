// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The entry points of libspnav over a pipe: one write is one event.
#include "tests/unit/devices/sensor/stand_in/spacenav.hpp"

#include <spnav.h>
#include <unistd.h>

#include <array>
#include <mutex>

namespace {

eti::stand_in::SpacenavState state;
std::mutex mutex;
std::array<int, 2> ends{-1, -1};

bool send(int type, const int (&values)[6], unsigned int period_ms) {
    const std::lock_guard lock(mutex);
    spnav_event event{};
    event.type = type;
    if (type == SPNAV_EVENT_MOTION) {
        event.motion.x = values[0];
        event.motion.y = values[1];
        event.motion.z = values[2];
        event.motion.rx = values[3];
        event.motion.ry = values[4];
        event.motion.rz = values[5];
        event.motion.period = period_ms;
    } else if (type == SPNAV_EVENT_DEV) {
        event.dev.op = values[0];
    } else {
        event.button.press = values[0];
        event.button.bnum = values[1];
    }
    return ends[1] >= 0 && ::write(ends[1], &event, sizeof event) == sizeof event;
}

void hang_up() {
    const std::lock_guard lock(mutex);
    state.daemon = false;
    ::close(ends[1]);
    ends[1] = -1;
}

}  // namespace

extern "C" {

eti::stand_in::SpacenavState* stand_in_spacenav() {
    state.send = &send;
    state.hang_up = &hang_up;
    return &state;
}

int spnav_open() {
    const std::lock_guard lock(mutex);
    if (!state.daemon || ::pipe(ends.data()) != 0) {
        return -1;
    }
    ++state.opened;
    return 0;
}
int spnav_close() {
    const std::lock_guard lock(mutex);
    for (int& end : ends) {
        if (end >= 0) {
            ::close(end);
        }
        end = -1;
    }
    return 0;
}
int spnav_fd() {
    return ends[0];
}
int spnav_poll_event(spnav_event* event) {
    return ::read(ends[0], event, sizeof *event) == sizeof *event ? event->type : 0;
}

}  // extern "C"

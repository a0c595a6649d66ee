// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The entry points of Ascension's 3D Guidance API, as the vendor documents them, backed by a sensor that
// rotates slowly about the transmitter's z axis. Shares no declaration with the driver under test.
#include "tests/unit/devices/sensor/stand_in/trakstar.hpp"

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

namespace {

eti::stand_in::TrakstarState state;

double seconds() {
    static const auto start = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

extern "C" {

struct DOUBLE_POSITION_MATRIX_TIME_Q_RECORD {
    double x, y, z;
    double s[3][3];
    double time;
    unsigned short quality;
};

eti::stand_in::TrakstarState* stand_in_trakstar() {
    return &state;
}

int InitializeBIRDSystem() {
    if (!state.plugged) {
        return static_cast<int>(0x80000000u | 14u);
    }
    ++state.opened;
    return 0;
}
int CloseBIRDSystem() {
    return 0;
}
int SetSystemParameter(int parameter, void* value, int size) {
    if (parameter == 5 && size == sizeof(int)) {
        int on = 0;
        std::memcpy(&on, value, sizeof on);
        state.millimetres = on != 0;
        return 0;
    }
    const bool known =
        (parameter == 0 && size == sizeof(short)) || (parameter == 3 && size == sizeof(double));
    return known ? 0 : 10;
}
int SetSensorParameter(unsigned short sensor, int parameter, void* value, int size) {
    if (parameter != 0 || size != sizeof(int)) {
        return 10;
    }
    int format = 0;
    std::memcpy(&format, value, sizeof format);
    state.format = format;
    state.sensor = sensor;
    return 0;
}
int GetAsynchronousRecord(unsigned short, void* to, int size) {
    if (!state.plugged) {
        return static_cast<int>(0x80000000u | 65u);
    }
    if (size != sizeof(DOUBLE_POSITION_MATRIX_TIME_Q_RECORD)) {
        return 28;
    }
    static double last = 0.0;
    const double now = std::floor(seconds() * state.rate) / state.rate;
    last = state.frozen ? last : now;
    const double angle = 0.1 * last;
    DOUBLE_POSITION_MATRIX_TIME_Q_RECORD record{};
    const double sign = state.other_hemisphere ? -1.0 : 1.0;
    record.x = sign * 200.0 + state.shift_mm;
    record.y = sign * 30.0;
    record.z = sign * (state.not_finite ? std::numeric_limits<double>::quiet_NaN() : 40.0);
    // Rows are the sensor's axes.
    const double s[3][3] = {{std::cos(angle), std::sin(angle), 0.0},
                            {-std::sin(angle), std::cos(angle), 0.0},
                            {0.0, 0.0, state.left_handed ? -1.0 : 1.0}};
    std::memcpy(record.s, s, sizeof s);
    record.time = last;
    std::memcpy(to, &record, sizeof record);
    return 0;
}
unsigned int GetSensorStatus(unsigned short) {
    return static_cast<unsigned int>(state.status.load());
}
int GetErrorText(int, char* text, int size, int) {
    std::strncpy(text, "USB connection has been lost", static_cast<std::size_t>(size));
    return 0;
}

}  // extern "C"

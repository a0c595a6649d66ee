// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The entry points of OpenHaptics' HD layer, as the vendor documents them, backed by a simulated device in a
// hand. Shares no declaration with the driver under test.
#include "tests/unit/devices/sensor/stand_in/openhaptics.hpp"

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "common/device/hand.hpp"

namespace {

eti::stand_in::OpenHapticsState state;

struct Servo {
    unsigned int (*callback)(void*) = nullptr;
    void* context = nullptr;
    std::atomic<bool> running{false};
    std::thread thread;
};
Servo servo;
eti::HandDevice hand{eti::HandSettings{}, {eti::Quatf::Identity(), {0.01f, 0.02f, 0.03f}}};
eti::Wrench wrench;
unsigned int last_error = 0;
int frames = 0;

}  // namespace

extern "C" {

struct HDErrorInfo {
    unsigned int errorCode;
    int internalErrorCode;
    unsigned int hHD;
};

eti::stand_in::OpenHapticsState* stand_in_openhaptics() {
    return &state;
}

unsigned int hdInitDevice(const char* name) {
    if (!state.plugged || (name != nullptr && std::string(name) == "nobody")) {
        last_error = 0x0302;
        return 0xffffffffu;
    }
    ++state.opened;
    return 7;
}
void hdDisableDevice(unsigned int) {
    state.forces_on = false;
}
void hdMakeCurrentDevice(unsigned int) {}
void hdEnable(unsigned int what) {
    state.forces_on = state.forces_on || what == 0x4000;
}
void hdBeginFrame(unsigned int) {
    if (!state.frozen) {
        // Tremor of a tenth of a millimetre at 10 Hz.
        const float tremble = 1e-4f * std::sin(0.063f * static_cast<float>(++frames));
        hand.step({eti::Quatf::Identity(), {0.01f, 0.02f + tremble, 0.03f}}, wrench, 1e-3f);
    }
    if (!state.plugged) {
        last_error = 0x0302;
    }
}
void hdEndFrame(unsigned int) {}
void hdGetDoublev(unsigned int what, double* out) {
    const eti::Motion& motion = hand.motion();
    if (what == 0x2052) {
        const Eigen::Matrix3f r = motion.pose.rotation.toRotationMatrix();
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) {
                out[4 * column + row] = static_cast<double>(r(row, column));
            }
            out[4 * column + 3] = 0.0;
            out[12 + column] = 1e3 * static_cast<double>(motion.pose.translation[column]);
        }
        out[15] = 1.0;
        out[12] += state.shift_mm;
        if (state.left_handed) {
            out[0] = -out[0];
            out[1] = -out[1];
            out[2] = -out[2];
        }
        if (state.not_finite) {
            out[13] = std::numeric_limits<double>::quiet_NaN();
        }
    } else if (what == 0x2051 || what == 0x2053) {
        const eti::Vec3f& v = what == 0x2051 ? motion.velocity : motion.angular_velocity;
        for (int k = 0; k < 3; ++k) {
            out[k] = (what == 0x2051 ? 1e3 : 1.0) * static_cast<double>(v[k]);
        }
    } else if (what == 0x2603) {
        out[0] = 3.3;  // a Touch
    }
}
void hdGetIntegerv(unsigned int what, int* out) {
    *out = what == 0x2000 ? state.buttons.load() : what == 0x2554 ? 3 : 0;
}
const char* hdGetString(unsigned int) {
    return "stand-in";
}
void hdSetDoublev(unsigned int what, const double* values) {
    if (what == 0x2700) {
        for (std::size_t k = 0; k < 3; ++k) {
            state.force[k] = values[k];
            wrench.force[static_cast<int>(k)] = state.forces_on ? static_cast<float>(values[k]) : 0.0f;
        }
    }
}
HDErrorInfo hdGetError() {
    const unsigned int code = last_error;
    last_error = 0;
    return {code, 0, 7};
}
const char* hdGetErrorString(unsigned int code) {
    return code == 0x0302 ? "communication error" : "no error";
}
unsigned long hdScheduleAsynchronous(unsigned int (*callback)(void*), void* context, unsigned short) {
    servo.callback = callback;
    servo.context = context;
    return 1;
}
void hdUnschedule(unsigned long) {
    servo.callback = nullptr;
}
void hdStartScheduler() {
    servo.running = true;
    servo.thread = std::thread([] {
        while (servo.running) {
            if (state.servo_calls && servo.callback != nullptr) {
                (void)servo.callback(servo.context);
            }
            std::this_thread::sleep_for(std::chrono::microseconds(state.servo_period_us));
        }
    });
}
void hdStopScheduler() {
    servo.running = false;
    if (servo.thread.joinable()) {
        servo.thread.join();
    }
}

}  // extern "C"

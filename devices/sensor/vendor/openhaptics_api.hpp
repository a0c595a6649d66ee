// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "devices/sensor/vendor/vendor_library.hpp"

namespace eti::devices::openhaptics {

// The part of the HD API in use, declared here after the OpenHaptics programmer's guide and API reference.
// Numbers and types agree with hdDefines.h of OpenHaptics 3.0 (SensAble Technologies 2004, build 66) as found
// in public repositories. Lengths are millimetres, forces newtons, torques newton millimetres.

using Handle = unsigned int;
using Schedule = unsigned long;
using Callback = unsigned int (*)(void* context);

struct ErrorInfo {
    unsigned int code;
    int internal_code;
    Handle device;
};

inline constexpr Handle no_device = 0xffffffffu;
inline constexpr unsigned int callback_done = 0, callback_continue = 1;
inline constexpr unsigned short highest_priority = 0xffff;

inline constexpr unsigned int current_buttons = 0x2000;
inline constexpr unsigned int current_velocity = 0x2051;
inline constexpr unsigned int current_transform = 0x2052;  // 16 doubles, columns
inline constexpr unsigned int current_angular_velocity = 0x2053;
inline constexpr unsigned int model_type = 0x2501;
inline constexpr unsigned int output_dof = 0x2554;
inline constexpr unsigned int nominal_max_force = 0x2603;
inline constexpr unsigned int nominal_max_torque = 0x2622;
inline constexpr unsigned int current_force = 0x2700;
// Deprecated in that header in favour of joint and gimbal torques. Never sent to Touch and Touch X, which
// have three motors.
inline constexpr unsigned int current_torque = 0x2701;
inline constexpr unsigned int force_output = 0x4000;

inline constexpr unsigned int success = 0;
// Force errors (0x02..) concern one frame; device errors (0x03..) mean that the device is lost.
inline constexpr unsigned int device_errors = 0x0300, error_class = 0xff00;

struct Api {
    explicit Api(const VendorLibrary& library);

    Handle (*init_device)(const char* name) = nullptr;
    void (*disable_device)(Handle) = nullptr;
    void (*make_current)(Handle) = nullptr;
    void (*begin_frame)(Handle) = nullptr;
    void (*end_frame)(Handle) = nullptr;
    void (*enable)(unsigned int) = nullptr;
    void (*get_doubles)(unsigned int, double*) = nullptr;
    void (*get_integers)(unsigned int, int*) = nullptr;
    const char* (*get_string)(unsigned int) = nullptr;
    void (*set_doubles)(unsigned int, const double*) = nullptr;
    ErrorInfo (*get_error)() = nullptr;
    const char* (*error_string)(unsigned int) = nullptr;
    void (*start_scheduler)() = nullptr;
    void (*stop_scheduler)() = nullptr;
    Schedule (*schedule)(Callback, void* context, unsigned short priority) = nullptr;
    void (*unschedule)(Schedule) = nullptr;
};

}  // namespace eti::devices::openhaptics

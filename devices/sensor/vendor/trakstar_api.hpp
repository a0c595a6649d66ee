// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "devices/sensor/vendor/vendor_library.hpp"

namespace eti::devices::trakstar {

// The part of the 3D Guidance API in use, declared here after the vendor's installation and operation guide.
// Numbers, types and the record agree with ATC3DG.h (Ascension Technology, revision 1.6) as found in public
// repositories. The name of the library on Linux is not verified; --library selects another.

inline constexpr int select_transmitter = 0;  // system parameters
inline constexpr int measurement_rate = 3;
inline constexpr int metric = 5;
inline constexpr int data_format = 0;                    // sensor parameter
inline constexpr int position_matrix_time_quality = 27;  // format of Record

inline constexpr unsigned int not_attached = 0x2, global_error = 0x1, no_transmitter = 0x880;

/// The rows of `rotation` are the sensor's axes in the transmitter's frame.
struct Record {
    double x, y, z;  // [mm]
    double rotation[3][3];
    double time;  // [s]
    unsigned short quality;
};

struct Api {
    explicit Api(const VendorLibrary& library);

    int (*initialize)() = nullptr;
    int (*close)() = nullptr;
    int (*set_system)(int parameter, void* value, int size) = nullptr;
    int (*set_sensor)(unsigned short sensor, int parameter, void* value, int size) = nullptr;
    int (*newest_record)(unsigned short sensor, void* record, int size) = nullptr;
    unsigned int (*sensor_status)(unsigned short sensor) = nullptr;
    int (*error_text)(int code, char* text, int size, int verbose) = nullptr;
};

}  // namespace eti::devices::trakstar

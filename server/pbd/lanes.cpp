// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/lanes.hpp"

#include <cstdlib>
#include <string_view>

namespace eti::pbd {

bool has_avx2() {
#if defined(__x86_64__)
    static const bool use = [] {
        const char* const wanted = std::getenv("ETI_SIMD");
        return __builtin_cpu_supports("avx2") != 0 &&
               (wanted == nullptr || std::string_view(wanted) != "sse2");
    }();
    return use;
#else
    return false;
#endif
}

}  // namespace eti::pbd

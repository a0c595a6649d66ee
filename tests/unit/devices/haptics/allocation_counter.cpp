// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Replaces the program's allocation functions by counting ones. In a file of its own, because a
// compiler that sees them inlined beside their use takes malloc and delete for a mismatch.
#include "allocation_counter.hpp"

#include <cstdlib>
#include <new>

namespace {
thread_local std::uint64_t count = 0;
}

void* operator new(std::size_t size) {
    ++count;
    if (void* memory = std::malloc(size == 0 ? 1 : size)) {
        return memory;
    }
    throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    ++count;
    const auto multiple = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(multiple, (size + multiple - 1) / multiple * multiple)) {
        return memory;
    }
    throw std::bad_alloc();
}
// The library's own would call the first, a sanitizer's would not.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    ++count;
    return std::malloc(size == 0 ? 1 : size);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace eti::devices {

std::uint64_t allocations() {
    return count;
}

}  // namespace eti::devices

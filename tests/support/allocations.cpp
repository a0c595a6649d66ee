// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Replaces the program's allocation functions with counting ones. They have a file of their own: a compiler
// that inlines them at the call site reports a mismatch of malloc and delete.
#include "tests/support/allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<long> allocation_count{0};
thread_local long count_here = 0;

void add() {
    ++allocation_count;
    ++count_here;
}
}  // namespace

void* operator new(std::size_t size) {
    add();
    if (void* memory = std::malloc(size > 0 ? size : 1)) {
        return memory;
    }
    throw std::bad_alloc();
}

void* operator new(std::size_t size, std::align_val_t alignment) {
    add();
    const auto multiple = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(multiple, (size + multiple - 1) / multiple * multiple)) {
        return memory;
    }
    throw std::bad_alloc();
}

// The standard library's nothrow version calls the one above; a sanitizer's does not.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    add();
    return std::malloc(size > 0 ? size : 1);
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

namespace eti::test {

long allocations() {
    return allocation_count;
}

long allocations_here() {
    return count_here;
}

}  // namespace eti::test

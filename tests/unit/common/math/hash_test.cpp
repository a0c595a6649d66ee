// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/math/hash.hpp"

#include <gtest/gtest.h>

#include <array>

namespace eti {
namespace {

std::uint64_t of(std::string_view text) {
    Hash hash;
    hash.add(text);
    return hash.value();
}

/// Test vectors of FNV-1a, 64 bits (Fowler, Noll and Vo, test_fnv.c).
TEST(Hash, GivesThePublishedValues) {
    EXPECT_EQ(of(""), 0xcbf29ce484222325ULL);
    EXPECT_EQ(of("a"), 0xaf63dc4c8601ec8cULL);
    EXPECT_EQ(of("foobar"), 0x85944171f73967e8ULL);
}

TEST(Hash, IsIndependentOfPartition) {
    Hash apart;
    apart.add(std::string_view("foo"));
    const std::array<char, 3> bar{'b', 'a', 'r'};
    apart.add(std::span(bar));
    EXPECT_EQ(apart.value(), of("foobar"));
}

}  // namespace
}  // namespace eti

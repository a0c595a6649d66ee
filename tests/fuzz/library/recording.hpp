// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

namespace eti::fuzz {

/// Has a client and a server meet over the memory network, exchange samples while every fifth datagram is
/// lost, and part. Writes what the client received into `folder` as inputs: `introduction` until both know
/// each other, and further ones, each with some datagrams in a row.
void record(const std::filesystem::path& folder, const std::filesystem::path& lab);

}  // namespace eti::fuzz

// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::session {

/// Writes a session into the new file `to` without what says who took part, where and when: the participant
/// (in whose place stands `participant`, if any), the session's name, its start, folders, file names and
/// times of the file's own structure. People who commanded, wrote, drew or rated become "person 1", "person
/// 2", ..., also where texts name them. Series of numbers stay as they are, to the bit. Scenario and operator
/// stay as they were written, and so does what people wrote. Returns in words what went. Throws hdf5::Error.
std::vector<std::string> anonymise(const std::filesystem::path& from, const std::filesystem::path& to,
                                   const std::string& participant);

}  // namespace eti::session

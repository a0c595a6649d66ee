// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::session {

/// Writes an anonymised copy of a session into the new file `to`, without identity, place and time. Removed
/// are the participant (replaced by `participant`, if given), the session's name, its start, folders, file
/// names and creation times in the file's structure. People who sent commands, wrote, drew or rated become
/// "person 1", "person 2", ..., also where texts mention them. Numeric series are unchanged to the bit.
/// Scenario, operator and what people wrote are otherwise unchanged. Returns a description of what was
/// removed. Throws hdf5::Error.
std::vector<std::string> anonymise(const std::filesystem::path& from, const std::filesystem::path& to,
                                   const std::string& participant);

}  // namespace eti::session

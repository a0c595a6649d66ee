// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <ctime>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace eti::bus {

/// Topics that may be written or read in these partitions; both may hold wildcards (fnmatch).
struct Criteria {
    std::vector<std::string> topics;
    std::vector<std::string> partitions;
};

/// An allow_rule of DDS Security 1.1, 9.4.1.3.
struct Rule {
    std::vector<std::pair<int, int>> domains;  ///< first and last
    std::vector<Criteria> publish;
    std::vector<Criteria> subscribe;
};

/// A grant: the permissions of one subject.
struct Permit {
    std::string subject;  ///< in RFC 2253 form
    std::time_t from = 0;
    std::time_t until = 0;
    std::vector<Rule> rules;

    [[nodiscard]] bool domain(int number) const;
    /// Whether any topic may be read or written in this partition of the domain.
    [[nodiscard]] bool partition(int domain, const std::string& name) const;
    /// Whether the topic may be written (else: read) there.
    [[nodiscard]] bool topic(int domain, const std::string& partition, const std::string& name,
                             bool write) const;
};

/// The grants of a permissions document. Dates are local time, as in the library. Throws std::runtime_error
/// with the line if it is not a permissions document.
[[nodiscard]] std::vector<Permit> read_permits(std::string_view document);

}  // namespace eti::bus

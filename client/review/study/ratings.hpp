// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/review/statistics.hpp"
#include "common/session/opinions.hpp"

namespace eti::review {

/// An invalid rating on the command line; the message states what was found and expected.
class RatingError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Parses "ITEM=SCORE"; the item has at most 40 letters, digits, '_' and '-'. Throws RatingError.
[[nodiscard]] session::Rating parse_rating(const std::string& text, const std::string& rater);

/// Validates the name of a person, a form or similar: 1 to 40 bytes without control characters. Throws
/// RatingError.
void require_name(const std::string& option, const std::string& name);

/// Inter-rater agreement on one item.
struct ItemAgreement {
    std::string item;
    std::vector<std::string> raters;
    std::size_t sessions = 0;  ///< rated by all of them
    std::size_t left_out = 0;  ///< rated by only some of them
    Agreement value;
};

/// One entry per item rated in these files. Throws hdf5::Error; RatingError if nothing was rated.
[[nodiscard]] std::vector<ItemAgreement> rater_agreement(const std::vector<std::filesystem::path>& files,
                                                         double level);

[[nodiscard]] std::string to_table(const std::vector<ItemAgreement>& items);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<ItemAgreement>& items);

}  // namespace eti::review

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

/// A rating on the command line that cannot be taken; the text says what was found and expected.
class RatingError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// From "ITEM=SCORE", with the item a word of at most 40 letters, digits, '_' and '-'. Throws RatingError.
[[nodiscard]] session::Rating parse_rating(const std::string& text, const std::string& rater);

/// The name of a person, a form or the like: 1 to 40 bytes without control characters. Throws RatingError.
void require_name(const std::string& option, const std::string& name);

/// How far the raters of one item agree.
struct ItemAgreement {
    std::string item;
    std::vector<std::string> raters;
    std::size_t sessions = 0;  ///< that all of them rated
    std::size_t left_out = 0;  ///< that only some of them rated
    Agreement value;
};

/// For each item that was rated in these files. Throws hdf5::Error; RatingError where nothing was rated.
[[nodiscard]] std::vector<ItemAgreement> rater_agreement(const std::vector<std::filesystem::path>& files,
                                                         double level);

[[nodiscard]] std::string to_table(const std::vector<ItemAgreement>& items);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<ItemAgreement>& items);

}  // namespace eti::review
